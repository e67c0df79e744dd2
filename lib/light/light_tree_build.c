// SPDX-License-Identifier: Apache-2.0
// Building the light tree: ranges of lights are split where the sum over both sides of intensity x
// measure of directions x surface of the box is least (Conty Estevez, Kulla 2018, equation 1), over
// bins along each axis; a node takes the ranges that fifteen splits make.
#include <float.h>
#include <string.h>

#include "base/mem.h"
#include "light/light_tree.h"

enum { BINS = 12, MOST_BINNED_DEPTH = 64 };

struct item {
    struct light_bounds b;
    uint32_t index;
};

struct cluster {
    vec3 min, max;
    vec3 axes;       // sum of the axes, by intensity and by how narrow each is
    float intensity;
    float cos_e;
    uint32_t count;
};

struct range {
    uint32_t begin, end;
    struct cluster c;
};

struct builder {
    struct item *items;
    struct light_tree *tree;
    size_t capacity, parents_capacity; // of the tree's nodes
};

static const struct cluster EMPTY = {.min = {INFINITY, INFINITY, INFINITY},
                                     .max = {-INFINITY, -INFINITY, -INFINITY}, .cos_e = 1};

static inline vec3 least(vec3 a, vec3 b) {
    return v3(minf(a[0], b[0]), minf(a[1], b[1]), minf(a[2], b[2]));
}

static inline vec3 most(vec3 a, vec3 b) {
    return v3(maxf(a[0], b[0]), maxf(a[1], b[1]), maxf(a[2], b[2]));
}

static inline void add_item(struct cluster *c, const struct light_bounds *b) {
    c->min = least(c->min, b->min);
    c->max = most(c->max, b->max);
    c->axes += b->intensity * 0.5f * (1 + b->cos_o) * b->axis;
    c->intensity += b->intensity;
    c->cos_e = minf(c->cos_e, b->cos_e);
    c->count++;
}

static inline struct cluster merge(struct cluster a, struct cluster b) {
    return (struct cluster){least(a.min, b.min), most(a.max, b.max), a.axes + b.axes,
                            a.intensity + b.intensity, minf(a.cos_e, b.cos_e), a.count + b.count};
}

// The measure of directions M of the paper over pi, by quadratics that are right to 15 %. The half
// angle of the normals is that of the uniform cone with the mean axis of this length.
static float spread(const struct cluster *c) {
    const float mean = minf(length(c->axes) / c->intensity, 1);
    const float o = 2 * mean - 1, sin2_e = 1 - c->cos_e * c->cos_e;
    return sin2_e * (3.57f - (1.5f + 1.07f * o) * o) + (1 - sin2_e) * 2 * (1 - o) + 1e-3f;
}

// Half the surface of the box; a little for the diagonal, so that rows of lights are split too.
static float surface(const struct cluster *c) {
    const vec3 d = c->max - c->min;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0] + 0.01f * length2(d);
}

static float cost(const struct cluster *c) {
    return c->count ? c->intensity * spread(c) * surface(c) : 0;
}

static inline vec3 middle(const struct light_bounds *b) {
    return 0.5f * b->min + 0.5f * b->max;
}

// ---- splitting a range

struct bins {
    vec3 origin, scale;
    struct cluster c[3][BINS];
};

static inline int bin_of(const struct bins *bins, int axis, vec3 p) {
    const int i = (int)((p[axis] - bins->origin[axis]) * bins->scale[axis]);
    return i < BINS ? i : BINS - 1;
}

