// SPDX-License-Identifier: Apache-2.0
// Irradiance on the texels of a mesh: a light map by its texture coordinates.
//
// Pixel (x, y) of W x H gathers over the part of the mesh whose (u, v) lies in
// [x, x + 1) / W x [y, y + 1) / H, so that the picture can be looked up as a bitmap: row 0 is at
// v = 0. Points of a texel that lie beside the mesh count as the nearest of the mesh in that texel,
// so that the borders of charts are not darkened; texels without mesh are 0. Irradiance is that of
// the interpolated normals, where there are any.
#include "sensor/sensor.h"

struct texels {
    // made by prepare
    int width, height;
    const struct shape *shape;
    uint32_t *first, *triangles; // by texel: first[i] up to first[i + 1] of triangles
};

static const struct param params[] = {
    {"srf", PARAM_IGNORED, .unit = "", .help = "spectra are colours here"},
    PARAM_END,
};

// Corners of a triangle in texels.
static void corners(const struct texels *t, uint32_t triangle, double c[3][2]) {
    const struct mesh *m = &t->shape->mesh;
    for (int i = 0; i < 3; i++) {
        const float *uv = m->uvs[m->indices[triangle][i]];
        c[i][0] = (double)uv[0] * t->width;
        c[i][1] = (double)uv[1] * t->height;
    }
}

static double side(const double a[2], const double b[2], double x, double y) {
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

// Whether the triangle lies wholly beyond one of its own edges' lines as seen from texel (x, y).
static bool is_apart(double c[3][2], int x, int y) {
    const double turn = side(c[0], c[1], c[2][0], c[2][1]) < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        const double *a = c[i], *b = c[(i + 1) % 3];
        double most = -1;
        for (int k = 0; k < 4; k++)
            most = fmax(most, turn * side(a, b, x + k % 2, y + k / 2));
        if (most < 0)
            return true;
    }
    return false;
}

struct range {
    int x0, y0, x1, y1; // texels, the last included; empty: x1 < x0
};

static struct range texels_of(const struct texels *t, double c[3][2]) {
    const double x0 = fmin(c[0][0], fmin(c[1][0], c[2][0]));
    const double y0 = fmin(c[0][1], fmin(c[1][1], c[2][1]));
    const double x1 = fmax(c[0][0], fmax(c[1][0], c[2][0]));
    const double y1 = fmax(c[0][1], fmax(c[1][1], c[2][1]));
    if (!(x0 < t->width && y0 < t->height && x1 >= 0 && y1 >= 0))
        return (struct range){0, 0, -1, -1};
    return (struct range){(int)fmax(x0, 0), (int)fmax(y0, 0), (int)fmin(x1, t->width - 1),
                          (int)fmin(y1, t->height - 1)};
}

// Counts the triangles of each texel, or, once there is room, lists them.
static void sort_triangles(struct texels *t, uint32_t *next) {
    for (uint32_t i = 0; i < t->shape->mesh.triangle_count; i++) {
        double c[3][2];
        corners(t, i, c);
        const struct range r = texels_of(t, c);
        for (int y = r.y0; y <= r.y1; y++)
            for (int x = r.x0; x <= r.x1; x++) {
                const size_t texel = (size_t)y * (size_t)t->width + (size_t)x;
                if (is_apart(c, x, y))
                    continue;
                if (next)
                    t->triangles[next[texel]++] = i;
                else
                    t->first[texel + 1]++;
            }
    }
}

static bool prepare(struct object *self, const struct sensor_scene *scene) {
    struct texels *t = self->data;
    const size_t count = (size_t)scene->width * (size_t)scene->height;
    *t = (struct texels){.width = scene->width, .height = scene->height, .shape = scene->shape};
    if (!t->shape || t->shape->group != SCENE_NONE || t->shape->kind != SHAPE_MESH ||
        !t->shape->mesh.uvs) {
        log_error_at(self->at, "texels: stands in no mesh of the scene that has texture coordinates");
        return false;
    }
    t->first = arena_alloc(scene->arena, (count + 1) * sizeof *t->first);
    sort_triangles(t, NULL);
    for (size_t i = 0; i < count; i++)
        t->first[i + 1] += t->first[i];
    t->triangles = arena_alloc(scene->arena, ((size_t)t->first[count] + 1) * sizeof *t->triangles);
    uint32_t *next = mem_array(count, sizeof *next);
    for (size_t i = 0; i < count; i++)
        next[i] = t->first[i];
    sort_triangles(t, next);
    mem_free(next);
    if (t->first[count] == 0)
        log_error_at(self->at, "texels: no triangle has texture coordinates in the unit square");
    return t->first[count] > 0;
}

