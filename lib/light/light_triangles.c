// SPDX-License-Identifier: Apache-2.0
// The radiance is integrated once over all triangles of a fixed level and summed up the tree. Below
// that level a triangle's integral is dealt to its children as they are split.
#include "light/light_triangles.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/thread.h"

enum { ROOTS = 8, BASE_LEVEL = 8, DEEPEST = 24, SHARE_DEPTH = 3, CAREFUL_DEPTH = 5 };

static const double LARGEST = 0.01;   // sr: larger cells are not more urgent
static const double MATTERS = 1e-4;   // share of all light from which a cell is measured with care
static const double FACE = M_PI / 2;  // radians: edge of a root

struct cell {
    struct direction corner[3];
};

struct sum {
    double rgb[3];
};

static struct direction middle(struct direction a, struct direction b) {
    return direction_of(a.x + b.x, a.y + b.y, a.z + b.z);
}

// Van Oosterom and Strackee 1983.
double solid_angle_within(const struct direction c[3]) {
    const double det = c[0].x * (c[1].y * c[2].z - c[1].z * c[2].y) +
                       c[0].y * (c[1].z * c[2].x - c[1].x * c[2].z) +
                       c[0].z * (c[1].x * c[2].y - c[1].y * c[2].x);
    return 2 * atan2(fabs(det), 1 + direction_dot(c[0], c[1]) + direction_dot(c[1], c[2]) +
                                    direction_dot(c[2], c[0]));
}

static struct cell child_of(const struct cell *c, int i) {
    const struct direction m[3] = {middle(c->corner[0], c->corner[1]),
                                   middle(c->corner[1], c->corner[2]),
                                   middle(c->corner[2], c->corner[0])};
    if (i == 3)
        return (struct cell){{m[0], m[1], m[2]}};
    return (struct cell){{c->corner[i], m[i], m[(i + 2) % 3]}};
}

