// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: which elements it holds, with which properties, in which encoding.
//
// Source: Greg Turk, The PLY Polygon File Format, 1994; the type names int8 ... float64 and the
// 64-bit integers long and ulong are later habits.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum ply_type {
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_INT64,
    PLY_UINT64,
    PLY_FLOAT32,
    PLY_FLOAT64,
    PLY_NONE,
};

enum ply_format { PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN };

enum { PLY_MOST_ELEMENTS = 32, PLY_MOST_PROPERTIES = 256, PLY_MOST_NAME = 40 };

struct ply_property {
    char name[PLY_MOST_NAME];
    enum ply_type type;
    enum ply_type count_type; // of a list; PLY_NONE: a single value
};

struct ply_element {
    char name[PLY_MOST_NAME];
    uint32_t count;
    int first, property_count; // into the header's properties
};

struct ply_header {
    enum ply_format format;
    struct ply_element elements[PLY_MOST_ELEMENTS];
    int element_count;
    struct ply_property properties[PLY_MOST_PROPERTIES];
    int property_count;
    size_t size; // bytes up to the data
    int lines;
};

size_t ply_type_size(enum ply_type type);
bool ply_type_is_integer(enum ply_type type);
const char *ply_type_name(enum ply_type type);

// text ends with a zero byte behind `size` bytes. false after a message.
bool ply_read_header(const char *path, const char *text, size_t size, struct ply_header *h);
const struct ply_element *ply_find_element(const struct ply_header *h, const char *name);
// Index into h->properties of a property of the element that is a list or not; -1: none.
int ply_find_property(const struct ply_header *h, const struct ply_element *e, const char *name,
                      bool list);
