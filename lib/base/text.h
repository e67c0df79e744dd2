// SPDX-License-Identifier: Apache-2.0
// Numbers and words in text formats, read from memory that ends with a zero byte.
//
// Faster than strtod and independent of the locale. The text is never believed to be text: any
// byte may follow any other.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// [+-]digits[.digits][e[+-]digits], with digits on at least one side of the point. Too large a
// number gives infinity; words such as nan and inf are no numbers. false: *p stays where it was.
// Within one unit in the last place of a double.
bool text_number(const char **p, double *value);

// [+-]digits, clamped to the range of int64_t. false: *p stays where it was.
bool text_integer(const char **p, int64_t *value);

static inline bool text_is_blank(char c) {
    return c == ' ' || c == '\t';
}

static inline bool text_is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

// What stands at p, up to white space and at most n - 1 bytes, for messages; bytes that are not
// printable ASCII become '?', the end of the text "end of file", an empty word "end of line".
const char *text_excerpt(const char *p, char *out, size_t n);
