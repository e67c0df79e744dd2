// SPDX-License-Identifier: Apache-2.0
#include "medium/majorant.h"

// Part of [*t0, *t1] where lo <= o + t d <= hi; false: none.
static bool clip(float o, float d, float lo, float hi, float *t0, float *t1) {
    if (d == 0)
        return o >= lo && o <= hi;
    const float a = (lo - o) / d, b = (hi - o) / d;
    *t0 = maxf(*t0, minf(a, b));
    *t1 = minf(*t1, maxf(a, b));
    return *t0 < *t1;
}

void majorant_begin(struct majorant_walk *w, const struct medium *m, vec3 o, vec3 d, float end) {
    const struct volume_bounds *b = m->bounds;
    *w = (struct majorant_walk){.m = m, .end = end};
    if (!b)
        return;
    w->o = affine_point(&b->to_local, o);
    w->d = affine_vector(&b->to_local, d);
    for (int k = 0; k < 3; k++)
        w->done |= !clip(w->o[k], w->d[k], 0, (float)b->cells[k], &w->t, &w->end);
    for (int k = 0; k < 3; k++) {
        const float x = w->o[k] + w->t * w->d[k];
        const int i = x > 0 ? (int)minf(x, (float)b->cells[k]) : 0;
        w->cell[k] = i < b->cells[k] ? i : b->cells[k] - 1;
    }
}

// Where the ray leaves the cell, and through which axis.
static float leave_cell(const struct majorant_walk *w, int *axis) {
    float leave = INFINITY;
    *axis = 0;
    for (int k = 0; k < 3; k++) {
        if (w->d[k] == 0)
            continue;
        const float face = (float)(w->cell[k] + (w->d[k] > 0));
        const float t = (face - w->o[k]) / w->d[k];
        if (t < leave) {
            leave = t;
            *axis = k;
        }
    }
    return leave;
}

static spectrum cell_majorant(const struct majorant_walk *w) {
    const struct volume_bounds *b = w->m->bounds;
    const size_t i = ((size_t)w->cell[2] * (size_t)b->cells[1] + (size_t)w->cell[1]) *
                         (size_t)b->cells[0] + (size_t)w->cell[0];
    const float *most = b->most + i * (size_t)b->lanes;
    return w->m->scale * (b->lanes == 1 ? spectrum_grey(most[0])
                                        : spectrum_rgb(most[0], most[1], most[2]));
}

static bool whole_ray(struct majorant_walk *w, struct majorant_piece *piece) {
    *piece = (struct majorant_piece){0, w->end, w->m->most_t};
    const bool first = !w->done;
    w->done = true;
    return first;
}

bool majorant_next(struct majorant_walk *w, struct majorant_piece *piece) {
    if (!w->m->bounds)
        return whole_ray(w, piece);
    if (w->done)
        return false;
    int axis;
    const float leave = leave_cell(w, &axis);
    *piece = (struct majorant_piece){w->t, maxf(w->t, minf(leave, w->end)), cell_majorant(w)};
    w->t = piece->b;
    w->cell[axis] += w->d[axis] > 0 ? 1 : -1;
    w->done = !(leave < w->end) || w->cell[axis] < 0 ||
              w->cell[axis] >= w->m->bounds->cells[axis];
    return true;
}
