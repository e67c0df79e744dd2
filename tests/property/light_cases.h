// SPDX-License-Identifier: Apache-2.0
// Lights seen from points, and charts of what is seen: maps from unit squares onto the light, so
// that a density over directions can be integrated over smooth pieces without tracing rays.
#pragma once

#include <math.h>
#include <string.h>

#include "light/light.h"
#include "make_object.h"
#include "math/frame.h"
#include "scene/quadric.h"

enum chart_kind { CHART_TRIANGLES, CHART_QUADRIC, CHART_SPHERE_CAP, CHART_SKY, CHART_CONE_AND_SKY };

struct light_case {
    char name[96];
    enum chart_kind kind;
    struct object *light;
    const struct shape *shape;  // area lights
    vec3 p;                     // where it is seen from
    int charts, kx, ky;         // bins of each chart
    int midpoints;              // > 0: integrate bins by so many squared midpoints
    bool edges;                 // along lines: points are anywhere about the midpoints
    double phase;               // CHART_SKY: u of the chart's left edge
    struct transform to_world;  // CHART_SKY: of the sky, y up
    vec3 sun;                   // CHART_CONE_AND_SKY: direction and 1 - cos of its half angle
    double cone_height;
    bool may_be_empty;          // nothing reaches p
};

static inline const struct light_type *case_type(const struct light_case *c) {
    return light_type_of(c->light);
}

// ---- points of shapes, in double

struct dpoint {
    double x[3];
};

static inline struct dpoint quadric_point(const struct light_case *c, double s, double t) {
    double l[3], q[3];
    const double phi = 2 * M_PI * t;
    switch (c->shape->kind) {
    case SHAPE_DISK:
        l[0] = sqrt(s) * cos(phi), l[1] = sqrt(s) * sin(phi), l[2] = 0;
        break;
    case SHAPE_CYLINDER:
        l[0] = cos(phi), l[1] = sin(phi), l[2] = s;
        break;
    default:
        l[2] = 1 - 2 * s;
        l[0] = sqrt(1 - l[2] * l[2]) * cos(phi), l[1] = sqrt(1 - l[2] * l[2]) * sin(phi);
    }
    transform_point(&c->shape->to_world, l, q);
    return (struct dpoint){{q[0], q[1], q[2]}};
}

static inline double sphere_radius(const struct shape *s) {
    return sqrt(s->to_world.m[0][0] * s->to_world.m[0][0] + s->to_world.m[1][0] *
                s->to_world.m[1][0] + s->to_world.m[2][0] * s->to_world.m[2][0]);
}

static inline vec3 sphere_centre(const struct shape *s) {
    return affine_from(&s->to_world).o;
}

// Smallest cosine, seen from the sphere's centre, between p and a visible point.
static inline double cap_cosine(const struct light_case *c) {
    const double d = (double)length(c->p - sphere_centre(c->shape));
    const double r = sphere_radius(c->shape);
    return c->shape->flip_normals ? -1 : r / d;
}

static inline struct frame cap_frame(const struct light_case *c) {
    const vec3 axis = c->p - sphere_centre(c->shape);
    return frame_from_normal(length(axis) > 0 ? normalize(axis) : v3(0, 0, 1));
}

static inline struct dpoint cap_point(const struct light_case *c, double s, double t) {
    const struct frame f = cap_frame(c);
    const double z = 1 - s * (1 - cap_cosine(c)), r = sqrt(fmax(0, 1 - z * z));
    const double x = r * cos(2 * M_PI * t), y = r * sin(2 * M_PI * t);
    struct dpoint q;
    for (int i = 0; i < 3; i++)
        q.x[i] = (double)sphere_centre(c->shape)[i] +
                 sphere_radius(c->shape) * (x * (double)f.s[i] + y * (double)f.t[i] +
                                            z * (double)f.n[i]);
    return q;
}

static inline struct dpoint triangle_point(const struct mesh *m, int triangle, double b1,
                                           double b2) {
    struct dpoint q;
    for (int i = 0; i < 3; i++) {
        const double v0 = (double)m->positions[m->indices[triangle][0]][i];
        const double v1 = (double)m->positions[m->indices[triangle][1]][i];
        const double v2 = (double)m->positions[m->indices[triangle][2]][i];
        q.x[i] = v0 + b1 * (v1 - v0) + b2 * (v2 - v0);
    }
    return q;
}

static inline struct dpoint chart_point(const struct light_case *c, int chart, double s,
                                        double t) {
    if (c->kind == CHART_TRIANGLES)
        return triangle_point(&c->shape->mesh, chart, sqrt(s) * (1 - t), sqrt(s) * t);
    return c->kind == CHART_SPHERE_CAP ? cap_point(c, s, t) : quadric_point(c, s, t);
}

