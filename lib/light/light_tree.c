// SPDX-License-Identifier: Apache-2.0
#include "light/light_tree.h"

#include <string.h>

#include "base/mem.h"
#include "math/lanes.h"

// Cosines below come from square roots and can be wrong by the root of the rounding, that of axes in
// 16 bits: nothing is excluded, nor counted less, than with this much to spare.
static const float SLACK = 1e-2f;
// Share that light from behind the receiver's normal counts: a guide only, since a material may
// have tilted the normal it really uses.
static const float LEAST_COSINE = 0.0625f;

// So many stay in the cache of a core: nothing is sent for.
enum { FEW_NODES = 256 };

typedef uint16_t wide_u16 __attribute__((vector_size(32)));
typedef int16_t wide_i16 __attribute__((vector_size(32)));

static inline wide unsigned_lanes(const uint16_t v[WIDE_LANES]) {
    wide_u16 x;
    memcpy(&x, v, sizeof x);
    return __builtin_convertvector(__builtin_convertvector(x, wide_int), wide);
}

static inline wide unit_lanes(const int16_t v[WIDE_LANES]) {
    wide_i16 x;
    memcpy(&x, v, sizeof x);
    return __builtin_convertvector(__builtin_convertvector(x, wide_int), wide) * (1.0f / 32767);
}

static inline wide intensity_lanes(const struct light_node *node) {
    wide_u16 x;
    memcpy(&x, node->intensity, sizeof x);
    return (wide)(__builtin_convertvector(x, wide_uint) << 16);
}

static inline struct wide3 centre_lanes(const struct light_node *node) {
    return (struct wide3){node->origin[0] + node->step * unsigned_lanes(node->centre[0]),
                          node->origin[1] + node->step * unsigned_lanes(node->centre[1]),
                          node->origin[2] + node->step * unsigned_lanes(node->centre[2])};
}

// Upper bounds of what the children give: intensity x cosines / distance^2 over all points and
// normals of a child. The distance is that of the middle, but at least the child's own size. Of the
// angles, b is what the child fills, o what its normals fill, w lies between their axis and the
// place, n between the receiver's normal and the child; of all but o cosine and sine are kept times
// the distance, so that no root waits for another.
static inline wide importance(const struct light_node *node, const struct light_place *at) {
    const wide none = {0}, one = wide_of(1);
    const wide cos_o = unit_lanes(node->cos_o), sin_o = wide_sqrt(1 - cos_o * cos_o);
    const wide sin_b = node->radius_step * unsigned_lanes(node->radius), r2 = sin_b * sin_b;
    const struct wide3 d = wide3_sub(centre_lanes(node), wide3_of(at->p));
    const wide d2 = wide_dot(d, d);
    const wide_mask inside = d2 <= r2;
    const wide far2 = wide_select(inside, r2, d2), inv2 = 1 / far2;
    const wide cos_b = wide_sqrt(far2 - r2);
    // beyond o + b the light shines slantwise
    const struct wide3 axis = {unit_lanes(node->axis[0]), unit_lanes(node->axis[1]),
                               unit_lanes(node->axis[2])};
    const wide cos_w = -wide_dot(d, axis);
    const wide sin_w = wide_sqrt(wide_max(d2 - cos_w * cos_w, none));
    const wide cos_ob = cos_o * cos_b - sin_o * sin_b, sin_ob = sin_o * cos_b + cos_o * sin_b;
    const wide_mask straight = inside | (sin_ob < 0) | (cos_w > cos_ob);
    const wide cos_l = wide_select(straight, one, (cos_w * cos_ob + sin_w * sin_ob) * inv2);
    const wide intensity = intensity_lanes(node);
    wide value = intensity * wide_max(cos_l, wide_of(SLACK));
    if (length2(at->n) > 0) {
        const wide cos_n = wide_dot(d, wide3_of(at->n));
        const wide sin_n = wide_sqrt(wide_max(d2 - cos_n * cos_n, none));
        const wide cos_i = wide_select(inside | (cos_n > cos_b), one,
                                       (cos_n * cos_b + sin_n * sin_b) * inv2);
        value *= wide_max(cos_i, wide_of(LEAST_COSINE));
    }
    const wide_mask dark = (cos_l < unit_lanes(node->cos_e) - SLACK) | (intensity <= 0);
    // at the very point of a light without size the product is infinite
    return wide_select(dark, none, wide_min(value * inv2, wide_of(1e36f)));
}

static const double END = 0x1.fffffffffffffp-1; // the last number below 1

typedef double double4 __attribute__((vector_size(32)));

// Children are looked at as a table of four rows, a column first: fewer steps than one by one.
struct table {
    double row[4][4];
    double column[4]; // sums up to and with each
};

static inline struct table table_of(wide v) {
    struct table t;
    float4 f[4];
    double4 r[4];
    memcpy(f, &v, sizeof f);
    for (int j = 0; j < 4; j++)
        r[j] = __builtin_convertvector(f[j], double4);
    memcpy(t.row, r, sizeof r);
    const double4 sum = (r[0] + r[1]) + (r[2] + r[3]);
    t.column[0] = sum[0];
    t.column[1] = sum[0] + sum[1];
    t.column[2] = t.column[1] + sum[2];
    t.column[3] = t.column[1] + (sum[2] + sum[3]);
    return t;
}

static inline double table_value(const struct table *t, int i) {
    return t->row[i / 4][i % 4];
}

