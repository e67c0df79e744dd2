// SPDX-License-Identifier: Apache-2.0
// Importance sampling of any filter by its own table.
//
// |f| is replaced by straight lines between nodes that are dense enough (and stand at all zeros of
// f), and those lines are sampled exactly: the densities differ by less than 1e-3 where |f| is above
// a tenth of its peak (measured by the filter test: 5e-5 up to three lobes, 2e-4 for eight), and by
// as little in absolute terms elsewhere. Filters are even, so the table covers [0, radius] and the
// sign of x comes from the number too: inside the main lobe x grows steadily with u, which keeps
// stratified numbers stratified.
#include <assert.h>
#include <float.h>

#include "filter/filter.h"

enum { CELLS = 1024, GUIDE = 2048 };

struct cell {
    float cdf; // where it begins
    float left, width;
    float f0, f1; // |f| at its ends
};

// The part of the half-axis on which f has one sign.
struct lobe {
    double mass; // integral of |f| over the part
    int count;
    struct cell cells[CELLS + 1];
    uint16_t guide[GUIDE + 1]; // first cell that may hold u = i / GUIDE
};

struct filter_table {
    float positive_share; // of the integral of |f|
    float weight;         // (integral |f| / integral f), to be squared with the other axis' sign
    struct lobe lobes[2]; // positive, negative
};

static void lobe_add(struct lobe *l, double x0, double x1, double f0, double f1) {
    if (!(x1 > x0) || !(f0 + f1 > 0))
        return;
    assert(l->count < CELLS);
    l->cells[l->count++] = (struct cell){.left = (float)x0, .width = (float)(x1 - x0),
                                         .f0 = (float)f0, .f1 = (float)f1};
    l->mass += 0.5 * (f0 + f1) * (x1 - x0);
}

static void lobe_finish(struct lobe *l) {
    double sum = 0;
    for (int i = 0; i < l->count; i++) {
        const struct cell *c = &l->cells[i];
        sum += 0.5 * ((double)c->f0 + (double)c->f1) * (double)c->width;
        l->cells[i + 1].cdf = (float)fmin(sum / l->mass, 1);
    }
    l->cells[l->count].cdf = 1;
    for (int i = 0, g = 0; g <= GUIDE; g++) {
        while (i + 1 < l->count && l->cells[i + 1].cdf * GUIDE <= (float)g)
            i++;
        l->guide[g] = (uint16_t)i;
    }
}

static void table_add_cell(struct filter_table *t, double x0, double x1, double f0, double f1) {
    if (f0 * f1 >= 0) {
        lobe_add(&t->lobes[f0 + f1 < 0], x0, x1, fabs(f0), fabs(f1));
        return;
    }
    const double zero = x0 + (x1 - x0) * f0 / (f0 - f1);
    lobe_add(&t->lobes[f0 < 0], x0, zero, fabs(f0), 0);
    lobe_add(&t->lobes[f1 < 0], zero, x1, 0, fabs(f1));
}

// Each lobe gets at most one cell of every step, so CELLS are enough.
static struct filter_table *table_create(const struct object *filter, double radius) {
    const struct filter_type *type = (const struct filter_type *)filter->type;
    struct filter_table *t = mem_array(1, sizeof *t);
    double x0 = 0, f0 = type->eval(filter->data, 0);
    for (int i = 1; i <= CELLS; i++) {
        const double x1 = radius * i / CELLS;
        const double f1 = i < CELLS ? type->eval(filter->data, (float)x1) : 0;
        table_add_cell(t, x0, x1, f0, f1);
        x0 = x1;
        f0 = f1;
    }
    const double positive = t->lobes[0].mass, negative = t->lobes[1].mass;
    t->positive_share = (float)(positive / (positive + negative));
    t->weight = (float)((positive + negative) / (positive - negative));
    lobe_finish(&t->lobes[0]);
    lobe_finish(&t->lobes[1]);
    return t;
}

const struct filter_sampler filter_sampler_box = {.radius = 0.5f};

bool filter_sampler_init(struct filter_sampler *s, struct object *filter) {
    const struct filter_type *type = (const struct filter_type *)filter->type;
    *s = (struct filter_sampler){0};
    if (!type->prepare(filter, &s->radius))
        return false;
    if (type == &filter_box)
        return true;
    s->table = table_create(filter, s->radius);
    if (s->table->lobes[0].mass > 1.01 * s->table->lobes[1].mass)
        return true;
    log_error_at(filter->at, "%s: the filter's integral is not positive, expected one whose "
                 "positive part outweighs the negative", filter->type->name);
    filter_sampler_finish(s);
    return false;
}

void filter_sampler_finish(struct filter_sampler *s) {
    mem_free(s->table);
    *s = (struct filter_sampler){0};
}

// Where a density that runs linearly from f0 to f1 over the unit interval puts u.
static float sample_linear(float u, float f0, float f1) {
    const float root = sqrtf(lerpf(u, f0 * f0, f1 * f1));
    return minf(u * (f0 + f1) / maxf(f0 + root, FLT_MIN), 1);
}

static float lobe_sample(const struct lobe *l, float u) {
    const int g = (int)(u * GUIDE);
    int lo = l->guide[g], hi = l->guide[g + 1] + 1; // cdf of lo <= u < cdf of hi
    while (hi - lo > 1) {
        const int middle = (lo + hi) / 2;
        if (l->cells[middle].cdf <= u)
            lo = middle;
        else
            hi = middle;
    }
    const struct cell *c = &l->cells[lo];
    const float inside = (u - c->cdf) / maxf(c[1].cdf - c->cdf, FLT_MIN);
    return c->left + c->width * sample_linear(minf(inside, 1), c->f0, c->f1);
}

static float table_sample(const struct filter_table *t, float u, float *weight) {
    const bool negative = u >= t->positive_share;
    *weight *= negative ? -t->weight : t->weight;
    u = negative ? (u - t->positive_share) / (1 - t->positive_share) : u / t->positive_share;
    const float side = 2 * minf(u, 0x1.fffffep-1f) - 1;
    return copysignf(lobe_sample(&t->lobes[negative], minf(fabsf(side), 0x1.fffffep-1f)), side);
}

struct vec2 filter_sample(const struct filter_sampler *s, struct vec2 u, float *weight) {
    *weight = 1;
    if (!s->table)
        return (struct vec2){(2 * u.x - 1) * s->radius, (2 * u.y - 1) * s->radius};
    const float x = table_sample(s->table, u.x, weight);
    return (struct vec2){x, table_sample(s->table, u.y, weight)};
}
