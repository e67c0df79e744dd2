// SPDX-License-Identifier: Apache-2.0
#include "light/light_tree.h"

#include <string.h>

#include "base/mem.h"
#include "math/lanes.h"

// Cosines below come from square roots and can be wrong by the root of the rounding, that of axes in
// bytes: nothing is excluded, nor counted less, than with this much to spare.
static const float SLACK = 1e-2f;
// Share that light from behind the receiver's normal counts: a guide only, since a material may
// have tilted the normal it really uses.
static const float LEAST_COSINE = 0.0625f;

// So many stay in the cache of a core: nothing is sent for.
enum { FEW_NODES = 512 };

// Of WIDE_LANES children from `first` on:

static inline wide intensity_lanes(const struct light_node *node, int first) {
    const wide_uint code =
        __builtin_convertvector(wide_of_bytes(node->intensity + first), wide_uint);
    return (wide)((code << 20) + (96u << 23));
}

static inline struct wide3 centre_lanes(const struct light_node *node, int first) {
    return (struct wide3){node->origin[0] + node->step * wide_of_bytes(node->centre[0] + first),
                          node->origin[1] + node->step * wide_of_bytes(node->centre[1] + first),
                          node->origin[2] + node->step * wide_of_bytes(node->centre[2] + first)};
}

static inline wide axis_lanes(const int8_t v[WIDE_LANES]) {
    return wide_of_signed_bytes(v) * (1.0f / 127);
}

// Upper bounds of what the children give: intensity x cosines / distance^2 over all points and
// normals of a child. The distance is that of the middle, but at least the child's own size. Of the
// angles, b is what the child fills, o what its normals fill, w lies between their axis and the
// place, n between the receiver's normal and the child; of all but o cosine and sine are kept times
// the distance, so that no root waits for another.
static inline wide importance(const struct light_node *node, int first,
                              const struct light_place *at) {
    const wide none = {0}, one = wide_of(1);
    const wide half = wide_of_bytes(node->spread + first) * (1.0f / 255), half2 = half * half;
    const wide cos_o = 1 - 2 * half2, sin_o = 2 * half * wide_sqrt(wide_max(1 - half2, none));
    const wide sin_b = node->radius_step * wide_of_bytes(node->radius + first), r2 = sin_b * sin_b;
    const struct wide3 d = wide3_sub(centre_lanes(node, first), wide3_of(at->p));
    const wide d2 = wide_dot(d, d);
    const wide_mask inside = d2 <= r2;
    const wide far2 = wide_select(inside, r2, d2), inv2 = 1 / far2;
    const wide cos_b = wide_sqrt(far2 - r2);
    // beyond o + b the light shines slantwise
    const struct wide3 axis = {axis_lanes(node->axis[0] + first), axis_lanes(node->axis[1] + first),
                               axis_lanes(node->axis[2] + first)};
    const wide cos_w = -wide_dot(d, axis);
    const wide sin_w = wide_sqrt(wide_max(d2 - cos_w * cos_w, none));
    const wide cos_ob = cos_o * cos_b - sin_o * sin_b, sin_ob = sin_o * cos_b + cos_o * sin_b;
    const wide_mask straight = inside | (sin_ob < 0) | (cos_w > cos_ob);
    const wide cos_l = wide_select(straight, one, (cos_w * cos_ob + sin_w * sin_ob) * inv2);
    const wide intensity = intensity_lanes(node, first);
    wide value = intensity * wide_max(cos_l, wide_of(SLACK));
    if (length2(at->n) > 0) {
        const wide cos_n = wide_dot(d, wide3_of(at->n));
        const wide sin_n = wide_sqrt(wide_max(d2 - cos_n * cos_n, none));
        const wide cos_i = wide_select(inside | (cos_n > cos_b), one,
                                       (cos_n * cos_b + sin_n * sin_b) * inv2);
        value *= wide_max(cos_i, wide_of(LEAST_COSINE));
    }
    const wide code = wide_of_bytes(node->intensity + first);
    const wide cos_e = wide_of_bytes(node->cos_e + first) * (1.0f / 255);
    const wide_mask dark = (cos_l < cos_e - SLACK) | (code <= 0);
    // at the very point of a light without size the product is infinite
    return wide_select(dark, none, wide_min(value * inv2, wide_of(1e36f)));
}

static const double END = 0x1.fffffffffffffp-1; // the last number below 1

