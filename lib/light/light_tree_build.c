// SPDX-License-Identifier: Apache-2.0
// Building the light tree: a node takes the ranges that fifteen splits make (light_tree_split.h), and
// bounds them.
#include <string.h>

#include "base/mem.h"
#include "light/light_tree_split.h"

struct builder {
    struct light_splitter s;
    struct light_tree *tree;
    size_t capacity[2]; // of the tree's nodes, parents
};

// Cosine of the sum of two angles in [0, pi], -1 beyond a half turn.
static float cos_sum(float a, float b) {
    if (b >= 1)
        return a;
    return a <= -b ? -1 : a * b - safe_sqrt(1 - a * a) * safe_sqrt(1 - b * b);
}

// Bounds of a range, as they are before they are rounded into a node; of its axis, the directions
// that the bytes give.
struct bounds {
    vec3 centre;
    int8_t axis[3];
    float radius, cos_o;
};

// A vector of bytes along a unit axis, no longer than 127 (a longer one would let what shines slantwise
// seem to shine less): the longest of those around it.
static vec3 round_axis(vec3 axis, int8_t out[3]) {
    vec3 best = v3(0, 0, 0);
    for (int i = 0; i < 8; i++) {
        vec3 v;
        for (int k = 0; k < 3; k++)
            v[k] = floorf(127 * axis[k]) + (float)(i >> k & 1);
        if (length2(v) <= 127 * 127 && dot(v, axis) > dot(best, axis))
            best = v;
    }
    for (int k = 0; k < 3; k++)
        out[k] = (int8_t)best[k];
    return normalize(best);
}

static struct bounds bounds_of(const struct light_item *items, const struct light_range *r) {
    const struct light_cluster *c = &r->c;
    const vec3 centre = 0.5f * c->min + 0.5f * c->max, size = c->max - centre;
    const vec3 reach = v3(fabsf(centre[0]), fabsf(centre[1]), fabsf(centre[2]));
    struct bounds b = {.centre = centre,
                       .radius = length(size) * (1 + 1e-6f) + 0x1p-22f * length(reach)};
    const vec3 axis = round_axis(normalize(c->axes), b.axis);
    b.cos_o = length2(axis) > 0 ? 1 : -1;
    for (uint32_t i = r->begin; i < r->end && b.cos_o > -1; i++)
        b.cos_o = items[i].b.cos_o <= -1
                      ? -1
                      : minf(b.cos_o, cos_sum(dot(axis, items[i].b.axis), items[i].b.cos_o));
    return b;
}

static uint8_t byte_up(float x) {
    return (uint8_t)clampf(ceilf(x), 0, 255);
}

// The byte of a share x of the greatest, in (0, 1], rounded up; what is below 2^-31 of it counts that.
static uint8_t intensity_up(float x) {
    const float scaled = maxf(x * 1.875f, 0x1p-30f);
    uint32_t bits;
    memcpy(&bits, &scaled, sizeof bits);
    return (uint8_t)(((bits + 0xfffff) >> 20) - (96u << 3));
}

// Steps of the coordinates between all centres, and of the largest radius once half the diagonal of
// a step is added: so far may a centre be from where it is rounded to.
static void set_steps(struct light_node *node, const struct bounds *b, int n, float *moved) {
    vec3 lo = b[0].centre, hi = b[0].centre;
    float radius = 0, reach = 0;
    for (int i = 0; i < n; i++) {
        lo = light_least(lo, b[i].centre);
        hi = light_most(hi, b[i].centre);
        radius = maxf(radius, b[i].radius);
    }
    for (int k = 0; k < 3; k++) {
        node->origin[k] = lo[k];
        node->step = maxf(node->step, (hi[k] - lo[k]) / 255);
        reach = maxf(reach, maxf(fabsf(lo[k]), fabsf(hi[k])));
    }
    *moved = 0.87f * node->step + 0x1p-22f * reach;
    node->radius_step = (radius + *moved) / 254.9f;
}

static void set_lanes(struct light_node *node, const struct light_item *items,
                      const struct light_range *ranges, int n) {
    struct bounds b[LIGHT_TREE_CHILDREN] = {0};
    float moved, strongest = 0;
    for (int i = 0; i < n; i++) {
        b[i] = bounds_of(items, &ranges[i]);
        strongest = maxf(strongest, ranges[i].c.intensity);
    }
    set_steps(node, b, n, &moved);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) {
            const float steps = (b[i].centre[k] - node->origin[k]) / node->step;
            node->centre[k][i] = (uint8_t)(node->step > 0 ? minf(rintf(steps), 255) : 0);
            node->axis[k][i] = b[i].axis[k];
        }
        if (node->radius_step > 0)
            node->radius[i] = byte_up((b[i].radius + moved) / node->radius_step);
        const float half2 = 0.5f * (1 - b[i].cos_o) + 1e-6f; // of the sine of half the angle
        node->spread[i] = byte_up(255 * sqrtf(half2));
        node->cos_e[i] = (uint8_t)floorf(clampf(ranges[i].c.cos_e, 0, 1) * 255);
        node->intensity[i] = intensity_up(ranges[i].c.intensity / strongest);
    }
}

