// SPDX-License-Identifier: Apache-2.0
// Importance sampling of one term of the editable form from its own curves.
//
// A curve is spread over its intervals between knots; which density of directions that makes
// depends on its gamma. With p the density over the interval's coordinate x, constant inside for
// boxes, linear for hats:
//
//     theta_h, phi_h     half vectors, x = sin^2(theta_h):        p_h = p(x) cos_h / pi
//     power, ratio       half vectors, x = gamma of either axis; sqrt(-2 log cos_h) (cos phi_h,
//                        sin phi_h) has the density exp(-(x^2 + y^2) / 2) of solid angle, so the
//                        two axes are independent
//     slope              half vectors, x = gamma of either axis
//     theta_r, theta_d   around the mirror direction or wo, x = sin^2(angle / 2):  p(x) / 4 pi
//     theta_i            around the normal, x = sin^2(theta_i):   p(x) cos_i / pi
//
// Half vectors are symmetric about the normal and reflect as in math/half_vector.h. Some share of
// all samples is cosine-distributed: what a curve does not know (the quotient, the other curve)
// keeps a density.
#pragma once

#include "curve/form.h"
#include "math/direction.h"

enum curve_strategy_kind {
    STRATEGY_COSINE,
    STRATEGY_POLAR, // half vectors by theta_h and phi_h
    STRATEGY_POWER,
    STRATEGY_SLOPE,
    STRATEGY_MIRROR,
    STRATEGY_DIFFERENCE,
    STRATEGY_LIGHT,
};

static inline struct angles angles_between(struct direction wo, struct direction wi) {
    const double o[3] = {wo.x, wo.y, wo.z}, i[3] = {wi.x, wi.y, wi.z};
    return angles_make(o, i);
}

// A density over the intervals of a basis. basis NULL: even in gamma.
struct curve_marginal {
    const struct basis *basis;
    struct gamma gamma;
    const double *cdf;        // intervals + 1
    const double *edges;      // of x, intervals + 1
    const double (*ends)[2];  // density over x at both ends of an interval
    bool level;               // intervals are equally likely, and even inside
};

struct curve_strategy {
    enum curve_strategy_kind kind;
    double share;
    struct curve_marginal first, second; // second: of the other axis of a pair
};

enum { CURVE_STRATEGIES = 3 };

struct curve_sampler {
    uint32_t count;
    struct curve_strategy strategy[CURVE_STRATEGIES]; // the cosine first
};

// What a marginal that has a basis holds up to the coordinate x.
double curve_marginal_cdf(const struct curve_marginal *m, double x);
// Gives every interval the same probability, even inside.
void curve_marginal_level(struct curve_marginal *m, struct arena *arena);

// From a term whose curves are tables; memory from the arena. Shares are equal at first.
void curve_sampler_init(struct curve_sampler *s, const struct form *f, const struct form_term *t,
                        struct arena *arena);

// Density of wi per solid angle of one strategy, both directions above the surface.
double curve_strategy_pdf_sa(const struct curve_strategy *s, struct direction wo,
                             struct direction wi, struct angles *a);
double curve_sampler_pdf_sa(const struct curve_sampler *s, struct direction wo,
                            struct direction wi, struct angles *a);
// left decides between the two images of a half vector. The direction may lie below.
struct direction curve_strategy_sample(const struct curve_strategy *s, struct direction wo,
                                       double left, double u, double v);
// u1 chooses the strategy; what is left of it, and u, v, choose the direction, which may lie below.
struct direction curve_sampler_sample(const struct curve_sampler *s, struct direction wo,
                                      double u1, double u, double v);
