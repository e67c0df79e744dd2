// SPDX-License-Identifier: Apache-2.0
// Adaptive integration of a pair of functions over a rectangle.
#pragma once

#include <math.h>

struct pair {
    double a, b;
};

typedef struct pair (*pair_fn)(void *ctx, double x, double y);

static inline struct pair cubature_rule(pair_fn f, void *ctx, double x0, double x1, double y0,
                                        double y1) {
    static const double node[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                   0.8611363115940526};
    static const double weight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                     0.3478548451374538};
    struct pair sum = {0, 0};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) {
            const struct pair v = f(ctx, 0.5 * (x0 + x1) + 0.5 * (x1 - x0) * node[i],
                                    0.5 * (y0 + y1) + 0.5 * (y1 - y0) * node[j]);
            sum.a += weight[i] * weight[j] * v.a;
            sum.b += weight[i] * weight[j] * v.b;
        }
    }
    const double area = 0.25 * (x1 - x0) * (y1 - y0);
    return (struct pair){sum.a * area, sum.b * area};
}

static inline struct pair cubature_split(pair_fn f, void *ctx, double x0, double x1, double y0,
                                         double y1, struct pair whole, double tolerance,
                                         int depth) {
    const double xm = 0.5 * (x0 + x1), ym = 0.5 * (y0 + y1);
    const struct pair q[4] = {cubature_rule(f, ctx, x0, xm, y0, ym),
                              cubature_rule(f, ctx, xm, x1, y0, ym),
                              cubature_rule(f, ctx, x0, xm, ym, y1),
                              cubature_rule(f, ctx, xm, x1, ym, y1)};
    const struct pair sum = {q[0].a + q[1].a + q[2].a + q[3].a, q[0].b + q[1].b + q[2].b + q[3].b};
    if (depth == 0 || fmax(fabs(sum.a - whole.a), fabs(sum.b - whole.b)) <= tolerance)
        return sum;
    const double xs[4] = {x0, xm, x0, xm}, ys[4] = {y0, y0, ym, ym};
    struct pair total = {0, 0};
    for (int i = 0; i < 4; i++) {
        const struct pair p = cubature_split(f, ctx, xs[i], xs[i] + 0.5 * (x1 - x0), ys[i],
                                             ys[i] + 0.5 * (y1 - y0), q[i], 0.5 * tolerance,
                                             depth - 1);
        total.a += p.a;
        total.b += p.b;
    }
    return total;
}

// Both integrals, from panels x panels rectangles that are halved until that changes neither by more
// than the tolerance.
static inline struct pair cubature_panels(pair_fn f, void *ctx, double x0, double x1, double y0,
                                          double y1, int panels, double tolerance) {
    struct pair total = {0, 0};
    for (int i = 0; i < panels; i++) {
        for (int j = 0; j < panels; j++) {
            const double dx = (x1 - x0) / panels, dy = (y1 - y0) / panels;
            const double x = x0 + i * dx, y = y0 + j * dy;
            const struct pair whole = cubature_rule(f, ctx, x, x + dx, y, y + dy);
            const struct pair p =
                cubature_split(f, ctx, x, x + dx, y, y + dy, whole, tolerance / panels, 9);
            total.a += p.a;
            total.b += p.b;
        }
    }
    return total;
}

static inline struct pair cubature(pair_fn f, void *ctx, double x0, double x1, double y0,
                                   double y1, double tolerance) {
    return cubature_panels(f, ctx, x0, x1, y0, y1, 1, tolerance);
}
