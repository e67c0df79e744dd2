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

#include "accel/few_box.h"
#include "accel/few_facet.h"
#include "accel/few_sphere.h"
#include "base/mem.h"
#include "scene/quadric.h"

// Where a tree is faster for bounces: measured with tests/bench/packets.
enum { MOST_TRIANGLES = 100, MOST_QUADRICS = 8 };

enum { LEAST_IN_BOX = 4 }; // facets

struct few_quadric {
    struct placed_quadric placed;
    float centre[3], radius; // of a sphere that holds it
    bool is_sphere;          // for few_sphere_hits
};

struct few {
    struct few_facet *facets;
    struct few_quadric *quadrics;
    struct few_box *boxes;   // over all facets, in order
    uint32_t facet_count, quadric_count, box_count;
};

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

// Around the facets from `first` on.
static void add_box(struct few *f, const struct mesh *m, uint32_t first) {
    struct few_box *b = &f->boxes[f->box_count++];
    *b = (struct few_box){.first = first, .count = f->facet_count - first,
                          .lo = {INFINITY, INFINITY, INFINITY},
                          .hi = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 9; k++) {
            const float x = m->positions[m->indices[t][k / 3]][k % 3];
            b->lo[k % 3] = minf(x, b->lo[k % 3]);
            b->hi[k % 3] = maxf(x, b->hi[k % 3]);
            b->extent = maxf(fabsf(x), b->extent);
        }
}

static void add_shape(struct few *f, const struct scene *s, uint32_t shape) {
    if (s->shapes[shape].kind == SHAPE_MESH) {
        const struct mesh *m = &s->shapes[shape].mesh;
        const uint32_t first = f->facet_count;
        f->facet_count += few_facets_of(m, shape, f->facets + first);
        add_box(f, m, first);
        return;
    }
    struct few_quadric *q = &f->quadrics[f->quadric_count++];
    placed_quadric_init(&q->placed, s, shape);
    q->is_sphere = few_sphere_is_one(&q->placed);
    set_bounds(q);
}

struct few *few_create(const struct scene *s) {
    uint64_t triangles = 0, quadrics = 0;
    for (uint32_t i = 0; i < s->shape_count; i++) {
        if (s->shapes[i].kind == SHAPE_MESH)
            triangles += s->shapes[i].mesh.triangle_count;
        else
            quadrics++;
    }
    if (triangles > MOST_TRIANGLES || quadrics > MOST_QUADRICS || s->instance_count > 0 ||
        s->group_count > 0)
        return NULL;
    struct few *f = mem_array(1, sizeof *f);
    f->facets = mem_array(triangles, sizeof *f->facets);
    f->boxes = mem_array(s->shape_count, sizeof *f->boxes);
    f->quadrics = mem_array(quadrics, sizeof *f->quadrics);
    for (uint32_t i = 0; i < s->shape_count; i++)
        add_shape(f, s, i);
    return f;
}

struct few *few_create_of(const struct few_facet *facets, uint32_t count) {
    if (!count)
        return NULL;
    struct few *f = mem_array(1, sizeof *f);
    f->facets = mem_array(count, sizeof *f->facets);
    f->boxes = mem_array(count, sizeof *f->boxes);
    for (uint32_t i = 0; i < count; i++) {
        f->facets[i] = facets[i];
        f->boxes[i] = (struct few_box){.first = i, .count = 1};
    }
    f->facet_count = f->box_count = count;
    return f;
}

void few_destroy(struct few *f) {
    if (!f)
        return;
    mem_free(f->facets);
    mem_free(f->boxes);
    mem_free(f->quadrics);
    mem_free(f);
}

// ---- queries ----------------------------------------------------------------------------------

static wide dot_with(const float a[3], struct wide3 b) {
    return a[0] * b.x + a[1] * b.y + a[2] * b.z;
}

// On which side of an edge the rays pass, times the area they span.
static wide side(const struct few_facet *f, int k, struct wide3 d, struct wide3 o_cross_d) {
    return dot_with(f->moment[k], d) + dot_with(f->edge[k], o_cross_d);
}

// Whether the whole line meets the facet; the sides of its edges. Signs at a corner can contradict
// each other by rounding; what they lack is tolerated, as a share of the facet.
static wide_mask line_meets(const struct few_facet *f, struct wide3 d, struct wide3 o_cross_d,
                            wide sides[4]) {
    const float tolerated = 0x1p-21f;
    for (int k = 0; k < 3; k++)
        sides[k] = side(f, k, d, o_cross_d);
    wide least = wide_min(sides[0], wide_min(sides[1], sides[2]));
    wide most = wide_max(sides[0], wide_max(sides[1], sides[2]));
    wide all = sides[0] + sides[1] + sides[2];
    sides[3] = all;
    if (f->count == 2) {
        sides[3] = side(f, 3, d, o_cross_d);
        least = wide_min(least, sides[3]);
        most = wide_max(most, sides[3]);
        all += sides[3];
    }
    const wide slack = tolerated * wide_abs(all);
    return wide_either(least >= -slack, most <= slack);
}