static struct cell root_of(int i) {
    const double x = i & 1 ? -1 : 1, y = i & 2 ? -1 : 1, z = i & 4 ? -1 : 1;
    return (struct cell){{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
}

static struct direction centre_of(const struct cell *c) {
    const struct direction *k = c->corner;
    return direction_of(k[0].x + k[1].x + k[2].x, k[0].y + k[1].y + k[2].y,
                        k[0].z + k[1].z + k[2].z);
}

// ---- integration ------------------------------------------------------------------------------

static void integrate(const struct sky *sky, const struct cell *c, int depth, struct sum *s) {
    if (depth > 0) {
        for (int i = 0; i < 4; i++) {
            const struct cell child = child_of(c, i);
            integrate(sky, &child, depth - 1, s);
        }
        return;
    }
    const spectrum radiance = sky->radiance(sky->ctx, direction_round(centre_of(c)));
    const double omega = solid_angle_within(c->corner);
    for (int k = 0; k < 3; k++)
        s->rgb[k] += omega * (double)radiance[k];
}

// Subdivisions of a cell of a level after which points are half the details apart.
static int depth_for(const struct sky *sky, int level) {
    int depth = 0;
    while (sky->detail > 0 && depth < 4 && FACE / (1 << (level + depth)) > sky->detail / 2)
        depth++;
    return depth;
}

struct measure {
    const struct sky *sky;
    struct sum *cells; // of the base level
    int depth;
    double careful; // sum of channels from which a cell is measured again; 0: none
};

// Item: a cell of level 4.
static void measure_part(void *ctx, size_t item, int worker) {
    enum { BELOW = BASE_LEVEL - 4, CELLS = 1 << 2 * BELOW };
    const struct measure *m = ctx;
    struct cell part = root_of((int)(item >> 8));
    (void)worker;
    for (int i = 3; i >= 0; i--)
        part = child_of(&part, item >> 2 * i & 3);
    for (size_t k = 0; k < CELLS; k++) {
        struct sum *s = &m->cells[item * CELLS + k];
        struct cell c = part;
        if (m->careful > 0 && !(s->rgb[0] + s->rgb[1] + s->rgb[2] > m->careful))
            continue;
        for (int i = BELOW - 1; i >= 0; i--)
            c = child_of(&c, k >> 2 * i & 3);
        *s = (struct sum){{0}};
        integrate(m->sky, &c, m->careful > 0 ? CAREFUL_DEPTH : m->depth, s);
    }
}

// ---- tree ---------------------------------------------------------------------------------------

struct node {
    struct cell cell;
    struct sum sum;
    double urgency;
    size_t index; // among the nodes of its level
    int level;
    uint64_t path; // from the root, for the order of the list
};

struct tree {
    const struct sky *sky;
    struct sum *levels[BASE_LEVEL + 1];
    struct node *heap; // greatest urgency first
    uint32_t count;
};

static void sum_levels(struct tree *t, int threads) {
    const size_t cells = (size_t)ROOTS << 2 * BASE_LEVEL;
    struct measure m = {t->sky, NULL, depth_for(t->sky, BASE_LEVEL), 0};
    for (int l = 0; l <= BASE_LEVEL; l++)
        t->levels[l] = mem_array((size_t)ROOTS << 2 * l, sizeof **t->levels);
    m.cells = t->levels[BASE_LEVEL];
    thread_for(threads, ROOTS << 8, measure_part, &m);
    double total = 0;
    for (size_t i = 0; i < cells; i++)
        total += m.cells[i].rgb[0] + m.cells[i].rgb[1] + m.cells[i].rgb[2];
    m.careful = MATTERS * total;
    if (m.careful > 0)
        thread_for(threads, ROOTS << 8, measure_part, &m);
    for (int l = BASE_LEVEL; l > 0; l--)
        for (size_t i = 0; i < (size_t)ROOTS << 2 * l; i++)
            for (int k = 0; k < 3; k++)
                t->levels[l - 1][i / 4].rgb[k] += t->levels[l][i].rgb[k];
}

static void push(struct tree *t, struct node n) {
    const double omega = solid_angle_within(n.cell.corner);
    n.urgency = n.level < DEEPEST ? (n.sum.rgb[0] + n.sum.rgb[1] + n.sum.rgb[2]) *
                                        sqrt(sqrt(fmin(omega, LARGEST))) : 0;
    uint32_t i = t->count++;
    while (i > 0 && t->heap[(i - 1) / 2].urgency < n.urgency) {
        t->heap[i] = t->heap[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    t->heap[i] = n;
}

static struct node pop(struct tree *t) {
    const struct node top = t->heap[0], last = t->heap[--t->count];
    uint32_t i = 0;
    for (;;) {
        uint32_t child = 2 * i + 1;
        if (child + 1 < t->count && t->heap[child + 1].urgency > t->heap[child].urgency)
            child++;
        if (child >= t->count || t->heap[child].urgency <= last.urgency)
            break;
        t->heap[i] = t->heap[child];
        i = child;
    }
    t->heap[i] = last;
    return top;
}

// Below the base level: the parent's integral in the proportions measured in the children.
static void deal(const struct sky *sky, const struct node *parent, struct node child[4]) {
    double all[3] = {0};
    for (int i = 0; i < 4; i++) {
        integrate(sky, &child[i].cell, SHARE_DEPTH, &child[i].sum);
        for (int k = 0; k < 3; k++)
            all[k] += child[i].sum.rgb[k];
    }
    const double omega = solid_angle_within(parent->cell.corner);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            child[i].sum.rgb[k] = parent->sum.rgb[k] *
                                  (all[k] > 0 ? child[i].sum.rgb[k] / all[k]
                                              : solid_angle_within(child[i].cell.corner) / omega);
}

static void split(struct tree *t, const struct node *parent) {
    struct node child[4];
    for (int i = 0; i < 4; i++) {
        child[i] = (struct node){
            .cell = child_of(&parent->cell, i), .index = 4 * parent->index + (size_t)i,
            .level = parent->level + 1,
            .path = parent->path | (uint64_t)i << 2 * (DEEPEST - 1 - parent->level)};
        if (parent->level < BASE_LEVEL)
            child[i].sum = t->levels[child[i].level][child[i].index];
    }
    if (parent->level >= BASE_LEVEL)
        deal(t->sky, parent, child);
    for (int i = 0; i < 4; i++)
        push(t, child[i]);
}

// ---- list ---------------------------------------------------------------------------------------

static int by_path(const void *a, const void *b) {
    const uint64_t x = ((const struct node *)a)->path, y = ((const struct node *)b)->path;
    return (x > y) - (x < y);
}

static void list_nodes(struct tree *t, struct light_triangles *out) {
    qsort(t->heap, t->count, sizeof *t->heap, by_path);
    out->items = mem_array(t->count, sizeof *out->items);
    for (uint32_t i = 0; i < t->count; i++) {
        const struct node *n = &t->heap[i];
        const struct direction *c = n->cell.corner;
        if (!(n->sum.rgb[0] + n->sum.rgb[1] + n->sum.rgb[2] > 0))
            continue;
        struct light_triangle *l = &out->items[out->count++];
        *l = (struct light_triangle){
            .corner = {c[0], c[1], c[2]}, .centre = centre_of(&n->cell),
            .solid_angle = solid_angle_within(c), .level = n->level, .number = n->index};
        for (int k = 0; k < 3; k++) {
            l->power[k] = n->sum.rgb[k];
            out->power[k] += n->sum.rgb[k];
        }
    }
}

void light_triangles_init(struct light_triangles *out, const struct sky *sky, uint32_t most,
                          int threads) {
    struct tree t = {.sky = sky};
    *out = (struct light_triangles){.count = 0};
    sum_levels(&t, threads);
    t.heap = mem_array(most + 4, sizeof *t.heap);
    for (int i = 0; i < ROOTS; i++)
        push(&t, (struct node){.cell = root_of(i), .sum = t.levels[0][i], .index = (size_t)i,
                               .path = (uint64_t)i << 2 * DEEPEST});
    while (t.count + 3 <= most && t.heap[0].urgency > 0) {
        const struct node n = pop(&t);
        split(&t, &n);
    }
    list_nodes(&t, out);
    mem_free(t.heap);
    for (int l = 0; l <= BASE_LEVEL; l++)
        mem_free(t.levels[l]);
}

// ---- refinement -------------------------------------------------------------------------------

static uint64_t path_of(const struct light_triangle *t) {
    return t->number << 2 * (DEEPEST - t->level);
}

static void keep(struct light_triangles *out, const struct light_triangle *t, double sign) {
    struct light_triangle *l = &out->items[out->count++];
    *l = *t;
    for (int k = 0; k < 3; k++) {
        l->power[k] *= sign;
        out->power[k] += l->power[k];
    }
}

void light_triangles_refine(struct light_triangles *t, const struct light_triangles *coarse) {
    struct light_triangles out = {.items = mem_array(t->count + coarse->count, sizeof *t->items)};
    uint32_t i = 0, k = 0;
    while (i < t->count || k < coarse->count) {
        const struct light_triangle *a = &t->items[i], *b = &coarse->items[k];
        if (i < t->count && k < coarse->count && a->number == b->number && a->level == b->level)
            i++, k++;
        else if (k == coarse->count || (i < t->count && path_of(a) < path_of(b)))
            keep(&out, &t->items[i++], 1);
        else
            keep(&out, &coarse->items[k++], -1);
    }
    light_triangles_finish(t);
    *t = out;
}

void light_triangles_finish(struct light_triangles *t) {
    mem_free(t->items);
    *t = (struct light_triangles){.count = 0};
}
