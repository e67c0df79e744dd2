// SPDX-License-Identifier: Apache-2.0
// Generators: material models as sums of terms with editable curves (Ben-Artzi 2007, chapter 3).
//
// A generator turns numbers that a person sets into curves; from there on the curves are what is
// edited, by numbers again (generate anew, which keeps the shape of the form), by files or by
// operators. Numbers that stand in a quotient or a gamma are `fixed`: changing them changes the
// shape.
#pragma once

#include "curve/form.h"

enum model_curve {
    MODEL_CURVE_O, // in place of the first term's f_o, f_A, f_B
    MODEL_CURVE_A,
    MODEL_CURVE_B,
    MODEL_CURVE_DIFFUSE_O, // of the term "diffuse"
    MODEL_CURVE_DIFFUSE_A,
    MODEL_CURVES,
};

struct model_parameters {
    double reflectance[CURVE_CHANNELS]; // factor on all but the diffuse term
    double diffuse[CURVE_CHANNELS];     // reflectance of an added Lambertian term; 0: no such term
    double exponent_u, exponent_v;      // along the tangent (round models: this one) and across
    double alpha_u, alpha_v;            // roughness likewise: root mean square slope times sqrt 2
    double eta[CURVE_CHANNELS], k[CURVE_CHANNELS]; // index; eta 0, k 1: reflects everything
    double r0[CURVE_CHANNELS];          // Schlick's reflectance at normal incidence
    double isotropy;                    // Schlick's p; fixed
    int variant;                        // Ward: 0 original, 1 Duer, 2 bounded; fixed
    bool literal;       // Phong and Cook-Torrance with the factors as printed in the source
    bool fixed_fresnel; // Fresnel factor inside the quotient, no curve f_B
    enum gamma_kind gamma[SLOTS];       // freehand
    enum quotient_kind quotient;        // freehand
    const struct curve *curve[MODEL_CURVES]; // NULL: as the model says
};

extern const struct model_parameters model_defaults;

struct model {
    const char *name, *help;
    // Adds the model's terms to an empty form, the parameters being in range.
    void (*make)(const struct model_parameters *p, struct arena *arena, struct form *f);
};

#define X(name) extern const struct model model_##name;
#include "curve/list.h"
#undef X

extern const struct model *const models[]; // NULL-terminated
const struct model *model_find(const char *name); // NULL: there is none

// Checks the parameters, makes the model, puts tables into slots, adds the diffuse term. What the
// form refers to lives in the arena. `at` names the material in messages; false after one.
bool model_make(const struct model *m, const struct model_parameters *p, struct arena *arena,
                struct form *f, const char *at);

// ---- for generators -------------------------------------------------------------------------

// The term "diffuse": colour / pi, with curves of 1 over theta_o and theta_i to bend by hand.
void model_add_diffuse(struct form *f, const double colour[CURVE_CHANNELS]);
// f_B over theta_d from eta and k, or the same as part of the quotient where the model says so.
void model_add_fresnel(struct form *f, struct form_term *t, const struct model_parameters *p);
