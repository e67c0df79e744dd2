// SPDX-License-Identifier: Apache-2.0
// Analytic curves: the factors of material models that a person edits by a number.
#pragma once

#include "curve/curve.h"

enum function_kind {
    FUNCTION_CONSTANT,  // p0
    FUNCTION_COS_POWER, // cos(g)^p0, 0 beyond pi/2
    FUNCTION_BECKMANN,  // exp(-tan(g)^2 / p0^2) / (p0^2 cos(g)^4); pi D of roughness p0
    FUNCTION_GAUSSIAN,  // exp(-tan(g)^2 / p0^2)
    FUNCTION_FRESNEL,   // reflectance of index p0 + i p1 at incidence g
    FUNCTION_SCHLICK_F, // p0 + (1 - p0) (1 - cos g)^5
    FUNCTION_SCHLICK_Z, // p0 / (sin(g)^2 + p0 cos(g)^2)^2; pi Z of roughness p0 (Schlick 1994)
    FUNCTION_TABLE,     // a tabulated curve
};

struct curve_function {
    enum function_kind kind;
    double p[2];
    const struct curve *table;
    uint32_t channel; // of the table
};

double function_value(const struct curve_function *f, double gamma);
double function_at(const void *function, double gamma); // the same as a curve_fn

// Of a lobe: the exponent n of the cos(g)^n that is as narrow around 0; 0: no lobe.
double function_exponent(const struct curve_function *f);

// Fills a channel of a curve; a table's own knots are minded.
void function_project(struct curve *c, uint32_t channel, const struct curve_function *f,
                      enum curve_filter filter);
