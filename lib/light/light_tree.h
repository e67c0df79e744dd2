// SPDX-License-Identifier: Apache-2.0
// Choosing one of many lights by what each could give at a place, in O(log n).
//
// A tree of bounds over position and direction is descended from its root, at every node by chance
// in proportion to an upper bound of the irradiance of each child (A. Conty Estevez, C. Kulla 2018,
// Importance Sampling of Many Lights with Adaptive Tree Splitting; without the splitting; M. Pharr,
// W. Jakob, G. Humphreys 2023, 12.6.3). Nodes have sixteen children that are looked at together: what
// a node costs is mostly the wait for it, so few nodes are better than small ones. The probability
// of a light is found on the way from its leaf up to the root.
//
// A light of positive intensity that can light a place has a positive probability there. Nothing
// here has a unit of its own: scenes that differ by a power of two give the same bits.
#pragma once

#include <stdalign.h>
#include <stddef.h>

#include "math/wide.h"

enum { LIGHT_TREE_CHILDREN = 16 }; // of a node

// Where one light (a point, a triangle, ...) stands and whither it shines.
struct light_bounds {
    vec3 min, max;
    vec3 axis;       // unit; middle of its normals
    float cos_o;     // cosine of the angle around the axis that its normals fill; -1: all
    float cos_e;     // in [0, 1): cosine of how far from a normal it still shines; 0: a surface
    float intensity; // largest, luminance in W/sr; 0: dark
};

// Where light arrives.
struct light_place {
    vec3 p;
    vec3 n; // unit: light from its other side counts little; zero: all sides count the same
};

// What a sample needs of an item it has chosen, in one place and beside those of the same node: each
// place more would be a wait for memory more.
struct light_leaf {
    uint32_t item;
    float inv_area;      // of a triangle, and its corners; filled by who has them
    float corner[3][3];
};

// What the density of an item needs first.
struct light_slot {
    uint32_t slot;   // 16 x node + child, or LIGHT_TREE_NONE
    uint32_t parent; // slot of that node
    float inv_area;  // as above
};

struct light_tree {
    struct light_node *nodes;  // owned
    uint32_t *parents;         // by node: its slot; of the root: LIGHT_TREE_NONE; owned
    struct light_leaf *leaves; // by slot; owned
    struct light_slot *slots;  // by item; owned
    uint32_t node_count, item_count;
};

// Items without intensity are never chosen.
void light_tree_init(struct light_tree *t, const struct light_bounds *items, uint32_t count);
void light_tree_finish(struct light_tree *t);
size_t light_tree_bytes(const struct light_tree *t);

// u in [0, 1) with as many bits as there are. false: no light reaches the place.
bool light_tree_choose(const struct light_tree *t, const struct light_place *at, double u,
                       const struct light_leaf **leaf, float *pmf);
// The same, to the bit, for the lanes of `wanted`; returns those that found an item. They go down side
// by side, so that while one is looked at, the nodes of the others are on their way from memory.
uint32_t light_tree_choose_lanes(const struct light_tree *t, uint32_t wanted,
                                 const struct light_place at[WIDE_LANES],
                                 const double u[WIDE_LANES],
                                 const struct light_leaf *leaf[WIDE_LANES], float pmf[WIDE_LANES]);
// The probability that choose finds the item.
float light_tree_pmf(const struct light_tree *t, const struct light_place *at, uint32_t item);
// Sends for the memory that light_tree_pmf will need, without waiting for it.
// At most one for each lane.
void light_tree_prefetch(const struct light_tree *t, const uint32_t *items, int count);
// For who fills it with what the item is. NULL: it is not in the tree.
struct light_leaf *light_tree_leaf(struct light_tree *t, uint32_t item);
// Nodes that choose looks at to find the item.
int light_tree_depth(const struct light_tree *t, uint32_t item);

// ---- for building

#define LIGHT_TREE_NONE UINT32_MAX // slot of an item that is not in the tree

// Children of a node, in bytes and rounded so that they hold what they bound: three
// cache lines, and a few hundred kilobytes for all but the lowest nodes of a million lights, since a
// choice mostly waits for memory. Those that are nodes follow one another.
struct light_node {
    alignas(64) float origin[3];
    float step;         // of the centres
    float radius_step;
    uint32_t first;     // of the children that are nodes
    uint16_t inner;     // bit a child: it is a node
    uint16_t lowest;    // it is a node whose children are all items
    uint8_t centre[3][LIGHT_TREE_CHILDREN], radius[LIGHT_TREE_CHILDREN]; // of a sphere, in steps
    int8_t axis[3][LIGHT_TREE_CHILDREN];    // of length 127 at most
    uint8_t spread[LIGHT_TREE_CHILDREN];    // 255: 1; sine of half the angle that the normals fill
    uint8_t cos_e[LIGHT_TREE_CHILDREN];     // 255: 1
    uint8_t intensity[LIGHT_TREE_CHILDREN]; // 5 bits of exponent, 3 of fraction; 0: none. The greatest is 255
};
