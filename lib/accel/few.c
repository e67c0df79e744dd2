// SPDX-License-Identifier: Apache-2.0
// A ray o + t d passes the directed line from a to b on the side of the sign of
//
//     d . (a x b) + (b - a) . (o x d)
//
// the permuted inner product of the two lines' Pluecker coordinates, and meets a triangle when it
// passes all three edges on the same side. Two triangles that share an edge compute the same number
// up to its sign, so nothing slips through between them; zero counts as a hit of both. The three
// numbers are the barycentric weights of the corners opposite, up to a factor (Shevtsov, Soupikov,
// Kapustin 2007; Jones 2000).
#include "accel/few.h"

#include "accel/placed_quadric.h"
#include "base/mem.h"
#include "scene/quadric.h"

// Where a tree is faster for bounces: measured with tests/bench/packets.
enum { MOST_TRIANGLES = 100, MOST_QUADRICS = 8 };

struct few_triangle {
    float edge[3][3], moment[3][3]; // of the edge opposite corner k: b - a, a x b
    float normal[3];                // largest component 1
    float corner[3];
};

struct few_id {
    uint32_t shape, primitive;
};

struct few_quadric {
    struct placed_quadric placed;
    float centre[3], radius; // of a sphere that holds it
};

struct few {
    struct few_triangle *triangles;
    struct few_id *ids; // of the triangles, then the quadrics
    struct few_quadric *quadrics;
    uint32_t triangle_count, quadric_count;
};

// In double: a difference of products of positions would lose the digits of short edges.
static void cross_double(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static void set_triangle(struct few_triangle *t, const struct mesh *m, const uint32_t index[3]) {
    double p[3][3], e[3][3], n[3];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            p[k][i] = m->positions[index[k]][i];
    for (int k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        double moment[3];
        cross_double(a, b, moment);
        for (int i = 0; i < 3; i++) {
            e[k][i] = b[i] - a[i];
            t->edge[k][i] = (float)e[k][i];
            t->moment[k][i] = (float)moment[i];
        }
    }
    cross_double(e[0], e[1], n);
    const double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    for (int i = 0; i < 3; i++) {
        t->normal[i] = most > 0 ? (float)(n[i] / most) : 0;
        t->corner[i] = (float)p[0][i];
    }
}

static double column_length(const double m[4][4], int c) {
    return sqrt(m[0][c] * m[0][c] + m[1][c] * m[1][c] + m[2][c] * m[2][c]);
}

// Whether no direction is stretched by more than the longest column.
static bool keeps_angles(const double m[4][4]) {
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3;
        const double d = m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b];
        if (fabs(d) > 1e-5 * column_length(m, a) * column_length(m, b))
            return false;
    }
    return true;
}

static bool fits(const struct scene *s, struct few *f) {
    uint64_t triangles = 0, quadrics = 0;
    for (uint32_t i = 0; i < s->shape_count; i++) {
        if (s->shapes[i].kind == SHAPE_MESH)
            triangles += s->shapes[i].mesh.triangle_count;
        else
            quadrics++;
    }
    f->triangle_count = (uint32_t)triangles;
    f->quadric_count = (uint32_t)quadrics;
    return triangles <= MOST_TRIANGLES && quadrics <= MOST_QUADRICS && s->instance_count == 0 &&
           s->group_count == 0;
}

// A sphere's own, or one around the box that the columns span.
static void set_bounds(struct few_quadric *q) {
    const double(*m)[4] = q->placed.to_world.m;
    double lo[3], hi[3], middle[3], centre[3], sum = 0, longest = 0;
    quadric_bounds(q->placed.kind, lo, hi);
    for (int c = 0; c < 3; c++) {
        middle[c] = 0.5 * (lo[c] + hi[c]);
        const double l = (hi[c] - middle[c]) * column_length(m, c);
        sum += l;
        longest = fmax(longest, l);
    }
    transform_point(&q->placed.to_world, middle, centre);
    for (int i = 0; i < 3; i++)
        q->centre[i] = (float)centre[i];
    q->radius =
        1.0001f * (float)(q->placed.kind == SHAPE_SPHERE && keeps_angles(m) ? longest : sum);
}