typedef double double4 __attribute__((vector_size(32)));

static inline double4 doubles_of(float4 f) {
#if defined(__AVX512F__)
    return (double4)_mm256_cvtps_pd((__m128)f); // GCC 12 goes through memory
#else
    return __builtin_convertvector(f, double4);
#endif
}

// Children are looked at as a table of four rows, a column first: fewer steps than one by one, and
// no branch, of which the processor could not know where it goes.
struct table {
    double row[4][4];
    double above[4][4]; // sums of the rows above
    double left[4];     // sums of the columns on the left
    double sum;
};

static inline struct table table_of(const struct light_node *node, const struct light_place *at) {
    struct table t;
    wide v[LIGHT_TREE_CHILDREN / WIDE_LANES];
    float4 f[4];
    double4 r[4];
    for (int i = 0; i < LIGHT_TREE_CHILDREN / WIDE_LANES; i++)
        v[i] = importance(node, WIDE_LANES * i, at);
    memcpy(f, v, sizeof f);
    for (int j = 0; j < 4; j++)
        r[j] = doubles_of(f[j]);
    const double4 two = r[0] + r[1], sum = two + (r[2] + r[3]);
    const double4 above[4] = {{0}, r[0], two, two + r[2]};
    memcpy(t.row, r, sizeof r);
    memcpy(t.above, above, sizeof above);
    t.left[0] = 0;
    t.left[1] = sum[0];
    t.left[2] = sum[0] + sum[1];
    t.left[3] = t.left[2] + sum[2];
    t.sum = t.left[2] + (sum[2] + sum[3]);
    return t;
}

static inline double table_value(const struct table *t, int i) {
    return t->row[i / 4][i % 4];
}

// By rounding, beyond the last.
static __attribute__((noinline)) int table_last(const struct table *t) {
    int last = 0;
    for (int i = 0; i < LIGHT_TREE_CHILDREN; i++)
        last = table_value(t, i) > 0 ? i : last;
    return last;
}

// The child at *x in [0, sum), one of those above 0; *x becomes the place within it.
static inline int table_choose(const struct table *t, double *x) {
    const int k = (*x >= t->left[1]) + (*x >= t->left[2]) + (*x >= t->left[3]);
    *x -= t->left[k];
    const int j = (*x >= t->above[1][k]) + (*x >= t->above[2][k]) + (*x >= t->above[3][k]);
    *x -= t->above[j][k];
    return t->row[j][k] > 0 ? 4 * j + k : table_last(t);
}

// All lines of a node at once.
static inline void prefetch_node(const struct light_node *node) {
    for (size_t k = 0; k < sizeof *node; k += 64)
        __builtin_prefetch((const char *)node + k);
}

struct descent {
    double u, probability;
    uint32_t node;
    uint32_t slot; // of the item that was reached; LIGHT_TREE_NONE: on the way
    bool lowest;   // the node has nothing but items
};

// One node further down. false: none of its children gives light.
static inline bool descend(const struct light_tree *t, const struct light_place *at,
                           struct descent *d) {
    const struct light_node *node = &t->nodes[d->node];
    const struct table values = table_of(node, at);
    if (!(values.sum > 0))
        return false;
    double x = d->u * values.sum;
    const int i = table_choose(&values, &x);
    d->slot = node->inner >> i & 1 ? LIGHT_TREE_NONE : LIGHT_TREE_CHILDREN * d->node + (uint32_t)i;
    d->lowest = node->lowest >> i & 1;
    d->node = node->first + (uint32_t)__builtin_popcount(node->inner & ((1u << i) - 1));
    x /= table_value(&values, i);
    d->u = x > 0 ? x < END ? x : END : 0;
    d->probability *= table_value(&values, i) / values.sum;
    return true;
}

static inline struct descent descent_of(double u) {
    return (struct descent){.u = u, .probability = 1, .slot = LIGHT_TREE_NONE};
}

// The items of a node that has nothing else, before it is looked at itself.
static inline void prefetch_leaves(const struct light_tree *t, uint32_t node) {
    const char *leaves = (const char *)&t->leaves[LIGHT_TREE_CHILDREN * (size_t)node];
    for (size_t k = 0; k < LIGHT_TREE_CHILDREN * sizeof *t->leaves; k += 64)
        __builtin_prefetch(leaves + k);
}

