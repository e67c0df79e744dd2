// SPDX-License-Identifier: Apache-2.0
#include "accel/few_blockers.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"

// Of all rays: a facet that blocks fewer costs as much as it saves.
static const float least_share = 0.02f;

enum { MOST_CROSSED = 16 }; // facets that a ray is followed through

struct crossing {
    uint32_t shape, primitive; // the facet's first
    uint32_t ray;
};

struct crossings {
    struct crossing *at;
    uint32_t count;
};

// The first triangle of the facet that one is in: quadrilaterals are triangles 2k and 2k + 1.
static uint32_t first_of_facet(const struct mesh *m, uint32_t triangle) {
    struct few_facet f;
    few_facet_of(m, 0, triangle & ~1u, &f);
    return f.count == 2 ? triangle & ~1u : triangle;
}

// All facets that would block a ray if they were alone.
static void follow(const struct accel *a, const struct scene *s, struct ray ray, uint32_t index,
                   struct crossings *c) {
    struct accel_hit hit;
    for (int k = 0; k < MOST_CROSSED && accel_intersect(a, &ray, &hit); k++) {
        ray.tmin = nextafterf(hit.t, INFINITY);
        const struct shape *shape = &s->shapes[hit.shape];
        if (hit.instance == SCENE_NONE && shape->kind == SHAPE_MESH)
            c->at[c->count++] = (struct crossing){
                hit.shape, first_of_facet(&shape->mesh, hit.primitive), index};
    }
}

static int compare_facets(const struct crossing *a, const struct crossing *b) {
    const int shapes = (a->shape > b->shape) - (a->shape < b->shape);
    return shapes ? shapes : (a->primitive > b->primitive) - (a->primitive < b->primitive);
}

static int compare(const void *a, const void *b) {
    const struct crossing *x = a, *y = b;
    const int facets = compare_facets(x, y);
    return facets ? facets : (x->ray > y->ray) - (x->ray < y->ray);
}

// The end of those of one facet.
static uint32_t end_of(const struct crossings *c, uint32_t first) {
    uint32_t end = first;
    while (end < c->count && compare_facets(&c->at[end], &c->at[first]) == 0)
        end++;
    return end;
}

// Where those of the facet begin that blocks most of the rays that are left; how many.
static uint32_t find_best(const struct crossings *c, const bool *blocked, uint32_t *best) {
    uint32_t most = 0;
    for (uint32_t first = 0, end; first < c->count; first = end) {
        uint32_t found = 0;
        end = end_of(c, first);
        for (uint32_t k = first; k < end; k++)
            found += !blocked[c->at[k].ray] && (k == first || c->at[k].ray != c->at[k - 1].ray);
        if (found > most) {
            most = found;
            *best = first;
        }
    }
    return most;
}

uint32_t few_blockers_of(const struct accel *a, const struct scene *scene, const struct ray *rays,
                         uint32_t count, struct few_facet blockers[FEW_BLOCKERS]) {
    struct crossings c = {mem_array((size_t)count * MOST_CROSSED, sizeof *c.at), 0};
    bool *blocked = mem_array(count, sizeof *blocked);
    uint32_t chosen = 0, best = 0;
    for (uint32_t i = 0; i < count; i++)
        follow(a, scene, rays[i], i, &c);
    qsort(c.at, c.count, sizeof *c.at, compare);
    while (chosen < FEW_BLOCKERS &&
           (float)find_best(&c, blocked, &best) > least_share * (float)count) {
        const struct crossing *first = &c.at[best];
        few_facet_of(&scene->shapes[first->shape].mesh, first->shape, first->primitive,
                     &blockers[chosen++]);
        for (uint32_t k = best; k < end_of(&c, best); k++)
            blocked[c.at[k].ray] = true;
    }
    mem_free(blocked);
    mem_free(c.at);
    return chosen;
}