static void add_shape(struct few *f, const struct scene *s, uint32_t shape, uint32_t *triangle,
                      uint32_t *quadric) {
    const struct mesh *m = &s->shapes[shape].mesh;
    if (s->shapes[shape].kind != SHAPE_MESH) {
        struct few_quadric *q = &f->quadrics[*quadric];
        placed_quadric_init(&q->placed, s, shape);
        set_bounds(q);
        f->ids[f->triangle_count + (*quadric)++] = (struct few_id){shape, 0};
        return;
    }
    for (uint32_t k = 0; k < m->triangle_count; k++) {
        set_triangle(&f->triangles[*triangle], m, m->indices[k]);
        f->ids[(*triangle)++] = (struct few_id){shape, k};
    }
}

struct few *few_create(const struct scene *scene) {
    struct few sizes, *f;
    if (!fits(scene, &sizes))
        return NULL;
    f = mem_array(1, sizeof *f);
    *f = sizes;
    f->triangles = mem_array(f->triangle_count, sizeof *f->triangles);
    f->quadrics = mem_array(f->quadric_count, sizeof *f->quadrics);
    f->ids = mem_array((size_t)f->triangle_count + f->quadric_count, sizeof *f->ids);
    uint32_t triangle = 0, quadric = 0;
    for (uint32_t i = 0; i < scene->shape_count; i++)
        add_shape(f, scene, i, &triangle, &quadric);
    return f;
}

void few_destroy(struct few *f) {
    if (!f)
        return;
    mem_free(f->triangles);
    mem_free(f->quadrics);
    mem_free(f->ids);
    mem_free(f);
}

// ---- queries ----------------------------------------------------------------------------------

static wide dot_with(const float a[3], struct wide3 b) {
    return a[0] * b.x + a[1] * b.y + a[2] * b.z;
}

// On which side of the edge opposite corner k the rays pass, times the area they span.
static wide side(const struct few_triangle *t, int k, struct wide3 d, struct wide3 o_cross_d) {
    return dot_with(t->moment[k], d) + dot_with(t->edge[k], o_cross_d);
}

// Weights of the corners, not normalised, their sum, and whether the whole line meets the triangle.
// The signs at a corner can contradict each other by rounding; what they lack is tolerated, as a
// share of the triangle.
static wide_mask line_meets(const struct few_triangle *t, struct wide3 d, struct wide3 o_cross_d,
                            wide weights[3], wide *all) {
    const float tolerated = 0x1p-21f;
    for (int k = 0; k < 3; k++)
        weights[k] = side(t, k, d, o_cross_d);
    *all = weights[0] + weights[1] + weights[2];
    const wide slack = tolerated * wide_abs(*all);
    const wide least = wide_min(weights[0], wide_min(weights[1], weights[2]));
    const wide most = wide_max(weights[0], wide_max(weights[1], weights[2]));
    return (least >= -slack) | (most <= slack);
}

static wide plane_distance(const struct few_triangle *t, const struct accel_rays *r) {
    const struct wide3 to_corner = {t->corner[0] - r->o.x, t->corner[1] - r->o.y,
                                    t->corner[2] - r->o.z};
    return dot_with(t->normal, to_corner) / dot_with(t->normal, r->d);
}

// Lanes whose ray may meet the quadric before tmax: none that does is left out.
static uint32_t come_near(const struct few_quadric *q, const struct accel_rays *r, wide tmax) {
    const struct wide3 to = {q->centre[0] - r->o.x, q->centre[1] - r->o.y, q->centre[2] - r->o.z};
    const wide d2 = wide_dot(r->d, r->d), t = wide_dot(to, r->d) / d2;
    const struct wide3 off = {to.x - t * r->d.x, to.y - t * r->d.y, to.z - t * r->d.z};
    const wide radius = q->radius + 1e-6f * wide_sqrt(wide_dot(to, to));
    const wide half = radius / wide_sqrt(d2) + 1e-6f * wide_abs(t);
    return wide_bits((wide_dot(off, off) <= radius * radius) & (t + half >= r->tmin) &
                     (t - half <= tmax));
}

