// SPDX-License-Identifier: Apache-2.0
#include "scene/quadric.h"

#include <math.h>

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Both roots of a t^2 + 2 b t + c, ascending, without cancellation.
static bool solve_quadratic(double a, double b, double c, double t[2]) {
    const double discriminant = b * b - a * c;
    if (!(discriminant >= 0) || !(a > 0))
        return false;
    const double q = -(b + copysign(sqrt(discriminant), b));
    const double t0 = q / a, t1 = q != 0 ? c / q : t0;
    t[0] = t0 < t1 ? t0 : t1;
    t[1] = t0 < t1 ? t1 : t0;
    return true;
}

// The discriminant from the distance of the ray's line to the centre, which keeps its digits when
// the origin is far away (Haines et al. 2019, Precision Improvements for Ray/Sphere Intersection).
static bool sphere_roots(const double o[3], const double d[3], double t[2]) {
    const double a = dot3(d, d), b = dot3(o, d);
    double f[3];
    for (int i = 0; i < 3; i++)
        f[i] = o[i] - b / a * d[i];
    const double discriminant = a * (1 - dot3(f, f));
    if (!(discriminant >= 0))
        return false;
    const double c = dot3(o, o) - 1;
    const double q = -(b + copysign(sqrt(discriminant), b));
    const double t0 = q / a, t1 = q != 0 ? c / q : t0;
    t[0] = t0 < t1 ? t0 : t1;
    t[1] = t0 < t1 ? t1 : t0;
    return true;
}

static bool inside(double t, double tmin, double tmax) {
    return t > tmin && t < tmax;
}

bool quadric_intersect(enum shape_kind kind, const double o[3], const double d[3], double tmin,
                       double tmax, double *t) {
    if (kind == SHAPE_DISK) {
        *t = -o[2] / d[2];
        const double x = o[0] + *t * d[0], y = o[1] + *t * d[1];
        return inside(*t, tmin, tmax) && x * x + y * y <= 1; // NaN when d[2] is 0: refused
    }
    double root[2];
    const bool hit = kind == SHAPE_SPHERE
                         ? sphere_roots(o, d, root)
                         : solve_quadratic(d[0] * d[0] + d[1] * d[1], o[0] * d[0] + o[1] * d[1],
                                           o[0] * o[0] + o[1] * o[1] - 1, root);
    for (int i = 0; hit && i < 2; i++) {
        const double z = o[2] + root[i] * d[2];
        if (inside(root[i], tmin, tmax) && (kind == SHAPE_SPHERE || (z >= 0 && z <= 1))) {
            *t = root[i];
            return true;
        }
    }
    return false;
}

void quadric_project(enum shape_kind kind, double p[3]) {
    if (kind == SHAPE_DISK) {
        p[2] = 0;
        return;
    }
    const int dimensions = kind == SHAPE_SPHERE ? 3 : 2;
    double l2 = 0;
    for (int i = 0; i < dimensions; i++)
        l2 += p[i] * p[i];
    const double scale = l2 > 0 ? 1 / sqrt(l2) : 1;
    for (int i = 0; i < dimensions; i++)
        p[i] *= scale;
}

static double turn(double y, double x) { // angle of (x, y) over 2 pi, in [0, 1)
    const double phi = atan2(y, x) / (2 * M_PI);
    return phi < 0 ? phi + 1 : phi;
}

static void sphere_surface(const double p[3], double n[3], double uv[2], double dpdu[3],
                           double dpdv[3]) {
    const double rho = hypot(p[0], p[1]);
    const double cos_phi = rho > 0 ? p[0] / rho : 1, sin_phi = rho > 0 ? p[1] / rho : 0;
    uv[0] = turn(p[1], p[0]);
    uv[1] = acos(fmax(-1, fmin(1, p[2]))) / M_PI;
    for (int i = 0; i < 3; i++)
        n[i] = p[i];
    dpdu[0] = -2 * M_PI * p[1];
    dpdu[1] = 2 * M_PI * p[0];
    dpdu[2] = 0;
    dpdv[0] = M_PI * p[2] * cos_phi;
    dpdv[1] = M_PI * p[2] * sin_phi;
    dpdv[2] = -M_PI * rho;
}

static void disk_surface(const double p[3], double n[3], double uv[2], double dpdu[3],
                         double dpdv[3]) {
    const double r = hypot(p[0], p[1]);
    const double c = r > 0 ? p[0] / r : 1, s = r > 0 ? p[1] / r : 0;
    uv[0] = r;
    uv[1] = turn(p[1], p[0]);
    n[0] = n[1] = 0;
    n[2] = 1;
    dpdu[0] = c;
    dpdu[1] = s;
    dpdu[2] = 0;
    dpdv[0] = -2 * M_PI * s; // per unit v at radius 1, as a direction is enough
    dpdv[1] = 2 * M_PI * c;
    dpdv[2] = 0;
}

static void cylinder_surface(const double p[3], double n[3], double uv[2], double dpdu[3],
                             double dpdv[3]) {
    uv[0] = turn(p[1], p[0]);
    uv[1] = p[2];
    n[0] = p[0];
    n[1] = p[1];
    n[2] = 0;
    dpdu[0] = -2 * M_PI * p[1];
    dpdu[1] = 2 * M_PI * p[0];
    dpdu[2] = 0;
    dpdv[0] = dpdv[1] = 0;
    dpdv[2] = 1;
}

void quadric_surface(enum shape_kind kind, const double p[3], double n[3], double uv[2],
                     double dpdu[3], double dpdv[3]) {
    if (kind == SHAPE_SPHERE)
        sphere_surface(p, n, uv, dpdu, dpdv);
    else if (kind == SHAPE_DISK)
        disk_surface(p, n, uv, dpdu, dpdv);
    else
        cylinder_surface(p, n, uv, dpdu, dpdv);
}

void quadric_bounds(enum shape_kind kind, double lo[3], double hi[3]) {
    for (int i = 0; i < 3; i++) {
        lo[i] = -1;
        hi[i] = 1;
    }
    if (kind != SHAPE_SPHERE)
        lo[2] = 0;
    if (kind == SHAPE_DISK)
        hi[2] = 0;
}