// The range to split next: of those that do not fit into one node the one of the greatest cost, else
// the greatest cost where all fit into this one; -1: none. So nodes are well filled.
static int worst_range(const struct light_range *ranges, int n, uint32_t fits) {
    int worst = -1;
    for (int i = 0; i < n; i++)
        if (ranges[i].c.count > fits &&
            (worst < 0 || light_range_cost(&ranges[i]) > light_range_cost(&ranges[worst])))
            worst = i;
    return worst;
}

static int split_for_node(struct builder *b, const struct light_range *from, int depth,
                          struct light_range out[LIGHT_TREE_CHILDREN]) {
    const uint32_t fits = light_range_unit(from->c.count);
    int n = 1;
    out[0] = *from;
    for (int worst; n < LIGHT_TREE_CHILDREN && (worst = worst_range(out, n, fits)) >= 0; n++) {
        struct light_range two[2];
        light_splitter_split(&b->s, &out[worst], depth, two);
        out[worst] = two[0];
        out[n] = two[1];
    }
    return n;
}

static void reserve(struct builder *b, uint32_t nodes) {
    struct light_tree *t = b->tree;
    mem_grow(&t->nodes, &b->capacity[0], nodes, sizeof *t->nodes);
    mem_grow(&t->parents, &b->capacity[1], nodes, sizeof *t->parents);
}

static void build(struct builder *b, const struct light_range *from, uint32_t index, uint32_t parent,
                  int depth) {
    struct light_tree *t = b->tree;
    struct light_range ranges[LIGHT_TREE_CHILDREN];
    const int n = split_for_node(b, from, depth, ranges);
    struct light_node node = {.first = t->node_count};
    set_lanes(&node, b->s.items, ranges, n);
    for (int i = 0; i < n; i++) {
        const uint32_t slot = LIGHT_TREE_CHILDREN * index + (uint32_t)i;
        node.inner |= (uint16_t)((ranges[i].c.count > 1) << i);
        node.lowest |= (uint16_t)((ranges[i].c.count > 1 && ranges[i].c.count <= LIGHT_TREE_CHILDREN) << i);
        if (ranges[i].c.count == 1)
            t->slots[b->s.items[ranges[i].begin].index] = (struct light_slot){slot, parent, 0};
    }
    t->node_count += (uint32_t)__builtin_popcount(node.inner);
    reserve(b, t->node_count);
    t->nodes[index] = node;
    t->parents[index] = parent;
    uint32_t child = node.first;
    for (int i = 0; i < n; i++)
        if (ranges[i].c.count > 1)
            build(b, &ranges[i], child++, LIGHT_TREE_CHILDREN * index + (uint32_t)i, depth + 1);
}

void light_tree_init(struct light_tree *t, const struct light_bounds *items, uint32_t count) {
    *t = (struct light_tree){.item_count = count, .slots = mem_array(count, sizeof *t->slots)};
    struct builder b = {.tree = t};
    light_splitter_init(&b.s, count);
    float strongest = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++)
        strongest = maxf(strongest, items[i].intensity);
    for (uint32_t i = 0; i < count; i++) {
        t->slots[i].slot = t->slots[i].parent = LIGHT_TREE_NONE;
        if (!(items[i].intensity > 0))
            continue;
        b.s.items[n] = (struct light_item){items[i], i};
        // Sums and quotients stay in range, and nothing that shines gets lost.
        b.s.items[n++].b.intensity = clampf(items[i].intensity / strongest, 1e-12f, 1);
    }
    const struct light_range all = light_splitter_range(&b.s, 0, n);
    if (n > 0) {
        reserve(&b, t->node_count = 1);
        build(&b, &all, 0, LIGHT_TREE_NONE, 0);
    }
    light_splitter_finish(&b.s);
    t->leaves = mem_array((size_t)LIGHT_TREE_CHILDREN * t->node_count, sizeof *t->leaves);
    for (uint32_t i = 0; i < count; i++)
        if (t->slots[i].slot != LIGHT_TREE_NONE)
            t->leaves[t->slots[i].slot].item = i;
}