static bool quadric_hit(const struct few_quadric *q, const struct accel_rays *r, int i, float tmax,
                        double *t) {
    const double o[3] = {(double)r->o.x[i], (double)r->o.y[i], (double)r->o.z[i]};
    const double d[3] = {(double)r->d.x[i], (double)r->d.y[i], (double)r->d.z[i]};
    return placed_quadric_hit(&q->placed, o, d, (double)r->tmin[i], (double)tmax, t);
}

static void intersect_quadrics(const struct few *f, const struct accel_rays *r, wide *best,
                               wide_int *found, struct accel_hits *h) {
    for (uint32_t k = 0; k < f->quadric_count; k++) {
        const uint32_t near = come_near(&f->quadrics[k], r, *best);
        for (int i = 0; i < WIDE_LANES; i++) {
            double t;
            if (near >> i & 1 && quadric_hit(&f->quadrics[k], r, i, (*best)[i], &t)) {
                (*best)[i] = (float)t;
                (*found)[i] = (int32_t)(f->triangle_count + k);
                h->u[i] = h->v[i] = 0;
            }
        }
    }
}

static void name_hits(const struct few *f, wide_int found, struct accel_hits *h) {
    for (int i = 0; i < WIDE_LANES; i++) {
        const int32_t k = found[i];
        h->shape[i] = k < 0 ? SCENE_NONE : f->ids[k].shape;
        h->primitive[i] = k < 0 ? SCENE_NONE : f->ids[k].primitive;
    }
}

void few_intersect(const struct few *f, const struct accel_rays *r, struct accel_hits *h) {
    const struct wide3 d = r->d, o_cross_d = wide_cross(r->o, d);
    wide best = r->tmax, u = {0}, v = {0}, all = wide_of(1);
    wide_int found = wide_int_of(-1);
    for (uint32_t k = 0; k < f->triangle_count; k++) {
        wide w[3], sum;
        const wide_mask meets = line_meets(&f->triangles[k], d, o_cross_d, w, &sum);
        if (!wide_any(meets))
            continue;
        const wide t = plane_distance(&f->triangles[k], r);
        const wide_mask hit = meets & (t > r->tmin) & (t < best);
        if (!wide_any(hit))
            continue;
        best = wide_select(hit, t, best);
        u = wide_select(hit, w[1], u);
        v = wide_select(hit, w[2], v);
        all = wide_select(hit, sum, all);
        found = wide_int_select(hit, wide_int_of((int32_t)k), found);
    }
    all = wide_select(all != 0, all, wide_of(1)); // of a triangle without area
    h->u = u / all;
    h->v = v / all;
    if (f->quadric_count)
        intersect_quadrics(f, r, &best, &found, h);
    h->t = best;
    name_hits(f, found, h);
}

uint32_t few_occluded(const struct few *f, const struct accel_rays *r) {
    const struct wide3 d = r->d, o_cross_d = wide_cross(r->o, d);
    const uint32_t live = wide_bits(r->tmin < r->tmax);
    uint32_t blocked = 0;
    for (uint32_t k = 0; k < f->triangle_count && blocked != live; k++) {
        wide w[3], sum;
        const wide_mask meets = line_meets(&f->triangles[k], d, o_cross_d, w, &sum);
        if (!wide_any(meets))
            continue;
        const wide t = plane_distance(&f->triangles[k], r);
        blocked |= wide_bits(meets & (t > r->tmin) & (t < r->tmax));
    }
    for (uint32_t k = 0; k < f->quadric_count && blocked != live; k++) {
        const uint32_t near = come_near(&f->quadrics[k], r, r->tmax) & ~blocked;
        for (int i = 0; i < WIDE_LANES; i++) {
            double t;
            if (near >> i & 1 && quadric_hit(&f->quadrics[k], r, i, r->tmax[i], &t))
                blocked |= 1u << i;
        }
    }
    return blocked;
}
