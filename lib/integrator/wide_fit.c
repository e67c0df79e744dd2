// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_fit.h"

// A part is off by what of it lies between a bent line and a straight one. In units of the tolerance
// of shares: bend of gamma, relative to its range, up to which four parts will do.
static const float MOST_COARSE = 12;

// Where gamma is no quadratic any more: near the pole of an angle.
static const float MOST_BEND = 0.12f;

// Corners of the coarse parts.
static const int parts[FIT_COARSE][3] = {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}};

// Barycentric coordinates of corners 1 and 2 at the corners of the fine parts.
static const float b1[3][FIT_FINE] = {
    {0, 0.5, 0, 0.25, 1, 0.5, 0.5, 0.75, 0, 0, 0.5, 0, 0.5, 0.5, 0, 0.5},
    {0.25, 0.25, 0, 0.25, 0.75, 0.5, 0.75, 0.5, 0, 0.25, 0.25, 0.25, 0.5, 0.25, 0.25, 0.25},
    {0, 0.25, 0.25, 0, 0.75, 0.75, 0.5, 0.75, 0.25, 0, 0.25, 0.25, 0.25, 0.5, 0.25, 0.25},
};
static const float b2[3][FIT_FINE] = {
    {0, 0, 0.5, 0, 0, 0.5, 0, 0.25, 1, 0.5, 0.5, 0.75, 0, 0.5, 0.5, 0.25},
    {0, 0.25, 0.25, 0.25, 0.25, 0.25, 0, 0.25, 0.75, 0.5, 0.75, 0.5, 0.25, 0.5, 0.25, 0.5},
    {0.25, 0, 0.25, 0.25, 0, 0.25, 0.25, 0, 0.75, 0.75, 0.5, 0.75, 0.25, 0.25, 0.5, 0.25},
};

// Nodes halfway between which the corners of the fine parts lie.
static const int one[3][FIT_FINE] = {
    {0, 3, 5, 0, 1, 4, 3, 1, 2, 5, 4, 2, 3, 4, 5, 3},
    {0, 3, 5, 3, 1, 4, 3, 4, 2, 5, 4, 5, 3, 4, 5, 4},
    {5, 0, 3, 5, 3, 1, 4, 3, 4, 2, 5, 4, 5, 3, 4, 5},
};
static const int other[3][FIT_FINE] = {
    {0, 3, 5, 3, 1, 4, 3, 4, 2, 5, 4, 5, 3, 4, 5, 4},
    {3, 5, 0, 5, 4, 3, 1, 3, 5, 4, 2, 4, 4, 5, 3, 5},
    {0, 3, 5, 0, 1, 4, 3, 1, 2, 5, 4, 2, 3, 4, 5, 3},
};

struct course {
    wide least, most, bend, shift;
};

static struct course course_of(const wide g[OVERLAP_NODES]) {
    struct course c = {g[0], g[0], wide_of(0), wide_of(0)};
    for (int i = 1; i < OVERLAP_NODES; i++) {
        c.least = wide_min(c.least, g[i]);
        c.most = wide_max(c.most, g[i]);
    }
    for (int i = 0; i < 3; i++) {
        const wide bend = g[3 + i] - 0.5f * (g[i] + g[(i + 1) % 3]);
        c.bend = wide_max(c.bend, wide_abs(bend));
        c.shift += bend * (1.0f / 3);
    }
    return c;
}

static void intervals_of(const struct wide_axis *a, wide gamma, uint32_t out[WIDE_LANES]) {
    const int32_t last = (int32_t)basis_intervals(&a->axis->basis) - 1;
    const wide place = wide_min(wide_max(gamma, wide_of(0)) * a->per_step, wide_of((float)last));
    const wide_int i = __builtin_convertvector(place, wide_int);
    for (int k = 0; k < WIDE_LANES; k++)
        out[k] = a->per_step > 0 ? (uint32_t)i[k] : overlap_interval(a->axis, (double)gamma[k]);
}