// Where the rays meet the facet's plane, and which do so between tmin and tmax: t is distance over
// speed; speed is not negative.
static wide_mask meet_plane(const struct few_facet *f, const struct accel_rays *r, wide tmax,
                            wide *distance, wide *speed) {
    const struct wide3 to_corner = {f->corner[0] - r->o.x, f->corner[1] - r->o.y,
                                    f->corner[2] - r->o.z};
    const wide along = dot_with(f->normal, r->d);
    *distance = wide_negate(along < 0, dot_with(f->normal, to_corner));
    *speed = wide_abs(along);
    return wide_both(*distance > r->tmin * *speed, *distance < tmax * *speed);
}

// Lanes whose ray may meet the quadric before tmax: none that does is left out.
static uint32_t come_near(const struct few_quadric *q, const struct accel_rays *r, wide tmax) {
    const struct wide3 to = {q->centre[0] - r->o.x, q->centre[1] - r->o.y, q->centre[2] - r->o.z};
    const wide d2 = wide_dot(r->d, r->d), t = wide_dot(to, r->d) / d2;
    const struct wide3 off = {to.x - t * r->d.x, to.y - t * r->d.y, to.z - t * r->d.z};
    const wide radius = q->radius + 1e-6f * wide_sqrt(wide_dot(to, to));
    const wide half = radius / wide_sqrt(d2) + 1e-6f * wide_abs(t);
    const wide_mask within = wide_both(t + half >= r->tmin, t - half <= tmax);
    return wide_bits(wide_both(wide_dot(off, off) <= radius * radius, within));
}

// Of those lanes, the ones that meet it before tmax, and where.
static uint32_t quadric_hits(const struct few_quadric *q, const struct accel_rays *r, uint32_t near,
                             wide tmax, wide *t) {
    if (q->is_sphere)
        return near & few_sphere_hits(&q->placed, r, tmax, t);
    uint32_t hits = 0;
    for (; near; near &= near - 1) {
        const int i = __builtin_ctz(near);
        const double o[3] = {(double)r->o.x[i], (double)r->o.y[i], (double)r->o.z[i]};
        const double d[3] = {(double)r->d.x[i], (double)r->d.y[i], (double)r->d.z[i]};
        double found;
        if (!placed_quadric_hit(&q->placed, o, d, (double)r->tmin[i], (double)tmax[i], &found))
            continue;
        (*t)[i] = (float)found;
        hits |= 1u << i;
    }
    return hits;
}

static void intersect_quadrics(const struct few *f, const struct accel_rays *r, wide *best,
                               wide_int *found, struct accel_hits *h) {
    for (uint32_t k = 0; k < f->quadric_count; k++) {
        const uint32_t near = come_near(&f->quadrics[k], r, *best);
        wide t = *best;
        if (!near)
            continue;
        const wide_mask hit = wide_mask_of(quadric_hits(&f->quadrics[k], r, near, *best, &t));
        const wide_int index = wide_int_of((int32_t)(f->facet_count + k));
        *best = wide_select(hit, t, *best);
        *found = wide_int_select(hit, index, *found);
        h->u = wide_select(hit, wide_of(0), h->u);
        h->v = wide_select(hit, wide_of(0), h->v);
    }
}

// What is found so far.
struct found {
    wide t, u, v, all; // u, v: weights of vertices 1 and 2, over `all`
    wide_int facet;    // or quadric, after the facets; negative: none
    wide_mask second;  // of the facet's triangles
};

// The weights of a triangle's vertices 1 and 2 from those of its corners, q0 first.
static void set_weights(wide_mask hit, const wide corners[3], uint32_t first, struct found *b) {
    b->u = wide_select(hit, corners[(4 - first) % 3], b->u);
    b->v = wide_select(hit, corners[(5 - first) % 3], b->v);
    b->all = wide_select(hit, corners[0] + corners[1] + corners[2], b->all);
}

// A corner's weight is the side of the edge opposite.
static void set_hit(const struct few_facet *f, wide_mask hit, const struct accel_rays *r,
                    struct wide3 o_cross_d, const wide sides[4], struct found *b) {
    if (f->count == 1) {
        set_weights(hit, (const wide[3]){sides[1], sides[2], sides[0]}, f->first[0], b);
        b->second &= ~hit; // of a quadrilateral behind it
        return;
    }
    const wide diagonal = side(f, FACET_DIAGONAL, r->d, o_cross_d);
    const wide_mask back = sides[0] + sides[1] + sides[2] + sides[3] < 0;
    const wide_mask second = wide_whole(wide_negate(back, diagonal) > 0);
    set_weights(hit & ~second, (const wide[3]){sides[1], -diagonal, sides[0]}, f->first[0], b);
    set_weights(hit & second, (const wide[3]){sides[2], sides[3], diagonal}, f->first[1], b);
    b->second = (second & hit) | (b->second & ~hit);
}

