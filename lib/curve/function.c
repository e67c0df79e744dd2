// SPDX-License-Identifier: Apache-2.0
#include "curve/function.h"

#include <string.h>
#include <math.h>

// cos(g)^n. log(cos g) from the sine near 0, where the cosine has lost the angle.
static double cos_power(double g, double n) {
    const double c = cos(g), s = sin(g);
    if (n == 0)
        return 1;
    if (!(c > 0))
        return 0;
    return exp(n * (c * c > s * s ? log1p(-s * s) / 2 : log(c)));
}

// Unpolarised reflectance of a smooth surface of index eta + i k. With a + i b the square root of
// (eta + i k)^2 - sin^2 (Moeller 1988, Optics); a dielectric (k = 0) in the form without
// cancellation at eta = 1.
static double fresnel(double c, double eta, double k) {
    const double c2 = c * c, s2 = 1 - c2, ek2 = eta * k * eta * k;
    const double m = (eta - 1) * (eta + 1) - k * k + c2;
    if (k == 0) {
        if (m <= 0)
            return eta == 1 ? 0 : 1;
        const double d = (eta - 1) * (eta + 1), q = sqrt(m), e2 = eta * eta;
        const double r_s = d / ((c + q) * (c + q));
        const double r_p = d * (1 - c2 * (1 + e2)) / ((q + e2 * c) * (q + e2 * c));
        return (r_s * r_s + r_p * r_p) / 2;
    }
    const double norm = sqrt(m * m + 4 * ek2), big = (norm + fabs(m)) / 2;
    const double small = big > 0 ? ek2 / big : 0;
    const double a = sqrt(m >= 0 ? big : small), b2 = m >= 0 ? small : big;
    const double r_s = ((a - c) * (a - c) + b2) / ((a + c) * (a + c) + b2);
    const double pm = c * a - s2, pp = c * a + s2;
    return r_s * (1 + (pm * pm + c2 * b2) / (pp * pp + c2 * b2)) / 2;
}

static double schlick_f(double g, double r0) {
    const double s = sin(g / 2), m = 2 * s * s; // 1 - cos g
    return r0 + (1 - r0) * (m * m * m * m * m);
}

static double beckmann(double g, double roughness) {
    const double c = cos(g), c2 = c * c, t = tan(g) / roughness;
    return c > 0 ? exp(-t * t) / (roughness * roughness * c2 * c2) : 0;
}

static double gaussian(double g, double roughness) {
    const double t = tan(g) / roughness;
    return exp(-t * t);
}

static double schlick_z(double g, double r) {
    const double s = sin(g), c = cos(g), q = s * s + r * c * c;
    return r / (q * q);
}

double function_value(const struct curve_function *f, double g) {
    const double p = f->p[0];
    switch (f->kind) {
    case FUNCTION_CONSTANT: return p;
    case FUNCTION_COS_POWER: return cos_power(g, p);
    case FUNCTION_BECKMANN: return beckmann(g, p);
    case FUNCTION_GAUSSIAN: return gaussian(g, p);
    case FUNCTION_FRESNEL: return fresnel(fmax(cos(g), 0), p, f->p[1]);
    case FUNCTION_SCHLICK_F: return schlick_f(g, p);
    case FUNCTION_SCHLICK_Z: return schlick_z(g, p);
    case FUNCTION_TABLE: return curve_at(f->table, f->channel, g);
    }
    return 0;
}

double function_at(const void *function, double gamma) {
    return function_value(function, gamma);
}

// From what they are next to 0: cos(g)^n is exp(-n g^2 / 2).
double function_exponent(const struct curve_function *f) {
    const double p = f->p[0];
    switch (f->kind) {
    case FUNCTION_COS_POWER: return p;
    case FUNCTION_BECKMANN: return fmax(2 / (p * p) - 4, 0);
    case FUNCTION_GAUSSIAN: return 2 / (p * p);
    case FUNCTION_SCHLICK_Z: return 4 * (1 - p) / p;
    case FUNCTION_CONSTANT:
    case FUNCTION_FRESNEL:
    case FUNCTION_SCHLICK_F:
    case FUNCTION_TABLE: break;
    }
    return 0;
}

void function_project(struct curve *c, uint32_t channel, const struct curve_function *f,
                      enum curve_filter filter) {
    const struct basis *b = f->kind == FUNCTION_TABLE ? &f->table->basis : NULL;
    if (b && basis_equal(b, &c->basis))
        memcpy(c->values + (size_t)channel * b->count, curve_values(f->table, f->channel),
               sizeof *c->values * b->count);
    else
        curve_project(c, channel, function_at, f, filter, b ? b->knots : NULL,
                      b ? basis_knots(b) : 0);
}
