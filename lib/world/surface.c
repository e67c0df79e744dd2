// SPDX-License-Identifier: Apache-2.0
// From a hit to a shaded point: position with its error bound, normals, texture coordinates.
//
// Error bounds follow Pharr, Jakob, Humphreys 2023 (6.8): gamma(n) = n u / (1 - n u) bounds the
// relative error of n rounded operations, u = 2^-24.
#include "scene/quadric.h"
#include "world/world.h"

static const float GAMMA_3 = 3 * 0x1p-24f / (1 - 3 * 0x1p-24f);

// dp/du and dp/dv of a triangle; zero where its texture coordinates are degenerate.
static void triangle_derivatives(const struct world_shape *m, const uint32_t i[3], vec3 e1, vec3 e2,
                                 struct bsdf_point *point) {
    const float *t0 = m->uvs[i[0]], *t1 = m->uvs[i[1]], *t2 = m->uvs[i[2]];
    const float du1 = t1[0] - t0[0], dv1 = t1[1] - t0[1];
    const float du2 = t2[0] - t0[0], dv2 = t2[1] - t0[1];
    const float det = du1 * dv2 - dv1 * du2;
    if (det == 0)
        return;
    const float inv = 1 / det;
    point->dpdu = (dv2 * e1 - dv1 * e2) * inv;
    point->dpdv = (du1 * e2 - du2 * e1) * inv;
}

struct texture_point world_texture_point(const struct world_shape *m, const struct accel_hit *hit) {
    const float b1 = hit->u, b2 = hit->v, b0 = 1 - b1 - b2;
    struct texture_point at = {{b1, b2}, m->mesh, hit->primitive, {b1, b2}};
    if (m->uvs) {
        const uint32_t *i = m->indices[hit->primitive];
        const float *t0 = m->uvs[i[0]], *t1 = m->uvs[i[1]], *t2 = m->uvs[i[2]];
        at.uv = (struct vec2){b0 * t0[0] + b1 * t1[0] + b2 * t2[0],
                              b0 * t0[1] + b1 * t1[1] + b2 * t2[1]};
    }
    return at;
}

static void triangle_surface(const struct world_shape *m, const struct accel_hit *hit,
                             bool tangents, struct surface *s) {
    const uint32_t *i = m->indices[hit->primitive];
    const vec3 p0 = v3_load_padded(m->positions[i[0]]), p1 = v3_load_padded(m->positions[i[1]]),
               p2 = v3_load_padded(m->positions[i[2]]);
    const float b1 = hit->u, b2 = hit->v, b0 = 1 - b1 - b2;
    const vec3 e1 = p1 - p0, e2 = p2 - p0;
    s->p = b0 * p0 + b1 * p1 + b2 * p2;
    s->p_error = triangle_error(b0 * p0, b1 * p1, b2 * p2, e1, e2);
    s->ng = normalize(cross(e1, e2));
    vec3 ns = s->ng;
    if (m->normals) {
        ns = normalize(b0 * v3_load(m->normals[i[0]]) + b1 * v3_load(m->normals[i[1]]) +
                       b2 * v3_load(m->normals[i[2]]));
        if (!(length2(ns) > 0))
            ns = s->ng;
    }
    s->point.dpdu = s->point.dpdv = (vec3){0};
    s->point.at = world_texture_point(m, hit);
    if (m->uvs && tangents)
        triangle_derivatives(m, i, e1, e2, &s->point);
    s->point.frame.n = ns;
}

static vec3 to_vec3(const double a[3]) {
    return v3((float)a[0], (float)a[1], (float)a[2]);
}

// In double: the point is put back onto the shape, so only its rounding to float is left. In the
// space of its group where `instance` is not NULL.
static void quadric_shading(enum shape_kind kind, const struct world_transform *x,
                            const struct world_transform *instance, const struct ray *ray, float t,
                            struct surface *s) {
    double world[3], place[3], p[3], n[3], uv[2], du[3], dv[3], v[3];
    for (int i = 0; i < 3; i++)
        place[i] = world[i] = (double)ray->o[i] + (double)t * (double)ray->d[i];
    if (instance)
        transform_point(&instance->to_object, world, place);
    transform_point(&x->to_object, place, p);
    quadric_project(kind, p);
    quadric_surface(kind, p, n, uv, du, dv);
    transform_point(&x->to_world, p, place);
    s->p = to_vec3(place);
    s->p_error = GAMMA_3 * absolute(s->p) + x->error;
    transform_normal(&x->to_object, n, v);
    s->ng = normalize(to_vec3(v));
    transform_vector(&x->to_world, du, v);
    s->point.dpdu = to_vec3(v);
    transform_vector(&x->to_world, dv, v);
    s->point.dpdv = to_vec3(v);
    s->point.at = (struct texture_point){.uv = {(float)uv[0], (float)uv[1]}};
    s->point.frame.n = s->ng;
}

// Takes a surface from its group's space into the world.
static void apply_instance(const struct world_transform *x, struct surface *s) {
    const struct affine *m = &x->forward;
    const struct affine size = {absolute(m->x), absolute(m->y), absolute(m->z), absolute(m->o)};
    s->p_error = (GAMMA_3 + 1) * affine_vector(&size, s->p_error) +
                 GAMMA_3 * affine_point(&size, absolute(s->p));
    s->p = affine_point(m, s->p);
    s->ng = normalize(affine_normal(&x->inverse, s->ng));
    s->point.frame.n = normalize(affine_normal(&x->inverse, s->point.frame.n));
    s->point.dpdu = affine_vector(m, s->point.dpdu);
    s->point.dpdv = affine_vector(m, s->point.dpdv);
}

void world_surface(const struct world *w, const struct ray *ray, const struct accel_hit *hit,
                   struct surface *s) {
    const struct world_shape *shape = &w->shapes[hit->shape];
    s->t = hit->t;
    s->bsdf = shape->bsdf;
    s->light = shape->light;
    s->shape = hit->shape;
    s->primitive = hit->primitive;
    s->instance = hit->instance;
    s->point.wavelengths.count = 0;
    const struct world_transform *instance =
        hit->instance != SCENE_NONE ? &w->instances[hit->instance] : NULL;
    if (shape->kind == SHAPE_MESH)
        triangle_surface(shape, hit, w->tangents_matter, s);
    else
        quadric_shading((enum shape_kind)shape->kind, &w->quadrics[hit->shape], instance, ray,
                        hit->t, s);
    if (instance)
        apply_instance(instance, s);
    if (shape->flip_normals) {
        s->ng = -s->ng;
        s->point.frame.n = -s->point.frame.n;
    }
    const vec3 n = s->point.frame.n;
    s->point.frame = length2(s->point.dpdu) > 0 ? frame_from_normal_tangent(n, s->point.dpdu)
                                                : frame_from_normal(n);
}
