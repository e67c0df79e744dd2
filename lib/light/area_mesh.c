// SPDX-License-Identifier: Apache-2.0
// Triangles by their area. A single triangle and a rectangle are sampled by solid angle instead
// where they are near, which removes the variance of distance and foreshortening.
#include "light/area_shape.h"

#include <string.h>

#include "light/solid_angle.h"
#include "math/warp.h"
#include "math/wide_maps.h"

static vec3 vertex(const struct mesh *m, uint32_t triangle, uint32_t corner) {
    return v3_load(m->positions[m->indices[triangle][corner % 3]]);
}

// Twice the area times the normal of the winding.
static vec3 winding_cross(const struct mesh *m, uint32_t triangle) {
    const vec3 a = vertex(m, triangle, 0);
    return cross(vertex(m, triangle, 1) - a, vertex(m, triangle, 2) - a);
}

// In double: the squares of small edges leave the range of float.
static double triangle_area(const struct mesh *m, uint32_t triangle) {
    double e[2][3];
    for (int i = 0; i < 3; i++) {
        const float *const p = m->positions[m->indices[triangle][0]];
        e[0][i] = (double)m->positions[m->indices[triangle][1]][i] - p[i];
        e[1][i] = (double)m->positions[m->indices[triangle][2]][i] - p[i];
    }
    const double x = e[0][1] * e[1][2] - e[0][2] * e[1][1];
    const double y = e[0][2] * e[1][0] - e[0][0] * e[1][2];
    const double z = e[0][0] * e[1][1] - e[0][1] * e[1][0];
    return 0.5 * sqrt(x * x + y * y + z * z);
}

// Some files wind a triangle against its vertex normals; light leaves on the side of the normals.
static bool opposes_normals(const struct mesh *m, uint32_t triangle, vec3 n) {
    if (!m->normals)
        return false;
    vec3 sum = v3(0, 0, 0);
    for (int i = 0; i < 3; i++)
        sum += v3_load(m->normals[m->indices[triangle][i]]);
    return dot(sum, n) < 0;
}

// n: of the winding.
static vec3 emitting_side(const struct area_mesh *a, uint32_t triangle, vec3 n) {
    return (a->mixed && opposes_normals(a->mesh, triangle, n)) != a->flip ? -n : n;
}

static vec3 emitting_normal(const struct area_mesh *a, uint32_t triangle) {
    return emitting_side(a, triangle, normalize(winding_cross(a->mesh, triangle)));
}

static bool near_point(vec3 a, vec3 b, float tolerance) {
    return length2(a - b) <= tolerance * tolerance;
}

// Two triangles that share the hypotenuse of a rectangle: first[] gets their right-angled corners.
static bool find_rectangle(struct area_mesh *a) {
    const struct mesh *m = a->mesh;
    for (uint32_t k = 0; k < 3; k++) {
        const vec3 o = vertex(m, 0, k);
        const vec3 x = vertex(m, 0, k + 1) - o, y = vertex(m, 0, k + 2) - o;
        const float tolerance = 1e-6f * (length(x) + length(y));
        if (!(fabsf(dot(normalize(x), normalize(y))) < 1e-6f))
            continue;
        for (uint32_t l = 0; l < 3; l++)
            if (near_point(vertex(m, 1, l), o + x + y, tolerance) &&
                near_point(vertex(m, 1, l + 1), o + y, tolerance) &&
                near_point(vertex(m, 1, l + 2), o + x, tolerance)) {
                a->corner = o, a->edge_x = x, a->edge_y = y;
                a->first[0] = k, a->first[1] = l;
                return true;
            }
    }
    return false;
}

static void init_kind(struct area_mesh *a) {
    const struct mesh *m = a->mesh;
    a->kind = POLYGON_MESH;
    if (m->triangle_count == 1) {
        a->kind = POLYGON_TRIANGLE;
        a->corner = vertex(m, 0, 0);
        a->edge_x = vertex(m, 0, 1) - a->corner;
        a->edge_y = vertex(m, 0, 2) - a->corner;
    } else if (m->triangle_count == 2 && !a->mixed && find_rectangle(a)) {
        a->kind = POLYGON_RECTANGLE;
    }
    a->n = emitting_normal(a, 0);
    if (a->kind != POLYGON_MESH)
        solid_angle_init(a);
}

