// SPDX-License-Identifier: Apache-2.0
// Irradiance on a shape, on the side of its normals; stands inside the shape as in Mitsuba.
//
// The picture covers the shape: a rectangle by its own axes, so that pixels are texels; others by a
// map of the unit square that keeps areas. A picture of one pixel is the mean over the shape.
#include <string.h>

#include "math/distribution.h"
#include "math/warp.h"
#include "scene/quadric.h"
#include "sensor/sensor.h"

struct irradiancemeter {
    // made by prepare
    float scale_x, scale_y;     // from film points to the unit square
    const struct shape *shape;
    bool rectangle;
    struct distribution by_area; // of triangles; its memory is the arena's
    struct transform to_object;  // quadrics
    double mean_element;
};

static const struct param params[] = {
    {"srf", PARAM_IGNORED, .unit = "", .help = "spectra are colours here"},
    PARAM_END,
};

static struct vec2 clamp_square(struct vec2 u) {
    return (struct vec2){clampf(u.x, 0, 0x1.fffffep-1f), clampf(u.y, 0, 0x1.fffffep-1f)};
}

// ---- meshes -------------------------------------------------------------------------------------

static void triangle(const struct mesh *m, uint32_t i, vec3 *p0, vec3 *e1, vec3 *e2) {
    const uint32_t *v = m->indices[i];
    *p0 = v3_load(m->positions[v[0]]);
    *e1 = v3_load(m->positions[v[1]]) - *p0;
    *e2 = v3_load(m->positions[v[2]]) - *p0;
}

static bool prepare_mesh(struct irradiancemeter *r, struct arena *arena) {
    const struct mesh *m = &r->shape->mesh;
    float *areas = mem_array(m->triangle_count, sizeof *areas);
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        vec3 p0, e1, e2;
        triangle(m, i, &p0, &e1, &e2);
        areas[i] = length(cross(e1, e2));
    }
    struct distribution d;
    distribution_init(&d, areas, m->triangle_count);
    r->by_area = d;
    const size_t bytes = (d.count + 1) * sizeof *d.cdf;
    r->by_area.cdf = memcpy(arena_alloc(arena, bytes), d.cdf, bytes);
    distribution_finish(&d);
    mem_free(areas);
    return r->by_area.total > 0;
}

static void place_on_mesh(const struct irradiancemeter *r, struct vec2 u, struct sensor_place *s) {
    const struct mesh *m = &r->shape->mesh;
    float pmf;
    vec3 p0, e1, e2;
    const uint32_t i = distribution_sample(&r->by_area, u.x, &pmf, r->rectangle ? NULL : &u.x);
    triangle(m, i, &p0, &e1, &e2);
    s->n = normalize(cross(e1, e2));
    if (r->rectangle) { // by its axes: vertices 1 and 3 are the neighbours of 0 (mesh_make_rectangle)
        p0 = v3_load(m->positions[0]);
        e1 = v3_load(m->positions[1]) - p0;
        e2 = v3_load(m->positions[3]) - p0;
    } else {
        u = warp_triangle(u);
    }
    s->p = p0 + u.x * e1 + u.y * e2;
    s->p_error = triangle_error(absolute(p0), absolute(e1), absolute(e2), e1, e2);
    s->weight = 1;
}

// ---- quadrics -----------------------------------------------------------------------------------

// A point of the unit shape that is uniform over its area.
static void unit_point(enum shape_kind kind, struct vec2 u, double p[3]) {
    const struct vec2 disk = warp_disk(u);
    const double phi = 2 * M_PI * (double)u.x;
    vec3 q = kind == SHAPE_DISK ? v3(disk.x, disk.y, 0) : warp_sphere(u);
    if (kind == SHAPE_CYLINDER)
        q = v3((float)cos(phi), (float)sin(phi), u.y);
    for (int i = 0; i < 3; i++)
        p[i] = (double)q[i];
}

// World normal at a point of the unit shape; its length before scaling is the world area for an
// object area, up to a constant (the determinant of the transform).
static double normal_at(const struct irradiancemeter *r, const double p[3], double n[3]) {
    double object[3], uv[2], du[3], dv[3];
    quadric_surface(r->shape->kind, p, object, uv, du, dv);
    const double size = sqrt(object[0] * object[0] + object[1] * object[1] + object[2] * object[2]);
    transform_normal(&r->to_object, object, n);
    const double world = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++)
        n[i] /= world;
    return world / size;
}

static bool prepare_quadric(struct irradiancemeter *r) {
    enum { STEPS = 64 };
    double p[3], n[3];
    if (!transform_invert(&r->shape->to_world, &r->to_object))
        return false;
    r->mean_element = 0;
    for (int i = 0; i < STEPS * STEPS; i++) {
        unit_point(r->shape->kind, (struct vec2){((float)(i % STEPS) + 0.5f) / STEPS,
                                                 ((float)(i / STEPS) + 0.5f) / STEPS}, p);
        r->mean_element += normal_at(r, p, n) / (STEPS * STEPS);
    }
    return r->mean_element > 0;
}

static void place_on_quadric(const struct irradiancemeter *r, struct vec2 u,
                             struct sensor_place *s) {
    double p[3], n[3], world[3];
    const struct transform *m = &r->shape->to_world;
    unit_point(r->shape->kind, u, p);
    s->weight = (float)(normal_at(r, p, n) / r->mean_element);
    transform_point(m, p, world);
    s->p = v3((float)world[0], (float)world[1], (float)world[2]);
    s->n = v3((float)n[0], (float)n[1], (float)n[2]);
    for (int i = 0; i < 3; i++)
        s->p_error[i] = 0x1p-21f * (float)(fabs(m->m[i][0]) + fabs(m->m[i][1]) + fabs(m->m[i][2]) +
                                           fabs(m->m[i][3]));
}

// ---- the sensor ---------------------------------------------------------------------------------

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct irradiancemeter *r = self->data;
    *r = (struct irradiancemeter){.scale_x = 1 / (float)scene->width,
                                  .scale_y = 1 / (float)scene->height, .shape = scene->shape};
    if (!r->shape || r->shape->group != SCENE_NONE) {
        log_error_at(self->at, "irradiancemeter: stands in no shape, or in one of a shapegroup; "
                     "expected it inside a shape of the scene");
        return false;
    }
    r->rectangle = strcmp(r->shape->type, "rectangle") == 0;
    if (r->shape->kind == SHAPE_MESH ? prepare_mesh(r, scene->arena) : prepare_quadric(r))
        return true;
    log_error_at(self->at, "irradiancemeter: its shape has no area");
    return false;
}

static void place(const void *data, float x, float y, struct sensor_place *out) {
    const struct irradiancemeter *r = data;
    const struct vec2 u = clamp_square((struct vec2){x * r->scale_x, y * r->scale_y});
    if (r->shape->kind == SHAPE_MESH)
        place_on_mesh(r, u, out);
    else
        place_on_quadric(r, u, out);
    if (r->shape->flip_normals)
        out->n = -out->n;
}

const struct sensor_type sensor_irradiancemeter = {
    .entry = {.name = "irradiancemeter", .help = "irradiance on the shape it stands in, in W/m^2",
              .params = params, .size = sizeof(struct irradiancemeter)},
    .prepare = prepare, .place = place, .own_area = true,
};
