// SPDX-License-Identifier: Apache-2.0
// Joins corners of faces into vertices: formats such as OBJ index positions, texture coordinates
// and normals apart, a mesh has one index for all three.
#pragma once

#include <stddef.h>
#include <stdint.h>

#define CORNER_NONE UINT32_MAX

struct corner {
    uint32_t v, vt, vn; // indices from zero; CORNER_NONE: absent
};

// Vertices in the order of their first use. Zero-initialise.
struct corner_table {
    struct corner *corners; // count of them
    size_t count, capacity;
    uint32_t *next;    // per vertex: the next one in the same bucket
    uint32_t *buckets; // first vertex of each; bucket_count is a power of two
    size_t bucket_count, next_capacity;
};

// The vertex with this corner, made if it is new; at most UINT32_MAX - 1 of them.
uint32_t corner_vertex(struct corner_table *t, struct corner c);
void corner_table_finish(struct corner_table *t);
