// SPDX-License-Identifier: Apache-2.0
#include "light/solid_angle.h"

struct dvec3 {
    double x, y, z;
};

static struct dvec3 from_float(vec3 a) {
    return (struct dvec3){a[0], a[1], a[2]};
}

static struct dvec3 add_scaled(struct dvec3 a, double t, struct dvec3 b) {
    return (struct dvec3){a.x + t * b.x, a.y + t * b.y, a.z + t * b.z};
}

static double dot_d(struct dvec3 a, struct dvec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct dvec3 cross_d(struct dvec3 a, struct dvec3 b) {
    return (struct dvec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double det(struct dvec3 a, struct dvec3 b, struct dvec3 c) {
    return dot_d(a, cross_d(b, c));
}

static struct dvec3 unit(struct dvec3 a) {
    return add_scaled((struct dvec3){0, 0, 0}, 1 / sqrt(dot_d(a, a)), a);
}

static double clamp_d(double x, double lo, double hi) {
    return x > lo ? fmin(x, hi) : lo; // NaN becomes lo
}

void solid_angle_init(struct area_mesh *a) {
    const float share = a->kind == POLYGON_RECTANGLE ? 0.5f : 1.0f / 3;
    a->middle = a->corner + share * (a->edge_x + a->edge_y);
    a->least_height = 1e-4f * (length(a->edge_x) + length(a->edge_y));
    const struct dvec3 x = unit(from_float(a->edge_x)), y = unit(from_float(a->edge_y));
    const struct dvec3 axes[3] = {x, y, cross_d(x, y)};
    for (int i = 0; i < 3; i++) {
        a->axes[i][0] = axes[i].x;
        a->axes[i][1] = axes[i].y;
        a->axes[i][2] = axes[i].z;
    }
    a->extent[0] = dot_d(x, from_float(a->edge_x));
    a->extent[1] = dot_d(y, from_float(a->edge_y));
}

// Beyond some 2 edge lengths sampling by area makes a Cornell box 3 % noisier and costs a tenth less.
// In the plane of the light the formulas lose their digits and the light sends nothing anyway.
bool solid_angle_pays(const struct area_mesh *a, vec3 p) {
    return length2(p - a->middle) < 5 * a->area && dot(p - a->corner, a->n) > a->least_height;
}

// ---- rectangle: Urena, Fajardo, King 2013, An Area-Preserving Parametrization for Spherical
// Rectangles; letters as there

struct rectangle {
    double x0, x1, y0, y1, z0; // z0 < 0
};

static struct rectangle rectangle_seen(const struct area_mesh *a, vec3 p) {
    double d[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            d[i] += ((double)a->corner[k] - (double)p[k]) * a->axes[i][k];
    return (struct rectangle){d[0], d[0] + a->extent[0], d[1], d[1] + a->extent[1], -fabs(d[2])};
}

// Sum of four arc tangents, as the argument of a product of complex numbers.
static double rectangle_solid_angle(const struct rectangle *r) {
    const double x[4] = {r->x1, r->x0, r->x0, r->x1}, y[4] = {r->y1, r->y1, r->y0, r->y0};
    double re = 1, im = 0;
    for (int i = 0; i < 4; i++) {
        const double a = -r->z0 * sqrt(x[i] * x[i] + y[i] * y[i] + r->z0 * r->z0);
        const double b = i % 2 ? -x[i] * y[i] : x[i] * y[i];
        const double t = re * a - im * b;
        im = re * b + im * a;
        re = t;
    }
    const double angle = atan2(im, re);
    return angle < 0 ? angle + 2 * M_PI : angle;
}

float solid_angle_of_rectangle(const struct area_mesh *a, vec3 p) {
    const struct rectangle r = rectangle_seen(a, p);
    return (float)rectangle_solid_angle(&r);
}

float solid_angle_sample_rectangle(const struct area_mesh *a, vec3 p, struct vec2 u,
                                   struct vec2 *xy) {
    const struct rectangle r = rectangle_seen(a, p);
    const double S = rectangle_solid_angle(&r);
    if (!((float)S > 0))
        return 0;
    const double z2 = r.z0 * r.z0;
    const double b0 = -r.y0 / sqrt(z2 + r.y0 * r.y0), b1 = r.y1 / sqrt(z2 + r.y1 * r.y1);
    const double n3 = -r.x0 / sqrt(z2 + r.x0 * r.x0);
    // The angle au = u S + k with k = 2 pi - g2 - g3 appears by its sine and cosine only.
    const double c2 = -b1 * n3, c3 = -n3 * b0;
    const double s2 = sqrt(fmax(0, 1 - c2 * c2)), s3 = sqrt(fmax(0, 1 - c3 * c3));
    const double cos_k = c2 * c3 - s2 * s3, sin_k = -(s2 * c3 + c2 * s3);
    const double cos_us = cos(u.x * S), sin_us = sin(u.x * S);
    const double fu = ((cos_us * cos_k - sin_us * sin_k) * b0 - b1) /
                      (sin_us * cos_k + cos_us * sin_k);
    const double cu = clamp_d(copysign(1, fu) / sqrt(fu * fu + b0 * b0), -1, 1);
    const double xu = clamp_d(-(cu * r.z0) / sqrt(1 - cu * cu), r.x0, r.x1);
    const double d = sqrt(xu * xu + z2);
    const double h0 = r.y0 / sqrt(d * d + r.y0 * r.y0), h1 = r.y1 / sqrt(d * d + r.y1 * r.y1);
    const double hv = h0 + u.y * (h1 - h0);
    const double yv = clamp_d(hv * d / sqrt(fmax(1 - hv * hv, 1e-300)), r.y0, r.y1);
    xy->x = clampf((float)((xu - r.x0) / (r.x1 - r.x0)), 0, 1);
    xy->y = clampf((float)((yv - r.y0) / (r.y1 - r.y0)), 0, 1);
    return (float)S;
}

// ---- triangle: Arvo 1995, Stratified Sampling of Spherical Triangles

struct triangle {
    struct dvec3 a, b, c; // unit directions of the corners
};

static struct triangle triangle_seen(const struct area_mesh *m, vec3 p) {
    const struct dvec3 a = add_scaled(from_float(m->corner), -1, from_float(p));
    return (struct triangle){unit(a), unit(add_scaled(a, 1, from_float(m->edge_x))),
                             unit(add_scaled(a, 1, from_float(m->edge_y)))};
}

// van Oosterom and Strackee 1983, equation 8
static double triangle_solid_angle(const struct triangle *t) {
    const double cosines = dot_d(t->a, t->b) + dot_d(t->b, t->c) + dot_d(t->c, t->a);
    return 2 * atan2(fabs(det(t->a, t->b, t->c)), 1 + cosines);
}

float solid_angle_of_triangle(const struct area_mesh *a, vec3 p) {
    const struct triangle t = triangle_seen(a, p);
    return (float)triangle_solid_angle(&t);
}

// Where the arc through a and c splits off the share u of the area: cosine of its angle from a.
static double split_arc(const struct triangle *t, double area) {
    const double cos_c = dot_d(t->a, t->b);
    const double alpha = atan2(fabs(det(t->a, t->b, t->c)),
                               dot_d(t->b, t->c) - cos_c * dot_d(t->a, t->c));
    const double s = sin(area - alpha), c = cos(area - alpha);
    const double u = c - cos(alpha), v = s + sin(alpha) * cos_c;
    const double q = ((v * c - u * s) * cos(alpha) - v) / ((v * s + u * c) * sin(alpha));
    return clamp_d(q, -1, 1);
}

// The unit vector at cosine q from a, towards b.
static struct dvec3 on_arc(struct dvec3 a, struct dvec3 b, double q) {
    const struct dvec3 side = unit(add_scaled(b, -dot_d(a, b), a));
    const double s = sqrt(fmax(0, 1 - q * q));
    return add_scaled((struct dvec3){s * side.x, s * side.y, s * side.z}, q, a);
}

float solid_angle_sample_triangle(const struct area_mesh *m, vec3 p, struct vec2 u,
                                  struct vec2 *xy) {
    const struct triangle t = triangle_seen(m, p);
    const double area = triangle_solid_angle(&t);
    if (!((float)area > 0))
        return 0;
    struct dvec3 w = u.x > 0 ? on_arc(t.a, t.c, split_arc(&t, u.x * area)) : t.a;
    w = on_arc(t.b, w, 1 - u.y * (1 - dot_d(w, t.b)));
    // Barycentric coordinates of the corners themselves, not of their directions.
    const struct dvec3 a = add_scaled(from_float(m->corner), -1, from_float(p));
    const struct dvec3 b = add_scaled(a, 1, from_float(m->edge_x));
    const struct dvec3 c = add_scaled(a, 1, from_float(m->edge_y));
    const double wa = det(w, b, c), wb = det(a, w, c), wc = det(a, b, w);
    const double x = clamp_d(wb / (wa + wb + wc), 0, 1);
    xy->x = (float)x;
    xy->y = (float)clamp_d(wc / (wa + wb + wc), 0, 1 - x);
    return (float)area;
}
