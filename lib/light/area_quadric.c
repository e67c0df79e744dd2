// SPDX-License-Identifier: Apache-2.0
// Spheres, disks and cylinders as lights. A sphere is sampled by the cone it subtends; the others,
// and spheres that a transform has made ellipsoids, by area.
#include "light/area_shape.h"

#include "math/elementary.h"
#include "math/frame.h"
#include "math/warp.h"
#include "math/wide_maps.h"
#include "scene/quadric.h"

static vec3 object_normal(enum shape_kind kind, vec3 p) {
    if (kind == SHAPE_DISK)
        return v3(0, 0, 1);
    return normalize(kind == SHAPE_SPHERE ? p : v3(p[0], p[1], 0));
}

// Uniform over the shape's area in object space.
static vec3 object_point(enum shape_kind kind, struct vec2 u) {
    if (kind == SHAPE_SPHERE)
        return warp_sphere(u);
    if (kind == SHAPE_DISK) {
        const struct vec2 d = warp_disk(u);
        return v3(d.x, d.y, 0);
    }
    float sine, cosine;
    sincos_turn(u.x, &sine, &cosine);
    return v3(cosine, sine, u.y);
}

static float object_area(enum shape_kind kind) {
    return kind == SHAPE_SPHERE ? 4 * PI : kind == SHAPE_DISK ? PI : 2 * PI;
}

// World area per object area at a point with that object normal: |cofactor(M) n|.
static float area_element(const struct affine *m, vec3 n) {
    return length(n[0] * cross(m->y, m->z) + n[1] * cross(m->z, m->x) + n[2] * cross(m->x, m->y));
}

static vec3 world_normal(const struct area_quadric *q, vec3 n) {
    const vec3 w = normalize(affine_normal(&q->to_object, n));
    return q->flip ? -w : w;
}

static bool keeps_angles(const struct affine *m, float tolerance) {
    const float l = length(m->x);
    return fabsf(length(m->y) - l) <= tolerance * l && fabsf(length(m->z) - l) <= tolerance * l &&
           fabsf(dot(m->x, m->y)) <= tolerance * l * l &&
           fabsf(dot(m->y, m->z)) <= tolerance * l * l &&
           fabsf(dot(m->z, m->x)) <= tolerance * l * l;
}

// Mean area element times area; exact where the element is constant.
static float world_area(const struct area_quadric *q) {
    enum { STEPS = 64 };
    double sum = 0;
    for (int i = 0; i < STEPS * STEPS; i++) {
        const struct vec2 u = {((float)(i % STEPS) + 0.5f) / STEPS,
                               ((float)(i / STEPS) + 0.5f) / STEPS};
        const vec3 n = object_normal(q->kind, object_point(q->kind, u));
        sum += area_element(&q->to_world, n);
    }
    return (float)(sum / (STEPS * STEPS)) * object_area(q->kind);
}

bool area_quadric_init(struct area_quadric *q, const struct shape *shape) {
    struct transform inverse;
    if (!transform_invert(&shape->to_world, &inverse))
        return false;
    *q = (struct area_quadric){.kind = shape->kind, .flip = shape->flip_normals,
                               .to_world = affine_from(&shape->to_world),
                               .to_object = affine_from(&inverse)};
    q->round = q->kind == SHAPE_SPHERE && keeps_angles(&q->to_world, 3e-7f);
    q->uniform = keeps_angles(&q->to_world, 1e-5f) || q->kind == SHAPE_DISK;
    q->jacobian = area_element(&q->to_world, q->kind == SHAPE_DISK ? v3(0, 0, 1) : v3(1, 0, 0));
    q->area = world_area(q);
    q->centre = q->to_world.o;
    q->radius = length(q->to_world.x);
    return q->area > 0 && q->area < INFINITY;
}

// A flat disk shows its whole area along its normal; the others, convex, a quarter in the mean.
void area_quadric_bounds(const struct area_quadric *q, struct light_bounds *b) {
    const struct affine *m = &q->to_world;
    const bool flat = q->kind == SHAPE_DISK, tube = q->kind == SHAPE_CYLINDER;
    const vec3 middle = m->o + (tube ? 0.5f * m->z : v3(0, 0, 0));
    const vec3 across = m->x * m->x + m->y * m->y;
    vec3 half = v3(sqrtf(across[0]), sqrtf(across[1]), sqrtf(across[2]));
    if (tube)
        half += 0.5f * v3(fabsf(m->z[0]), fabsf(m->z[1]), fabsf(m->z[2]));
    else if (!flat)
        for (int i = 0; i < 3; i++)
            half[i] = sqrtf(across[i] + m->z[i] * m->z[i]);
    *b = (struct light_bounds){
        .min = middle - half, .max = middle + half, .cos_o = flat ? 1 : -1,
        .axis = flat ? world_normal(q, v3(0, 0, 1)) : v3(0, 0, 1),
        .intensity = flat ? q->area : 0.25f * q->area};
}

