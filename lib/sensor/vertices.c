// SPDX-License-Identifier: Apache-2.0
// Irradiance at the vertices of a mesh: vertex i is pixel (i mod W, i / W). Pixels beyond the last
// vertex are 0, and so are vertices of no triangle with area.
#include "sensor/sensor.h"

struct vertices {
    // made by prepare
    int width;
    const struct shape *shape;
    float (*normals)[3]; // unit or zero, to the side that counts
    float error;         // of positions
};

static const struct param params[] = {
    {"srf", PARAM_IGNORED, .unit = "", .help = "spectra are colours here"},
    PARAM_END,
};

// The file's normals, or the sum of the triangles' around a vertex, which weighs them by area.
static void find_normals(struct vertices *r) {
    const struct mesh *m = &r->shape->mesh;
    for (uint32_t i = 0; !m->normals && i < m->triangle_count; i++) {
        const uint32_t *v = m->indices[i];
        const vec3 p = v3_load(m->positions[v[0]]);
        const vec3 n = cross(v3_load(m->positions[v[1]]) - p, v3_load(m->positions[v[2]]) - p);
        for (int k = 0; k < 9; k++)
            r->normals[v[k / 3]][k % 3] += n[k % 3];
    }
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const vec3 sum = v3_load(m->normals ? m->normals[i] : r->normals[i]);
        const float l = (r->shape->flip_normals ? -1.0f : 1.0f) * length(sum);
        for (int k = 0; k < 3; k++)
            r->normals[i][k] = l != 0 ? sum[k] / l : 0;
    }
}

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct vertices *r = self->data;
    *r = (struct vertices){.width = scene->width, .shape = scene->shape};
    if (!r->shape || r->shape->group != SCENE_NONE || r->shape->kind != SHAPE_MESH) {
        log_error_at(self->at, "vertices: stands in no mesh of the scene");
        return false;
    }
    const struct mesh *m = &r->shape->mesh;
    if ((uint64_t)scene->width * (uint64_t)scene->height < m->vertex_count) {
        log_error_at(self->at, "vertices: a picture of %dx%d was found, expected a pixel for each of "
                     "%u vertices", scene->width, scene->height, m->vertex_count);
        return false;
    }
    r->normals = arena_alloc(scene->arena, m->vertex_count * sizeof *r->normals);
    find_normals(r);
    for (uint32_t i = 0; i < m->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            r->error = maxf(r->error, 4 * 0x1p-24f * fabsf(m->positions[i][k]));
    return true;
}

static void place(const void *data, float x, float y, struct sensor_place *out) {
    const struct vertices *r = data;
    const uint64_t i = (uint64_t)maxf(y, 0) * (uint64_t)r->width + (uint64_t)maxf(x, 0);
    *out = (struct sensor_place){.n = {0, 0, 1}};
    if (i >= r->shape->mesh.vertex_count)
        return;
    const vec3 n = v3_load(r->normals[i]);
    if (length2(n) > 0)
        *out = (struct sensor_place){v3_load(r->shape->mesh.positions[i]),
                                     v3(r->error, r->error, r->error), n, 1};
}

const struct sensor_type sensor_vertices = {
    .entry = {.name = "vertices", .help = "irradiance at the vertices of the mesh it stands in",
              .params = params, .size = sizeof(struct vertices)},
    .prepare = prepare, .place = place, .own_area = true,
};