// ---- places -------------------------------------------------------------------------------------

// The point of a triangle that is nearest to (x, y): weights of vertices 1 and 2. Returns the squared
// distance in texels.
static double nearest(double c[3][2], double x, double y, double b[2]) {
    const double area = side(c[0], c[1], c[2][0], c[2][1]);
    double best = INFINITY;
    if (area != 0) {
        b[0] = side(c[2], c[0], x, y) / area;
        b[1] = side(c[0], c[1], x, y) / area;
        if (b[0] >= 0 && b[1] >= 0 && b[0] + b[1] <= 1)
            return 0;
    }
    for (int i = 0; i < 3; i++) {
        const double *p = c[i], *q = c[(i + 1) % 3];
        const double d[2] = {q[0] - p[0], q[1] - p[1]}, l2 = d[0] * d[0] + d[1] * d[1];
        const double along = l2 > 0 ? ((x - p[0]) * d[0] + (y - p[1]) * d[1]) / l2 : 0;
        const double s = fmin(fmax(along, 0), 1);
        const double dx = p[0] + s * d[0] - x, dy = p[1] + s * d[1] - y, d2 = dx * dx + dy * dy;
        if (d2 >= best)
            continue;
        best = d2;
        b[0] = i == 0 ? s : i == 1 ? 1 - s : 0;
        b[1] = i == 1 ? s : i == 2 ? 1 - s : 0;
    }
    return best;
}

static void place_at(const struct shape *shape, uint32_t triangle, float b1, float b2,
                     struct sensor_place *out) {
    const struct mesh *m = &shape->mesh;
    const uint32_t *v = m->indices[triangle];
    const vec3 p0 = v3_load(m->positions[v[0]]), p1 = v3_load(m->positions[v[1]]),
               p2 = v3_load(m->positions[v[2]]);
    const float b0 = 1 - b1 - b2;
    vec3 n = cross(p1 - p0, p2 - p0);
    if (m->normals)
        n = b0 * v3_load(m->normals[v[0]]) + b1 * v3_load(m->normals[v[1]]) +
            b2 * v3_load(m->normals[v[2]]);
    if (!(length2(n) > 0)) // a triangle without area receives nothing
        return;
    *out = (struct sensor_place){b0 * p0 + b1 * p1 + b2 * p2,
                                 triangle_error(b0 * p0, b1 * p1, b2 * p2, p1 - p0, p2 - p0),
                                 shape->flip_normals ? -normalize(n) : normalize(n), 1};
}

static void place(const void *data, float x, float y, struct sensor_place *out) {
    const struct texels *t = data;
    const int column = (int)clampf(x, 0, (float)t->width - 1);
    const int row = (int)clampf(y, 0, (float)t->height - 1);
    const size_t texel = (size_t)row * (size_t)t->width + (size_t)column;
    double best = INFINITY, weights[2] = {0, 0}; // of vertices 1 and 2
    uint32_t found = SCENE_NONE;
    for (uint32_t i = t->first[texel]; i < t->first[texel + 1] && best > 0; i++) {
        double c[3][2], b[2] = {0, 0};
        corners(t, t->triangles[i], c);
        const double d2 = nearest(c, (double)x, (double)y, b);
        if (d2 < best) {
            best = d2;
            found = t->triangles[i];
            weights[0] = b[0];
            weights[1] = b[1];
        }
    }
    *out = (struct sensor_place){.n = {0, 0, 1}};
    if (found != SCENE_NONE)
        place_at(t->shape, found, (float)weights[0], (float)weights[1], out);
}

const struct sensor_type sensor_texels = {
    .entry = {.name = "texels", .help = "irradiance on the texels of the mesh it stands in: a light map",
              .params = params, .size = sizeof(struct texels)},
    .prepare = prepare, .place = place, .own_area = true,
};
