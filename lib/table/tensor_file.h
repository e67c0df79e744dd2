// SPDX-License-Identifier: Apache-2.0
// The container of measured materials by EPFL's realistic graphics lab (tensor_file, version 1):
// named arrays of numbers, little-endian.
//
// Layout: "tensor_file\0", version (u8 1, u8 0), number of fields (u32); for each field the length
// of its name (u16), the name, number of dimensions (u16), type (u8), offset of the data from the
// beginning of the file (u64), the shape (u64 each); then the data.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TENSOR_MOST_DIMENSIONS = 8, TENSOR_U8 = 1, TENSOR_U32 = 5, TENSOR_F32 = 10 };

struct tensor_field {
    char name[64];
    int dimensions, type;
    size_t shape[TENSOR_MOST_DIMENSIONS];
    size_t count;              // product of the shape
    const unsigned char *data; // inside the file, count values; may be unaligned
};

struct tensor_file {
    const char *path;
    char *bytes; // owned
    struct tensor_field *fields; // owned
    uint32_t field_count;
};

// false after an error message, with nothing to finish.
bool tensor_file_read(const char *path, struct tensor_file *file);
void tensor_file_finish(struct tensor_file *file);

// The field of that name, type and number of dimensions. NULL after an error message.
const struct tensor_field *tensor_field_need(const struct tensor_file *file, const char *name,
                                             int type, int dimensions);
bool tensor_has_field(const struct tensor_file *file, const char *name);
