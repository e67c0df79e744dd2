// SPDX-License-Identifier: Apache-2.0
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "transport/tensor.h"

enum { VERSION = 1 };

struct tensor_writer {
    char path[4096], temp[4096];
    unsigned char *map;
    size_t size, parts; // of the file; marks behind it while it is being made
    bool kept;
    int nameless; // the file, which has no name yet; -1: it has its temporary one
    unsigned char *data;
    uint64_t *values, *halves, *sums; // offsets by block
    uint64_t fixed, fixed_sums;
    const struct tensor *shape; // while the writer is being made
};

// ---- header -------------------------------------------------------------------------------------

// Other readers of such files refuse bytes that belong to no array.
static void add_padding(struct json *header, uint64_t from, uint64_t to) {
    char name[64];
    snprintf(name, sizeof name, "padding.%" PRIu64, from);
    struct json *entry = json_add_object(header, name);
    json_add_text(entry, "dtype", "U8");
    json_append_count(json_add_array(entry, "shape"), (int64_t)(to - from));
    struct json *offsets = json_add_array(entry, "data_offsets");
    json_append_count(offsets, (int64_t)from);
    json_append_count(offsets, (int64_t)to);
}

// Adds an array behind the others and returns where it begins.
static uint64_t add_array(struct json *header, const char *name, const char *dtype, size_t item,
                          const uint64_t *shape, int rank, uint64_t *end) {
    const uint64_t begin = (*end + TENSOR_ALIGN - 1) / TENSOR_ALIGN * TENSOR_ALIGN;
    if (begin > *end)
        add_padding(header, *end, begin);
    struct json *entry = json_add_object(header, name);
    uint64_t bytes = item;
    json_add_text(entry, "dtype", dtype);
    struct json *sizes = json_add_array(entry, "shape");
    for (int i = 0; i < rank; i++) {
        json_append_count(sizes, (int64_t)shape[i]);
        bytes *= shape[i];
    }
    struct json *offsets = json_add_array(entry, "data_offsets");
    json_append_count(offsets, (int64_t)begin);
    json_append_count(offsets, (int64_t)(begin + bytes));
    *end = begin + bytes;
    return begin;
}

static const char *storage_name(enum tensor_storage s) {
    return s == TENSOR_BF16 ? "BF16" : s == TENSOR_ROWS ? "ROWS" : "F32";
}

static void describe_block(struct json *blocks, const struct tensor_block *b) {
    struct json *j = json_append_object(blocks);
    json_add_text(j, "object", b->object);
    json_add_text(j, "term", b->term);
    json_add_text(j, "storage", storage_name(b->storage));
    json_add_count(j, "pixels", (int64_t)b->pixel_count);
    json_add_count(j, "channels", b->channels);
    json_add_count(j, "groups", b->groups);
    struct json *axes = json_add_array(j, "axes");
    for (uint32_t i = 0; i < b->axis_count; i++) {
        struct json *axis = json_append_object(axes);
        json_add_text(axis, "name", b->axes[i].name);
        json_add_text(axis, "basis", b->axes[i].basis == TENSOR_HAT ? "hat" : "box");
        json_add_count(axis, "bins", b->axes[i].bins);
        json_add_bool(axis, "edges", b->axes[i].edges != NULL);
    }
}

static struct json *describe(const struct tensor *t) {
    struct json *meta = t->meta ? json_clone(t->meta) : json_new_object();
    json_add_count(meta, "version", VERSION);
    json_add_count(meta, "width", t->width);
    json_add_count(meta, "height", t->height);
    struct json *blocks = json_add_array(meta, "blocks");
    for (uint32_t i = 0; i < t->block_count; i++)
        describe_block(blocks, &t->blocks[i]);
    return meta;
}

// Small arrays that are known already, copied when the file is mapped.
struct copy {
    uint64_t to;
    const void *from;
    size_t size;
};

struct plan {
    struct json *header;
    uint64_t end;
    struct copy *copies;
    size_t count, capacity;
};

static uint64_t add_small(struct plan *p, uint32_t block, const char *what, const char *dtype,
                          size_t item, const uint64_t *shape, int rank, const void *from,
                          uint64_t size) {
    char name[64];
    snprintf(name, sizeof name, "%u.%s", block, what);
    const uint64_t at = add_array(p->header, name, dtype, item, shape, rank, &p->end);
    if (from) {
        mem_grow(&p->copies, &p->capacity, p->count + 1, sizeof *p->copies);
        p->copies[p->count++] = (struct copy){at, from, size};
    }
    return at;
}

static uint64_t plan_rows(struct plan *p, uint32_t i, const struct tensor_block *b, bool halves) {
    const struct tensor_rows *r = halves ? &b->half_rows : &b->value_rows;
    const uint64_t shape[2] = {tensor_tiles(b), b->coefficients}, ends = shape[0] + 1;
    add_small(p, i, halves ? "half_rows" : "value_rows", "U32", 4, shape, 2, r->entries,
              shape[0] * shape[1] * 4);
    add_small(p, i, halves ? "half_starts" : "value_starts", "U64", 8, &ends, 1, r->starts, ends * 8);
    return add_small(p, i, halves ? "halves" : "values", "U8", 1, &r->starts[shape[0]], 1, NULL, 0);
}