// Outward normal (of the winding, of the quadric) before flip_normals.
static inline vec3 outward(const struct light_case *c, struct dpoint q, const double cross[3]) {
    vec3 n = normalize(v3((float)cross[0], (float)cross[1], (float)cross[2]));
    if (c->kind == CHART_TRIANGLES)
        return n;
    const vec3 from_centre = v3((float)q.x[0], (float)q.x[1], (float)q.x[2]) -
                             affine_from(&c->shape->to_world).o;
    const vec3 z = affine_from(&c->shape->to_world).z;
    const vec3 out = c->shape->kind == SHAPE_DISK ? z : from_centre;
    return dot(n, out - (c->shape->kind == SHAPE_CYLINDER ? dot(out, normalize(z)) * normalize(z)
                                                          : v3(0, 0, 0))) < 0 ? -n : n;
}

static inline void sub_cross(struct dpoint a0, struct dpoint a1, struct dpoint b0,
                             struct dpoint b1, double c[3]) {
    double a[3], b[3];
    for (int i = 0; i < 3; i++) {
        a[i] = a1.x[i] - a0.x[i];
        b[i] = b1.x[i] - b0.x[i];
    }
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline struct texture_point triangle_place(const struct mesh *m, uint32_t triangle,
                                                  float b1, float b2) {
    struct texture_point at = {{b1, b2}, m, triangle, {b1, b2}};
    const uint32_t *i = m->indices[triangle];
    if (m->uvs) {
        const float b0 = 1 - b1 - b2;
        at.uv.x = b0 * m->uvs[i[0]][0] + b1 * m->uvs[i[1]][0] + b2 * m->uvs[i[2]][0];
        at.uv.y = b0 * m->uvs[i[0]][1] + b1 * m->uvs[i[1]][1] + b2 * m->uvs[i[2]][1];
    }
    return at;
}

static inline struct texture_point quadric_place(const struct shape *shape, struct dpoint q) {
    struct transform inverse;
    double p[3], n[3], uv[2], du[3], dv[3];
    transform_invert(&shape->to_world, &inverse);
    transform_point(&inverse, q.x, p);
    quadric_surface(shape->kind, p, n, uv, du, dv);
    return (struct texture_point){.uv = {(float)uv[0], (float)uv[1]}};
}

// The hit at a place of a chart, and solid angle per unit of the chart. false: seen from behind.
static inline bool surface_hit(const struct light_case *c, int chart, double s, double t,
                               struct light_hit *hit, double *solid_angle) {
    const double h = 1e-5;
    s = fmin(fmax(s, 2 * h), 1 - 2 * h);
    t = fmin(fmax(t, 2 * h), 1 - 2 * h);
    const struct dpoint q = chart_point(c, chart, s, t);
    double cross[3], d[3], d2 = 0, cosine = 0, length_cross = 0;
    sub_cross(chart_point(c, chart, s - h, t), chart_point(c, chart, s + h, t),
              chart_point(c, chart, s, t - h), chart_point(c, chart, s, t + h), cross);
    for (int i = 0; i < 3; i++) {
        d[i] = q.x[i] - (double)c->p[i];
        d2 += d[i] * d[i];
        length_cross += cross[i] * cross[i];
    }
    // The chart of a triangle turns either way: its winding decides.
    vec3 n = outward(c, q, cross);
    if (c->kind == CHART_TRIANGLES) {
        const struct dpoint v0 = triangle_point(&c->shape->mesh, chart, 0, 0);
        double winding[3];
        sub_cross(v0, triangle_point(&c->shape->mesh, chart, 1, 0), v0,
                  triangle_point(&c->shape->mesh, chart, 0, 1), winding);
        n = normalize(v3((float)winding[0], (float)winding[1], (float)winding[2]));
    }
    n = c->shape->flip_normals ? -n : n;
    for (int i = 0; i < 3; i++)
        cosine += cross[i] * d[i];
    cosine = fabs(cosine) / sqrt(d2 * length_cross);
    *solid_angle = sqrt(length_cross) / (4 * h * h) * cosine / d2;
    *hit = (struct light_hit){.wi = normalize(v3((float)(d[0] / sqrt(d2)), (float)(d[1] / sqrt(d2)),
                                                 (float)(d[2] / sqrt(d2)))),
                              .distance = (float)sqrt(d2), .ng = n};
    if (c->kind == CHART_TRIANGLES)
        hit->at = triangle_place(&c->shape->mesh, (uint32_t)chart, (float)(sqrt(s) * (1 - t)),
                                 (float)(sqrt(s) * t));
    else
        hit->at = quadric_place(c->shape, q);
    return dot(hit->wi, n) < 0;
}

// ---- skies

static inline struct frame sun_frame(const struct light_case *c) {
    return frame_from_normal(c->sun);
}

static inline bool sky_hit(const struct light_case *c, int chart, double s, double t,
                           struct light_hit *hit, double *solid_angle) {
    vec3 w;
    if (c->kind == CHART_SKY) {
        const double phi = 2 * M_PI * (s + c->phase), theta = M_PI * t;
        const struct affine a = affine_from(&c->to_world);
        w = affine_vector(&a, v3((float)(sin(phi) * sin(theta)), (float)cos(theta),
                                 (float)(-cos(phi) * sin(theta))));
        *solid_angle = 2 * M_PI * M_PI * sin(theta);
    } else if (chart == 0) { // the sun's cone
        const struct frame f = sun_frame(c);
        const double height = t * c->cone_height, r = sqrt(height * (2 - height));
        w = to_world(&f, v3((float)(r * cos(2 * M_PI * s)), (float)(r * sin(2 * M_PI * s)),
                            (float)(1 - height)));
        *solid_angle = 2 * M_PI * c->cone_height;
    } else { // upper half, z up, outside the cone
        const double r = sqrt(1 - t * t);
        w = v3((float)(r * cos(2 * M_PI * s)), (float)(r * sin(2 * M_PI * s)), (float)t);
        *solid_angle = 2 * M_PI;
        if (0.5 * (double)length2(w - c->sun) <= c->cone_height)
            return false;
    }
    *hit = (struct light_hit){.wi = normalize(w), .distance = INFINITY};
    return true;
}

static inline bool chart_hit(const struct light_case *c, int chart, double s, double t,
                             struct light_hit *hit, double *solid_angle) {
    return c->shape ? surface_hit(c, chart, s, t, hit, solid_angle)
                    : sky_hit(c, chart, s, t, hit, solid_angle);
}

// ---- back from a sample to its chart

static inline double turns(double y, double x) {
    const double t = atan2(y, x) / (2 * M_PI);
    return t - floor(t);
}

static inline int where_on_triangles(const struct light_case *c, vec3 p, double *s, double *t) {
    const struct mesh *m = &c->shape->mesh;
    int best = -1;
    double least = INFINITY;
    for (int i = 0; i < (int)m->triangle_count; i++) {
        const struct dpoint v0 = triangle_point(m, i, 0, 0), v1 = triangle_point(m, i, 1, 0),
                            v2 = triangle_point(m, i, 0, 1);
        double aa = 0, ab = 0, bb = 0, ad = 0, bd = 0, dd = 0;
        for (int k = 0; k < 3; k++) {
            const double a = v1.x[k] - v0.x[k], b = v2.x[k] - v0.x[k], d = (double)p[k] - v0.x[k];
            aa += a * a, ab += a * b, bb += b * b, ad += a * d, bd += b * d, dd += d * d;
        }
        const double det = aa * bb - ab * ab;
        if (!(det > 0))
            continue;
        const double b1 = (bb * ad - ab * bd) / det, b2 = (aa * bd - ab * ad) / det;
        const double off = dd - b1 * ad - b2 * bd; // squared distance from the plane
        const double out = fmax(0, -fmin(fmin(b1, b2), 1 - b1 - b2));
        const double score = off / (aa + bb) + out * out;
        if (score < least) {
            least = score;
            best = i;
            *s = fmin(fmax((b1 + b2) * (b1 + b2), 0), 1);
            *t = b1 + b2 > 0 ? fmin(fmax(b2 / (b1 + b2), 0), 1) : 0;
        }
    }
    return best;
}

static inline int where_on_quadric(const struct light_case *c, vec3 p, double *s, double *t) {
    struct transform inverse;
    transform_invert(&c->shape->to_world, &inverse);
    double l[3] = {(double)p[0], (double)p[1], (double)p[2]};
    transform_point(&inverse, l, l);
    *t = turns(l[1], l[0]);
    *s = c->shape->kind == SHAPE_DISK       ? l[0] * l[0] + l[1] * l[1]
         : c->shape->kind == SHAPE_CYLINDER ? l[2]
                                            : 0.5 * (1 - l[2]);
    return 0;
}

// The chart a sample lies in and its place there, or -1.
static inline int chart_of(const struct light_case *c, const struct light_sample *x, double *s,
                           double *t) {
    if (c->kind == CHART_TRIANGLES)
        return where_on_triangles(c, x->p, s, t);
    if (c->kind == CHART_QUADRIC)
        return where_on_quadric(c, x->p, s, t);
    if (c->kind == CHART_SPHERE_CAP) {
        const struct frame f = cap_frame(c);
        const vec3 n = to_local(&f, normalize(x->p - sphere_centre(c->shape)));
        *s = (1 - (double)n[2]) / (1 - cap_cosine(c));
        *t = turns((double)n[1], (double)n[0]);
        return 0;
    }
    if (c->kind == CHART_SKY) {
        struct transform inverse;
        transform_invert(&c->to_world, &inverse);
        const struct affine a = affine_from(&inverse);
        const vec3 w = affine_vector(&a, x->wi);
        const double u = turns((double)w[0], -(double)w[2]) - c->phase;
        *s = u - floor(u);
        *t = atan2(sqrt((double)w[0] * w[0] + (double)w[2] * w[2]), (double)w[1]) / M_PI;
        return 0;
    }
    const double height = 0.5 * (double)length2(x->wi - c->sun);
    if (height <= c->cone_height) {
        const struct frame f = sun_frame(c);
        const vec3 w = to_local(&f, x->wi);
        *s = turns((double)w[1], (double)w[0]);
        *t = height / c->cone_height;
        return 0;
    }
    *s = turns((double)x->wi[1], (double)x->wi[0]);
    *t = (double)x->wi[2];
    return 1;
}
