// SPDX-License-Identifier: Apache-2.0
// A material in a shading frame that a texture tilts: what bumpmap and normalmap share.
#pragma once

#include "bsdf/bsdf.h"

struct perturbation {
    bool flip_invalid_normals;
    bool use_shadowing_function;
};

#define PERTURBATION_PARAMS(type, m)                                                               \
    {"flip_invalid_normals", PARAM_BOOL, offsetof(type, m.flip_invalid_normals), .def = "true",    \
     .unit = "", .help = "turn normals that face away to the viewer (Schuessler et al. 2017)"},    \
    {"use_shadowing_function", PARAM_BOOL, offsetof(type, m.use_shadowing_function),               \
     .def = "true", .unit = "", .help = "soften the terminator (Conty Estevez et al. 2019)"}

// Resolves child in the frame with normal n (local, any length above 0; else it is (0, 0, 1)).
const struct closure *perturbed_resolve(const struct perturbation *p, const struct object *child,
                                        vec3 n, const struct bsdf_point *point, vec3 wo,
                                        struct closure_stack *stack);
spectrum perturbed_null_transmittance(const struct perturbation *p, const struct object *child,
                                      vec3 n, const struct bsdf_point *point, vec3 wo);

spectrum perturbed_eval(const struct closure *closure, vec3 wi, float *pdf_sa);
bool perturbed_sample(const struct closure *closure, float u1, struct vec2 u2,
                      struct bsdf_sample *s);
const struct closure *perturbed_inside(const struct closure *closure, vec3 *wi, float *factor);
spectrum perturbed_albedo(const struct closure *closure);