static void fill_texture_point(const struct area_quadric *q, vec3 object,
                               struct texture_point *at) {
    const double p[3] = {object[0], object[1], object[2]};
    double n[3], uv[2], dpdu[3], dpdv[3];
    quadric_surface(q->kind, p, n, uv, dpdu, dpdv);
    *at = (struct texture_point){.uv = {(float)uv[0], (float)uv[1]}};
}

// Fills place, its rounding error and the normal from the object-space point.
static void place(const struct area_quadric *q, vec3 object, struct light_sample *s,
                  struct texture_point *at) {
    const struct affine *m = &q->to_world;
    s->p = affine_point(m, object);
    s->p_error = 4 * 0x1p-23f *
                 (absolute(object[0] * m->x) + absolute(object[1] * m->y) +
                  absolute(object[2] * m->z) + absolute(m->o));
    s->n = world_normal(q, object_normal(q->kind, object));
    if (at)
        fill_texture_point(q, object, at);
}

static bool sample_by_area(const struct area_quadric *q, vec3 p, struct vec2 u,
                           struct light_sample *s, struct texture_point *at) {
    const vec3 object = object_point(q->kind, u);
    place(q, object, s, at);
    const float element = q->uniform ? q->jacobian
                                     : area_element(&q->to_world, object_normal(q->kind, object));
    return area_finish_sample(p, 1 / (object_area(q->kind) * element), s);
}

// ---- sphere

enum side { OUTSIDE, INSIDE, DARK };

// Seen from inside, every direction meets the sphere once. Points on the sphere count as inside
// although rounding may have put them out: there a sphere that emits inwards must light itself.
static enum side sphere_side(const struct area_quadric *q, float distance2) {
    const float r2 = q->radius * q->radius;
    if (q->flip) {
        const float slack = 1e-5f + 4e-7f * length(q->centre) / q->radius;
        return distance2 < r2 * (1 + 2 * slack) ? INSIDE : DARK;
    }
    return distance2 > r2 ? OUTSIDE : DARK;
}

// 1 - cos of the half angle that the sphere subtends, without cancellation
static float cone_height(float sin2_max) {
    return sin2_max / (1 + safe_sqrt(1 - sin2_max));
}

static float cone_pdf(float sin2_max) {
    return 1 / (TWO_PI * cone_height(sin2_max));
}

// Unit vector from the sphere's centre to the point that is seen at angle theta off the axis
// (which points from the centre to p), azimuth phi (Pharr, Jakob, Humphreys 2023, 6.2.4).
static vec3 seen_point(vec3 axis, float sin2_max, struct vec2 u) {
    const float t = u.x * cone_height(sin2_max); // 1 - cos theta
    const float sin2 = t * (2 - t);
    const float cos_alpha = sin2 / sqrtf(sin2_max) + (1 - t) * safe_sqrt(1 - sin2 / sin2_max);
    const float sin_alpha = safe_sqrt(1 - cos_alpha * cos_alpha);
    const struct frame f = frame_from_normal(axis);
    float sin_phi, cos_phi;
    sincos_turn(u.y, &sin_phi, &cos_phi);
    return to_world(&f, v3(sin_alpha * cos_phi, sin_alpha * sin_phi, minf(cos_alpha, 1)));
}

static void place_on_sphere(const struct area_quadric *q, vec3 outwards, struct light_sample *s,
                            struct texture_point *at) {
    if (q->round && !at) {
        const vec3 from_centre = q->radius * outwards;
        s->p = q->centre + from_centre;
        s->p_error = 4 * 0x1p-23f * (absolute(from_centre) + absolute(q->centre));
        s->n = q->flip ? -outwards : outwards;
        return;
    }
    const vec3 object = normalize(affine_vector(&q->to_object, outwards));
    place(q, object, s, at);
}