// Values and halves, whose offset is returned.
static uint64_t plan_values(struct plan *p, uint32_t i, const struct tensor_block *b, bool halves) {
    const uint64_t shape[4] = {tensor_tiles(b), b->coefficients, b->channels, TENSOR_LANES};
    return b->storage == TENSOR_ROWS
               ? plan_rows(p, i, b, halves)
               : add_small(p, i, halves ? "halves" : "values", storage_name(b->storage),
                           tensor_value_size(b->storage), shape, 4, NULL, 0);
}

static void plan_block(struct tensor_writer *w, struct plan *p, uint32_t i) {
    const struct tensor_block *b = &w->shape->blocks[i];
    const uint64_t tiles = tensor_tiles(b);
    const uint64_t sums[4] = {tiles, b->coefficients, 2ull * b->channels, TENSOR_LANES};
    const uint64_t view[2] = {tiles, TENSOR_LANES}, views[3] = {2, tiles, TENSOR_LANES};
    const uint64_t weights[2] = {b->coefficients, b->channels};
    add_small(p, i, "pixels", "U32", 4, &b->pixel_count, 1, b->pixels, b->pixel_count * 4);
    for (uint32_t a = 0; a < b->axis_count; a++) {
        const uint64_t edges = tensor_edges(&b->axes[a]);
        if (b->axes[a].edges)
            add_small(p, i, a ? "edges1" : "edges0", "F64", 8, &edges, 1, b->axes[a].edges, edges * 8);
    }
    if (b->view)
        add_small(p, i, "view", "F32", 4, view, 2, b->view, tiles * TENSOR_LANES * 4);
    if (b->views)
        add_small(p, i, "views", "F64", 8, views, 3, b->views, tiles * TENSOR_LANES * 16);
    if (b->weights)
        add_small(p, i, "weights", "F32", 4, weights, 2, b->weights, weights[0] * weights[1] * 4);
    w->values[i] = plan_values(p, i, b, false);
    if (b->halves)
        w->halves[i] = plan_values(p, i, b, true);
    if (b->sums)
        w->sums[i] = add_small(p, i, "sums", "F64", 8, sums, 4, NULL, 0);
}

// The header as a text that ends, with the length before it, at a multiple of the alignment.
static char *header_text(struct json *header, uint64_t *size) {
    char *text = json_to_text(header);
    const size_t n = strlen(text);
    *size = (n + 8 + TENSOR_ALIGN - 1) / TENSOR_ALIGN * TENSOR_ALIGN - 8;
    char *padded = mem_array(*size + 1, 1);
    memcpy(padded, text, n);
    memset(padded + n, ' ', *size - n);
    mem_free(text);
    return padded;
}

// ---- file ---------------------------------------------------------------------------------------

// Whether the file that is there is the same one, begun earlier.
static bool was_begun(const struct tensor_writer *w, int fd, const char *header, uint64_t n) {
    struct stat st;
    bool same = w->kept && fstat(fd, &st) == 0 && st.st_size == (off_t)(w->size + w->parts);
    char *there = mem_array(n + 1, 1);
    same = same && pread(fd, there, n, 8) == (ssize_t)n && memcmp(there, header, n) == 0;
    mem_free(there);
    return same;
}

// A file that goes when the process is killed, where the file system has such and /proc can name it.
static int open_nameless(const char *path) {
    char directory[4096];
    file_directory(path, directory, sizeof directory);
    return access("/proc/self/fd", X_OK) == 0 ? open(directory, O_TMPFILE | O_RDWR, 0644) : -1;
}

static bool give_name(struct tensor_writer *w) {
    char from[64];
    snprintf(from, sizeof from, "/proc/self/fd/%d", w->nameless);
    unlink(w->temp); // of another process that had this number
    const bool given = linkat(AT_FDCWD, from, AT_FDCWD, w->temp, AT_SYMLINK_FOLLOW) == 0;
    if (given) {
        close(w->nameless);
        w->nameless = -1;
    }
    return given;
}

static bool map_file(struct tensor_writer *w, const char *header, uint64_t n) {
    const size_t size = w->size + w->parts;
    w->nameless = w->kept ? -1 : open_nameless(w->path);
    const int fd = w->nameless >= 0 ? w->nameless : open(w->temp, O_RDWR | O_CREAT, 0644);
    int error = fd < 0 || (!was_begun(w, fd, header, n) && ftruncate(fd, 0) != 0) ? errno : 0;
    // Room is taken now: a full disk would otherwise end the process when a page is written.
    error = error ? error : posix_fallocate(fd, 0, (off_t)size);
    void *map = error ? MAP_FAILED : mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (!error && map == MAP_FAILED)
        error = errno;
    if (fd >= 0 && fd != w->nameless)
        close(fd);
    if (error) {
        log_error("%s: cannot be written (%zu bytes): %s", w->path, w->size, strerror(error));
        file_discard(w->temp);
        return false;
    }
    w->map = map;
    return true;
}

