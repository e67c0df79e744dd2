// SPDX-License-Identifier: Apache-2.0
#include "sink/journal.h"

#include <errno.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"

static const char MAGIC[8] = {'r', 'e', 'l', 'u', 'm', 'e', 'J', '1'};

enum {
    MOST_HEAD = 1 << 24,  // bytes
    MOST_LEVEL = 40,
    MOST_GROWTH = 4,      // times the bytes of what is live
};

struct record {
    uint32_t seed, level;
    uint64_t index;
    uint32_t missing, zero;
    uint64_t hash;
};

_Static_assert(sizeof(struct record) == 32, "records are written as they are");

struct journal {
    FILE *file;
    char path[4096];
    char *head; // text
    size_t values;
    struct record *written; // the nodes that the file holds
    size_t count, capacity;
    uint64_t records;       // in the file, replaced ones too
};

static uint64_t record_hash(const struct record *r, const double *values, size_t n) {
    return file_hash(values, n * sizeof *values, file_hash(r, offsetof(struct record, hash), 0));
}

static struct record record_of(const struct sums_node *node) {
    return (struct record){.seed = node->seed, .level = node->level, .index = node->index,
                           .missing = node->missing};
}

// ---- writing ------------------------------------------------------------------------------------

static bool append(struct journal *j, const struct sums_node *node) {
    struct record r = record_of(node);
    r.hash = record_hash(&r, node->values, j->values);
    mem_grow(&j->written, &j->capacity, j->count + 1, sizeof *j->written);
    j->written[j->count++] = r;
    j->records++;
    return fwrite(&r, sizeof r, 1, j->file) == 1 &&
           fwrite(node->values, sizeof *node->values, j->values, j->file) == j->values;
}

static bool is_written(const struct record *written, size_t n, const struct sums_node *node) {
    for (size_t i = 0; i < n; i++)
        if (written[i].seed == node->seed && written[i].level == node->level &&
            written[i].index == node->index && written[i].missing == node->missing)
            return true;
    return false;
}

// Appends what is not there; what is live after that is the sums and the short block.
static bool append_new(struct journal *j, const struct sums *sums,
                       const struct sums_node *short_block) {
    struct record *old = j->written;
    const size_t n = j->count;
    bool written = true;
    j->written = NULL;
    j->count = j->capacity = 0;
    for (size_t i = 0; i <= sums->count && written; i++) {
        const struct sums_node *node = i < sums->count ? &sums->nodes[i] : short_block;
        if (!node)
            continue;
        if (!is_written(old, n, node)) {
            written = append(j, node);
        } else {
            mem_grow(&j->written, &j->capacity, j->count + 1, sizeof *j->written);
            j->written[j->count++] = record_of(node);
        }
    }
    mem_free(old);
    return written && fflush(j->file) == 0;
}

static bool write_head(struct journal *j) {
    const uint64_t size = strlen(j->head), hash = file_hash(j->head, size, 0);
    return fwrite(MAGIC, sizeof MAGIC, 1, j->file) == 1 && fwrite(&size, sizeof size, 1, j->file) == 1 &&
           fwrite(&hash, sizeof hash, 1, j->file) == 1 && fwrite(j->head, 1, size, j->file) == size;
}

// Writes the whole file anew.
static bool rewrite(struct journal *j, const struct sums *sums,
                    const struct sums_node *short_block) {
    char temp[4096];
    FILE *old = j->file;
    if (!file_temp_name(j->path, temp, sizeof temp))
        return false;
    j->count = 0;
    j->records = 0;
    j->file = fopen(temp, "wb");
    if (j->file && write_head(j) && append_new(j, sums, short_block)) {
        if (old)
            fclose(old);
        return file_commit(temp, j->path);
    }
    log_error("%s: cannot be written: %s", j->path, strerror(errno));
    if (j->file)
        fclose(j->file);
    j->file = old;
    file_discard(temp);
    return false;
}

bool journal_path(const char *picture, char *path, size_t size) {
    const int n = snprintf(path, size, "%s.journal", picture);
    if (n < 0 || (size_t)n >= size)
        log_error("%s: name is too long", picture);
    return n >= 0 && (size_t)n < size;
}

struct journal *journal_create(const char *path, const struct json *head, const struct sums *sums,
                               const struct sums_node *short_block) {
    struct journal *j = mem_array(1, sizeof *j);
    j->head = json_to_text(head);
    j->values = sums->values;
    if ((size_t)snprintf(j->path, sizeof j->path, "%s", path) < sizeof j->path &&
        rewrite(j, sums, short_block))
        return j;
    journal_close(j);
    return NULL;
}

