// SPDX-License-Identifier: Apache-2.0
// The editable form of a material (Ben-Artzi 2007, eq. 3.1): a sum of terms
//
//     rho = f_q rho_q(wi, wo) f_o(gamma_o(wo)) f_A(gamma_A(wi, wo)) f_B(gamma_B(wi, wo))
//
// f_q a number, rho_q fixed (curve/quotient.h), f_o, f_A and f_B curves that a person edits. A
// picture is linear in each curve under the light's integral, which is what lets it be precomputed.
// Terms may share curves, and a curve may stand in two slots (with two gammas).
//
// A parametrisation that differs between channels is three terms with f_q in one channel each.
// All is zero where wi or wo is not above the surface.
#pragma once

#include "curve/quotient.h"

enum form_slot_name { SLOT_O, SLOT_A, SLOT_B, SLOTS };

enum { FORM_TERMS = 8, FORM_CURVES = 16 };

extern const char *const slot_names[]; // "f_o", "f_A", "f_B", NULL

struct form_curve {
    const char *name;
    struct curve_function f[CURVE_CHANNELS];
};

struct form_slot {
    struct gamma gamma; // GAMMA_NONE: no curve here, the factor is 1
    uint32_t curve;     // index into the form's curves
};

struct form_term {
    const char *name;
    double scale[CURVE_CHANNELS]; // f_q
    struct quotient quotient;
    struct form_slot slots[SLOTS];
};

struct form {
    uint32_t terms, curves; // numbers of
    struct form_term term[FORM_TERMS];
    struct form_curve curve[FORM_CURVES];
};

// rho cos_i, per channel.
void form_eval(const struct form *f, const double wo[3], const double wi[3],
               double out[CURVE_CHANNELS]);

// rho cos_i / f_q of one term of the form.
void form_term_eval(const struct form *f, const struct form_term *t, struct angles *a,
                    double out[CURVE_CHANNELS]);

// ---- building -------------------------------------------------------------------------------

// A new term with f_q = colour * factor and no curves. There must be room.
struct form_term *form_add_term(struct form *f, const char *name, enum quotient_kind quotient,
                                const double colour[CURVE_CHANNELS], double factor);
// A slot with a new curve, the same in all channels, or with parameters per channel (p1 may be
// NULL: 0).
struct form_slot form_add_curve(struct form *f, const char *name, enum gamma_kind gamma,
                                enum function_kind kind, double p0);
struct form_slot form_add_curve_rgb(struct form *f, const char *name, enum gamma_kind gamma,
                                    enum function_kind kind, const double p0[CURVE_CHANNELS],
                                    const double *p1);
// Adds the terms of another form. false when there is no room.
bool form_append(struct form *f, const struct form *other);

// ---- tables ---------------------------------------------------------------------------------

// The weighting with which light sees a curve: FILTER_SINE for polar angles, else FILTER_MEAN.
enum curve_filter form_filter(const struct form *f, uint32_t curve);

// Puts tables over `basis` in place of one curve's functions; memory from the arena.
struct curve *form_tabulate(struct form *f, uint32_t curve, const struct basis *basis,
                            enum curve_filter filter, struct arena *arena);

// Whether an edit leads from one to the other: the same terms, quotients and gammas.
bool form_same_shape(const struct form *a, const struct form *b);
