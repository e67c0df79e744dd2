// SPDX-License-Identifier: Apache-2.0
// Materials: how a surface scatters light.
//
// A material in the scene is a struct object of a struct bsdf_type. At a hit it is *resolved*: its
// textures are looked up once for that point and that viewing direction, and what is left is a
// small closure on a stack, which is evaluated and sampled as often as needed. Wrappers (twosided,
// mask, ...) return their child's closure itself where they can.
//
// Conventions: local shading frame with n = +z; wi towards the light, wo towards the eye, both
// unit and pointing away from the surface. Radiance travels from light to eye, so refraction scales
// it by (eta_o/eta_i)^2 of the two sides (eta_o: side of wo). Densities are per solid angle of wi.
// eval returns f(wo, wi) |cos theta_i|; it is 0 for directions that only a delta lobe reaches.
// All results are finite and non-negative for any unit directions and any parameters in range.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/frame.h"
#include "math/vec.h"
#include "texture/texture.h"

enum lobe {
    LOBE_DIFFUSE = 1,       // nearly constant in wi
    LOBE_GLOSSY = 2,        // rough specular
    LOBE_SPECULAR = 4,      // delta
    LOBE_NULL = 8,          // delta, straight through: the surface is not there
    LOBE_REFLECTION = 16,
    LOBE_TRANSMISSION = 32,
    LOBE_ANISOTROPIC = 64,  // it matters how the shading frame is turned about its normal
};

#define LOBE_DELTA (LOBE_SPECULAR | LOBE_NULL)
#define LOBE_SMOOTH (LOBE_DIFFUSE | LOBE_GLOSSY)

// Where a material is resolved.
struct bsdf_point {
    struct texture_point at;
    struct frame frame;  // shading frame in world space
    vec3 dpdu, dpdv;     // world space; zero where the surface has no parametrisation
    struct wavelengths wavelengths;
};

struct closure {
    const struct bsdf_type *type;
    uint32_t lobes; // union of the lobes that may be non-zero here
    // the type's own data follows
};

// Memory for the closures of one hit; reset `used` to 0 before each resolve.
struct closure_stack {
    size_t used;
    _Alignas(16) unsigned char bytes[6144 - 16];
};

struct bsdf_sample {
    vec3 wi;
    spectrum weight; // f |cos| / pdf
    float pdf_sa;    // of this wi over all non-delta lobes; for a delta lobe its probability
    float eta;       // eta of the side of wi over eta of the side of wo; 1 for reflection
    uint32_t lobe;   // the one lobe that was sampled
};

enum bsdf_claim {
    CLAIM_RECIPROCAL = 1,   // f(wo,wi) = f(wi,wo), refraction's radiance scaling divided out
    CLAIM_ENERGY = 2,       // directional albedo at most 1 for every parameter in range
    CLAIM_LOSSLESS = 4,     // directional albedo exactly 1 with default colours (smooth dielectric)
};

// A material that can be shaded many points at once (bsdf/bsdf_wide.h), and by whom.
struct wide_material {
    const struct wide_bsdf *kind;
    const void *data; // for the kind
    bool two_sided;   // the same on the other side, mirrored
    bool textured;    // it depends on the place
};

struct bsdf_type {
    struct entry entry;
    uint32_t claims; // enum bsdf_claim
    // Checks the parameters and builds tables, once per object, children first; tables come from
    // the arena. false after an error message. NULL: nothing to do.
    bool (*prepare)(struct object *self, struct arena *arena);
    // Union of all lobes that may ever be non-zero (LOBE_NULL tells the world that shadow rays may
    // pass). Called after prepare.
    uint32_t (*lobes)(const void *data);
    // The material at a point, seen from wo. NULL: absorbs everything (black), nothing to sample.
    const struct closure *(*resolve)(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack);
    // Whether it can be shaded many points at once; m comes zeroed. NULL: no.
    bool (*widen)(const void *data, struct wide_material *m);
    // f |cos theta_i| of the non-delta lobes; *pdf_sa is sample's density of this wi.
    spectrum (*eval)(const struct closure *closure, vec3 wi, float *pdf_sa);
    // u1 chooses the lobe, u2 the direction, all in [0,1). false: nothing was scattered.
    bool (*sample)(const struct closure *closure, float u1, struct vec2 u2, struct bsdf_sample *s);
    // Directional albedo towards wo: exact where cheap, else a good approximation, for the albedo
    // layer and sampling decisions; never for the picture.
    spectrum (*albedo)(const struct closure *closure);
    // Of a closure around one other: that one, with wi brought into its frame, and times what the
    // outer one leaves of it. NULL: it has none, or it is black. NULL function: never.
    const struct closure *(*inside)(const struct closure *closure, vec3 *wi, float *factor);
    // Straight-through transmittance of the LOBE_NULL part for a ray along wo; NULL: zero.
    spectrum (*null_transmittance)(const void *data, const struct bsdf_point *point, vec3 wo);
};

#define X(name) extern const struct bsdf_type bsdf_##name;
#include "bsdf/list.h"
#undef X

extern const struct registry bsdfs;

// A white Lambertian surface: the radiance that it returns, times pi, is the irradiance on it.
extern const struct object bsdf_white;

static inline const struct bsdf_type *bsdf_type_of(const struct object *o) {
    return (const struct bsdf_type *)o->type;
}

// Takes (uninitialised) room for a closure of `size` bytes and fills its head. Nesting that
// exceeds the stack is refused when the scene is built, so this cannot fail.
void *closure_alloc(struct closure_stack *stack, const struct bsdf_type *type, size_t size,
                    uint32_t lobes);

static inline const struct closure *bsdf_resolve(const struct object *o,
                                                 const struct bsdf_point *point, vec3 wo,
                                                 struct closure_stack *stack) {
    return bsdf_type_of(o)->resolve(o->data, point, wo, stack);
}

static inline bool bsdf_wide(const struct object *o, struct wide_material *m) {
    const struct bsdf_type *type = bsdf_type_of(o);
    *m = (struct wide_material){0};
    return type->widen && type->widen(o->data, m);
}

static inline uint32_t bsdf_lobes(const struct object *o) {
    return bsdf_type_of(o)->lobes(o->data);
}

static inline spectrum bsdf_null_transmittance(const struct object *o,
                                               const struct bsdf_point *point, vec3 wo) {
    const struct bsdf_type *type = bsdf_type_of(o);
    return type->null_transmittance ? type->null_transmittance(o->data, point, wo)
                                    : spectrum_grey(0);
}

// Refuses nesting that a closure_stack cannot hold; every material with children asks in prepare.
// false after an error message.
bool bsdf_check_nesting(const struct object *o);

static inline spectrum closure_eval(const struct closure *c, vec3 wi, float *pdf_sa) {
    return c->type->eval(c, wi, pdf_sa);
}

// The eval of materials that are delta functions: 0 everywhere.
spectrum closure_eval_delta(const struct closure *c, vec3 wi, float *pdf_sa);

static inline bool closure_sample(const struct closure *c, float u1, struct vec2 u2,
                                  struct bsdf_sample *s) {
    return c->type->sample(c, u1, u2, s);
}

static inline spectrum closure_albedo(const struct closure *c) {
    return c->type->albedo(c);
}