static bool write_plan(struct tensor_writer *w, const struct plan *p) {
    uint64_t n;
    char *text = header_text(p->header, &n);
    w->size = 8 + n + p->end;
    const bool mapped = map_file(w, text, n);
    if (mapped) {
        memcpy(w->map, &n, sizeof n);
        memcpy(w->map + 8, text, n);
        w->data = w->map + 8 + n;
        for (size_t i = 0; i < p->count; i++)
            memcpy(w->data + p->copies[i].to, p->copies[i].from, p->copies[i].size);
    }
    mem_free(text);
    return mapped;
}

static bool make_file(struct tensor_writer *w) {
    const struct tensor *t = w->shape;
    struct plan p = {.header = json_new_object()};
    const uint64_t fixed[3] = {3, t->height, t->width};
    struct json *meta = describe(t);
    char *text = json_to_text(meta);
    json_add_text(json_add_object(p.header, "__metadata__"), "relume", text);
    for (uint32_t i = 0; i < t->block_count; i++)
        plan_block(w, &p, i);
    if (t->fixed)
        w->fixed = add_array(p.header, "fixed", "F32", 4, fixed, 3, &p.end);
    if (t->fixed_sums)
        w->fixed_sums = add_array(p.header, "fixed_sums", "F64", 8, fixed, 3, &p.end);
    const bool made = write_plan(w, &p);
    mem_free(text);
    json_destroy(meta);
    json_destroy(p.header);
    mem_free(p.copies);
    return made;
}

// Makes the file under its temporary name. NULL after an error message.
static struct tensor_writer *begin(struct tensor_writer *w, const struct tensor *shape, bool named) {
    w->shape = shape;
    w->nameless = -1;
    w->values = mem_array(shape->block_count, sizeof *w->values);
    w->halves = mem_array(shape->block_count, sizeof *w->halves);
    w->sums = mem_array(shape->block_count, sizeof *w->sums);
    const bool made = named && make_file(w);
    w->shape = NULL;
    if (made)
        return w;
    w->temp[0] = '\0';
    tensor_abandon(w);
    return NULL;
}

struct tensor_writer *tensor_create(const char *path, const struct tensor *shape) {
    struct tensor_writer *w = mem_array(1, sizeof *w);
    const bool named = snprintf(w->path, sizeof w->path, "%s", path) < (int)sizeof w->path &&
                       file_temp_name(path, w->temp, sizeof w->temp);
    return begin(w, shape, named);
}

struct tensor_writer *tensor_create_kept(const char *path, const struct tensor *shape, size_t parts,
                                         unsigned char **marks) {
    struct tensor_writer *w = mem_array(1, sizeof *w);
    const bool named =
        snprintf(w->temp, sizeof w->temp, "%s.part", path) < (int)sizeof w->temp &&
        snprintf(w->path, sizeof w->path, "%s", path) < (int)sizeof w->path;
    if (!named)
        log_error("%s: name is too long", path);
    w->kept = true;
    w->parts = parts;
    w = begin(w, shape, named);
    *marks = w ? w->map + w->size : NULL;
    return w;
}

void *tensor_values(struct tensor_writer *w, uint32_t block) {
    return w->data + w->values[block];
}

void *tensor_halves(struct tensor_writer *w, uint32_t block) {
    return w->data + w->halves[block];
}

double *tensor_sums(struct tensor_writer *w, uint32_t block) {
    return (double *)(void *)(w->data + w->sums[block]);
}

float *tensor_fixed(struct tensor_writer *w) {
    return (float *)(void *)(w->data + w->fixed);
}

double *tensor_fixed_sums(struct tensor_writer *w) {
    return (double *)(void *)(w->data + w->fixed_sums);
}

bool tensor_finish(struct tensor_writer *w) {
    const bool synced = msync(w->map, w->size, MS_SYNC) == 0 && (w->nameless < 0 || give_name(w)) &&
                        (!w->kept || truncate(w->temp, (off_t)w->size) == 0);
    if (!synced)
        log_error("%s: cannot be written: %s", w->path, strerror(errno));
    const bool written = synced && file_commit(w->temp, w->path);
    if (written)
        w->temp[0] = '\0';
    tensor_abandon(w);
    return written;
}

void tensor_abandon(struct tensor_writer *w) {
    if (w->map)
        munmap(w->map, w->size + w->parts);
    if (w->nameless >= 0)
        close(w->nameless);
    else if (w->temp[0] && !w->kept)
        file_discard(w->temp);
    mem_free(w->values);
    mem_free(w->halves);
    mem_free(w->sums);
    mem_free(w);
}
