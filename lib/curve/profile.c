// SPDX-License-Identifier: Apache-2.0
#include "curve/profile.h"

#include <math.h>

// Interpolation at Chebyshev's points, panel by panel.
void profile_fit(struct profile *p, curve_fn f, const void *ctx) {
    const double width = CURVE_END / PROFILE_PANELS;
    for (int i = 0; i < PROFILE_PANELS; i++) {
        double v[PROFILE_ORDER];
        for (int k = 0; k < PROFILE_ORDER; k++)
            v[k] = f(ctx, width * (i + 0.5 + 0.5 * cos(M_PI * (k + 0.5) / PROFILE_ORDER)));
        for (int j = 0; j < PROFILE_ORDER; j++) {
            double sum = 0;
            for (int k = 0; k < PROFILE_ORDER; k++)
                sum += v[k] * cos(M_PI * j * (k + 0.5) / PROFILE_ORDER);
            p->c[i][j] = sum * (j ? 2.0 : 1.0) / PROFILE_ORDER;
        }
    }
}

double profile_at(const struct profile *p, double x) {
    const double place = x * (PROFILE_PANELS / CURVE_END);
    int i = place > 0 ? (int)place : 0;
    i = i < PROFILE_PANELS ? i : PROFILE_PANELS - 1;
    const double t = 2 * (place - i) - 1;
    double b1 = 0, b2 = 0;
    for (int k = PROFILE_ORDER - 1; k > 0; k--) {
        const double b = p->c[i][k] + 2 * t * b1 - b2;
        b2 = b1;
        b1 = b;
    }
    return p->c[i][0] + t * b1 - b2;
}

// ---- area of facets -------------------------------------------------------------------------

// Integral over h's azimuth of (h.k)+ for elevations theta of k and x of h.
static double ring(double theta, double x) {
    const double a = cos(theta) * cos(x), b = sin(theta) * sin(x);
    if (a >= b)
        return 2 * M_PI * a;
    const double phi = acos(fmax(-a / b, -1));
    return 2 * (a * phi + b * sin(phi));
}

struct area {
    curve_fn p;
    const void *ctx;
    double theta;
};

static double integrand(const struct area *s, double x) {
    return s->p(s->ctx, x) * ring(s->theta, x) * sin(x);
}

// Gauss-Legendre with 8 points, for one interval of a table.
static double smooth_piece(const struct area *s, double lo, double hi) {
    static const double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                0.9602898564975363};
    static const double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                0.1012285362903763};
    const double middle = 0.5 * (lo + hi), half = 0.5 * (hi - lo);
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += w[i] * (integrand(s, middle - half * x[i]) + integrand(s, middle + half * x[i]));
    return half * sum;
}

// The tanh-sinh rule (Takahasi and Mori 1974), which minds neither lobes nor roots at the ends.
static double sharp_piece(const struct area *s, double lo, double hi) {
    enum { STEPS = 180 };
    const double step = 3.7 / STEPS;
    double sum = 0;
    for (int i = -STEPS; i <= STEPS; i++) {
        const double u = 0.5 * M_PI * sinh(i * step), far = 1 / (1 + exp(2 * u));
        const double w = M_PI * cosh(i * step) * far * (1 - far);
        sum += w * integrand(s, u < 0 ? lo + (hi - lo) * (1 - far) : hi - (hi - lo) * far);
    }
    return sum * (hi - lo) * step;
}

double facet_area(curve_fn p, const void *ctx, const double *breaks, uint32_t break_count,
                  double theta) {
    const struct area s = {p, ctx, theta};
    const double bend = CURVE_END - theta; // ring() has a root's end there
    double lo = 0, sum = 0;
    uint32_t i = 0;
    while (lo < CURVE_END) {
        while (i < break_count && breaks[i] <= lo)
            i++;
        double hi = i < break_count && breaks[i] < CURVE_END ? breaks[i] : CURVE_END;
        if (bend > lo && bend < hi)
            hi = bend;
        const double width = hi - lo;
        const bool sharp = break_count == 0 || (bend > lo - width && bend < hi + width);
        sum += sharp ? sharp_piece(&s, lo, hi) : smooth_piece(&s, lo, hi);
        lo = hi;
    }
    return sum;
}