static void find_functions(struct wide_fit *f, const struct wide_axis *a, const struct course *c) {
    const wide low = c->least - 0.5f * c->bend, high = c->most + 0.5f * c->bend;
    uint32_t last[WIDE_LANES], single = 0;
    f->straddles = wide_bits(c->least < 0);
    intervals_of(a, low, f->first);
    intervals_of(a, wide_select(c->least < 0, wide_max(high, -low), high), last);
    for (uint32_t i = 0; i < WIDE_LANES; i++) {
        if (f->straddles >> i & 1)
            f->first[i] = 0;
        f->count[i] = last[i] - f->first[i] + 1 + a->hat;
        single |= (uint32_t)(f->count[i] == 1 && high[i] <= a->end) << i;
    }
    f->finer &= ~single;
    f->splits &= ~single;
    f->far &= ~single;
}

void wide_fit_make(struct wide_fit *f, const struct wide_axis *a, const wide gamma[OVERLAP_NODES],
                   const wide part[FIT_COARSE], wide tolerance) {
    const wide_mask down = gamma[0] + gamma[1] + gamma[2] < 0;
    wide g[OVERLAP_NODES];
    for (int i = 0; i < OVERLAP_NODES; i++) {
        f->gamma[i] = gamma[i];
        g[i] = wide_negate(down, gamma[i]); // most of it is positive
    }
    f->turned = wide_bits(down);
    const struct course c = course_of(g);
    const wide range = wide_max(c.most - c.least, wide_of(a->hat ? a->step : 0));
    const wide quadratic = wide_sqrt(tolerance) * range;
    f->finer = wide_bits(c.bend > MOST_COARSE * tolerance * range);
    f->far = wide_bits(c.bend > MOST_BEND * range);
    f->splits = wide_bits(c.bend > quadratic);
    find_functions(f, a, &c);
    for (int k = 0; k < FIT_COARSE; k++) {
        struct part *to[WIDE_LANES];
        for (int i = 0; i < WIDE_LANES; i++)
            to[i] = &f->part[i][k];
        parts_store(a, g[parts[k][0]] + 0.25f * c.shift, g[parts[k][1]] + 0.25f * c.shift,
                    g[parts[k][2]] + 0.25f * c.shift, part[k], to);
    }
}

// The quadratic through the nodes at the corners of the fine parts from `first` on.
static void bent_corners(const float g[OVERLAP_NODES], float shift, int first, wide out[3]) {
    const float c3 = 2 * (g[1] + g[0]) - 4 * g[3], c5 = 2 * (g[2] + g[0]) - 4 * g[5];
    const float c1 = g[1] - g[0] - c3, c2 = g[2] - g[0] - c5;
    const float c4 = 4 * (g[4] - g[0] - 0.5f * (c1 + c2)) - c3 - c5;
    for (int i = 0; i < 3; i++) {
        const wide x = wide_load(b1[i] + first), y = wide_load(b2[i] + first);
        out[i] = g[0] + x * (c1 + c3 * x + c4 * y) + y * (c2 + c5 * y) + shift * 0.0625f;
    }
}

static void straight_corners(const float g[OVERLAP_NODES], float shift, int first, wide out[3]) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < WIDE_LANES; k++)
            out[i][k] = 0.5f * (g[one[i][first + k]] + g[other[i][first + k]]) + shift * 0.25f;
}

void wide_fit_fine(const struct wide_fit *f, const struct wide_axis *a, uint32_t lane,
                   const float weight[FIT_FINE], bool straight, struct part out[FIT_FINE]) {
    float g[OVERLAP_NODES], shift = 0;
    for (int i = 0; i < OVERLAP_NODES; i++)
        g[i] = f->turned >> lane & 1 ? -f->gamma[i][lane] : f->gamma[i][lane];
    for (int i = 0; i < 3; i++)
        shift += (g[3 + i] - 0.5f * (g[i] + g[(i + 1) % 3])) * (1.0f / 3);
    for (int first = 0; first < FIT_FINE; first += WIDE_LANES) {
        struct part *to[WIDE_LANES];
        wide corner[3];
        if (straight)
            straight_corners(g, shift, first, corner);
        else
            bent_corners(g, shift, first, corner);
        for (int i = 0; i < WIDE_LANES; i++)
            to[i] = &out[first + i];
        parts_store(a, corner[0], corner[1], corner[2], wide_load(weight + first), to);
    }
}