// The child at *x in [0, sum), one of those above 0; *x becomes the place within it.
static inline int table_choose(const struct table *t, double *x) {
    const int k = (*x >= t->column[0]) + (*x >= t->column[1]) + (*x >= t->column[2]);
    *x -= k > 0 ? t->column[k - 1] : 0;
    const double a = t->row[0][k], b = a + t->row[1][k], c = b + t->row[2][k];
    const int j = (*x >= a) + (*x >= b) + (*x >= c);
    *x -= j > 1 ? j > 2 ? c : b : j > 0 ? a : 0;
    if (t->row[j][k] > 0)
        return 4 * j + k;
    int last = 0; // by rounding, beyond the last
    for (int i = 0; i < WIDE_LANES; i++)
        last = table_value(t, i) > 0 ? i : last;
    return last;
}

// All lines of a node at once.
static inline void prefetch_node(const struct light_node *node) {
    for (size_t k = 0; k < sizeof *node; k += 64)
        __builtin_prefetch((const char *)node + k);
    __builtin_prefetch((const char *)(node + 1) - 1);
}

struct descent {
    double u, probability;
    uint32_t child;
};

// One node further down. false: none of its children gives light.
static inline bool descend(const struct light_tree *t, const struct light_place *at,
                           struct descent *d) {
    const struct light_node *node = &t->nodes[d->child];
    const struct table values = table_of(importance(node, at));
    const double sum = values.column[3];
    if (!(sum > 0))
        return false;
    double x = d->u * sum;
    const int i = table_choose(&values, &x);
    d->child = node->child[i];
    x /= table_value(&values, i);
    d->u = x > 0 ? x < END ? x : END : 0;
    d->probability *= table_value(&values, i) / sum;
    return true;
}

bool light_tree_choose(const struct light_tree *t, const struct light_place *at, double u,
                       uint32_t *item, float *pmf) {
    struct descent d = {.u = u, .probability = 1};
    if (t->node_count == 0)
        return false;
    while (!(d.child & LIGHT_TREE_LEAF))
        if (!descend(t, at, &d))
            return false;
    *item = d.child - LIGHT_TREE_LEAF;
    *pmf = (float)d.probability;
    return *pmf > 0;
}

uint32_t light_tree_choose_lanes(const struct light_tree *t, uint32_t wanted,
                                 const struct light_place at[WIDE_LANES],
                                 const double u[WIDE_LANES], uint32_t item[WIDE_LANES],
                                 float pmf[WIDE_LANES]) {
    struct descent d[WIDE_LANES];
    uint32_t found = 0;
    for (int i = 0; i < WIDE_LANES; i++)
        d[i] = (struct descent){.u = u[i], .probability = 1};
    for (uint32_t going = t->node_count ? wanted : 0; going;)
        for (uint32_t left = going; left; left &= left - 1) {
            const int i = __builtin_ctz(left);
            const bool lit = descend(t, &at[i], &d[i]);
            if (lit && !(d[i].child & LIGHT_TREE_LEAF)) {
                if (t->node_count > FEW_NODES)
                    prefetch_node(&t->nodes[d[i].child]);
                continue;
            }
            going &= ~(1u << i);
            item[i] = d[i].child & ~LIGHT_TREE_LEAF;
            pmf[i] = (float)d[i].probability;
            found |= (uint32_t)(lit && pmf[i] > 0) << i;
        }
    return found;
}

void light_tree_prefetch(const struct light_tree *t, const uint32_t *items, int count) {
    uint32_t slot[WIDE_LANES];
    if (t->node_count <= FEW_NODES)
        return;
    for (int i = 0; i < count; i++)
        slot[i] = t->slots[items[i]];
    // level by level, since the way up waits for memory too
    for (int going = count; going > 0;) {
        const int were = going;
        going = 0;
        for (int i = 0; i < were; i++) {
            if (slot[i] == LIGHT_TREE_NONE)
                continue;
            prefetch_node(&t->nodes[slot[i] / WIDE_LANES]);
            slot[going++] = t->parents[slot[i] / WIDE_LANES];
        }
    }
}

float light_tree_pmf(const struct light_tree *t, const struct light_place *at, uint32_t item) {
    double probability = 1;
    uint32_t slot = t->slots[item];
    if (slot == LIGHT_TREE_NONE)
        return 0;
    for (; slot != LIGHT_TREE_NONE; slot = t->parents[slot / WIDE_LANES]) {
        const struct table values = table_of(importance(&t->nodes[slot / WIDE_LANES], at));
        const double value = table_value(&values, (int)(slot % WIDE_LANES));
        if (!(value > 0))
            return 0;
        probability *= value / values.column[3];
    }
    return (float)probability;
}

int light_tree_depth(const struct light_tree *t, uint32_t item) {
    int nodes = 0;
    for (uint32_t s = t->slots[item]; s != LIGHT_TREE_NONE; s = t->parents[s / WIDE_LANES])
        nodes++;
    return nodes;
}

void light_tree_finish(struct light_tree *t) {
    mem_free(t->nodes);
    mem_free(t->parents);
    mem_free(t->slots);
    *t = (struct light_tree){0};
}

size_t light_tree_bytes(const struct light_tree *t) {
    return t->node_count * (sizeof *t->nodes + sizeof *t->parents) +
           t->item_count * sizeof *t->slots;
}
