// SPDX-License-Identifier: Apache-2.0
// Editing a curve by regions (Ben-Artzi 2007, Real-time and accurate editing of BRDFs, chapter 9).
//
// An operator acts fully on [b, c] and fades over [a, b] and [c, d]; outside [a, d] nothing
// changes, and it brings in no jump. With the window W (0 outside, 1 on [b, c]):
//
//     translate-y   f + m W                          m: what is added
//     amplify-y     base + (f - base) (1 + (m-1) W)  m: factor on the distance from base
//     translate-x   f(x - m W)                       m: way to the right
//     amplify-x     f(x + (base - x) (1 - 1/m) W)    m: stretch about base
//
// W fades by S(t) = 1 / (1 + exp(1/t^2 - 1/(1-t)^2)), whose derivatives all vanish at 0 and 1; its
// slope is at most 8. An operator along x that would turn back somewhere (fold the curve) is
// refused. Fades of width 0 are for ends of the domain only. Results below 0 become 0.
#pragma once

#include "curve/curve.h"

enum operator_kind {
    OPERATOR_TRANSLATE_X,
    OPERATOR_TRANSLATE_Y,
    OPERATOR_AMPLIFY_X,
    OPERATOR_AMPLIFY_Y,
    OPERATOR_COUNT,
};

extern const char *const operator_names[]; // "translate-x", ..., NULL

struct curve_operator {
    enum operator_kind kind;
    double a, b, c, d; // radians, 0 <= a <= b <= c <= d <= pi/2
    double magnitude;  // m; along x radians (translate) or a factor above 0 (amplify)
    double base;       // of amplify: a value (y) or radians (x)
};

// "amplify-y,a,b,c,d,m[,base]", angles in degrees; several are separated by ";". At most `most`
// are stored; *count says how many. false after an error message that names `at`.
bool operators_parse(const char *text, struct curve_operator *out, uint32_t most, uint32_t *count,
                     const char *at);

// false after an error message that names `at`: bad regions, or a fold.
bool operator_check(const struct curve_operator *o, const char *at);
// The smallest slope of the map that an operator along x applies to x; 1 for the others.
double operator_least_slope(const struct curve_operator *o);

// W(x)
double operator_window(const struct curve_operator *o, double x);

// A function edited by layers of operators: those along y first, then those along x, each group in
// order, since an operator along x moves the regions of the others.
struct edited_curve {
    curve_fn f;
    const void *ctx;
    const struct curve_operator *operators;
    uint32_t count;
};

double edited_curve_at(const void *edited, double gamma); // a curve_fn

// Applies operators to channels (bit k: channel k) of a tabulated curve: the mean over a box, the
// value at a hat's node. Coefficients whose function lies outside every [a, d] keep their bits. A
// curve with one channel is edited whole.
void curve_edit(struct curve *c, uint32_t channels, const struct curve_operator *operators,
                uint32_t count);
