// SPDX-License-Identifier: Apache-2.0
// Participating media: what fills the space between surfaces.
//
// Conventions: coefficients per metre of the world, finite and non-negative; sigma_t = sigma_a +
// sigma_s. Emission is the radiance gained per metre, sigma_a times the radiance of the source that
// the file names (a black body fills up to exactly that radiance).
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/vec.h"
#include "volume/volume.h"

// A medium at a point.
struct medium_point {
    spectrum sigma_s, sigma_t, emission;
};

// A medium made ready for tracing.
struct medium {
    const struct medium_type *type;
    const void *data;
    const struct object *phase;
    bool homogeneous;     // `constant` holds everywhere
    bool scatters, emits; // anywhere
    bool grey;            // every lane has the same extinction
    bool plain;           // homogeneous, grey, scattering and dark: every collision scatters
    bool sample_emitters; // next event estimation from points inside
    struct medium_point constant;
    float scale;          // of bounds
    const struct volume_bounds *bounds; // of sigma_t / scale; NULL: most_t bounds it everywhere
    spectrum most_t;      // no sigma_t is larger
};

struct medium_type {
    struct entry entry;
    // Checks the parameters and fills m (type and data are set); volumes are prepared already.
    // false after an error message.
    bool (*prepare)(struct object *self, struct arena *arena, struct medium *m);
    void (*at)(const void *data, vec3 p, struct medium_point *point); // NULL: homogeneous
    // The volume whose voxels part the extinction along a ray; NULL: homogeneous.
    const struct volume_ref *(*density)(const void *data);
};

#define X(name) extern const struct medium_type medium_##name;
#include "medium/list.h"
#undef X

extern const struct registry media;

static inline const struct medium_type *medium_type_of(const struct object *o) {
    return (const struct medium_type *)o->type;
}

bool medium_prepare(struct object *self, struct arena *arena, struct medium *m);

static inline void medium_at(const struct medium *m, vec3 p, struct medium_point *point) {
    if (m->homogeneous)
        *point = m->constant;
    else
        m->type->at(m->data, p, point);
}

// ---- for the media themselves -----------------------------------------------------------------

struct medium_common {
    const struct object *phase;
    bool sample_emitters;
    float scale;
    struct volume_ref emission;
};

#define MEDIUM_PARAMS(type, field)                                                                 \
    {"phase", PARAM_PHASE, offsetof(type, field.phase), .optional = true,                          \
     .help = "how it scatters; absent: isotropic"},                                                \
        {"sample_emitters", PARAM_BOOL, offsetof(type, field.sample_emitters), .def = "true",      \
         .help = "next event estimation inside; of no use behind refracting boundaries"},          \
        {"scale", PARAM_FLOAT, offsetof(type, field.scale), .def = "1", .min = 0, .max = 1e30,     \
         .unit = "", .help = "factor on the coefficients"},                                        \
        {"emission", PARAM_VOLUME, offsetof(type, field.emission), .def = "0", .min = 0,           \
         .max = 1e30, .unit = "W/(sr m^2)", .help = "radiance of what glows; absorption emits it"}

// What all media have in common. mean_cosine: of the phase function where none is named.
void medium_init(struct medium *m, const struct medium_common *common, float mean_cosine,
                 struct arena *arena);