static void name_hits(const struct few *f, const struct found *b, struct accel_hits *h) {
    uint32_t shape[WIDE_LANES], primitive[WIDE_LANES]; // a vector would be written anew by each lane
    for (int i = 0; i < WIDE_LANES; i++) {
        const int32_t k = b->facet[i];
        shape[i] = SCENE_NONE;
        primitive[i] = k < 0 ? SCENE_NONE : 0;
        if (k >= 0 && (uint32_t)k < f->facet_count) {
            shape[i] = f->facets[k].shape;
            primitive[i] = f->facets[k].primitive[b->second[i] & 1];
        } else if (k >= 0) {
            shape[i] = f->quadrics[(uint32_t)k - f->facet_count].placed.shape;
        }
    }
    memcpy(&h->shape, shape, sizeof shape);
    memcpy(&h->primitive, primitive, sizeof primitive);
}

static void intersect_facets(const struct few *f, const struct few_box *box,
                             const struct accel_rays *r, struct wide3 o_cross_d,
                             struct found *b) {
    for (uint32_t k = box->first; k < box->first + box->count; k++) {
        const struct few_facet *facet = &f->facets[k];
        wide sides[4], distance, speed;
        const wide_mask reached = meet_plane(facet, r, b->t, &distance, &speed);
        if (!wide_any(reached))
            continue;
        const wide_mask hit = reached & line_meets(facet, r->d, o_cross_d, sides);
        if (!wide_any(hit))
            continue;
        b->t = wide_select(hit, distance / speed, b->t);
        b->facet = wide_int_select(hit, wide_int_of((int32_t)k), b->facet);
        set_hit(facet, hit, r, o_cross_d, sides, b);
    }
}

// Whether to look into a box: with few facets in it that takes longer than they do.
static bool look_into(const struct few_box *box, const struct accel_rays *r,
                      const struct few_slabs *slabs, wide tmax) {
    return box->count < LEAST_IN_BOX || few_box_is_met(box, r, slabs, tmax);
}

void few_intersect(const struct few *f, const struct accel_rays *r, struct accel_hits *h) {
    const struct wide3 o_cross_d = wide_cross(r->o, r->d);
    const struct few_slabs slabs = few_slabs_of(r);
    struct found b = {.t = r->tmax, .all = wide_of(1), .facet = wide_int_of(-1)};
    for (uint32_t k = 0; k < f->box_count; k++)
        if (look_into(&f->boxes[k], r, &slabs, b.t))
            intersect_facets(f, &f->boxes[k], r, o_cross_d, &b);
    const wide all = wide_select(b.all != 0, b.all, wide_of(1)); // of a triangle without area
    h->u = b.u / all;
    h->v = b.v / all;
    if (f->quadric_count)
        intersect_quadrics(f, r, &b.t, &b.facet, h);
    h->t = b.t;
    name_hits(f, &b, h);
}

static uint32_t facets_block(const struct few *f, const struct few_box *box,
                             const struct accel_rays *r, struct wide3 o_cross_d) {
    uint32_t blocked = 0;
    for (uint32_t k = box->first; k < box->first + box->count; k++) {
        wide sides[4], distance, speed;
        const wide_mask reached = meet_plane(&f->facets[k], r, r->tmax, &distance, &speed);
        if (wide_any(reached))
            blocked |= wide_bits(reached & line_meets(&f->facets[k], r->d, o_cross_d, sides));
    }
    return blocked;
}

uint32_t few_occluded(const struct few *f, const struct accel_rays *r) {
    const struct wide3 o_cross_d = wide_cross(r->o, r->d);
    const struct few_slabs slabs = few_slabs_of(r);
    const uint32_t live = wide_bits(r->tmin < r->tmax);
    uint32_t blocked = 0;
    for (uint32_t k = 0; k < f->box_count && blocked != live; k++)
        if (look_into(&f->boxes[k], r, &slabs, r->tmax))
            blocked |= facets_block(f, &f->boxes[k], r, o_cross_d);
    for (uint32_t k = 0; k < f->quadric_count && blocked != live; k++) {
        const uint32_t near = come_near(&f->quadrics[k], r, r->tmax) & ~blocked;
        wide t = r->tmax;
        if (near)
            blocked |= quadric_hits(&f->quadrics[k], r, near, r->tmax, &t);
    }
    return blocked;
}
