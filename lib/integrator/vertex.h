// SPDX-License-Identifier: Apache-2.0
// What the integrators share at a path's vertices: emission that is found, light that is sampled.
#pragma once

#include "integrator/integrator.h"

// Veach and Guibas 1995, power heuristic with exponent 2, safe for any finite densities.
static inline float mis_weight(float pdf, float other) {
    if (!(pdf > 0))
        return 0;
    const float r = other / pdf;
    return r < 1e15f ? 1 / (1 + r * r) : 0;
}

// Russian roulette (Arvo and Kirk 1990): the chance of going on, at most `most`. A path that carries
// more than half stays: from the third edge on, that takes a tenth fewer rays than chances equal to
// the throughput from the fifth on, at the same variance.
static inline float roulette_chance(spectrum beta, float eta2, float most) {
    return minf(2 * spectrum_max(beta) * eta2, most);
}

// Where a path came from when it finds light: the last vertex that scattered, and how.
struct path_origin {
    vec3 p;           // that vertex (or the sensor)
    float pdf_sa;     // of the direction taken there; unused when delta
    bool delta;       // no light sampling could have found this light
    uint32_t depth;   // scattering events so far
    uint32_t lobe;    // of the first event
    vec3 n;           // as vertex_light_side gave it for the light sampling there
    uint32_t receiver; // 1 + the shape that scattered there; 0: none, which all lights light
};

// The normal by which lights are chosen at a vertex, turned to the side of wo (local); zero where
// light passes through, or where there is no surface: lights on all sides are then alike.
static inline vec3 vertex_light_side(const struct surface *s, const struct closure *closure,
                                     vec3 wo) {
    if (closure->lobes & LOBE_TRANSMISSION)
        return v3(0, 0, 0);
    return cos_theta(wo) < 0 ? -s->point.frame.n : s->point.frame.n;
}

// Hands out the emission of the surface that was hit, if it is a light's.
void vertex_add_emission(struct trace_context *ctx, int lane, const struct surface *s, vec3 d,
                         spectrum beta, const struct path_origin *from);
// Hands out the infinite lights, for a ray that left the scene along unit d.
void vertex_add_infinite(struct trace_context *ctx, int lane, vec3 d, spectrum beta,
                         const struct path_origin *from);

// A light sample waiting for its shadow ray.
struct shadow_test {
    struct ray ray;
    struct contribution contribution;
    int most_passes; // straight through surfaces, each an edge of the path; negative: no limit
    bool pending;
    bool late;       // the emission is still to be asked for; till then it is taken to follow the density
};

// The luminance that it brings if nothing is in the way.
static inline float shadow_test_value(const struct shadow_test *t) {
    return spectrum_luminance(t->contribution.weight * t->contribution.emission);
}

// Samples one light from a surface: fills the test, or leaves it not pending. `rivals` is how many
// material samples there are for each light sample, for MIS; 0: none, and for delta lights. `side`
// as vertex_light_side gives it. u1 is needed only where world->choice.draws.
void vertex_sample_light(struct trace_context *ctx, const struct surface *s,
                         const struct closure *closure, vec3 side, float u1, struct vec2 u2,
                         float rivals, struct shadow_test *test);

// Its second step, for a sample of a light that is given; the test is not pending.
void vertex_test_light(struct trace_context *ctx, const struct surface *s,
                       const struct closure *closure, uint32_t light, const struct light_sample *l,
                       float rivals, struct shadow_test *test);

// Hands out the light of a test whose ray has met nothing.
void vertex_add_light(struct trace_context *ctx, int lane, struct shadow_test *test);
// Runs the shadow ray of a pending test and hands out what comes through.
void vertex_finish_light(struct trace_context *ctx, int lane, struct shadow_test *test);

// Fills and hands out the sink's first-hit record, when wanted.
void vertex_add_first(struct trace_context *ctx, int lane, const struct surface *s,
                      const struct closure *closure);
