// SPDX-License-Identifier: Apache-2.0
// The file around a glTF model: .glb chunks (specification, section 4), buffers and URIs.
#include <ctype.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "scene/gltf.h"

#define CHUNK_JSON 0x4e4f534au
#define CHUNK_BIN 0x004e4942u

bool gltf_fail(const struct gltf *g, const char *at, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    log_error("%s: %s%s%s", g->path, at, *at ? ": " : "", text);
    return false;
}

void gltf_warn(struct gltf *g, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (size_t i = 0; i < g->warned.count; i++)
        if (strcmp(LIST_AT(&g->warned, const char *, i), text) == 0)
            return;
    *LIST_ADD(&g->warned, const char *) = arena_strdup(g->arena, text);
    log_warn("%s: %s", g->path, text);
}

// ---- looking in -----------------------------------------------------------------------------

const struct json *gltf_item(const struct gltf *g, const char *collection, size_t index) {
    return json_at(json_get(g->root, collection), index);
}

const struct json *gltf_extension(const struct json *object, const char *name) {
    return json_get(json_get(object, "extensions"), name);
}

int64_t gltf_index(const struct json *object, const char *key) {
    double v = -1;
    json_read_number(json_get(object, key), &v);
    return (int64_t)v;
}

double gltf_number(const struct json *object, const char *key, double otherwise) {
    json_read_number(json_get(object, key), &otherwise);
    return otherwise;
}

bool gltf_flag(const struct json *object, const char *key) {
    bool v = false;
    json_read_bool(json_get(object, key), &v);
    return v;
}

bool gltf_numbers(const struct json *object, const char *key, int count, double *out) {
    const struct json *array = json_get(object, key);
    if (!array)
        return false;
    for (int i = 0; i < count; i++)
        json_read_number(json_at(array, (size_t)i), &out[i]);
    return true;
}

// ---- URIs -----------------------------------------------------------------------------------

bool gltf_is_data_uri(const char *uri) {
    return strncmp(uri, "data:", 5) == 0;
}

static int hex_digit(char c) {
    return c >= '0' && c <= '9' ? c - '0' : isxdigit((unsigned char)c) ? (c | 32) - 'a' + 10 : -1;
}

// Replaces %XX in place; the number of bytes that are left.
static size_t unescape(char *text) {
    char *out = text;
    for (const char *c = text; *c; c++) {
        const bool escaped = *c == '%' && hex_digit(c[1]) >= 0 && hex_digit(c[2]) >= 0;
        *out++ = escaped ? (char)(16 * hex_digit(c[1]) + hex_digit(c[2])) : *c;
        c += escaped ? 2 : 0;
    }
    *out = '\0';
    return (size_t)(out - text);
}

const char *gltf_uri_path(struct gltf *g, const char *uri, const char *at) {
    char directory[PATH_MAX];
    const size_t word = strspn(uri, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ+-.0123456789");
    if (uri[word] == ':' || !*uri) {
        gltf_fail(g, at, "\"%.60s\" is no relative URI, expected a file beside the model", uri);
        return NULL;
    }
    char *name = arena_strdup(g->arena, uri);
    unescape(name);
    file_directory(g->path, directory, sizeof directory);
    const char *path = name[0] == '/' ? name : arena_printf(g->arena, "%s/%s", directory, name);
    if (file_exists(path))
        return path;
    gltf_fail(g, at, "there is no file \"%.200s\" beside the model", name);
    return NULL;
}

static int base64_digit(char c) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = c ? strchr(digits, c) : NULL;
    return at ? (int)(at - digits) : -1;
}

// RFC 4648, section 4.
static bool decode_base64(struct gltf *g, const char *text, const char *at,
                          struct gltf_buffer *out) {
    size_t n = strlen(text);
    while (n > 0 && text[n - 1] == '=')
        n--;
    unsigned char *data = arena_alloc(g->arena, n / 4 * 3 + 4);
    uint32_t bits = 0;
    out->data = data;
    out->size = 0;
    for (size_t i = 0; i < n; i++) {
        const int digit = base64_digit(text[i]);
        if (digit < 0)
            return gltf_fail(g, at, "holds '%c' where a base64 digit is expected",
                             isprint((unsigned char)text[i]) ? text[i] : '?');
        bits = bits << 6 | (uint32_t)digit;
        if (i % 4 != 0)
            data[out->size++] = (unsigned char)(bits >> (6 - 2 * (i % 4)));
    }
    return true;
}

static bool decode_percent(struct gltf *g, const char *text, struct gltf_buffer *out) {
    char *data = arena_strdup(g->arena, text);
    out->size = unescape(data);
    out->data = (const unsigned char *)data;
    return true;
}

