// SPDX-License-Identifier: Apache-2.0
// Many items are split between bins along each axis, few between all of them.
#include "light/light_tree_split.h"

#include <string.h>

#include "base/mem.h"

enum { BINS = 12, MOST_BINNED_DEPTH = 64 };

static const struct light_cluster EMPTY = {.min = {INFINITY, INFINITY, INFINITY},
                                     .max = {-INFINITY, -INFINITY, -INFINITY}, .cos_e = 1};

static inline void add_item(struct light_cluster *c, const struct light_bounds *b) {
    c->min = light_least(c->min, b->min);
    c->max = light_most(c->max, b->max);
    c->axes += b->intensity * 0.5f * (1 + b->cos_o) * b->axis;
    c->intensity += b->intensity;
    c->cos_e = minf(c->cos_e, b->cos_e);
    c->count++;
}

static inline struct light_cluster merge(struct light_cluster a, struct light_cluster b) {
    return (struct light_cluster){light_least(a.min, b.min), light_most(a.max, b.max), a.axes + b.axes,
                            a.intensity + b.intensity, minf(a.cos_e, b.cos_e), a.count + b.count};
}

// The measure of directions M of the paper over pi, by quadratics that are right to 15 %. The half
// angle of the normals is that of the uniform cone with the mean axis of this length.
static float spread(const struct light_cluster *c) {
    const float mean = minf(length(c->axes) / c->intensity, 1);
    const float o = 2 * mean - 1, sin2_e = 1 - c->cos_e * c->cos_e;
    return sin2_e * (3.57f - (1.5f + 1.07f * o) * o) + (1 - sin2_e) * 2 * (1 - o) + 1e-3f;
}

// Half the surface of the box; a little for the diagonal, so that rows of lights are split too.
static float surface(const struct light_cluster *c) {
    const vec3 d = c->max - c->min;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0] + 0.01f * length2(d);
}

static float cost(const struct light_cluster *c) {
    return c->count ? c->intensity * spread(c) * surface(c) : 0;
}

static inline vec3 middle(const struct light_bounds *b) {
    return 0.5f * b->min + 0.5f * b->max;
}

// ---- splitting a range

struct bins {
    vec3 origin, scale;
    struct light_cluster c[3][BINS];
};

static inline int bin_of(const struct bins *bins, int axis, vec3 p) {
    const int i = (int)((p[axis] - bins->origin[axis]) * bins->scale[axis]);
    return i < BINS ? i : BINS - 1;
}

static void fill_bins(struct bins *bins, const struct light_item *items, const struct light_range *r) {
    vec3 lo = EMPTY.min, hi = EMPTY.max;
    for (uint32_t i = r->begin; i < r->end; i++) {
        lo = light_least(lo, middle(&items[i].b));
        hi = light_most(hi, middle(&items[i].b));
    }
    bins->origin = lo;
    for (int axis = 0; axis < 3; axis++) {
        const float scale = BINS / (hi[axis] - lo[axis]);
        bins->scale[axis] = scale < INFINITY ? scale : 0;
        for (int i = 0; i < BINS; i++)
            bins->c[axis][i] = EMPTY;
    }
    for (uint32_t i = r->begin; i < r->end; i++)
        for (int axis = 0; axis < 3; axis++)
            add_item(&bins->c[axis][bin_of(bins, axis, middle(&items[i].b))], &items[i].b);
}

struct split {
    int axis, bin; // items of bins up to this one go left
    float cost;
};

// Thin slices of a box cost more (the factor k_r of the paper).
static struct split best_split(const struct bins *bins, const struct light_range *r) {
    struct split best = {-1, 0, INFINITY};
    const vec3 d = r->c.max - r->c.min;
    const float longest = maxf(d[0], maxf(d[1], d[2]));
    for (int axis = 0; axis < 3; axis++) {
        float left_cost[BINS];
        struct light_cluster left = EMPTY, right = EMPTY;
        if (!(bins->scale[axis] > 0) || !(d[axis] > 0))
            continue;
        for (int i = 0; i < BINS - 1; i++) {
            left = merge(left, bins->c[axis][i]);
            left_cost[i] = left.count ? cost(&left) : INFINITY;
        }
        for (int i = BINS - 1; i > 0; i--) {
            right = merge(right, bins->c[axis][i]);
            const float both = (left_cost[i - 1] + cost(&right)) * (longest / d[axis]);
            if (right.count && both < best.cost)
                best = (struct split){axis, i - 1, both};
        }
    }
    return best;
}

static uint32_t partition(struct light_item *items, const struct light_range *r, const struct bins *bins,
                          struct split s) {
    uint32_t i = r->begin, j = r->end;
    while (i < j) {
        if (bin_of(bins, s.axis, middle(&items[i].b)) <= s.bin) {
            i++;
            continue;
        }
        const struct light_item other = items[--j];
        items[j] = items[i];
        items[i] = other;
    }
    return i;
}

// ---- few items: whole subtrees go to either side, so that the lowest nodes are full