bool journal_update(struct journal *j, const struct sums *sums,
                    const struct sums_node *short_block) {
    if (j->records > MOST_GROWTH * (sums->count + 2))
        return rewrite(j, sums, short_block);
    if (append_new(j, sums, short_block) && fdatasync(fileno(j->file)) == 0)
        return true;
    log_error("%s: cannot be written: %s", j->path, strerror(errno));
    return false;
}

void journal_close(struct journal *j) {
    if (!j)
        return;
    if (j->file)
        fclose(j->file);
    mem_free(j->head);
    mem_free(j->written);
    mem_free(j);
}

// ---- reading ------------------------------------------------------------------------------------

static struct json *read_head(FILE *f, const char *path) {
    char magic[sizeof MAGIC];
    uint64_t size, hash;
    if (fread(magic, sizeof magic, 1, f) != 1 || memcmp(magic, MAGIC, sizeof MAGIC) != 0) {
        log_error("%s: is not a journal of relume", path);
        return NULL;
    }
    if (fread(&size, sizeof size, 1, f) != 1 || fread(&hash, sizeof hash, 1, f) != 1 ||
        size > MOST_HEAD) {
        log_error("%s: the head is damaged", path);
        return NULL;
    }
    char *text = mem_array(size + 1, 1);
    struct json *head = NULL;
    if (fread(text, 1, size, f) != size || file_hash(text, size, 0) != hash)
        log_error("%s: the head is damaged", path);
    else
        head = json_parse(text, size, path);
    mem_free(text);
    return head;
}

static bool lies_within(const struct sums_node *in, const struct sums_node *around) {
    return in->seed == around->seed && in->level <= around->level &&
           in->index >> (around->level - in->level) == around->index;
}

// Adds a node in place of those that lie inside it. false: it overlaps in another way.
static bool replace(struct sums *s, struct sums_node node) {
    size_t kept = 0;
    for (size_t i = 0; i < s->count; i++) {
        if (lies_within(&s->nodes[i], &node))
            mem_free(s->nodes[i].values);
        else
            s->nodes[kept++] = s->nodes[i];
    }
    s->count = kept;
    if (sums_overlap(s, &node))
        return false;
    sums_add(s, node);
    return true;
}

// The next record; false at the end of what is sound.
static bool read_record(FILE *f, struct sums *s) {
    struct record r;
    if (fread(&r, sizeof r, 1, f) != 1 || r.level > MOST_LEVEL || r.index >> (58 - r.level) ||
        r.zero || r.missing >= SUMS_BLOCK || (r.missing && r.level))
        return false;
    double *values = mem_array(s->values, sizeof *values);
    const struct sums_node node = {r.seed, r.level, r.index, r.missing, values};
    if (fread(values, sizeof *values, s->values, f) == s->values &&
        record_hash(&r, values, s->values) == r.hash && replace(s, node))
        return true;
    mem_free(values);
    return false;
}

// How many numbers a node holds, as the head says.
static bool read_values(const struct json *head, const char *path, int64_t *values) {
    if (json_read_integer(json_get(head, "values"), values) && *values > 0 &&
        *values < (int64_t)1 << 40)
        return true;
    log_error("%s: the head does not say how many values a node holds", path);
    return false;
}

bool journal_read(const char *path, struct json **head, struct sums *sums) {
    int64_t values;
    FILE *f = fopen(path, "rb");
    *head = NULL;
    if (!f) {
        log_error("%s: cannot be read: %s", path, strerror(errno));
        return false;
    }
    fseeko(f, 0, SEEK_END);
    const off_t size = ftello(f);
    rewind(f);
    *head = read_head(f, path);
    if (*head && !read_values(*head, path, &values)) {
        json_destroy(*head);
        *head = NULL;
    }
    if (!*head) {
        fclose(f);
        return false;
    }
    sums_init(sums, (size_t)values);
    off_t sound = ftello(f);
    const off_t record = (off_t)(sizeof(struct record) + sums->values * sizeof(double));
    while (size - sound >= record && read_record(f, sums))
        sound = ftello(f);
    fclose(f);
    if (sound < size)
        log_warn("%s: the last %" PRIu64 " bytes are incomplete; what was there before is used", path,
                 (uint64_t)(size - sound));
    return true;
}
