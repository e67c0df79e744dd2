// SPDX-License-Identifier: Apache-2.0
// Opening a tensor: nothing of the file is believed before it was checked.
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "transport/tensor.h"

enum {
    VERSION = 1,
    MOST_HEADER = 1 << 27, // bytes
    MOST_BLOCKS = 1 << 16,
    MOST_RANK = 4,
    MOST_COUNT = 1 << 28,  // of bins, groups and coefficients
};

struct extent {
    uint64_t begin, end;
};

struct tensor_file {
    const char *path;
    const unsigned char *map;
    size_t size;
    const unsigned char *data; // after the header
    size_t data_size;
    struct json *header, *meta;
    struct tensor tensor;
    struct extent *extents; // of the arrays seen so far
    size_t extent_count, extent_capacity;
    struct arena arena;
};

static bool fail(const struct tensor_file *f, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static bool fail(const struct tensor_file *f, const char *format, ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    log_error("%s: %s", f->path, text);
    return false;
}

// ---- arrays -------------------------------------------------------------------------------------

struct array {
    const char *name, *dtype;
    int rank;
    uint64_t shape[MOST_RANK];
};

static bool read_count(const struct json *value, uint64_t *out) {
    int64_t v;
    if (!json_read_integer(value, &v) || v < 0)
        return false;
    *out = (uint64_t)v;
    return true;
}

static size_t item_size(const char *dtype) {
    static const struct {
        const char *name;
        size_t size;
    } types[] = {{"F32", 4}, {"BF16", 2}, {"U32", 4}, {"F64", 8}, {"U64", 8}, {"U8", 1}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(types[i].name, dtype) == 0)
            return types[i].size;
    return 0;
}

// Whether the entry's shape is the expected one.
static bool has_shape(const struct json *entry, const struct array *a) {
    const struct json *shape = json_get(entry, "shape");
    bool equal = json_is_array(shape) && json_count(shape) == (size_t)a->rank;
    for (int i = 0; i < a->rank && equal; i++) {
        uint64_t n;
        equal = read_count(json_at(shape, (size_t)i), &n) && n == a->shape[i];
    }
    return equal;
}

// The array's data, or NULL: absent (an error if it must be there) or wrong.
static const void *find_array(struct tensor_file *f, const struct array *a, bool required,
                              bool *wrong) {
    const struct json *entry = json_get(f->header, a->name);
    const struct json *offsets = json_get(entry, "data_offsets");
    const char *dtype = json_text(json_get(entry, "dtype"));
    uint64_t begin, end, bytes = item_size(a->dtype);
    *wrong = required || entry;
    if (!entry) {
        if (required)
            fail(f, "array %s is missing", a->name);
        return NULL;
    }
    for (int i = 0; i < a->rank; i++)
        if (a->shape[i] && bytes > f->data_size / a->shape[i])
            return fail(f, "array %s would be larger than the file", a->name), NULL;
        else
            bytes *= a->shape[i];
    if (!dtype || strcmp(dtype, a->dtype) != 0)
        return fail(f, "array %s: found type %s, expected %s", a->name, dtype ? dtype : "none", a->dtype),
               NULL;
    if (!has_shape(entry, a))
        return fail(f, "array %s: its shape does not fit the metadata", a->name), NULL;
    if (json_count(offsets) != 2 || !read_count(json_at(offsets, 0), &begin) ||
        !read_count(json_at(offsets, 1), &end) || begin > end || end > f->data_size ||
        end - begin != bytes)
        return fail(f, "array %s: its offsets do not hold %" PRIu64 " bytes inside the file", a->name,
                    bytes), NULL;
    if (begin % TENSOR_ALIGN)
        return fail(f, "array %s: does not begin at a multiple of %d bytes", a->name, TENSOR_ALIGN), NULL;
    mem_grow(&f->extents, &f->extent_capacity, f->extent_count + 1, sizeof *f->extents);
    f->extents[f->extent_count++] = (struct extent){begin, end};
    *wrong = false;
    return f->data + begin;
}

static int by_begin(const void *a, const void *b) {
    const struct extent *x = a, *y = b;
    return x->begin < y->begin ? -1 : x->begin > y->begin;
}

static bool arrays_are_apart(struct tensor_file *f) {
    qsort(f->extents, f->extent_count, sizeof *f->extents, by_begin);
    for (size_t i = 1; i < f->extent_count; i++)
        if (f->extents[i].begin < f->extents[i - 1].end)
            return fail(f, "two arrays overlap at byte %" PRIu64 " of the data", f->extents[i].begin);
    return true;
}

// ---- blocks -------------------------------------------------------------------------------------

static const char *array_name(struct tensor_file *f, uint32_t block, const char *what) {
    return arena_printf(&f->arena, "%u.%s", block, what);
}

static bool read_axis(struct tensor_file *f, const struct json *j, uint32_t block, int which,
                      struct tensor_axis *a) {
    const char *basis = json_text(json_get(j, "basis"));
    uint64_t bins;
    bool wrong, has_edges = false;
    a->name = json_text(json_get(j, "name"));
    if (!a->name || !basis || (strcmp(basis, "box") != 0 && strcmp(basis, "hat") != 0) ||
        !read_count(json_get(j, "bins"), &bins) || bins < 1 || bins > MOST_COUNT)
        return fail(f, "block %u: axis %d is not described", block, which);
    a->basis = strcmp(basis, "hat") == 0 ? TENSOR_HAT : TENSOR_BOX;
    a->bins = (uint32_t)bins;
    json_read_bool(json_get(j, "edges"), &has_edges);
    if (!has_edges)
        return true;
    const struct array edges = {array_name(f, block, which ? "edges1" : "edges0"), "F64", 1,
                                {tensor_edges(a)}};
    a->edges = find_array(f, &edges, true, &wrong);
    if (wrong)
        return false;
    for (uint64_t i = 0; i < tensor_edges(a); i++)
        if (!isfinite(a->edges[i]) || (i && !(a->edges[i] > a->edges[i - 1])))
            return fail(f, "array %s: edge %" PRIu64 " does not lie above the one before",
                        edges.name, i);
    return true;
}

static bool read_axes(struct tensor_file *f, const struct json *j, uint32_t block,
                      struct tensor_block *b) {
    const struct json *axes = json_get(j, "axes");
    uint64_t groups, all;
    if (!json_is_array(axes) || json_count(axes) > TENSOR_MOST_AXES ||
        !read_count(json_get(j, "groups"), &groups) || groups < 1 || groups > MOST_COUNT)
        return fail(f, "block %u: axes or groups are not described", block);
    b->axis_count = (uint32_t)json_count(axes);
    b->groups = (uint32_t)groups;
    all = groups;
    for (uint32_t i = 0; i < b->axis_count; i++) {
        if (!read_axis(f, json_at(axes, i), block, (int)i, &b->axes[i]))
            return false;
        all *= b->axes[i].bins;
        if (all > MOST_COUNT)
            return fail(f, "block %u: more than %d coefficients", block, MOST_COUNT);
    }
    b->coefficients = (uint32_t)all;
    return true;
}

static bool read_pixels(struct tensor_file *f, uint32_t block, struct tensor_block *b) {
    const uint64_t most = (uint64_t)f->tensor.width * f->tensor.height;
    const struct array pixels = {array_name(f, block, "pixels"), "U32", 1, {b->pixel_count}};
    bool wrong;
    b->pixels = find_array(f, &pixels, true, &wrong);
    if (wrong)
        return false;
    uint64_t *seen = mem_array(most / 64 + 1, sizeof *seen), wrong_one = 0;
    for (uint64_t i = 0; i < b->pixel_count && !wrong; i++) {
        const uint32_t p = b->pixels[i];
        wrong = p >= most || seen[p / 64] >> p % 64 & 1;
        wrong_one = i;
        if (!wrong)
            seen[p / 64] |= 1ull << p % 64;
    }
    mem_free(seen);
    return !wrong || fail(f, "array %s: pixel %" PRIu64 " of the list is outside the picture, or there "
                          "twice", pixels.name, wrong_one);
}

// An array whose only length is not known before.
static const void *find_bytes(struct tensor_file *f, const char *name, bool required, uint64_t *bytes,
                              bool *wrong) {
    const struct json *shape = json_get(json_get(f->header, name), "shape");
    *bytes = 0;
    read_count(json_at(shape, 0), bytes);
    return find_array(f, &(struct array){name, "U8", 1, {*bytes}}, required, wrong);
}

static bool read_rows(struct tensor_file *f, uint32_t block, const struct tensor_block *b, bool halves,
                      const void **values, struct tensor_rows *r) {
    const uint64_t tiles = tensor_tiles(b);
    const struct array entries = {array_name(f, block, halves ? "half_rows" : "value_rows"), "U32", 2,
                                  {tiles, b->coefficients}};
    const struct array starts = {array_name(f, block, halves ? "half_starts" : "value_starts"), "U64",
                                 1, {tiles + 1}};
    uint64_t bytes;
    bool wrong;
    *values = find_bytes(f, array_name(f, block, halves ? "halves" : "values"), !halves, &bytes, &wrong);
    if (wrong || !*values)
        return !wrong;
    r->entries = find_array(f, &entries, true, &wrong);
    if (wrong)
        return false;
    r->starts = find_array(f, &starts, true, &wrong);
    if (wrong)
        return false;
    const char *fault = rows_fault(r, tiles, b->coefficients, bytes);
    return !fault || fail(f, "array %s: its rows %s", entries.name, fault);
}

// Values and halves, which may be absent.
static bool read_values(struct tensor_file *f, const char *dtype, uint32_t block,
                        struct tensor_block *b) {
    bool wrong;
    if (b->storage == TENSOR_ROWS)
        return read_rows(f, block, b, false, &b->values, &b->value_rows) &&
               read_rows(f, block, b, true, &b->halves, &b->half_rows);
    struct array values = {array_name(f, block, "values"), dtype, 4,
                           {tensor_tiles(b), b->coefficients, b->channels, TENSOR_LANES}};
    b->values = find_array(f, &values, true, &wrong);
    if (wrong)
        return false;
    values.name = array_name(f, block, "halves");
    b->halves = find_array(f, &values, false, &wrong);
    return !wrong;
}

static bool read_storage(const char *name, enum tensor_storage *out) {
    static const char *const names[] = {"F32", "BF16", "ROWS"}; // by enum tensor_storage
    for (int i = 0; name && i < 3; i++)
        if (strcmp(name, names[i]) == 0) {
            *out = (enum tensor_storage)i;
            return true;
        }
    return false;
}

static bool read_block(struct tensor_file *f, const struct json *j, uint32_t block,
                       struct tensor_block *b) {
    const char *storage = json_text(json_get(j, "storage"));
    uint64_t channels;
    bool wrong;
    b->object = json_text(json_get(j, "object"));
    b->term = json_text(json_get(j, "term"));
    if (!b->object || !b->term || !read_storage(storage, &b->storage) ||
        !read_count(json_get(j, "channels"), &channels) || channels != 3 ||
        !read_count(json_get(j, "pixels"), &b->pixel_count) || b->pixel_count > UINT32_MAX)
        return fail(f, "block %u: object, term, storage, channels or pixels are not described", block);
    b->channels = (uint32_t)channels;
    if (!read_axes(f, j, block, b) || !read_pixels(f, block, b) || !read_values(f, storage, block, b))
        return false;
    const uint64_t tiles = tensor_tiles(b);
    const struct array sums = {array_name(f, block, "sums"), "F64", 4,
                               {tiles, b->coefficients, 2 * channels, TENSOR_LANES}};
    const struct array views = {array_name(f, block, "views"), "F64", 3, {2, tiles, TENSOR_LANES}};
    const struct array view = {array_name(f, block, "view"), "F32", 2, {tiles, TENSOR_LANES}};
    b->sums = find_array(f, &sums, false, &wrong);
    if (wrong)
        return false;
    b->view = find_array(f, &view, false, &wrong);
    if (wrong)
        return false;
    b->views = find_array(f, &views, false, &wrong);
    if (wrong)
        return false;
    const struct array weights = {array_name(f, block, "weights"), "F32", 2,
                                  {b->coefficients, channels}};
    b->weights = find_array(f, &weights, false, &wrong);
    return !wrong;
}

// ---- file ---------------------------------------------------------------------------------------

// Sums of all blocks or of none.
static bool sums_are_whole(struct tensor_file *f) {
    const struct tensor *t = &f->tensor;
    for (uint32_t i = 0; i < t->block_count; i++)
        if (!t->blocks[i].sums != !t->fixed_sums ||
            !t->blocks[i].views != !(t->blocks[i].view && t->fixed_sums))
            return fail(f, "block %u: some sums are there and some are not", i);
    return true;
}

static bool read_meta(struct tensor_file *f) {
    struct tensor *t = &f->tensor;
    const struct json *blocks = json_get(f->meta, "blocks");
    uint64_t version, width, height;
    bool wrong;
    if (!read_count(json_get(f->meta, "version"), &version) || version != VERSION)
        return fail(f, "is not a tensor of version %d", VERSION);
    if (!read_count(json_get(f->meta, "width"), &width) || width < 1 || width > 65536 ||
        !read_count(json_get(f->meta, "height"), &height) || height < 1 || height > 65536)
        return fail(f, "the size of the picture is not described");
    if (!json_is_array(blocks) || json_count(blocks) > MOST_BLOCKS)
        return fail(f, "the blocks are not described");
    t->width = (uint32_t)width;
    t->height = (uint32_t)height;
    t->meta = f->meta;
    t->block_count = (uint32_t)json_count(blocks);
    t->blocks = arena_alloc(&f->arena, (t->block_count + 1) * sizeof *t->blocks);
    for (uint32_t i = 0; i < t->block_count; i++)
        if (!read_block(f, json_at(blocks, i), i, &t->blocks[i]))
            return false;
    const struct array fixed = {"fixed", "F32", 3, {3, height, width}};
    t->fixed = find_array(f, &fixed, false, &wrong);
    if (wrong)
        return false;
    struct array fixed_sums = fixed;
    fixed_sums.name = "fixed_sums";
    fixed_sums.dtype = "F64";
    t->fixed_sums = find_array(f, &fixed_sums, false, &wrong);
    return !wrong && sums_are_whole(f) && arrays_are_apart(f);
}

static bool read_header(struct tensor_file *f) {
    uint64_t n;
    if (f->size < sizeof n)
        return fail(f, "is too short for a tensor");
    memcpy(&n, f->map, sizeof n);
    if (n < 2 || n > MOST_HEADER || n > f->size - sizeof n)
        return fail(f, "is not a safetensors file: its header would have %" PRIu64 " bytes", n);
    if ((n + sizeof n) % TENSOR_ALIGN)
        return fail(f, "its data do not begin at a multiple of %d bytes", TENSOR_ALIGN);
    f->data = f->map + sizeof n + n;
    f->data_size = f->size - sizeof n - n;
    f->header = json_parse((const char *)f->map + sizeof n, n, f->path);
    if (!f->header)
        return false;
    const char *text = json_text(json_get(json_get(f->header, "__metadata__"), "relume"));
    if (!text)
        return fail(f, "has no metadata of relume");
    f->meta = json_parse(text, strlen(text), f->path);
    return f->meta && read_meta(f);
}

struct tensor_file *tensor_open(const char *path) {
    struct tensor_file *f = mem_array(1, sizeof *f);
    f->path = arena_strdup(&f->arena, path);
    f->map = file_map(path, &f->size);
    if (f->map && read_header(f))
        return f;
    tensor_close(f);
    return NULL;
}

const struct tensor *tensor_get(const struct tensor_file *f) {
    return &f->tensor;
}

static bool all_finite(const float *values, uint64_t n) {
    bool finite = true;
    for (uint64_t i = 0; i < n; i++)
        finite &= isfinite(values[i]) != 0;
    return finite;
}

static bool data_finite(const struct tensor_block *b, const struct tensor_data *d) {
    bool finite = true;
    float row[ROW_VALUES];
    for (uint64_t t = 0; t < tensor_tiles(b) && d->data; t++)
        for (uint32_t c = 0; c < b->coefficients; c++) {
            tensor_row(d, b->coefficients, t, c, row);
            finite &= all_finite(row, ROW_VALUES);
        }
    return finite;
}

static bool sums_finite(const double *sums, uint64_t n) {
    bool finite = true;
    for (uint64_t i = 0; i < n && sums; i++)
        finite &= isfinite(sums[i]) != 0;
    return finite;
}

bool tensor_check_values(const struct tensor_file *f) {
    const struct tensor *t = &f->tensor;
    for (uint32_t i = 0; i < t->block_count; i++) {
        const struct tensor_block *b = &t->blocks[i];
        const uint64_t n = tensor_value_count(b);
        const struct tensor_data values = tensor_values_of(b), halves = tensor_halves_of(b);
        if (!data_finite(b, &values) || !data_finite(b, &halves) ||
            !sums_finite(b->sums, 2 * n) || !sums_finite(b->views, 2 * tensor_tiles(b) * TENSOR_LANES) ||
            (b->weights &&
             !all_finite(b->weights, (uint64_t)b->coefficients * b->channels)) ||
            (b->view && !all_finite(b->view, tensor_tiles(b) * TENSOR_LANES)))
            return fail(f, "block %u (%s.%s) holds values that are not finite", i, b->object, b->term);
    }
    if ((t->fixed && !all_finite(t->fixed, 3ull * t->width * t->height)) ||
        !sums_finite(t->fixed_sums, 3ull * t->width * t->height))
        return fail(f, "the fixed picture holds values that are not finite");
    return true;
}

void tensor_close(struct tensor_file *f) {
    if (!f)
        return;
    file_unmap(f->map, f->size);
    json_destroy(f->header);
    json_destroy(f->meta);
    mem_free(f->extents);
    arena_finish(&f->arena);
    mem_free(f);
}
