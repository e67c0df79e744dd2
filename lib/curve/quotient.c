// SPDX-License-Identifier: Apache-2.0
#include "curve/quotient.h"

#include <math.h>
#include <string.h>

const char *const quotient_names[] = {"one", "v_cavity", "ashikhmin", "ward", "ward_duer",
                                      "ward_bounded", "schlick", "schlick_rest", "oren_nayar",
                                      "facets", NULL};

static double at_least(double cosine) {
    return fmax(cosine, QUOTIENT_LEAST);
}

// The minimum of G = min(1, 2 cos_h cos_o / cos_d, 2 cos_h cos_i / cos_d) is taken after division.
static double v_cavity(struct angles *a) {
    const double i = at_least(a->cos_i), o = at_least(a->cos_o), s = 2 * a->cos_h / a->cos_d;
    return fmin(1 / (i * o), fmin(s / i, s / o));
}

static double ashikhmin(const struct quotient *q, struct angles *a) {
    const double fixed = q->n > 0 ? exp(-q->n * angles_log(a) * a->cos2_phi) : 1;
    return fixed / (a->cos_d * at_least(fmax(a->cos_i, a->cos_o)));
}

// cos_h = (cos_i + cos_o) / (2 cos_d)
static double ward_bounded(struct angles *a) {
    const double s = at_least(a->cos_i + a->cos_o), t = 4 * a->cos_d / (s * s);
    return t * t;
}

// r - r v + v
static double schlick_mask(double r, double v) {
    return at_least(r * (1 - v) + v);
}

static double schlick(const struct quotient *q, struct angles *a) {
    const double r = q->roughness, p2 = q->isotropy * q->isotropy;
    const double isotropy = sqrt(q->isotropy / (p2 * a->sin2_phi + a->cos2_phi));
    return isotropy / (schlick_mask(r, a->cos_i) * schlick_mask(r, a->cos_o));
}

// 1 - v v' / (m m'), m = v + r (1 - v), without cancellation at small r
static double schlick_rest(const struct quotient *q, struct angles *a) {
    const double r = q->roughness, i = a->cos_i, o = a->cos_o;
    const double di = r * (1 - i), d_o = r * (1 - o);
    return (di * o + d_o * i + di * d_o) /
           fmax((i + di) * (o + d_o), QUOTIENT_LEAST * QUOTIENT_LEAST);
}

// cos(phi_i - phi_o) sin(theta_i) sin(theta_o) / max(cos_i, cos_o)
static double oren_nayar(struct angles *a) {
    const double c = a->wi[0] * a->wo[0] + a->wi[1] * a->wo[1];
    return fmax(c, 0) / at_least(fmax(a->cos_i, a->cos_o));
}

static double facets(const struct quotient *q, struct angles *a) {
    const struct gamma i = {GAMMA_THETA_I, 0}, o = {GAMMA_THETA_O, 0};
    return 1 / (profile_at(q->g, gamma_at(&i, a)) * profile_at(q->g, gamma_at(&o, a)));
}

static double quotient(const struct quotient *q, struct angles *a) {
    switch (q->kind) {
    case QUOTIENT_V_CAVITY: return v_cavity(a);
    case QUOTIENT_ASHIKHMIN: return ashikhmin(q, a);
    case QUOTIENT_WARD: return 1 / sqrt(at_least(a->cos_i) * at_least(a->cos_o));
    case QUOTIENT_WARD_DUER: return 1 / (at_least(a->cos_i) * at_least(a->cos_o));
    case QUOTIENT_WARD_BOUNDED: return ward_bounded(a);
    case QUOTIENT_SCHLICK: return schlick(q, a);
    case QUOTIENT_SCHLICK_REST: return schlick_rest(q, a);
    case QUOTIENT_OREN_NAYAR: return oren_nayar(a);
    case QUOTIENT_FACETS: return facets(q, a);
    case QUOTIENT_ONE:
    case QUOTIENT_COUNT: break;
    }
    return 1;
}

void quotient_cos(const struct quotient *q, struct angles *a,
                     double out[CURVE_CHANNELS]) {
    const struct gamma d = {GAMMA_THETA_D, 0};
    const double v = a->cos_i > 0 && a->cos_o > 0 ? quotient(q, a) * a->cos_i : 0;
    const double theta_d = q->has_fresnel ? gamma_at(&d, a) : 0;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        out[k] = q->has_fresnel ? v * function_value(&q->fresnel[k], theta_d) : v;
}

static bool function_equal(const struct curve_function *a, const struct curve_function *b) {
    return a->kind == b->kind && a->p[0] == b->p[0] && a->p[1] == b->p[1] && a->table == b->table &&
           a->channel == b->channel;
}

static bool profile_equal(const struct profile *a, const struct profile *b) {
    return a == b || (a && b && memcmp(a, b, sizeof *a) == 0);
}

bool quotient_equal(const struct quotient *a, const struct quotient *b) {
    if (a->kind != b->kind || a->n != b->n || a->roughness != b->roughness ||
        a->isotropy != b->isotropy || !profile_equal(a->g, b->g) ||
        a->has_fresnel != b->has_fresnel)
        return false;
    for (int k = 0; k < CURVE_CHANNELS && a->has_fresnel; k++)
        if (!function_equal(&a->fresnel[k], &b->fresnel[k]))
            return false;
    return true;
}
