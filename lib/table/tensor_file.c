// SPDX-License-Identifier: Apache-2.0
#include "table/tensor_file.h"

#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"

enum { MOST_FIELDS = 256, MOST_BYTES = 1 << 30 };

struct cursor {
    const unsigned char *at, *end;
};

// A little-endian number of `bytes` bytes; false at the end of the file.
static bool take(struct cursor *c, int bytes, uint64_t *value) {
    if (c->end - c->at < bytes)
        return false;
    *value = 0;
    for (int i = 0; i < bytes; i++)
        *value |= (uint64_t)*c->at++ << (8 * i);
    return true;
}

static size_t type_size(uint64_t type) {
    static const size_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
    return type < sizeof sizes / sizeof *sizes ? sizes[type] : 0;
}

static bool take_name(struct cursor *c, char name[64]) {
    uint64_t length;
    if (!take(c, 2, &length) || length >= 64 || (uint64_t)(c->end - c->at) < length)
        return false;
    memcpy(name, c->at, length);
    name[length] = '\0';
    c->at += length;
    return true;
}

static bool take_shape(struct cursor *c, struct tensor_field *f) {
    f->count = 1;
    for (int i = 0; i < f->dimensions; i++) {
        uint64_t n;
        if (!take(c, 8, &n) || n > MOST_BYTES || (n && f->count > MOST_BYTES / n))
            return false;
        f->shape[i] = n;
        f->count *= n;
    }
    return true;
}

static bool take_field(struct cursor *c, const unsigned char *bytes, struct tensor_field *f) {
    uint64_t dimensions, type, offset;
    if (!take_name(c, f->name) || !take(c, 2, &dimensions) ||
        dimensions > TENSOR_MOST_DIMENSIONS || !take(c, 1, &type) || !type_size(type) ||
        !take(c, 8, &offset))
        return false;
    f->dimensions = (int)dimensions;
    f->type = (int)type;
    const size_t size = (size_t)(c->end - bytes);
    if (!take_shape(c, f) || offset > size || f->count > (size - offset) / type_size(type))
        return false;
    f->data = bytes + offset;
    return true;
}

static bool parse(struct tensor_file *file, size_t size) {
    const unsigned char *bytes = (const unsigned char *)file->bytes;
    struct cursor c = {bytes + 12, bytes + size};
    uint64_t major, minor, count;
    if (size < 18 || memcmp(bytes, "tensor_file", 12) != 0) {
        log_error("%s: is not a tensor file (it does not begin with \"tensor_file\")", file->path);
        return false;
    }
    if (!take(&c, 1, &major) || !take(&c, 1, &minor) || !take(&c, 4, &count) || major != 1) {
        log_error("%s: has version %u.%u, expected 1.0", file->path, bytes[12], bytes[13]);
        return false;
    }
    if (count > MOST_FIELDS) {
        log_error("%s: has %llu fields, more than the %d that are accepted", file->path,
                  (unsigned long long)count, MOST_FIELDS);
        return false;
    }
    file->fields = mem_array(count, sizeof *file->fields);
    file->field_count = (uint32_t)count;
    for (uint32_t i = 0; i < count; i++)
        if (!take_field(&c, bytes, &file->fields[i])) {
            log_error("%s: field %u of %u is damaged or lies beyond the end of the file",
                      file->path, i + 1, file->field_count);
            return false;
        }
    return true;
}

bool tensor_file_read(const char *path, struct tensor_file *file) {
    size_t size;
    *file = (struct tensor_file){.path = path, .bytes = file_read(path, MOST_BYTES, &size)};
    if (file->bytes && parse(file, size))
        return true;
    tensor_file_finish(file);
    return false;
}

void tensor_file_finish(struct tensor_file *file) {
    mem_free(file->bytes);
    mem_free(file->fields);
    *file = (struct tensor_file){0};
}

static const struct tensor_field *find(const struct tensor_file *file, const char *name) {
    for (uint32_t i = 0; i < file->field_count; i++)
        if (strcmp(file->fields[i].name, name) == 0)
            return &file->fields[i];
    return NULL;
}

bool tensor_has_field(const struct tensor_file *file, const char *name) {
    return find(file, name) != NULL;
}

const struct tensor_field *tensor_field_need(const struct tensor_file *file, const char *name,
                                             int type, int dimensions) {
    const struct tensor_field *f = find(file, name);
    if (!f)
        log_error("%s: has no field \"%s\"", file->path, name);
    else if (f->type != type || f->dimensions != dimensions || f->count == 0)
        log_error("%s: field \"%s\" has %d dimensions of type %d, expected %d of type %d and no "
                  "empty one", file->path, name, f->dimensions, f->type, dimensions, type);
    else
        return f;
    return NULL;
}