bool light_tree_choose(const struct light_tree *t, const struct light_place *at, double u,
                       const struct light_leaf **leaf, float *pmf) {
    struct descent d = descent_of(u);
    if (t->node_count == 0)
        return false;
    while (d.slot == LIGHT_TREE_NONE) {
        if (!descend(t, at, &d))
            return false;
        if (d.lowest && t->node_count > FEW_NODES)
            prefetch_leaves(t, d.node);
    }
    *leaf = &t->leaves[d.slot];
    *pmf = (float)d.probability;
    return *pmf > 0;
}

uint32_t light_tree_choose_lanes(const struct light_tree *t, uint32_t wanted,
                                 const struct light_place at[WIDE_LANES],
                                 const double u[WIDE_LANES],
                                 const struct light_leaf *leaf[WIDE_LANES],
                                 float pmf[WIDE_LANES]) {
    struct descent d[WIDE_LANES];
    uint32_t found = 0;
    for (int i = 0; i < WIDE_LANES; i++)
        d[i] = descent_of(u[i]);
    for (uint32_t going = t->node_count ? wanted : 0; going;)
        for (uint32_t left = going; left; left &= left - 1) {
            const int i = __builtin_ctz(left);
            const bool lit = descend(t, &at[i], &d[i]);
            if (lit && d[i].slot == LIGHT_TREE_NONE) {
                if (t->node_count > FEW_NODES)
                    prefetch_node(&t->nodes[d[i].node]);
                continue;
            }
            going &= ~(1u << i);
            if (!lit)
                continue;
            leaf[i] = &t->leaves[d[i].slot];
            pmf[i] = (float)d[i].probability;
            found |= (uint32_t)(pmf[i] > 0) << i;
            __builtin_prefetch(leaf[i]);
            __builtin_prefetch((const char *)(leaf[i] + 1) - 1);
        }
    return found;
}

// The lowest two nodes; what is above them is mostly in the cache.
static inline void prefetch_way(const struct light_tree *t, const struct light_slot *s) {
    if (s->slot != LIGHT_TREE_NONE)
        prefetch_node(&t->nodes[s->slot / LIGHT_TREE_CHILDREN]);
    if (s->parent != LIGHT_TREE_NONE)
        prefetch_node(&t->nodes[s->parent / LIGHT_TREE_CHILDREN]);
}

void light_tree_prefetch(const struct light_tree *t, const uint32_t *items, int count) {
    if (t->node_count <= FEW_NODES)
        return;
    for (int i = 0; i < count; i++)
        __builtin_prefetch(&t->slots[items[i]]);
    for (int i = 0; i < count; i++)
        prefetch_way(t, &t->slots[items[i]]);
}

// From the lowest node up: of lights that turn away it knows so already.
float light_tree_pmf(const struct light_tree *t, const struct light_place *at, uint32_t item) {
    const struct light_slot *lowest = &t->slots[item];
    double probability = 1;
    if (t->node_count > FEW_NODES)
        prefetch_way(t, lowest);
    for (uint32_t s = lowest->slot; s != LIGHT_TREE_NONE; s = t->parents[s / LIGHT_TREE_CHILDREN]) {
        const struct table values = table_of(&t->nodes[s / LIGHT_TREE_CHILDREN], at);
        const double value = table_value(&values, (int)(s % LIGHT_TREE_CHILDREN));
        if (!(value > 0))
            return 0;
        probability *= value / values.sum;
    }
    return lowest->slot == LIGHT_TREE_NONE ? 0 : (float)probability;
}

struct light_leaf *light_tree_leaf(struct light_tree *t, uint32_t item) {
    const uint32_t slot = t->slots[item].slot;
    return slot == LIGHT_TREE_NONE ? NULL : &t->leaves[slot];
}

int light_tree_depth(const struct light_tree *t, uint32_t item) {
    int nodes = 0;
    for (uint32_t s = t->slots[item].slot; s != LIGHT_TREE_NONE; s = t->parents[s / LIGHT_TREE_CHILDREN])
        nodes++;
    return nodes;
}

void light_tree_finish(struct light_tree *t) {
    mem_free(t->nodes);
    mem_free(t->parents);
    mem_free(t->leaves);
    mem_free(t->slots);
    *t = (struct light_tree){0};
}

size_t light_tree_bytes(const struct light_tree *t) {
    return t->node_count * (sizeof *t->nodes + sizeof *t->parents + LIGHT_TREE_CHILDREN * sizeof *t->leaves) +
           t->item_count * sizeof *t->slots;
}