enum { FEW_ITEMS = LIGHT_TREE_CHILDREN * LIGHT_TREE_CHILDREN * LIGHT_TREE_CHILDREN };

// A place along an axis, in the order of unsigned numbers, and below it which item.
typedef uint64_t key;

struct light_split_few {
    key keys[3][FEW_ITEMS], other[FEW_ITEMS];
    struct light_item items[FEW_ITEMS];
};

static inline key key_of(float x, uint32_t index) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits ^= bits >> 31 ? UINT32_MAX : 0x80000000u;
    return (key)bits << 32 | index;
}

// Merging runs of 1, 2, 4, ... without a branch that nobody can foretell.
static void sort_keys(key *keys, key *other, uint32_t count) {
    for (uint32_t run = 1; run < count; run *= 2) {
        for (uint32_t begin = 0; begin < count; begin += 2 * run) {
            const uint32_t middle = begin + run < count ? begin + run : count;
            const uint32_t end = begin + 2 * run < count ? begin + 2 * run : count;
            uint32_t i = begin, j = middle, k = begin;
            while (i < middle && j < end) {
                const bool right = keys[j] < keys[i];
                other[k++] = right ? keys[j] : keys[i];
                j += right;
                i += !right;
            }
            memcpy(&other[k], &keys[i], (middle - i) * sizeof *keys);
            memcpy(&other[k + middle - i], &keys[j], (end - j) * sizeof *keys);
        }
        memcpy(keys, other, count * sizeof *keys);
    }
}

// At a multiple of the unit, by the order of the keys; .bin is the number of items that go left.
static struct split best_multiple(const struct light_item *items, uint32_t count, const key *keys) {
    struct light_cluster part[LIGHT_TREE_CHILDREN], left = EMPTY, right = EMPTY;
    float right_cost[LIGHT_TREE_CHILDREN];
    const uint32_t unit = light_range_unit(count);
    struct split best = {0, (int)unit, INFINITY};
    const int n = (int)((count + unit - 1) / unit);
    for (int k = 0; k < n; k++)
        part[k] = EMPTY;
    for (uint32_t i = 0; i < count; i++)
        add_item(&part[i / unit], &items[(uint32_t)keys[i]].b);
    for (int k = n - 1; k > 0; k--) {
        right = merge(right, part[k]);
        right_cost[k] = cost(&right);
    }
    for (int k = 1; k < n; k++) {
        left = merge(left, part[k - 1]);
        if (cost(&left) + right_cost[k] < best.cost)
            best = (struct split){0, k * (int)unit, cost(&left) + right_cost[k]};
    }
    return best;
}

static uint32_t split_few(struct light_splitter *s, const struct light_range *r) {
    struct light_split_few *few = s->few;
    struct light_item *items = &s->items[r->begin];
    const uint32_t count = r->c.count;
    struct split best = {0, (int)light_range_unit(count), INFINITY};
    const vec3 d = r->c.max - r->c.min;
    const float longest = maxf(d[0], maxf(d[1], d[2]));
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < count; i++)
            few->keys[axis][i] = key_of(middle(&items[i].b)[axis], i);
        sort_keys(few->keys[axis], few->other, count);
        struct split one = best_multiple(items, count, few->keys[axis]);
        one.axis = axis;
        one.cost *= d[axis] > 0 ? longest / d[axis] : INFINITY;
        best = one.cost < best.cost ? one : best;
    }
    for (uint32_t i = 0; i < count; i++)
        few->items[i] = items[(uint32_t)few->keys[best.axis][i]];
    memcpy(items, few->items, count * sizeof *items);
    return r->begin + (uint32_t)best.bin;
}

// ---- all

// Lights in one place are halved as they come.
void light_splitter_split(struct light_splitter *s, const struct light_range *r, int depth,
                          struct light_range out[2]) {
    uint32_t cut = r->begin + (r->end - r->begin) / 2;
    if (r->c.count > LIGHT_TREE_CHILDREN && r->c.count <= FEW_ITEMS) {
        cut = split_few(s, r);
    } else if (r->c.count > 2 && depth < MOST_BINNED_DEPTH) {
        struct bins bins;
        fill_bins(&bins, s->items, r);
        const struct split best = best_split(&bins, r);
        if (best.axis >= 0)
            cut = partition(s->items, r, &bins, best);
    }
    out[0] = light_splitter_range(s, r->begin, cut);
    out[1] = light_splitter_range(s, cut, r->end);
}

float light_range_cost(const struct light_range *r) {
    return cost(&r->c);
}

struct light_range light_splitter_range(const struct light_splitter *s, uint32_t begin, uint32_t end) {
    struct light_range r = {begin, end, EMPTY};
    for (uint32_t i = begin; i < end; i++)
        add_item(&r.c, &s->items[i].b);
    return r;
}

void light_splitter_init(struct light_splitter *s, uint32_t count) {
    *s = (struct light_splitter){mem_array(count, sizeof *s->items), mem_array(1, sizeof *s->few)};
}

void light_splitter_finish(struct light_splitter *s) {
    mem_free(s->items);
    mem_free(s->few);
}