bool area_mesh_init(struct area_mesh *a, const struct shape *shape) {
    *a = (struct area_mesh){.mesh = &shape->mesh, .flip = shape->flip_normals};
    const uint32_t count = a->mesh->triangle_count;
    float *weights = mem_array(count, sizeof *weights);
    double total = 0, largest = 0;
    for (uint32_t i = 0; i < count; i++) {
        total += triangle_area(a->mesh, i);
        largest = fmax(largest, triangle_area(a->mesh, i));
        a->mixed |= opposes_normals(a->mesh, i, winding_cross(a->mesh, i));
    }
    const bool ok = largest > 0 && (float)total > 0 && (float)(1 / total) < INFINITY;
    if (ok) {
        for (uint32_t i = 0; i < count; i++)
            weights[i] = (float)(triangle_area(a->mesh, i) / largest);
        a->area = (float)total;
        a->inv_area = (float)(1 / total);
        init_kind(a);
        if (a->kind == POLYGON_MESH)
            alias_init(&a->by_area, weights, count);
    }
    mem_free(weights);
    return ok;
}

void area_mesh_finish(struct area_mesh *a) {
    alias_finish(&a->by_area);
}

static void fill_texture_point(const struct mesh *m, uint32_t triangle, struct vec2 b,
                               struct texture_point *at) {
    *at = (struct texture_point){b, m, triangle, b};
    if (!m->uvs)
        return;
    const float *const t0 = m->uvs[m->indices[triangle][0]], *const t1 = m->uvs[m->indices[triangle][1]],
                *const t2 = m->uvs[m->indices[triangle][2]];
    const float b0 = 1 - b.x - b.y;
    at->uv.x = b0 * t0[0] + b.x * t1[0] + b.y * t2[0];
    at->uv.y = b0 * t0[1] + b.x * t1[1] + b.y * t2[1];
}

// From its corners.
static void place_between(const struct area_mesh *a, uint32_t triangle, const vec3 v[3],
                          struct vec2 b, struct light_sample *s, struct texture_point *at) {
    const vec3 p0 = (1 - b.x - b.y) * v[0], p1 = b.x * v[1], p2 = b.y * v[2];
    const vec3 e1 = v[1] - v[0], e2 = v[2] - v[0];
    s->p = p0 + p1 + p2;
    s->p_error = triangle_error(p0, p1, p2, e1, e2);
    s->n = a->kind == POLYGON_MESH ? emitting_side(a, triangle, normalize(cross(e1, e2))) : a->n;
    if (at)
        fill_texture_point(a->mesh, triangle, b, at);
}

static void place_on_triangle(const struct area_mesh *a, uint32_t triangle, struct vec2 b,
                              struct light_sample *s, struct texture_point *at) {
    const vec3 v[3] = {vertex(a->mesh, triangle, 0), vertex(a->mesh, triangle, 1),
                       vertex(a->mesh, triangle, 2)};
    place_between(a, triangle, v, b, s, at);
}

// (x, y) in [0,1]^2 of the rectangle as a point of one of its triangles.
static void place_on_rectangle(const struct area_mesh *a, struct vec2 xy, struct light_sample *s,
                               struct texture_point *at) {
    const uint32_t triangle = xy.x + xy.y > 1;
    float b[3];
    b[(a->first[triangle] + 1) % 3] = triangle ? 1 - xy.x : xy.x;
    b[(a->first[triangle] + 2) % 3] = triangle ? 1 - xy.y : xy.y;
    b[a->first[triangle]] = triangle ? xy.x + xy.y - 1 : 1 - xy.x - xy.y;
    place_on_triangle(a, triangle, (struct vec2){b[1], b[2]}, s, at);
}

