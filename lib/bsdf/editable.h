// SPDX-License-Identifier: Apache-2.0
// The editable material as a precomputation sees it: terms, curves over bases, and where in them a
// pair of directions lies.
//
//     f cos_i = sum over terms of factor * product over slots of curve(gamma)
//
// The material's own evaluation is that sum, so that a tensor which bins by `place` and a picture
// are sums over the same numbers.
#pragma once

#include "bsdf/bsdf.h"
#include "curve/model.h"
#include "math/direction.h"

// The functions of a curve's basis that are not zero at its gamma.
struct curve_place {
    uint32_t count; // 0: there is no curve, or gamma is beyond it, where it is 0
    uint32_t index[2];
    double value[2];
};

struct editable_value {
    spectrum factor; // f_q times textures times rho_q cos_i: all but the curves
    struct curve_place place[SLOTS];
};

// NULL: the material is of another type. All curves of the form are tables.
const struct form *editable_form(const struct object *material);
// The model its curves were generated from, and the numbers that went into them.
const char *editable_model(const struct object *material, struct model_parameters *p);
// Puts the curves and scales of an edited form in place of a prepared material's own, whose terms it
// must have; to be called before rendering. false after an error message that names `at`.
bool editable_set_form(struct object *material, const struct form *edited, struct arena *arena,
                       const char *at);
// The textured factor of a term, or what it is where there is no texture.
const struct texture_ref *editable_texture(const struct object *material, uint32_t term);

// The closure of an editable material in another one, where others are around it (a twosided, a
// mask, a bumpmap): wi is brought into its frame, and factor times what those leave. NULL: none.
const struct closure *editable_inside(const struct closure *closure, vec3 *wi, float *factor);

// Of a closure of an editable material: the data of the material's object, wo in its frame, and the
// texture of a term where it was resolved.
const void *editable_owner(const struct closure *closure);
struct direction editable_wo(const struct closure *closure);
spectrum editable_texture_at(const struct closure *closure, uint32_t term);

// For a closure of an editable material: a value for each term; returns their number, which is 0
// where wi is not above the surface.
uint32_t editable_values(const struct closure *closure, vec3 wi,
                         struct editable_value out[FORM_TERMS]);
