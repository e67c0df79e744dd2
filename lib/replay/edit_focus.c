// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_focus.h"

#include <string.h>

#include "base/file.h"
#include "base/mem.h"

// ---- powers -------------------------------------------------------------------------------------

static bool same_group(const struct edited_group *a, const struct edited_group *b) {
    return a->count == b->count &&
           (a->count == 0 || memcmp(a->factors, b->factors, a->count * sizeof *a->factors) == 0);
}

// The active factors of a group, ascending.
static struct edited_group active_part(const struct edit_focus *f, const struct edited_group *g,
                                     uint32_t *out) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < g->count; i++) {
        if (!f->active[g->factors[i]])
            continue;
        uint32_t at = n++;
        for (; at > 0 && out[at - 1] > g->factors[i]; at--)
            out[at] = out[at - 1];
        out[at] = g->factors[i];
    }
    return (struct edited_group){n, out};
}

// Powers by the hash of their factors.
struct power_table {
    uint32_t *slot; // power + 1; 0: free
    size_t mask;
};

static uint32_t find_power(struct edit_focus *f, struct power_table *t, const struct edited_group *g) {
    size_t at = file_hash(g->factors, g->count * sizeof *g->factors, 0) & t->mask;
    for (; t->slot[at]; at = (at + 1) & t->mask)
        if (same_group(&f->powers[t->slot[at] - 1], g))
            return t->slot[at] - 1;
    uint32_t *own = arena_alloc(&f->arena, (g->count + 1) * sizeof *own);
    memcpy(own, g->factors, g->count * sizeof *own);
    f->powers[f->power_count++] = (struct edited_group){g->count, own};
    t->slot[at] = f->power_count;
    return f->power_count - 1;
}

void edit_focus_init(struct edit_focus *f, const struct edit_tensor *e,
                     const struct focus_curve *curves, uint32_t count) {
    struct power_table table = {.mask = 1};
    while (table.mask < 2 * (size_t)e->group_count)
        table.mask = 2 * table.mask + 1;
    table.slot = mem_array(table.mask + 1, sizeof *table.slot);
    *f = (struct edit_focus){.curve_count = count};
    memcpy(f->curves, curves, count * sizeof *curves);
    f->active = arena_alloc(&f->arena, (e->factor_count + 1) * sizeof *f->active);
    f->powers = arena_alloc(&f->arena, e->group_count * sizeof *f->powers);
    f->power_of = arena_alloc(&f->arena, e->group_count * sizeof *f->power_of);
    for (uint32_t i = 0; i < e->factor_count; i++)
        for (uint32_t k = 0; k < count; k++)
            f->active[i] |= edit_factor_has(&e->factors[i], curves[k].object);
    for (uint32_t g = 0; g < e->group_count; g++) {
        uint32_t scratch[EDITED_MOST_POWER + 1];
        const struct edited_group part = active_part(f, &e->groups[g], scratch);
        f->power_of[g] = find_power(f, &table, &part);
    }
    mem_free(table.slot);
}

void edit_focus_finish(struct edit_focus *f) {
    arena_finish(&f->arena);
    *f = (struct edit_focus){0};
}

bool focus_has(const struct focus_curve *curves, uint32_t count, struct focus_curve c) {
    for (uint32_t k = 0; k < count; k++)
        if (curves[k].object == c.object && (curves[k].curve == c.curve || c.curve == EDIT_NOTHING))
            return true;
    return false;
}

// ---- blocks -------------------------------------------------------------------------------------

unsigned edit_focus_axes(const struct edit_focus *f, const struct edit_tensor *e, uint32_t block) {
    unsigned axes = 0;
    for (uint32_t k = 0; k < f->curve_count; k++)
        for (uint32_t i = 0; i < e->tensor->blocks[block].axis_count; i++)
            axes |= (unsigned)(e->blocks[block].object == f->curves[k].object &&
                               edit_axis_curve(e, block, i) == f->curves[k].curve) << i;
    return axes;
}