bool gltf_load_uri(struct gltf *g, const char *uri, const char *at, struct gltf_buffer *out) {
    if (gltf_is_data_uri(uri)) {
        const char *comma = strchr(uri, ',');
        if (!comma)
            return gltf_fail(g, at, "is a data URI without data");
        const bool coded = comma - uri >= 7 && strncmp(comma - 7, ";base64", 7) == 0;
        return coded ? decode_base64(g, comma + 1, at, out) : decode_percent(g, comma + 1, out);
    }
    const char *path = gltf_uri_path(g, uri, at);
    size_t size;
    char *data = path ? file_read(path, 0, &size) : NULL;
    if (!data)
        return false;
    out->data = memcpy(arena_alloc(g->arena, size + 1), data, size);
    out->size = size;
    mem_free(data);
    return true;
}

// ---- chunks ---------------------------------------------------------------------------------

static uint32_t word_at(const char *p) {
    const unsigned char *b = (const unsigned char *)p;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static bool take_chunk(struct gltf *g, uint32_t type, const char *data, size_t size, bool first,
                       struct gltf_buffer *text) {
    struct gltf_buffer *slot = type == CHUNK_JSON ? text : type == CHUNK_BIN ? &g->chunk : NULL;
    if (first != (type == CHUNK_JSON))
        return gltf_fail(g, "", first ? "the first chunk is not JSON" : "has a second JSON chunk");
    if (type == CHUNK_JSON && size == 0)
        return gltf_fail(g, "", "the JSON chunk is empty");
    if (slot && slot->data)
        return gltf_fail(g, "", "has a second binary chunk");
    if (slot)
        *slot = (struct gltf_buffer){(const unsigned char *)data, size};
    return true;
}

static bool split_chunks(struct gltf *g, size_t size, struct gltf_buffer *text) {
    if (size < 20)
        return gltf_fail(g, "", "has %zu bytes, a .glb at least 20", size);
    const uint32_t version = word_at(g->file + 4), length = word_at(g->file + 8);
    if (version != 2)
        return gltf_fail(g, "", "is of version %u, expected 2", version);
    if (length > size || length < 20)
        return gltf_fail(g, "", "claims %u bytes, but has %zu", length, size);
    if (length < size)
        gltf_warn(g, "%zu bytes after the end of the model are ignored", size - length);
    for (size_t at = 12; at < length;) {
        const size_t left = length - at;
        const uint32_t bytes = left >= 8 ? word_at(g->file + at) : UINT32_MAX;
        if (left < 8 || bytes > left - 8)
            return gltf_fail(g, "", "the chunk at byte %zu reaches beyond the end", at);
        if (bytes % 4 != 0)
            return gltf_fail(g, "", "the chunk at byte %zu has %u bytes, no multiple of 4", at,
                             bytes);
        if (!take_chunk(g, word_at(g->file + at + 4), g->file + at + 8, bytes, at == 12, text))
            return false;
        at += 8 + bytes;
    }
    return true;
}

// ---- buffers --------------------------------------------------------------------------------

static bool load_buffer(struct gltf *g, size_t i) {
    const struct json *buffer = gltf_item(g, "buffers", i);
    const char *uri = json_text(json_get(buffer, "uri"));
    const char *at = arena_printf(g->arena, "/buffers/%zu%s", i, uri ? "/uri" : "");
    struct gltf_buffer *out = &g->buffers[i];
    if (uri && !gltf_load_uri(g, uri, at, out))
        return false;
    if (!uri && i == 0)
        *out = g->chunk;
    if (!uri && !out->data)
        return true; // to be noticed by whoever wants its data
    const double bytes = gltf_number(buffer, "byteLength", 0);
    if (bytes > (double)out->size)
        return gltf_fail(g, at, "has %zu bytes, but byteLength is %.0f", out->size, bytes);
    out->size = (size_t)bytes;
    return true;
}

static bool load_buffers(struct gltf *g) {
    g->buffer_count = json_count(json_get(g->root, "buffers"));
    g->buffers = arena_alloc(g->arena, (g->buffer_count + 1) * sizeof *g->buffers);
    for (size_t i = 0; i < g->buffer_count; i++)
        if (!load_buffer(g, i))
            return false;
    return true;
}

bool gltf_open(struct gltf *g, const char *path, struct arena *arena) {
    *g = (struct gltf){.path = arena_strdup(arena, path), .arena = arena};
    size_t size;
    g->file = file_read(path, UINT32_MAX, &size);
    if (!g->file)
        return false;
    char extension[8];
    file_extension(path, extension, sizeof extension);
    struct gltf_buffer text = {0};
    if (size >= 4 && memcmp(g->file, "glTF", 4) == 0) {
        if (!split_chunks(g, size, &text))
            return false;
    } else if (strcmp(extension, "glb") == 0) {
        return gltf_fail(g, "", "is no .glb: it does not begin with \"glTF\"");
    } else {
        text = (struct gltf_buffer){(const unsigned char *)g->file, size};
    }
    g->root = json_parse((const char *)text.data, text.size, g->path);
    return g->root && gltf_check_schema(g) && gltf_check_rules(g) && load_buffers(g) &&
           gltf_check_data(g);
}

void gltf_close(struct gltf *g) {
    json_destroy(g->root);
    mem_free(g->file);
    mem_free(g->warned.items);
    *g = (struct gltf){0};
}
