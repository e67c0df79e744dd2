// SPDX-License-Identifier: Apache-2.0
// Sinks: where integrators hand what they find.
//
// An integrator does not return a colour. It hands out contributions, each with the light it came
// from, and the sink decides what becomes of them: the film multiplies by emission now; a tensor
// bins by source or material and leaves that for later.
//
// Groups of sixteen samples (lanes) of different pixels run side by side, SINK_MOST_LANES lanes at
// most; contributions of one lane arrive between its begin and its end, in an order that depends on
// that lane's path alone. Every worker has a sink of its own, a view of what is being summed, and
// works on one tile of the absolute pixel grid at a time.
#pragma once

#include <stdint.h>

#include "bsdf/bsdf.h"
#include "math/vec.h"
#include "sink/chain.h"

enum { SINK_LANES = 16, SINK_MOST_LANES = 256, SINK_TILE = 32 };

struct contribution {
    spectrum weight;   // of the path: scattering, cosines, 1/pdf, MIS, roulette; no emission
    spectrum emission; // radiance of the source along the path (light.h for delta lights)
    uint32_t source;   // index of the light; from the number of lights on: of the medium that glows
    uint32_t depth;    // scattering events between sensor and source; 0: seen directly
    uint32_t lobe;     // enum lobe of the first scattering event; 0 at depth 0
    bool sampled;      // the light was, and not found by the path as it went on
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

// Pixels x0 <= x < x1, y0 <= y < y1 of the absolute grid.
struct sink_area {
    int x0, y0, x1, y1;
};

struct sink_type {
    // Goes to a tile; says which of its pixels are wanted.
    void (*open)(struct sink *s, uint32_t tile, struct sink_area *wanted);
    // Stores what the tile has gathered since open; without it that is forgotten.
    void (*close)(struct sink *s);
    // Ties a lane to a pixel. One that is not wanted is traced for its packet's sake and dropped.
    void (*place)(struct sink *s, int lane, int x, int y, uint32_t sample);
    void (*begin)(struct sink *s, int lane);
    void (*add)(struct sink *s, int lane, const struct contribution *c);
    void (*surface)(struct sink *s, int lane, const struct sink_surface *first);
    void (*covered)(struct sink *s, int lane); // the sensor's ray hit something
    void (*end)(struct sink *s, int lane, float filter_weight);
    void (*destroy)(struct sink *s);
};

struct sink {
    const struct sink_type *type;
    bool wants_surface; // whether anybody looks at `surface`; it is not called otherwise
    struct chain *chains; // of the lanes, for a response to editable materials; NULL: none is asked
    bool sums; // what arrives is added up now: light samples may be chosen by what they bring
};

static inline void sink_add(struct sink *s, int lane, const struct contribution *c) {
    s->type->add(s, lane, c);
}
