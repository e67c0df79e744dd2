// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_split.h"

#include <string.h>

#include "integrator/wide_angles.h"

// ROOM: for all points, and for all parts of the children, in whole vectors.
enum { FURTHER = 9, POINTS = OVERLAP_NODES + FURTHER, ROOM = FIT_COARSE * FIT_COARSE };

// Nodes of a triangle between which those of its children lie, then the children's nodes.
static const int between[FURTHER][2] = {{0, 3}, {3, 1}, {1, 4}, {4, 2}, {2, 5},
                                        {5, 0}, {3, 4}, {4, 5}, {5, 3}};
static const int nodes[FIT_COARSE][OVERLAP_NODES] = {
    {0, 3, 5, 6, 14, 11}, {1, 4, 3, 8, 12, 7}, {2, 5, 4, 10, 13, 9}, {3, 4, 5, 12, 13, 14}};
static const int parts[FIT_COARSE][3] = {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}};

struct patch {
    struct wide_nodes at; // in the first lane
    wide gamma[OVERLAP_NODES];
    float share;
};

void wide_margin_add(struct wide_overlap *o, uint32_t axis, const struct part_run *r) {
    const struct wide_axis *a = &o->axis[axis];
    overlap_touch(&o->scalar, axis, r->first, r->first + r->count);
    float done = 0;
    for (uint32_t at = 0; at < r->count; at += part_step(a)) {
        const wide share = part_shares(a, r, at, &done);
        double *to = o->scalar.margin[axis] + r->first + at;
        for (uint32_t i = 0; i < WIDE_LANES && at + i < r->count; i++)
            to[i] += (double)share[i];
    }
}

static wide length_of(struct wide3 a) {
    return wide_sqrt(wide_dot(a, a));
}

// Points of the children from `first` on: nodes of the triangle, then further ones.
static struct wide3 points_of(const struct patch *t, int first) {
    struct wide3 p = {{0}, {0}, {0}}, q = p;
    for (int i = first; i < POINTS && i < first + WIDE_LANES; i++) {
        const int a = i < OVERLAP_NODES ? i : between[i - OVERLAP_NODES][0];
        const int b = i < OVERLAP_NODES ? i : between[i - OVERLAP_NODES][1];
        wide3_set_lane(&p, i - first, wide3_lane(&t->at.node[a], 0));
        wide3_set_lane(&q, i - first, wide3_lane(&t->at.node[b], 0));
    }
    p = wide3_add(p, q);
    return wide3_scale(1 / wide_max(length_of(p), wide_of(1e-30f)), p);
}

// Twice the area of the children's parts from `first` on, as of plane triangles.
static wide areas_of(const vec3 points[ROOM], int first) {
    struct wide3 corner[3] = {{{0}, {0}, {0}}};
    for (int i = 0; i < WIDE_LANES; i++)
        for (int k = 0; k < 3; k++)
            wide3_set_lane(&corner[k], i, points[nodes[(first + i) / 4][parts[i % 4][k]]]);
    return length_of(wide_cross(wide3_sub(corner[1], corner[0]), wide3_sub(corner[2], corner[0])));
}

static void split(const struct wide_overlap *o, uint32_t axis, const struct patch *t,
                  struct patch child[FIT_COARSE]) {
    const struct direction wo = {o->scalar.wo[0], o->scalar.wo[1], o->scalar.wo[2]};
    vec3 points[ROOM];
    float area[ROOM], gamma[ROOM];
    for (int first = 0; first < ROOM; first += WIDE_LANES) {
        const struct wide3 p = points_of(t, first);
        const wide g = wide_gamma(&o->axis[axis].axis->gamma, wo, &p);
        memcpy(gamma + first, &g, sizeof g);
        for (int i = 0; i < WIDE_LANES; i++)
            points[first + i] = wide3_lane(&p, i);
    }
    for (int first = 0; first < ROOM; first += WIDE_LANES) {
        const wide a = areas_of(points, first);
        memcpy(area + first, &a, sizeof a);
    }
    for (int c = 0; c < FIT_COARSE; c++) {
        const float all = area[4 * c] + area[4 * c + 1] + area[4 * c + 2] + area[4 * c + 3];
        child[c].share = t->share * t->at.part[c][0];
        for (int i = 0; i < FIT_COARSE; i++)
            child[c].at.part[i] = wide_of(all > 0 ? area[4 * c + i] / all : 0.25f);
        for (int i = 0; i < OVERLAP_NODES; i++) {
            const int n = nodes[c][i];
            child[c].at.node[i] = wide3_of(points[n]);
            child[c].gamma[i] = n < OVERLAP_NODES ? t->gamma[n] : wide_of(gamma[n]);
        }
    }
}

static void add_leaf(struct wide_overlap *o, uint32_t axis, const struct patch *t,
                     const struct wide_fit *f) {
    struct part fine[FIT_FINE];
    struct part_run r = {f->part[0], FIT_COARSE, f->first[0], f->count[0], f->straddles & 1};
    if (f->finer & 1) {
        float weight[FIT_FINE];
        for (int i = 0; i < FIT_FINE; i++)
            weight[i] = 0.25f * t->at.part[i / 4][0] * t->share;
        wide_fit_fine(f, &o->axis[axis], 0, weight, false, fine);
        r.part = fine;
        r.parts = FIT_FINE;
    }
    wide_margin_add(o, axis, &r);
}

// A child that is small errs little in all.
static void add_patch(struct wide_overlap *o, uint32_t axis, const struct patch *t, int depth) {
    struct wide_fit f;
    wide weight[FIT_COARSE];
    for (int i = 0; i < FIT_COARSE; i++)
        weight[i] = t->share * t->at.part[i];
    wide_fit_make(&f, &o->axis[axis], t->gamma, weight, wide_of((float)o->scalar.tolerance / t->share));
    if ((f.splits & 1) && depth > 0) {
        struct patch child[FIT_COARSE];
        split(o, axis, t, child);
        for (int i = 0; i < FIT_COARSE; i++)
            add_patch(o, axis, &child[i], depth - 1);
        return;
    }
    add_leaf(o, axis, t, &f);
}

void wide_split_add(struct wide_overlap *o, uint32_t axis, const struct wide_nodes *n, uint32_t lane,
                    const wide gamma[OVERLAP_NODES]) {
    struct patch whole = {.share = 1};
    for (int i = 0; i < OVERLAP_NODES; i++) {
        whole.at.node[i] = wide3_of(wide3_lane(&n->node[i], (int)lane));
        whole.gamma[i] = wide_of(gamma[i][lane]);
    }
    for (int i = 0; i < FIT_COARSE; i++)
        whole.at.part[i] = wide_of(n->part[i][lane]);
    add_patch(o, axis, &whole, o->scalar.depth);
}
