// SPDX-License-Identifier: Apache-2.0
// Data of the light loop, for its own files.
#pragma once

#include "integrator/light_loop.h"
#include "integrator/wide_overlap.h"
#include "integrator/wide_quotient.h"

// A triangle, for WIDE_LANES at a time: its nodes, centre (then the tolerance of
// its shares) and parts.
enum { LIGHT_CENTRE = OVERLAP_NODES, LIGHT_PARTS, LIGHT_ROWS };

struct light_rows {
    float row[LIGHT_ROWS][4];
};

struct light_loop_scene {
    struct light_loop_options options;
    struct light_rows *rows;
    struct overlap_triangle *triangles; // of the lights, world space
    vec3 *centres;
    uint32_t *seen, *first; // lights by position: those of p are seen[first[p]] to seen[first[p + 1]]
    uint32_t *coefficients;             // by object
    // Lights that are sampled.
    struct world_light *others;
    uint32_t other_count;
    struct light_choice choice;
};

// A light that a position sees, light_loop_end(s, p) just past the last.
static inline const uint32_t *light_loop_first(const struct light_loop_scene *s, uint32_t position) {
    return s->seen + s->first[position];
}

static inline const uint32_t *light_loop_end(const struct light_loop_scene *s, uint32_t position) {
    return s->seen + s->first[position + 1];
}

// A surface of an object that a position of a pixel shows.
struct visit {
    struct surface surface;
    vec3 wo;         // world space
    spectrum weight; // of the position, times what surfaces before it let through
    uint32_t pixel, object, position;
    vec3 pole;       // normal of the editable closure, world space: it reflects no light from below
    double theta_o;  // of that closure
    uint32_t count;  // lights that reach it
};

// A light that reaches a visit, and what comes through.
struct arrival {
    uint32_t light;
    float through[3];
};

struct light_loop {
    const struct light_loop_scene *scene;
    int x, y;
    struct visit *visits; // in the order of positions
    size_t visit_count, visit_capacity;
    struct arrival *arrivals; // `most` for each visit
    size_t arrival_capacity, most;
    struct wide_overlap **overlaps;    // by object: of its terms
    struct wide_quotient **quotients;
    struct closure_stack stack;
    struct arena arena;
};

// The editable closure at a visit; rows: axes of its frame in world space. *outer: with what is
// around it.
const struct closure *visit_resolve(const struct visit *v, struct closure_stack *stack,
                                    const struct closure **outer, vec3 rows[3]);
