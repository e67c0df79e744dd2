// SPDX-License-Identifier: Apache-2.0
#include "curve/model.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/log.h"

const struct model *const models[] = {
#define X(name) &model_##name,
#include "curve/list.h"
#undef X
    NULL,
};

const struct model_parameters model_defaults = {
    .reflectance = {1, 1, 1},
    .exponent_u = 30, .exponent_v = 30,
    .alpha_u = 0.1, .alpha_v = 0.1,
    .k = {1, 1, 1},
    .r0 = {0.04, 0.04, 0.04},
    .isotropy = 1,
    .variant = 2,
};

const struct model *model_find(const char *name) {
    for (const struct model *const *m = models; *m; m++)
        if (strcmp((*m)->name, name) == 0)
            return *m;
    return NULL;
}

void model_add_diffuse(struct form *f, const double colour[CURVE_CHANNELS]) {
    struct form_term *t = form_add_term(f, "diffuse", QUOTIENT_ONE, colour,
                                        0.31830988618379067154);
    t->slots[SLOT_O] = form_add_curve(f, "view", GAMMA_THETA_O, FUNCTION_CONSTANT, 1);
    t->slots[SLOT_A] = form_add_curve(f, "light", GAMMA_THETA_I, FUNCTION_CONSTANT, 1);
}

void model_add_fresnel(struct form *f, struct form_term *t, const struct model_parameters *p) {
    if (!p->fixed_fresnel) {
        t->slots[SLOT_B] = form_add_curve_rgb(f, "fresnel", GAMMA_THETA_D, FUNCTION_FRESNEL,
                                              p->eta, p->k);
        return;
    }
    t->quotient.has_fresnel = true;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        t->quotient.fresnel[k] = (struct curve_function){.kind = FUNCTION_FRESNEL,
                                                         .p = {p->eta[k], p->k[k]}};
}

// ---- checks ---------------------------------------------------------------------------------

struct limit {
    const char *name;
    double value, min, max;
};

static bool check_parameters(const struct model_parameters *p, const char *at) {
    const struct limit one[] = {
        {"exponent_u", p->exponent_u, 0, 1e8}, {"exponent_v", p->exponent_v, 0, 1e8},
        {"alpha_u", p->alpha_u, 1e-4, 1e3},    {"alpha_v", p->alpha_v, 1e-4, 1e3},
        {"isotropy", p->isotropy, 1e-4, 1},
    };
    bool ok = true;
    for (size_t i = 0; i < sizeof one / sizeof *one; i++)
        if (!(one[i].value >= one[i].min && one[i].value <= one[i].max)) {
            log_error("%s: %s is %g, expected %g to %g", at, one[i].name, one[i].value, one[i].min,
                      one[i].max);
            ok = false;
        }
    if (p->quotient == QUOTIENT_FACETS) {
        log_error("%s: the quotient \"facets\" belongs to the model microfacet", at);
        ok = false;
    }
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        const struct limit per[] = {
            {"reflectance", p->reflectance[k], 0, 1e6},
            {"diffuse reflectance", p->diffuse[k], 0, 1},
            {"eta", p->eta[k], 0, 1e6}, {"k", p->k[k], 0, 1e6}, {"r0", p->r0[k], 0, 1},
        };
        for (size_t i = 0; i < sizeof per / sizeof *per; i++)
            if (!(per[i].value >= per[i].min && per[i].value <= per[i].max)) {
                log_error("%s: %s is %g, expected %g to %g", at, per[i].name, per[i].value,
                          per[i].min, per[i].max);
                ok = false;
            }
    }
    return ok;
}

// ---- making ---------------------------------------------------------------------------------

static struct form_term *find_term(struct form *f, enum model_curve which) {
    if (which < MODEL_CURVE_DIFFUSE_O)
        return f->terms > 0 ? &f->term[0] : NULL;
    for (uint32_t t = 0; t < f->terms; t++)
        if (strcmp(f->term[t].name, "diffuse") == 0)
            return &f->term[t];
    return NULL;
}

static bool put_table(struct form *f, enum model_curve which, const struct curve *table,
                      const struct model *m, const char *at) {
    static const enum form_slot_name slots[MODEL_CURVES] = {SLOT_O, SLOT_A, SLOT_B, SLOT_O, SLOT_A};
    const struct form_term *t = find_term(f, which);
    if (!t || t->slots[slots[which]].gamma.kind == GAMMA_NONE) {
        log_error("%s: model \"%s\" has no curve %s%s", at, m->name, slot_names[slots[which]],
                  which < MODEL_CURVE_DIFFUSE_O ? "" : " of a diffuse term");
        return false;
    }
    struct form_curve *c = &f->curve[t->slots[slots[which]].curve];
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
        c->f[k] = (struct curve_function){.kind = FUNCTION_TABLE, .table = table, .channel = k};
    return true;
}

bool model_make(const struct model *m, const struct model_parameters *p, struct arena *arena,
                struct form *f, const char *at) {
    const double *d = p->diffuse;
    memset(f, 0, sizeof *f);
    if (!check_parameters(p, at))
        return false;
    m->make(p, arena, f);
    if (d[0] > 0 || d[1] > 0 || d[2] > 0)
        model_add_diffuse(f, d);
    for (int i = 0; i < MODEL_CURVES; i++)
        if (p->curve[i] && !put_table(f, (enum model_curve)i, p->curve[i], m, at))
            return false;
    return true;
}