bool area_mesh_sample(const struct area_mesh *a, vec3 p, struct vec2 u, struct light_sample *s,
                      struct texture_point *at) {
    struct vec2 xy;
    float solid_angle = 0;
    switch (a->kind) {
    case POLYGON_RECTANGLE:
        xy = u;
        if (solid_angle_pays(a, p))
            solid_angle = solid_angle_sample_rectangle(a, p, u, &xy);
        place_on_rectangle(a, xy, s, at);
        break;
    case POLYGON_TRIANGLE:
        xy = warp_triangle(u);
        if (solid_angle_pays(a, p))
            solid_angle = solid_angle_sample_triangle(a, p, u, &xy);
        place_on_triangle(a, 0, xy, s, at);
        break;
    case POLYGON_MESH: {
        float pmf;
        const uint32_t triangle = alias_sample(&a->by_area, u.x, &pmf, &u.x);
        if (!(pmf > 0))
            return false;
        place_on_triangle(a, triangle, warp_triangle(u), s, at);
    }
    }
    if (!area_finish_sample(p, a->inv_area, s))
        return false;
    if (solid_angle > 0)
        s->pdf_sa = 1 / solid_angle;
    return true;
}

// ---- a lit point a lane: the operations above, lane by lane

// Corner k of the rectangle's first or, where the mask is set, second triangle.
static struct wide3 corner_wide(const struct area_mesh *a, wide_mask second, uint32_t k) {
    return wide3_select(second, wide3_of(vertex(a->mesh, 1, k)), wide3_of(vertex(a->mesh, 0, k)));
}

static void place_wide(const struct area_mesh *a, wide x, wide y, struct light_samples *s) {
    const wide_mask second = x + y > 1;
    const wide at_x = wide_select(second, 1 - x, x), at_y = wide_select(second, 1 - y, y);
    const wide rest = wide_select(second, x + y - 1, 1 - x - y);
    wide b[2][3]; // of each triangle
    for (int t = 0; t < 2; t++) {
        b[t][a->first[t]] = rest;
        b[t][(a->first[t] + 1) % 3] = at_x;
        b[t][(a->first[t] + 2) % 3] = at_y;
    }
    const wide b1 = wide_select(second, b[1][1], b[0][1]), b2 = wide_select(second, b[1][2], b[0][2]);
    const struct wide3 v0 = corner_wide(a, second, 0), v1 = corner_wide(a, second, 1),
                       v2 = corner_wide(a, second, 2);
    const struct wide3 p0 = wide3_scale(1 - b1 - b2, v0), p1 = wide3_scale(b1, v1),
                       p2 = wide3_scale(b2, v2);
    s->p = wide3_add(wide3_add(p0, p1), p2);
    s->p_error = wide_triangle_error(p0, p1, p2, wide3_sub(v1, v0), wide3_sub(v2, v0));
    s->n = wide3_of(a->n);
}

wide_mask area_rectangle_sample_wide(const struct area_mesh *a, const struct wide3 *p,
                                     const wide u[2], struct light_samples *s) {
    float x[WIDE_LANES], y[WIDE_LANES], angles[WIDE_LANES] = {0}; // set lane by lane
    const struct wide3 from_middle = wide3_sub(*p, wide3_of(a->middle));
    const struct wide3 from_corner = wide3_sub(*p, wide3_of(a->corner));
    uint32_t near = wide_bits((wide_dot(from_middle, from_middle) < 5 * a->area) &
                              (wide_dot(from_corner, wide3_of(a->n)) > a->least_height));
    memcpy(x, &u[0], sizeof x);
    memcpy(y, &u[1], sizeof y);
    for (; near; near &= near - 1) {
        const int i = __builtin_ctz(near);
        struct vec2 xy = {x[i], y[i]};
        angles[i] = solid_angle_sample_rectangle(a, wide3_lane(p, i), xy, &xy);
        x[i] = xy.x;
        y[i] = xy.y;
    }
    place_wide(a, wide_load(x), wide_load(y), s);
    const struct wide3 d = wide3_sub(s->p, *p);
    const wide solid_angle = wide_load(angles);
    s->distance = wide_sqrt(wide_dot(d, d));
    s->wi = wide_normalize(d);
    const wide cosine = -wide_dot(s->wi, s->n);
    const wide by_area = a->inv_area * s->distance * s->distance / cosine;
    const wide_mask lit = wide_both(cosine > 0, wide_both(by_area < INFINITY, by_area > 0));
    s->pdf_sa = wide_select(solid_angle > 0, 1 / solid_angle, by_area);
    return lit;
}

