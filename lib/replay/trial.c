// SPDX-License-Identifier: Apache-2.0
#include "replay/trial.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "replay/edit_weights.h"

static const double ALBEDO = 0.5, BROAD = 8;

const char *const trial_names[TRIALS] = {"as it is", "dull", "broad", "sharp"};

// ---- keeping ------------------------------------------------------------------------------------

// Copies all numbers that a trial changes, out of the objects or back.
static void copy_numbers(struct edit_tensor *e, double *at, bool back) {
    for (uint32_t i = 0; i < e->object_count; i++) {
        struct edited_object *o = &e->objects[i];
        for (uint32_t c = 0; c < o->form.curves; c++) {
            const size_t n = (size_t)CURVE_CHANNELS * o->curve[c]->basis.count;
            memcpy(back ? o->curve[c]->values : at, back ? at : o->curve[c]->values, n * sizeof *at);
            at += n;
        }
        for (uint32_t t = 0; t < o->form.terms; t++, at += CURVE_CHANNELS)
            memcpy(back ? o->form.term[t].scale : at, back ? at : o->form.term[t].scale,
                   CURVE_CHANNELS * sizeof *at);
    }
}

static size_t count_numbers(const struct edit_tensor *e) {
    size_t n = 0;
    for (uint32_t i = 0; i < e->object_count; i++) {
        const struct edited_object *o = &e->objects[i];
        n += (size_t)CURVE_CHANNELS * o->form.terms;
        for (uint32_t c = 0; c < o->form.curves; c++)
            n += (size_t)CURVE_CHANNELS * o->curve[c]->basis.count;
    }
    return n;
}

// ---- changing -----------------------------------------------------------------------------------

static void set_lobe(struct curve *c, int trial) {
    const uint32_t n = c->basis.count;
    const double exponent = trial == 1 ? 0 : trial == 2 ? BROAD : basis_exponent(&c->basis);
    for (uint32_t j = 0; j < n; j++) {
        const double lo = c->basis.knots[j], hi = c->basis.kind == BASIS_BOX ? c->basis.knots[j + 1] : lo;
        const double value = pow(fmax(cos(0.5 * (lo + hi)), 0), exponent);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            c->values[k * n + j] = value;
    }
}

// Brings the albedo to a half; objects that tell none keep their factors.
static void set_albedo(struct edit_tensor *e, uint32_t object) {
    struct edited_object *o = &e->objects[object];
    const struct edited_member own = {object, {1, 1, 1}};
    const struct edited_factor all = {1, &own, .term = EDIT_NOTHING};
    double albedo[CURVE_CHANNELS];
    for (uint32_t t = 0; t < o->form.terms; t++)
        if (!o->albedo[t])
            return;
    edit_factor_value(e, &all, albedo);
    for (uint32_t t = 0; t < o->form.terms; t++)
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            o->form.term[t].scale[k] *= albedo[k] > 0 ? ALBEDO / albedo[k] : 1;
}

void trial_apply(struct edit_tensor *e, int trial, struct trial_memory *m) {
    m->values = arena_alloc(&m->arena, (count_numbers(e) + 1) * sizeof *m->values);
    copy_numbers(e, m->values, false);
    for (uint32_t i = 0; i < e->object_count && trial > 0; i++) {
        struct edited_object *o = &e->objects[i];
        for (uint32_t t = 0; t < o->form.terms; t++)
            for (int s = SLOT_A; s <= SLOT_B; s++)
                if (edit_has_slot(&o->form.term[t], (enum form_slot_name)s))
                    set_lobe(o->curve[o->form.term[t].slots[s].curve], trial);
        set_albedo(e, i);
    }
}

void trial_restore(struct edit_tensor *e, struct trial_memory *m) {
    copy_numbers(e, m->values, true);
    arena_finish(&m->arena);
}

// ---- weights ------------------------------------------------------------------------------------

float **trial_weights(const struct edit_tensor *e, struct arena *arena) {
    const struct tensor *t = e->tensor;
    double(*factors)[CURVE_CHANNELS] = mem_array(e->factor_count, sizeof *factors);
    double(*groups)[CURVE_CHANNELS] = mem_array(e->group_count, sizeof *groups);
    float **weights = arena_alloc(arena, (t->block_count + 1) * sizeof *weights);
    for (uint32_t i = 0; i < e->factor_count; i++)
        edit_factor_value(e, &e->factors[i], factors[i]);
    for (uint32_t g = 0; g < e->group_count; g++)
        edit_group_value(&e->groups[g], (const double(*)[CURVE_CHANNELS])factors, NULL, groups[g]);
    for (uint32_t i = 0; i < t->block_count; i++) {
        const size_t n = CURVE_CHANNELS * (size_t)t->blocks[i].coefficients;
        float *out = arena_alloc(arena, n * sizeof *out), scale[CURVE_CHANNELS];
        double *exact = mem_array(n, sizeof *exact);
        edit_weights(e, i, (const double(*)[CURVE_CHANNELS])groups, t->blocks[i].groups,
                     EDIT_ALL_AXES, exact);
        edit_scale(e, i, scale);
        for (size_t k = 0; k < n; k++)
            out[k] = (float)exact[k] * scale[k % CURVE_CHANNELS];
        weights[i] = out;
        mem_free(exact);
    }
    mem_free(factors);
    mem_free(groups);
    return weights;
}
