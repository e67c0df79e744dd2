// SPDX-License-Identifier: Apache-2.0
// The light loop (Ben-Artzi 2007, Code 1): how pixels depend on the curves of editable materials
// under direct light. Works on blocks of 4x4 pixels: see what the camera sees, send shadow rays,
// then add up.
//
//     T[j] += rho_q cos_i * light of triangle m * Delta(m, j)   for every triangle m that is not hidden
//
// Visibility, quotient and cosine are those of the triangle's centre, the share Delta is that of all
// of it. A pixel is looked at in several positions, as the picture's filter places them; each light is
// seen from one of them, so that smooth edges cost no more rays. Lights that have a
// place, or come from one direction, are sampled, in two halves.
//
// f_q and curves are not in the sums; textures, coverage and the filter's weights are.
#pragma once

#include "bsdf/editable.h"
#include "curve/overlap.h"
#include "filter/filter.h"
#include "light/light_triangles.h"
#include "sampler/sampler.h"
#include "sensor/sensor.h"
#include "world/world.h"

enum { LIGHT_LOOP_SIDE = 4, LIGHT_LOOP_PIXELS = 16, LIGHT_LOOP_SPARE = 48 };

enum light_packets {
    PACKETS_OF_PIXELS, // 16 points of the block towards one light
    PACKETS_OF_LIGHTS, // one point towards 16 neighbouring lights
};

struct light_loop_object {
    const void *owner; // of closures (editable_owner)
    const struct form *form;
};

struct light_loop_options {
    const struct world *world;
    const struct object *sensor;
    const struct filter_sampler *filter;
    const struct sampler_type *sampler;
    uint32_t seed, positions;
    const struct light_triangles *lights;
    bool refines; // the lights are what a list has more than another: only they are summed
    bool unshadowed; // nothing hides the triangles, for comparison
    bool as_points; // triangles count as points at their centres, for comparison
    double tolerance; // of shares (curve/overlap.h); 0: 2.2e-6 by its solid angle ^ 1.5, 1e-4 to 1e-2
    uint32_t light_samples; // of the other lights at each position: even
    const struct light_loop_object *objects;
    uint32_t object_count;
    enum light_packets packets;
};

// The position that sees a light: neighbours in the sky are seen from different ones, and the same
// triangle of another list from the same.
static inline uint32_t light_loop_position(const struct light_triangle *l, uint32_t positions) {
    return (uint32_t)(l->number % positions);
}

// What workers share.
struct light_loop_scene;

struct light_loop_scene *light_loop_scene_create(const struct light_loop_options *options);
void light_loop_scene_destroy(struct light_loop_scene *s);
// Whether there are lights that are sampled.
bool light_loop_has_noise(const struct light_loop_scene *s);
void light_loop_set_packets(struct light_loop_scene *s, enum light_packets packets);
// Coefficients of all terms of an object, one after the other.
uint32_t light_loop_coefficients(const struct light_loop_scene *s, uint32_t object);

// What one worker needs.
struct light_loop;

struct light_loop *light_loop_create(const struct light_loop_scene *s);
void light_loop_destroy(struct light_loop *l);

// The block whose first pixel is (x, y), multiples of 4.
void light_loop_see(struct light_loop *l, int x, int y);
// Whether a pixel of the block (y * 4 + x) shows an object.
bool light_loop_shows(const struct light_loop *l, uint32_t pixel, uint32_t object);
// Shadow rays of all that was seen; their number.
uint64_t light_loop_shadow(struct light_loop *l);
// Mean of theta_o where a pixel shows an object, for f_o.
float light_loop_view(const struct light_loop *l, uint32_t pixel, uint32_t object);
// What a pixel gets from an object: sums[coefficient][3], and of the noise (a - b) / 2 where there
// is some (halves may be NULL). sums has LIGHT_LOOP_SPARE numbers more.
void light_loop_sum(struct light_loop *l, uint32_t pixel, uint32_t object, double *sums,
                    double *halves);