// Bins of an axis where it is in the set; else 1.
static uint32_t bins_in(const struct tensor_block *b, uint32_t axis, unsigned axes) {
    return axis < b->axis_count && axes >> axis & 1 ? b->axes[axis].bins : 1;
}

uint32_t edit_focus_coefficients(const struct edit_focus *f, const struct edit_tensor *e,
                                 uint32_t block) {
    const struct tensor_block *b = &e->tensor->blocks[block];
    const unsigned axes = edit_focus_axes(f, e, block);
    return f->power_count * bins_in(b, 0, axes) * bins_in(b, 1, axes);
}

// Where each coefficient goes.
static void find_targets(const struct edit_focus *f, const struct tensor_block *b, unsigned axes,
                         uint32_t *target) {
    const uint32_t rows = bins_in(b, 0, EDIT_ALL_AXES), columns = bins_in(b, 1, EDIT_ALL_AXES);
    const uint32_t kept_rows = bins_in(b, 0, axes), kept_columns = bins_in(b, 1, axes);
    for (uint32_t g = 0; g < b->groups; g++)
        for (uint32_t i = 0; i < rows; i++)
            for (uint32_t j = 0; j < columns; j++)
                *target++ = (f->power_of[g] * kept_rows + (axes & 1 ? i : 0)) * kept_columns +
                            (axes & 2 ? j : 0);
}

// What each coefficient is multiplied by: frozen factors and the axes that go.
static double *find_weights(const struct edit_focus *f, const struct edit_tensor *e, uint32_t block,
                            const double (*values)[CURVE_CHANNELS], unsigned axes) {
    const struct tensor_block *b = &e->tensor->blocks[block];
    const uint32_t rows = bins_in(b, 0, EDIT_ALL_AXES), columns = bins_in(b, 1, EDIT_ALL_AXES);
    const uint32_t gone_rows = bins_in(b, 0, ~axes), gone_columns = bins_in(b, 1, ~axes);
    double(*groups)[CURVE_CHANNELS] = mem_array(b->groups, sizeof *groups);
    bool *frozen = mem_array(e->factor_count, sizeof *frozen);
    double *part = mem_array((size_t)b->groups * gone_rows * gone_columns * 3, sizeof *part);
    double *all = mem_array((size_t)b->coefficients * 3, sizeof *all), *out = all;
    for (uint32_t i = 0; i < e->factor_count; i++)
        frozen[i] = !f->active[i];
    for (uint32_t g = 0; g < b->groups; g++)
        edit_group_value(&e->groups[g], values, frozen, groups[g]);
    edit_weights(e, block, (const double(*)[CURVE_CHANNELS])groups, b->groups,
                 ~axes & EDIT_ALL_AXES, part);
    for (uint32_t g = 0; g < b->groups; g++)
        for (uint32_t i = 0; i < rows; i++)
            for (uint32_t j = 0; j < columns; j++, out += 3)
                memcpy(out, part + 3 * (((size_t)g * gone_rows + (axes & 1 ? 0 : i)) * gone_columns +
                                        (axes & 2 ? 0 : j)), 3 * sizeof *out);
    mem_free(groups);
    mem_free(frozen);
    mem_free(part);
    return all;
}

struct contraction edit_focus_contraction(const struct edit_focus *f, const struct edit_tensor *e,
                                          uint32_t block, const double (*values)[CURVE_CHANNELS],
                                          struct arena *arena) {
    const struct tensor_block *b = &e->tensor->blocks[block];
    const unsigned axes = edit_focus_axes(f, e, block);
    uint32_t *target = mem_array(b->coefficients, sizeof *target);
    double *weights = find_weights(f, e, block, values, axes);
    find_targets(f, b, axes, target);
    const struct contraction c =
        contraction_of(b->storage, b->coefficients, edit_focus_coefficients(f, e, block), target,
                       weights, arena);
    mem_free(target);
    mem_free(weights);
    return c;
}