float area_mesh_pdf_sa(const struct area_mesh *a, vec3 p, const struct light_hit *hit) {
    if (a->kind != POLYGON_MESH && solid_angle_pays(a, p)) {
        const float solid_angle = a->kind == POLYGON_RECTANGLE ? solid_angle_of_rectangle(a, p)
                                                               : solid_angle_of_triangle(a, p);
        if (solid_angle > 0)
            return 1 / solid_angle;
    }
    return area_to_solid_angle(a->inv_area, hit->distance, fabsf(dot(hit->ng, hit->wi)));
}

bool area_mesh_faces(const struct area_mesh *a, const struct light_hit *hit) {
    const bool front = dot(hit->ng, hit->wi) < 0;
    if (!a->mixed)
        return front;
    const vec3 n = normalize(winding_cross(a->mesh, hit->at.triangle));
    return front != opposes_normals(a->mesh, hit->at.triangle, n);
}

void area_mesh_place_at(const struct area_mesh *a, struct vec2 xy, struct light_sample *s,
                        struct texture_point *at) {
    place_on_rectangle(a, xy, s, at);
}

struct vec2 area_mesh_xy(const struct area_mesh *a, const struct texture_point *at) {
    const float b[3] = {1 - at->barycentric.x - at->barycentric.y, at->barycentric.x,
                        at->barycentric.y};
    const uint32_t k = a->first[at->triangle];
    const float x = b[(k + 1) % 3], y = b[(k + 2) % 3];
    return at->triangle ? (struct vec2){1 - x, 1 - y} : (struct vec2){x, y};
}

// ---- single triangles, for the light tree

uint32_t area_mesh_parts(const struct area_mesh *a) {
    return a->kind == POLYGON_MESH ? a->mesh->triangle_count : 1;
}

void area_mesh_place(const struct area_mesh *a, uint32_t triangle, struct vec2 b,
                     struct texture_point *at) {
    fill_texture_point(a->mesh, triangle, b, at);
}

void area_mesh_part_shape(const struct area_mesh *a, uint32_t triangle, struct light_leaf *leaf) {
    leaf->inv_area = (float)(1 / triangle_area(a->mesh, triangle));
    for (int k = 0; k < 3; k++)
        memcpy(leaf->corner[k], a->mesh->positions[a->mesh->indices[triangle][k]],
               sizeof leaf->corner[k]);
}

bool area_mesh_part_sample(const struct area_mesh *a, uint32_t triangle,
                           const struct light_leaf *leaf, vec3 p, struct vec2 u,
                           struct light_sample *s, struct texture_point *at) {
    const vec3 v[3] = {v3_load(leaf->corner[0]), v3_load(leaf->corner[1]), v3_load(leaf->corner[2])};
    place_between(a, triangle, v, warp_triangle(u), s, at);
    return area_finish_sample(p, leaf->inv_area, s);
}

void area_mesh_bounds(const struct area_mesh *a, uint32_t part, struct light_bounds *b) {
    const uint32_t end = a->kind == POLYGON_MESH ? part + 1 : a->mesh->triangle_count;
    double area = 0;
    *b = (struct light_bounds){.min = vertex(a->mesh, part, 0), .max = vertex(a->mesh, part, 0),
                               .axis = emitting_normal(a, part), .cos_o = 1};
    for (uint32_t i = part; i < end; i++) {
        area += triangle_area(a->mesh, i);
        for (uint32_t k = 0; k < 3; k++) {
            const vec3 v = vertex(a->mesh, i, k);
            b->min = v3(minf(b->min[0], v[0]), minf(b->min[1], v[1]), minf(b->min[2], v[2]));
            b->max = v3(maxf(b->max[0], v[0]), maxf(b->max[1], v[1]), maxf(b->max[2], v[2]));
        }
    }
    b->intensity = length2(b->axis) > 0 ? (float)area : 0;
}

bool area_finish_sample(vec3 p, float pdf_area, struct light_sample *s) {
    const vec3 d = s->p - p;
    s->distance = length(d);
    s->wi = normalize(d);
    s->pdf_sa = area_to_solid_angle(pdf_area, s->distance, -dot(s->wi, s->n));
    return s->pdf_sa > 0;
}
