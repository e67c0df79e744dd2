// SPDX-License-Identifier: Apache-2.0
// Sinks: where integrators hand what they find.
//
// An integrator does not return a colour. It hands out contributions, each with the light it came
// from, and the sink decides what becomes of them: the film multiplies by emission now; a tensor
// bins by source or material and leaves that for later.
//
// Groups of sixteen samples (lanes) of different pixels run side by side, SINK_MOST_LANES lanes at
// most; contributions of one lane arrive
// between its begin and its end, in an order that depends on that lane's path alone.
#pragma once

#include <stdint.h>

#include "bsdf/bsdf.h"
#include "math/vec.h"

enum { SINK_LANES = 16, SINK_MOST_LANES = 256 };

struct contribution {
    spectrum weight;   // of the path: scattering, cosines, 1/pdf, MIS, roulette; no emission
    spectrum emission; // radiance of the source along the path (light.h for delta lights)
    uint32_t source;   // index of the light; from the number of lights on: of the medium that glows
    uint32_t depth;    // scattering events between sensor and source; 0: seen directly
    uint32_t lobe;     // enum lobe of the first scattering event; 0 at depth 0
    vec3 wi;           // direction from the last vertex towards the source
};

// What the sensor sees first, for the layers a compositor wants.
struct sink_surface {
    vec3 p, n, ng; // world space
    float z;       // distance along the sensor's ray
    struct vec2 uv;
    uint32_t shape, instance; // 1-based; instance 0: none
    spectrum albedo;
};

struct sink;

struct sink_type {
    void (*begin)(struct sink *s, int lane);
    void (*add)(struct sink *s, int lane, const struct contribution *c);
    void (*surface)(struct sink *s, int lane, const struct sink_surface *first);
    void (*covered)(struct sink *s, int lane); // the sensor's ray hit something
    void (*end)(struct sink *s, int lane, float filter_weight);
};

struct sink {
    const struct sink_type *type;
    bool wants_surface; // whether anybody looks at `surface`; it is not called otherwise
};

static inline void sink_add(struct sink *s, int lane, const struct contribution *c) {
    s->type->add(s, lane, c);
}
