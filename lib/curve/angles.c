// SPDX-License-Identifier: Apache-2.0
#include "curve/angles.h"

#include <math.h>

#include "curve/arc.h"

const char *const gamma_names[] = {"none", "theta_h", "theta_d", "theta_i", "theta_o", "theta_r",
                                   "phi_h", "power_u", "power_v", "ratio", "slope_u", "slope_v",
                                   0};

// Nearly opposite directions leave h undefined: lengths below this count as this.
#define LEAST 1e-6

static double norm(double x, double y, double z) {
    return sqrt(x * x + y * y + z * z);
}

struct angles angles_make(const double wo[3], const double wi[3]) {
    struct angles a = {.cos_i = wi[2], .cos_o = wo[2], .log_h = -1};
    for (int i = 0; i < 3; i++) {
        a.wi[i] = wi[i];
        a.wo[i] = wo[i];
        a.h[i] = wi[i] + wo[i];
    }
    const double x2 = a.h[0] * a.h[0], y2 = a.h[1] * a.h[1], r2 = x2 + y2;
    double l = sqrt(r2 + a.h[2] * a.h[2]);
    l = l > LEAST ? l : LEAST;
    a.cos_d = l / 2;
    a.sin_d = norm(wi[0] - wo[0], wi[1] - wo[1], wi[2] - wo[2]) / 2;
    a.cos_h = a.h[2] / l;
    a.sin_h = sqrt(r2) / l;
    a.cos2_phi = r2 > 0 ? x2 / r2 : 1;
    a.sin2_phi = r2 > 0 ? y2 / r2 : 0;
    for (int k = 0; k < GAMMA_COUNT; k++)
        a.known[k] = -1;
    return a;
}

double angles_log(struct angles *a) {
    const double t = a->sin_h / a->cos_h;
    if (a->log_h < 0)
        a->log_h = a->cos_h > 0 ? log1p(t * t) / 2 : HUGE_VAL;
    return a->log_h;
}

// arc cosine of exp(-l), l >= 0, for all sizes of l
static double acos_exp(double l) {
    return l > 0 ? atan2(sqrt(-expm1(-2 * l)), exp(-l)) : 0;
}

// Angle from the normal, pi/2 at most.
static double upper(double sine, double cosine) {
    return arc_quarter(sine, cosine > 0 ? cosine : 0);
}

// theta_r, from the chords to the mirror direction and to its opposite.
static double theta_r(const double *wi, const double *wo) {
    return 2 * arc_quarter(norm(wi[0] + wo[0], wi[1] + wo[1], wi[2] - wo[2]),
                           norm(wi[0] - wo[0], wi[1] - wo[1], wi[2] + wo[2]));
}

static double theta(const double *w) {
    return upper(sqrt(w[0] * w[0] + w[1] * w[1]), w[2]);
}

static double compute(const struct gamma *g, struct angles *a) {
    const double end = 1.57079632679489661923;
    double v = 0;
    switch (g->kind) {
    case GAMMA_NONE:
    case GAMMA_COUNT: return 0;
    case GAMMA_THETA_H: v = upper(a->sin_h, a->cos_h); break;
    case GAMMA_THETA_D: v = arc_quarter(a->sin_d, a->cos_d); break;
    case GAMMA_THETA_I: v = theta(a->wi); break;
    case GAMMA_THETA_O: v = theta(a->wo); break;
    case GAMMA_THETA_R: return theta_r(a->wi, a->wo);
    case GAMMA_PHI_H: v = arc_quarter(fabs(a->h[1]), fabs(a->h[0])); break;
    case GAMMA_POWER_U: v = acos_exp(angles_log(a) * a->cos2_phi); break;
    case GAMMA_POWER_V: v = acos_exp(angles_log(a) * a->sin2_phi); break;
    case GAMMA_RATIO: v = atan(sqrt(2 * angles_log(a) * a->sin2_phi * g->n)); break;
    case GAMMA_SLOPE_U: v = atan2(fabs(a->h[0]), a->h[2]); break;
    case GAMMA_SLOPE_V: v = atan2(fabs(a->h[1]), a->h[2]); break;
    }
    return v < end ? v : end;
}

double gamma_at(const struct gamma *g, struct angles *a) {
    if (g->kind == GAMMA_RATIO || g->kind >= GAMMA_COUNT)
        return compute(g, a);
    if (a->known[g->kind] < 0)
        a->known[g->kind] = compute(g, a);
    return a->known[g->kind];
}
