// SPDX-License-Identifier: Apache-2.0
#include "curve/form.h"

#include <assert.h>
#include <string.h>

const char *const slot_names[] = {"f_o", "f_A", "f_B", NULL};

void form_term_eval(const struct form *f, const struct form_term *t, struct angles *a,
                    double out[CURVE_CHANNELS]) {
    quotient_cos(&t->quotient, a, out);
    for (int s = 0; s < SLOTS; s++) {
        const struct form_slot *slot = &t->slots[s];
        if (slot->gamma.kind == GAMMA_NONE)
            continue;
        const double gamma = gamma_at(&slot->gamma, a);
        for (int k = 0; k < CURVE_CHANNELS; k++)
            out[k] *= function_value(&f->curve[slot->curve].f[k], gamma);
    }
}

void form_eval(const struct form *f, const double wo[3], const double wi[3],
               double out[CURVE_CHANNELS]) {
    struct angles a = angles_make(wo, wi);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        out[k] = 0;
    for (uint32_t t = 0; t < f->terms && a.cos_i > 0 && a.cos_o > 0; t++) {
        double v[CURVE_CHANNELS];
        form_term_eval(f, &f->term[t], &a, v);
        for (int k = 0; k < CURVE_CHANNELS; k++)
            out[k] += f->term[t].scale[k] * v[k];
    }
}

// ---- building -------------------------------------------------------------------------------

struct form_term *form_add_term(struct form *f, const char *name, enum quotient_kind quotient,
                                const double colour[CURVE_CHANNELS], double factor) {
    assert(f->terms < FORM_TERMS);
    struct form_term *t = &f->term[f->terms++];
    *t = (struct form_term){.name = name, .quotient = {.kind = quotient}};
    for (int k = 0; k < CURVE_CHANNELS; k++)
        t->scale[k] = colour[k] * factor;
    return t;
}

struct form_slot form_add_curve_rgb(struct form *f, const char *name, enum gamma_kind gamma,
                                    enum function_kind kind, const double p0[CURVE_CHANNELS],
                                    const double *p1) {
    assert(f->curves < FORM_CURVES);
    struct form_curve *c = &f->curve[f->curves];
    *c = (struct form_curve){.name = name};
    for (int k = 0; k < CURVE_CHANNELS; k++)
        c->f[k] = (struct curve_function){.kind = kind, .p = {p0[k], p1 ? p1[k] : 0}};
    return (struct form_slot){{gamma, 0}, f->curves++};
}

struct form_slot form_add_curve(struct form *f, const char *name, enum gamma_kind gamma,
                                enum function_kind kind, double p0) {
    const double same[CURVE_CHANNELS] = {p0, p0, p0};
    return form_add_curve_rgb(f, name, gamma, kind, same, NULL);
}

bool form_append(struct form *f, const struct form *other) {
    if (f->terms + other->terms > FORM_TERMS || f->curves + other->curves > FORM_CURVES)
        return false;
    for (uint32_t t = 0; t < other->terms; t++) {
        struct form_term *term = &f->term[f->terms + t];
        *term = other->term[t];
        for (int s = 0; s < SLOTS; s++)
            if (term->slots[s].gamma.kind != GAMMA_NONE)
                term->slots[s].curve += f->curves;
    }
    memcpy(f->curve + f->curves, other->curve, sizeof *f->curve * other->curves);
    f->terms += other->terms;
    f->curves += other->curves;
    return true;
}

// ---- tables ---------------------------------------------------------------------------------

enum curve_filter form_filter(const struct form *f, uint32_t curve) {
    for (uint32_t t = 0; t < f->terms; t++)
        for (int s = 0; s < SLOTS; s++) {
            const struct form_slot *slot = &f->term[t].slots[s];
            if (slot->gamma.kind != GAMMA_NONE && slot->curve == curve)
                return slot->gamma.kind <= GAMMA_THETA_R ? FILTER_SINE : FILTER_MEAN;
        }
    return FILTER_MEAN;
}

static bool is_grey(const struct form_curve *c) {
    for (int k = 1; k < CURVE_CHANNELS; k++) {
        const struct curve_function *a = &c->f[0], *b = &c->f[k];
        const bool same_table = a->table == b->table && (!a->table || a->table->channels == 1);
        if (a->kind != b->kind || a->p[0] != b->p[0] || a->p[1] != b->p[1] || !same_table)
            return false;
    }
    return true;
}

struct curve *form_tabulate(struct form *f, uint32_t curve, const struct basis *basis,
                            enum curve_filter filter, struct arena *arena) {
    struct form_curve *c = &f->curve[curve];
    struct curve *table = arena_alloc(arena, sizeof *table);
    *table = curve_make(arena, basis, is_grey(c) ? 1 : CURVE_CHANNELS);
    for (uint32_t k = 0; k < table->channels; k++)
        function_project(table, k, &c->f[k], filter);
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
        c->f[k] = (struct curve_function){.kind = FUNCTION_TABLE, .table = table, .channel = k};
    return table;
}

bool form_same_shape(const struct form *a, const struct form *b) {
    if (a->terms != b->terms || a->curves != b->curves)
        return false;
    for (uint32_t t = 0; t < a->terms; t++) {
        if (!quotient_equal(&a->term[t].quotient, &b->term[t].quotient))
            return false;
        for (int s = 0; s < SLOTS; s++) {
            const struct form_slot *x = &a->term[t].slots[s], *y = &b->term[t].slots[s];
            const bool none = x->gamma.kind == GAMMA_NONE; // and so no curve
            if (x->gamma.kind != y->gamma.kind ||
                (!none && (x->gamma.n != y->gamma.n || x->curve != y->curve)))
                return false;
        }
    }
    return true;
}
