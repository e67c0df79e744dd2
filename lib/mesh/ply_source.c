// SPDX-License-Identifier: Apache-2.0
#include "mesh/ply_source.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include "base/text.h"

struct ply_source ply_source_open(const char *path, const char *text, size_t size,
                                  const struct ply_header *h) {
    const int line = h->format == PLY_ASCII ? h->lines + 1 : 0;
    return (struct ply_source){h->format, text + h->size, text + size, {path, line}};
}

static bool fail_end(const struct ply_source *s) {
    log_error_at(s->at, "found the end of the file, expected more data");
    return false;
}

static bool skip_space(struct ply_source *s) {
    for (; text_is_space(*s->p); s->p++)
        s->at.line += *s->p == '\n' && s->at.line < INT_MAX;
    return s->p < s->end || fail_end(s);
}

static bool in_range(enum ply_type type, double x) {
    static const double low[] = {[PLY_INT8] = -0x1p7, [PLY_INT16] = -0x1p15,
                                 [PLY_INT32] = -0x1p31, [PLY_INT64] = -0x1p63,
                                 [PLY_UINT64] = 0};
    static const double high[] = {
        [PLY_INT8] = 0x1p7,   [PLY_UINT8] = 0x1p8,   [PLY_INT16] = 0x1p15, [PLY_UINT16] = 0x1p16,
        [PLY_INT32] = 0x1p31, [PLY_UINT32] = 0x1p32, [PLY_INT64] = 0x1p63, [PLY_UINT64] = 0x1p64};
    return !ply_type_is_integer(type) || (x >= low[type] && x < high[type] && x == floor(x));
}

static bool text_value(struct ply_source *s, enum ply_type type, double *value) {
    if (!skip_space(s))
        return false;
    const char *start = s->p;
    if (text_number(&s->p, value) && (text_is_space(*s->p) || s->p == s->end) &&
        in_range(type, *value))
        return true;
    char found[40];
    log_error_at(s->at, "found '%s', expected a number of type %s",
                 text_excerpt(start, found, sizeof found), ply_type_name(type));
    return false;
}

// Bytes of a value of the type in the order of this machine.
static void take(struct ply_source *s, void *to, size_t n) {
    const bool little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
    if (little == (s->format == PLY_LITTLE_ENDIAN))
        memcpy(to, s->p, n);
    else
        for (size_t i = 0; i < n; i++)
            ((char *)to)[i] = s->p[n - 1 - i];
    s->p += n;
}

#define TAKE(type)                                                                                 \
    do {                                                                                           \
        type x_;                                                                                   \
        take(s, &x_, sizeof x_);                                                                   \
        *value = (double)x_;                                                                       \
        return true;                                                                               \
    } while (0)

static bool binary_value(struct ply_source *s, enum ply_type type, double *value) {
    if ((size_t)(s->end - s->p) < ply_type_size(type))
        return fail_end(s);
    switch (type) {
    case PLY_INT8: TAKE(int8_t);
    case PLY_UINT8: TAKE(uint8_t);
    case PLY_INT16: TAKE(int16_t);
    case PLY_UINT16: TAKE(uint16_t);
    case PLY_INT32: TAKE(int32_t);
    case PLY_UINT32: TAKE(uint32_t);
    case PLY_INT64: TAKE(int64_t);
    case PLY_UINT64: TAKE(uint64_t);
    case PLY_FLOAT32: TAKE(float);
    case PLY_FLOAT64: TAKE(double);
    case PLY_NONE: break;
    }
    return false;
}

bool ply_value(struct ply_source *s, enum ply_type type, double *value) {
    return s->format == PLY_ASCII ? text_value(s, type, value) : binary_value(s, type, value);
}

size_t ply_least_bytes(const struct ply_source *s, enum ply_type type, size_t count) {
    return s->format == PLY_ASCII ? 2 * count : count * ply_type_size(type); // "0 "
}

bool ply_list_count(struct ply_source *s, const struct ply_property *list, uint32_t *count) {
    double n;
    if (!ply_value(s, list->count_type, &n))
        return false;
    const size_t left = (size_t)(s->end - s->p) + 1; // the last number needs no blank behind it
    if (!(n >= 0 && n < UINT32_MAX && ply_least_bytes(s, list->type, (size_t)n) <= left)) {
        log_error_at(s->at, "found a list %s of %.0f values, expected at most what fits the file",
                     list->name, n);
        return false;
    }
    *count = (uint32_t)n;
    return true;
}

bool ply_skip(struct ply_source *s, enum ply_type type, size_t count) {
    if (s->format != PLY_ASCII) {
        if ((size_t)(s->end - s->p) / ply_type_size(type) < count)
            return fail_end(s);
        s->p += count * ply_type_size(type);
        return true;
    }
    for (size_t i = 0; i < count; i++) {
        if (!skip_space(s))
            return false;
        while (s->p < s->end && !text_is_space(*s->p))
            s->p++;
    }
    return true;
}

bool ply_check_element(const struct ply_source *s, const struct ply_header *h,
                       const struct ply_element *e) {
    size_t each = 0;
    for (int i = e->first; i < e->first + e->property_count; i++) {
        const struct ply_property *q = &h->properties[i];
        each += ply_least_bytes(s, q->count_type == PLY_NONE ? q->type : q->count_type, 1);
    }
    if (each == 0 || e->count <= ((size_t)(s->end - s->p) + 1) / each)
        return true;
    log_error("%s: announces %u of element %s, expected at most the %zu that fit the file",
              s->at.file, e->count, e->name, ((size_t)(s->end - s->p) + 1) / each);
    return false;
}
