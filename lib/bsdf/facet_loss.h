// SPDX-License-Identifier: Apache-2.0
// What rough surfaces lose by single scattering, tabulated, and the lobe that gives it back (Kulla
// and Conty 2017, Revisiting Physically Based Shading at Imageworks): with E(v) what the lossless
// surface returns of light from v, lost = 1 - E and mean its mean over diffuse light,
//
//     f(wo, wi) = lost(wo) lost(wi) / (pi mean)
//
// has the albedo lost(wo) and is reciprocal. `mean` is that of the table as it is interpolated, so
// what is given back is lost as the table has it, to rounding.
//
// For any model of facets: it says what E is. Directions are local, on the upper side.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/vec.h"

// E of the lossless surface with these roughnesses. Where that takes quadrature, so many nodes in
// either dimension suffice, and its error is added, so that no energy is created.
typedef double (*facet_albedo_fn)(const void *context, float alpha_u, float alpha_v, vec3 v,
                                  int nodes);

struct facet_loss {
    int alphas;    // 1: of one roughness
    int azimuths;  // 1: isotropic
    float *lost;   // [alphas][azimuths][cosines]; memory is the arena's
    float *mean;   // [alphas]
    float *cdf;    // [alphas][cosines]: of lost cos, in cells of the cosine
};

// The table where the roughness is known.
struct facet_loss_at {
    const float *row[2], *cdf[2];
    float weight; // of row[1]
    float mean;
    int azimuths;
};

// What the quadratures of math/microfacet.h may err by, with so many nodes of a table; `critical`:
// below the critical angle facets begin to refract, which leaves a kink (measured, GGX).
double facet_albedo_error(int nodes, bool critical);

// Of one roughness.
void facet_loss_make(struct facet_loss *loss, float alpha_u, float alpha_v, facet_albedo_fn albedo,
                     const void *context, struct arena *arena);
// Of every isotropic roughness.
void facet_loss_make_all(struct facet_loss *loss, facet_albedo_fn albedo, const void *context,
                         struct arena *arena);

struct facet_loss_at facet_loss_at(const struct facet_loss *loss, float alpha);
float facet_lost(const struct facet_loss_at *at, vec3 v);

// Directions with nearly the density lost(v) cos / (pi mean), and that density itself.
vec3 facet_loss_sample(const struct facet_loss_at *at, struct vec2 u);
float facet_loss_pdf_sa(const struct facet_loss_at *at, vec3 v);

// How the loss of both sides of a boundary is shared between reflection and transmission: the
// transmitted shares keep detailed balance, n1^2 mean1 share12 = n2^2 mean2 share21, and follow the
// smooth boundary's as far as that allows. eta is n2 / n1.
void facet_loss_share(float eta, float mean1, float mean2, float *share12, float *share21);

// What `energy` says.
enum facet_energy { ENERGY_SINGLE, ENERGY_COMPENSATED };
extern const char *const energy_choices[];

#define ENERGY_PARAM(type, m)                                                                      \
    {"energy", PARAM_CHOICE, offsetof(type, m), .def = "single", .unit = "",                       \
     .help = "light that meets several facets is lost, or compensated (Kulla and Conty 2017)",     \
     .choices = energy_choices}