static bool sample_sphere(const struct area_quadric *q, vec3 p, struct vec2 u,
                          struct light_sample *s, struct texture_point *at) {
    const vec3 o = p - q->centre;
    const float d2 = length2(o), r2 = q->radius * q->radius;
    const enum side side = sphere_side(q, d2);
    if (side == DARK)
        return false;
    if (side == OUTSIDE) {
        place_on_sphere(q, seen_point(normalize(o), r2 / d2, u), s, at);
        s->wi = normalize(s->p - p);
        s->distance = length(s->p - p);
        s->pdf_sa = cone_pdf(r2 / d2);
        return s->distance > 0;
    }
    s->wi = warp_sphere(u);
    const float b = dot(o, s->wi);
    const float discriminant = b * b - d2 + r2;
    s->distance = safe_sqrt(discriminant) - b;
    s->pdf_sa = 1 / (4 * PI);
    if (!(s->distance > 0) || discriminant < 0)
        return false;
    place_on_sphere(q, normalize(o + s->distance * s->wi), s, at);
    return true;
}

static float sphere_pdf_sa(const struct area_quadric *q, vec3 p) {
    const float d2 = length2(p - q->centre);
    const enum side side = sphere_side(q, d2);
    if (side == DARK)
        return 0;
    return side == INSIDE ? 1 / (4 * PI) : cone_pdf(q->radius * q->radius / d2);
}

// ---- a lit point a lane, outside of a round sphere that emits outwards: the operations above, lane by
// lane

bool area_quadric_is_wide(const struct area_quadric *q) {
    return q->round && q->uniform && !q->flip;
}

static wide safe_sqrt_wide(wide x) {
    return wide_sqrt(wide_max(x, wide_of(0)));
}

static wide cone_height_wide(wide sin2_max) {
    return sin2_max / (1 + safe_sqrt_wide(1 - sin2_max));
}

static struct wide3 seen_point_wide(struct wide3 axis, wide sin2_max, const wide u[2]) {
    const wide t = u[0] * cone_height_wide(sin2_max);
    const wide sin2 = t * (2 - t);
    const wide cos_alpha =
        sin2 / wide_sqrt(sin2_max) + (1 - t) * safe_sqrt_wide(1 - sin2 / sin2_max);
    const wide sin_alpha = safe_sqrt_wide(1 - cos_alpha * cos_alpha);
    const struct wide_frame f = wide_frame_from_normal(axis);
    wide sin_phi, cos_phi;
    wide_sincos_turn(u[1], &sin_phi, &cos_phi);
    return wide_to_world(&f, (struct wide3){sin_alpha * cos_phi, sin_alpha * sin_phi,
                                            wide_min(cos_alpha, wide_of(1))});
}

wide_mask area_sphere_sample_wide(const struct area_quadric *q, const struct wide3 *p,
                                  const wide u[2], struct light_samples *s) {
    const struct wide3 centre = wide3_of(q->centre), o = wide3_sub(*p, centre);
    const wide d2 = wide_dot(o, o);
    const float r2 = q->radius * q->radius;
    const wide sin2_max = r2 / d2;
    s->n = seen_point_wide(wide_normalize(o), sin2_max, u);
    const struct wide3 from_centre = wide3_scale(wide_of(q->radius), s->n);
    s->p = wide3_add(centre, from_centre);
    s->p_error = wide3_scale(wide_of(4 * 0x1p-23f),
                             wide3_add(wide3_abs(from_centre), wide3_abs(centre)));
    const struct wide3 d = wide3_sub(s->p, *p);
    s->wi = wide_normalize(d);
    s->distance = wide_sqrt(wide_dot(d, d));
    s->pdf_sa = 1 / (TWO_PI * cone_height_wide(sin2_max));
    return wide_both(d2 > r2, s->distance > 0);
}

bool area_quadric_sample(const struct area_quadric *q, vec3 p, struct vec2 u,
                         struct light_sample *s, struct texture_point *at) {
    *s = (struct light_sample){0};
    if (q->kind == SHAPE_SPHERE && q->uniform)
        return sample_sphere(q, p, u, s, at);
    return sample_by_area(q, p, u, s, at);
}

float area_quadric_pdf_sa(const struct area_quadric *q, vec3 p, const struct light_hit *hit) {
    if (q->kind == SHAPE_SPHERE && q->uniform)
        return sphere_pdf_sa(q, p);
    float element = q->jacobian;
    if (!q->uniform) {
        const vec3 object = affine_point(&q->to_object, p + hit->distance * hit->wi);
        element = area_element(&q->to_world, object_normal(q->kind, object));
    }
    return area_to_solid_angle(1 / (object_area(q->kind) * element), hit->distance,
                               fabsf(dot(hit->ng, hit->wi)));
}