static void fill_bins(struct bins *bins, const struct item *items, const struct range *r) {
    vec3 lo = EMPTY.min, hi = EMPTY.max;
    for (uint32_t i = r->begin; i < r->end; i++) {
        lo = least(lo, middle(&items[i].b));
        hi = most(hi, middle(&items[i].b));
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
static struct split best_split(const struct bins *bins, const struct range *r) {
    struct split best = {-1, 0, INFINITY};
    const vec3 d = r->c.max - r->c.min;
    const float longest = maxf(d[0], maxf(d[1], d[2]));
    for (int axis = 0; axis < 3; axis++) {
        float left_cost[BINS];
        struct cluster left = EMPTY, right = EMPTY;
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

static struct cluster cluster_of(const struct item *items, uint32_t begin, uint32_t end) {
    struct cluster c = EMPTY;
    for (uint32_t i = begin; i < end; i++)
        add_item(&c, &items[i].b);
    return c;
}

static uint32_t partition(struct item *items, const struct range *r, const struct bins *bins,
                          struct split s) {
    uint32_t i = r->begin, j = r->end;
    while (i < j) {
        if (bin_of(bins, s.axis, middle(&items[i].b)) <= s.bin) {
            i++;
            continue;
        }
        const struct item other = items[--j];
        items[j] = items[i];
        items[i] = other;
    }
    return i;
}

// At least two items; both parts have some. Lights in one place are halved as they come.
static void split_range(struct builder *b, const struct range *r, int depth, struct range out[2]) {
    uint32_t cut = r->begin + (r->end - r->begin) / 2;
    if (r->end - r->begin > 2 && depth < MOST_BINNED_DEPTH) {
        struct bins bins;
        fill_bins(&bins, b->items, r);
        const struct split s = best_split(&bins, r);
        if (s.axis >= 0)
            cut = partition(b->items, r, &bins, s);
    }
    out[0] = (struct range){r->begin, cut, cluster_of(b->items, r->begin, cut)};
    out[1] = (struct range){cut, r->end, cluster_of(b->items, cut, r->end)};
}

// ---- nodes

// Cosine of the sum of two angles in [0, pi], -1 beyond a half turn.
static float cos_sum(float a, float b) {
    if (b >= 1)
        return a;
    return a <= -b ? -1 : a * b - safe_sqrt(1 - a * a) * safe_sqrt(1 - b * b);
}

// Bounds of a range, as they are before they are rounded into a node.
struct bounds {
    vec3 centre, axis;
    float radius, cos_o;
};

static struct bounds bounds_of(const struct item *items, const struct range *r) {
    const struct cluster *c = &r->c;
    const vec3 centre = 0.5f * c->min + 0.5f * c->max, size = c->max - centre;
    const vec3 reach = v3(fabsf(centre[0]), fabsf(centre[1]), fabsf(centre[2]));
    const vec3 axis = normalize(c->axes);
    float cos_o = length2(axis) > 0 ? 1 : -1;
    for (uint32_t i = r->begin; i < r->end && cos_o > -1; i++)
        cos_o = items[i].b.cos_o <= -1
                    ? -1
                    : minf(cos_o, cos_sum(dot(axis, items[i].b.axis), items[i].b.cos_o));
    return (struct bounds){centre, axis, length(size) * (1 + 1e-6f) + 0x1p-22f * length(reach),
                           cos_o};
}

static int16_t unit_down(float x) {
    return (int16_t)floorf(clampf(x, -1, 1) * 32767);
}

// The upper half of a float that is not below x >= 0.
static uint16_t half_up(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (uint16_t)((bits + 0xffff) >> 16);
}

// Steps of the coordinates between all centres, and of the largest radius once half the diagonal of
// a step is added: so far may a centre be from where it is rounded to.
static void set_steps(struct light_node *node, const struct bounds *b, int n, float *moved) {
    vec3 lo = b[0].centre, hi = b[0].centre;
    float radius = 0, reach = 0;
    for (int i = 0; i < n; i++) {
        lo = least(lo, b[i].centre);
        hi = most(hi, b[i].centre);
        radius = maxf(radius, b[i].radius);
    }
    for (int k = 0; k < 3; k++) {
        node->origin[k] = lo[k];
        node->step = maxf(node->step, (hi[k] - lo[k]) / 65535);
        reach = maxf(reach, maxf(fabsf(lo[k]), fabsf(hi[k])));
    }
    *moved = 0.87f * node->step + 0x1p-22f * reach;
    node->radius_step = (radius + *moved) / 65534;
}

static void set_lanes(struct light_node *node, const struct item *items, const struct range *ranges,
                      int n) {
    struct bounds b[WIDE_LANES] = {0};
    float moved;
    for (int i = 0; i < n; i++)
        b[i] = bounds_of(items, &ranges[i]);
    set_steps(node, b, n, &moved);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            const float steps = (b[i].centre[k] - node->origin[k]) / node->step;
            node->centre[k][i] = (uint16_t)(node->step > 0 ? minf(rintf(steps), 65535) : 0);
            node->axis[k][i] = (int16_t)rintf(b[i].axis[k] * 32767);
        }
        const float radius = (b[i].radius + moved) / node->radius_step;
        node->radius[i] = (uint16_t)(node->radius_step > 0 ? minf(ceilf(radius), 65535) : 0);
        // an axis of 16 bits is off by 3e-5 at most
        node->cos_o[i] = b[i].cos_o > -1 ? unit_down(b[i].cos_o - 3e-5f) : -32767;
        node->cos_e[i] = unit_down(ranges[i].c.cos_e);
        node->intensity[i] = half_up(ranges[i].c.intensity);
    }
}

// The range to split next: of those that do not fit into one node the one of the greatest cost, else
// the greatest cost where all fit into this one; -1: none. So nodes are well filled.
static int worst_range(const struct range *ranges, int n, uint32_t fits) {
    int worst = -1;
    for (int i = 0; i < n; i++)
        if (ranges[i].c.count > fits && (worst < 0 || cost(&ranges[i].c) > cost(&ranges[worst].c)))
            worst = i;
    return worst;
}

static int split_for_node(struct builder *b, const struct range *from, int depth,
                          struct range out[WIDE_LANES]) {
    const uint32_t fits = from->c.count <= WIDE_LANES ? 1 : WIDE_LANES;
    int n = 1;
    out[0] = *from;
    for (int worst; n < WIDE_LANES && (worst = worst_range(out, n, fits)) >= 0; n++) {
        struct range two[2];
        split_range(b, &out[worst], depth, two);
        out[worst] = two[0];
        out[n] = two[1];
    }
    return n;
}

static uint32_t build(struct builder *b, const struct range *from, uint32_t parent, int depth) {
    struct range ranges[WIDE_LANES];
    const uint32_t index = b->tree->node_count++;
    const int n = split_for_node(b, from, depth, ranges);
    struct light_node node = {0};
    set_lanes(&node, b->items, ranges, n);
    mem_grow(&b->tree->nodes, &b->capacity, index + 1, sizeof node);
    mem_grow(&b->tree->parents, &b->parents_capacity, index + 1, sizeof parent);
    b->tree->nodes[index] = node;
    b->tree->parents[index] = parent;
    for (int i = 0; i < n; i++) {
        const struct range *r = &ranges[i];
        const uint32_t slot = WIDE_LANES * index + (uint32_t)i;
        const bool leaf = r->end - r->begin == 1;
        const uint32_t item = b->items[r->begin].index;
        if (leaf)
            b->tree->slots[item] = slot;
        const uint32_t child = leaf ? item | LIGHT_TREE_LEAF : build(b, r, slot, depth + 1);
        b->tree->nodes[index].child[i] = child;
    }
    return index;
}

void light_tree_init(struct light_tree *t, const struct light_bounds *items, uint32_t count) {
    *t = (struct light_tree){.item_count = count, .slots = mem_array(count, sizeof *t->slots)};
    struct builder b = {.items = mem_array(count, sizeof *b.items), .tree = t};
    float strongest = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++)
        strongest = maxf(strongest, items[i].intensity);
    for (uint32_t i = 0; i < count; i++) {
        t->slots[i] = LIGHT_TREE_NONE;
        if (!(items[i].intensity > 0))
            continue;
        b.items[n] = (struct item){items[i], i};
        // Sums and quotients stay in range, and nothing that shines gets lost.
        b.items[n++].b.intensity = clampf(items[i].intensity / strongest, 1e-12f, 1);
    }
    const struct range all = {0, n, cluster_of(b.items, 0, n)};
    if (n > 0)
        build(&b, &all, LIGHT_TREE_NONE, 0);
    mem_free(b.items);
}
