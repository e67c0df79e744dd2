// SPDX-License-Identifier: Apache-2.0
// Splitting ranges of lights in two, for building the light tree: where the sum over both sides of
// intensity x measure of directions x surface of the box is least (Conty Estevez, Kulla 2018,
// equation 1).
#pragma once

#include "light/light_tree.h"

struct light_item {
    struct light_bounds b;
    uint32_t index;
};

struct light_cluster {
    vec3 min, max;
    vec3 axes;       // sum of the axes, by intensity and by how narrow each is
    float intensity;
    float cos_e;
    uint32_t count;
};

struct light_range {
    uint32_t begin, end; // of the items
    struct light_cluster c;
};

struct light_splitter {
    struct light_item *items;     // owned; splitting puts them into order
    struct light_split_few *few;  // room for sorting; owned
};

void light_splitter_init(struct light_splitter *s, uint32_t count);
void light_splitter_finish(struct light_splitter *s);

struct light_range light_splitter_range(const struct light_splitter *s, uint32_t begin, uint32_t end);
// At least two items; both parts have some. depth: of the node.
void light_splitter_split(struct light_splitter *s, const struct light_range *r, int depth,
                          struct light_range out[2]);
// Of a node that has the range.
float light_range_cost(const struct light_range *r);

// The items of each child when a node of so many is full: 1, 16, and 256 at most, since full nodes
// further up would not pay for worse splits.
static inline uint32_t light_range_unit(uint32_t count) {
    const uint32_t low = LIGHT_TREE_CHILDREN, high = low * low;
    return count <= low ? 1 : count <= high ? low : high;
}

static inline vec3 light_least(vec3 a, vec3 b) {
    return v3(minf(a[0], b[0]), minf(a[1], b[1]), minf(a[2], b[2]));
}

static inline vec3 light_most(vec3 a, vec3 b) {
    return v3(maxf(a[0], b[0]), maxf(a[1], b[1]), maxf(a[2], b[2]));
}
