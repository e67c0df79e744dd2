// SPDX-License-Identifier: Apache-2.0
// surface.c for a hit of a triangle a lane, operation by operation.
#include "world/world.h"

// Of each lane's triangle: corner k of an array of vertex positions.
static struct wide3 gather_positions(const struct world_shape *const shapes[WIDE_LANES],
                                     const uint32_t *const indices[WIDE_LANES], int k) {
    const float *row[WIDE_LANES];
    wide v[4];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = shapes[i]->positions[indices[i][k]];
    wide_gather4(row, v);
    return (struct wide3){v[0], v[1], v[2]};
}

// The normal at corner k; zero where a mesh has none. The float behind the last one is read, as
// mem_array allows.
static struct wide3 gather_normals(const struct world_shape *const shapes[WIDE_LANES],
                                   const uint32_t *const indices[WIDE_LANES], int k) {
    static const float none[4] = {0};
    const float *row[WIDE_LANES];
    wide v[4];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = shapes[i]->normals ? shapes[i]->normals[indices[i][k]] : none;
    wide_gather4(row, v);
    return (struct wide3){v[0], v[1], v[2]};
}

void world_surfaces(const struct world *w, const struct accel_hit *const hits[WIDE_LANES],
                    struct surfaces *s) {
    const struct world_shape *shapes[WIDE_LANES];
    const uint32_t *indices[WIDE_LANES];
    const float *row[WIDE_LANES];
    uint32_t flipped = 0, smooth = 0;
    for (int i = 0; i < WIDE_LANES; i++) {
        shapes[i] = &w->shapes[hits[i]->shape];
        indices[i] = shapes[i]->indices[hits[i]->primitive];
        flipped |= (uint32_t)shapes[i]->flip_normals << i;
        smooth |= (uint32_t)(shapes[i]->normals != NULL) << i;
        row[i] = &hits[i]->t;
    }
    wide hit[4]; // t, u, v and what follows
    wide_gather4(row, hit);
    const wide b1 = hit[1], b2 = hit[2], b0 = 1 - b1 - b2;
    const struct wide3 v0 = gather_positions(shapes, indices, 0);
    const struct wide3 v1 = gather_positions(shapes, indices, 1);
    const struct wide3 v2 = gather_positions(shapes, indices, 2);
    const struct wide3 p0 = wide3_scale(b0, v0), p1 = wide3_scale(b1, v1), p2 = wide3_scale(b2, v2);
    const struct wide3 e1 = wide3_sub(v1, v0), e2 = wide3_sub(v2, v0);
    s->p = wide3_add(wide3_add(p0, p1), p2);
    s->p_error = wide_triangle_error(p0, p1, p2, e1, e2);
    s->ng = wide_normalize(wide_cross(e1, e2));
    struct wide3 n = s->ng;
    if (smooth) {
        const struct wide3 n0 = wide3_scale(b0, gather_normals(shapes, indices, 0));
        const struct wide3 n1 = wide3_scale(b1, gather_normals(shapes, indices, 1));
        const struct wide3 n2 = wide3_scale(b2, gather_normals(shapes, indices, 2));
        const struct wide3 ns = wide_normalize(wide3_add(wide3_add(n0, n1), n2));
        n = wide3_select(wide_dot(ns, ns) > 0, ns, n);
    }
    const wide_mask flip = wide_mask_of(flipped);
    s->ng = wide3_negate(flip, s->ng);
    s->frame = wide_frame_from_normal(wide3_negate(flip, n));
}
