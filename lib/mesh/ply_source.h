// SPDX-License-Identifier: Apache-2.0
// The values behind the header of a PLY file, one after the other, whatever their encoding.
#pragma once

#include "base/log.h"
#include "mesh/ply_header.h"

struct ply_source {
    enum ply_format format;
    const char *p, *end; // a zero byte stands at the end
    struct where at;     // the line that is read; line 0 in binary data
};

struct ply_source ply_source_open(const char *path, const char *text, size_t size,
                                  const struct ply_header *h);

// The next value, in the range of its type; integers of 64 bits are rounded. A float may be
// infinite or not a number in binary data, and infinite in text. false after a message.
bool ply_value(struct ply_source *s, enum ply_type type, double *value);
// The length of a list, checked against what is left of the file. false after a message.
bool ply_list_count(struct ply_source *s, const struct ply_property *list, uint32_t *count);
bool ply_skip(struct ply_source *s, enum ply_type type, size_t count);

// Bytes that `count` values of a type take at least.
size_t ply_least_bytes(const struct ply_source *s, enum ply_type type, size_t count);
// Checks that all of an element can be there: its count against the rest of the file.
bool ply_check_element(const struct ply_source *s, const struct ply_header *h,
                       const struct ply_element *e);
