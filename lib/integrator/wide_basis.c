// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_basis.h"

#include "integrator/wide_strategy.h"

// Those of one half of the lanes.
static const uint32_t halves[WIDE_HALVES] = {(1u << WIDE_HALF) - 1, WIDE_ALL & ~((1u << WIDE_HALF) - 1)};

struct basis_lanes {
    const struct symbolic_object *object[WIDE_LANES];
    struct marks *to[WIDE_LANES]; // [CHAIN_WAYS]
    uint32_t distinct;            // lanes that do not repeat the first: each has a list of its own
    struct half_directions wo[WIDE_HALVES];
    wide_double reach[WIDE_HALVES][WIDE_STRATEGIES];
};

_Static_assert(sizeof(struct basis_lanes) <= sizeof(struct wide_closures), "it has room there");

static bool axis_fits(const struct form_slot *s) {
    return s->gamma.kind == GAMMA_NONE || half_gamma_fits(s->gamma.kind);
}

bool wide_basis_fits(const struct symbolic_object *o) {
    bool fits = wide_strategy_fits(&o->sampler);
    for (uint32_t t = 0; t < o->form->terms; t++) {
        const struct form_term *term = &o->form->term[t];
        const enum quotient_kind q = term->quotient.kind;
        fits = fits && axis_fits(&term->slots[SLOT_A]) && axis_fits(&term->slots[SLOT_B]) &&
               (q == QUOTIENT_ONE || q == QUOTIENT_V_CAVITY) && !term->quotient.has_fresnel &&
               !(o->texture[t] && o->texture[t]->texture);
    }
    return fits;
}

// Those of the lanes that see the same object as the first of them.
static uint32_t alike(const struct basis_lanes *c, uint32_t lanes) {
    const struct symbolic_object *o = c->object[__builtin_ctz(lanes)];
    uint32_t same = 0;
    for (int i = 0; i < WIDE_LANES; i++)
        same |= (uint32_t)(c->object[i] == o) << i;
    return same & lanes;
}

static struct half_directions half_of(const struct wide3 *w, int half) {
    return half_directions_of(wide_half_to_double(w->x, half), wide_half_to_double(w->y, half),
                          wide_half_to_double(w->z, half));
}

static void resolve(const struct wide_points *points, const struct wide3 *wo,
                    struct wide_closures *closures) {
    struct basis_lanes *c = (void *)closures;
    c->distinct = 1;
    for (int i = 0; i < WIDE_LANES; i++) {
        struct chain *chain = (void *)(uintptr_t)points->data[i];
        c->distinct |= (uint32_t)(points->data[i] != points->data[0]) << i;
        c->object[i] = chain->basis;
        c->to[i] = chain->first;
    }
    for (int h = 0; h < WIDE_HALVES; h++) {
        c->wo[h] = half_of(wo, h);
        for (uint32_t left = halves[h], same; left; left &= ~same) {
            const struct symbolic_object *o = c->object[__builtin_ctz(left)];
            wide_double reach[WIDE_STRATEGIES];
            same = alike(c, left);
            wide_strategy_reach(&o->sampler, c->wo[h], reach);
            for (uint32_t i = 0; i < o->sampler.count; i++)
                c->reach[h][i] =
                    wide_double_select(wide_half_mask(same, h), reach[i], c->reach[h][i]);
        }
    }
}

// ---- marks ----------------------------------------------------------------------------------

struct axes {
    wide_long index, count; // count: 0 beyond the last knot
    wide_double value[2];
};

static struct axes axis_at(const struct form *f, const struct form_slot *slot, struct half_angles *a) {
    const wide_double none = {0};
    struct axes x;
    x.index = (wide_long){0};
    x.count = x.index + 1;
    x.value[0] = none + 1;
    x.value[1] = none;
    if (slot->gamma.kind == GAMMA_NONE)
        return x;
    const struct basis *b = &f->curve[slot->curve].f[0].table->basis;
    const wide_double gamma = half_gamma_at(slot->gamma.kind, a);
    const double end = b->knots[basis_intervals(b)] * (1 + 1e-6);
    x.index = half_interval(b, gamma);
    x.count = ((gamma >= 0) & (gamma <= end)) & (b->kind == BASIS_BOX ? 1 : 2);
    if (b->kind == BASIS_BOX)
        return x;
    const wide_double start = wide_double_gather(b->knots, x.index);
    const wide_double t = (gamma - start) / (wide_double_gather(b->knots + 1, x.index) - start);
    x.value[1] = wide_double_min(wide_double_max(t, none), none + 1);
    x.value[0] = 1 - x.value[1];
    return x;
}

static wide_double at_least(wide_double cosine) {
    return wide_double_max(cosine, wide_double_of(QUOTIENT_LEAST));
}

// quotient_cos, the same for all channels
static wide_double quotient(const struct quotient *q, const struct half_angles *a) {
    if (q->kind == QUOTIENT_ONE)
        return a->wi.z;
    const wide_double i = at_least(a->wi.z), o = at_least(a->wo.z), s = 2 * a->cos_h / a->cos_d;
    return wide_double_min(1 / (i * o), wide_double_min(s / i, s / o)) * a->wi.z;
}

// A term at some directions.
struct half_term {
    uint32_t first, columns;
    spectrum texture;
    struct axes x, y;
    wide_double quotient;
};

static struct half_term term_at(const struct symbolic_object *o, uint32_t term, struct half_angles *a) {
    const struct form_term *t = &o->form->term[term];
    struct half_term at;
    at.first = o->first[term];
    at.columns = symbolic_bins(o->form, term, SLOT_B);
    at.texture = o->texture[term] ? o->texture[term]->value : spectrum_grey(1);
    at.x = axis_at(o->form, &t->slots[SLOT_A], a);
    at.y = axis_at(o->form, &t->slots[SLOT_B], a);
    at.quotient = quotient(&t->quotient, a);
    return at;
}

static void add_marks(const struct half_term *t, int i, float scale, struct marks *m) {
    const float q = (float)t->quotient[i];
    const spectrum f = spectrum_clamp(spectrum_rgb(q, q, q), 0, 1e30f);
    const spectrum weight = t->texture * f * scale;
    if (spectrum_is_black(weight))
        return;
    for (uint32_t j = 0; j < (uint32_t)t->x.count[i]; j++)
        for (uint32_t k = 0; k < (uint32_t)t->y.count[i]; k++)
            m->mark[m->count++] = (struct mark){
                t->first + ((uint32_t)t->x.index[i] + j) * t->columns + (uint32_t)t->y.index[i] + k,
                weight * (float)(t->x.value[j][i] * t->y.value[k][i])};
}

// Leaves the marks of directions in the lists of lanes of one object and one half; returns the
// densities of drawing them.
static wide_double mark(const struct basis_lanes *c, int half, uint32_t lanes,
                        struct half_directions wi, enum chain_way way) {
    const struct symbolic_object *o = c->object[__builtin_ctz(lanes)];
    struct half_angles a = half_angles_between(c->wo[half], wi);
    wide_double pdf = wide_strategy_pdf_sa(&o->sampler, c->reach[half], &a);
    float round[WIDE_LANES];
    pdf = wide_double_min(pdf, wide_double_of(1e30));
    for (int i = 0; i < WIDE_HALF; i++)
        round[i] = (float)pdf[i];
    for (uint32_t left = lanes; left; left &= left - 1)
        c->to[__builtin_ctz(left)][way].count = 0;
    for (uint32_t t = 0; t < o->form->terms; t++) {
        const struct half_term at = term_at(o, t, &a);
        for (uint32_t left = lanes; left; left &= left - 1) {
            const int lane = __builtin_ctz(left), i = lane % WIDE_HALF;
            if (round[i] > 0)
                add_marks(&at, i, 1 / round[i], &c->to[lane][way]);
        }
    }
    for (uint32_t left = lanes; left; left &= left - 1)
        if (c->to[__builtin_ctz(left)][way].count == 0)
            pdf[__builtin_ctz(left) % WIDE_HALF] = 0;
    return pdf;
}

// Marks of those that are above the surface; 0 for the others, and for those that repeat the first.
// Not inlined, as symbolic.c's mark.
__attribute__((noinline)) static wide mark_all(const struct basis_lanes *c, const struct wide3 *wi,
                                               enum chain_way way) {
    const uint32_t above = c->distinct & wide_bits(wi->z > 0);
    wide_double pdf[WIDE_HALVES] = {{0}, {0}};
    for (int h = 0; h < WIDE_HALVES; h++)
        for (uint32_t left = above & halves[h], same; left; left &= ~same) {
            same = alike(c, left);
            pdf[h] = wide_double_select(wide_half_mask(same, h),
                                        mark(c, h, same, half_of(wi, h), way), pdf[h]);
        }
    return wide_from_doubles(pdf[0], pdf[1]);
}

static struct wide3 eval(const struct wide_closures *closures, const struct wide3 *wi,
                         wide *pdf_sa) {
    *pdf_sa = mark_all((const void *)closures, wi, CHAIN_LIGHT);
    return (struct wide3){*pdf_sa, *pdf_sa, *pdf_sa};
}

static struct half_directions sample_half(const struct basis_lanes *c, int h, wide u1, const wide u2[2]) {
    const wide_double left_over = wide_half_to_double(u1, h);
    const wide_double u = wide_half_to_double(u2[0], h), v = wide_half_to_double(u2[1], h);
    struct half_directions wi = {{0}, {0}, {0}};
    for (uint32_t left = halves[h], same; left; left &= ~same) {
        const struct symbolic_object *o = c->object[__builtin_ctz(left)];
        same = alike(c, left);
        const wide_long here = wide_half_mask(same, h);
        const struct half_directions w =
            wide_strategy_sample(&o->sampler, c->reach[h], c->wo[h], left_over, u, v);
        wi = (struct half_directions){wide_double_select(here, w.x, wi.x),
                                  wide_double_select(here, w.y, wi.y),
                                  wide_double_select(here, w.z, wi.z)};
    }
    return wi;
}

static wide_mask sample(const struct wide_closures *closures, wide u1, const wide u2[2],
                        struct wide_samples *s) {
    const struct basis_lanes *c = (const void *)closures;
    const struct half_directions a = sample_half(c, 0, u1, u2), b = sample_half(c, 1, u1, u2);
    s->wi = (struct wide3){wide_from_doubles(a.x, b.x), wide_from_doubles(a.y, b.y),
                           wide_from_doubles(a.z, b.z)};
    s->pdf_sa = mark_all(c, &s->wi, CHAIN_PATH);
    s->weight = (struct wide3){wide_of(1), wide_of(1), wide_of(1)};
    s->lobe = (wide_uint)wide_int_of(LOBE_GLOSSY | LOBE_REFLECTION);
    return s->pdf_sa > 0;
}

const struct wide_bsdf wide_basis = {
    .lobes = LOBE_GLOSSY | LOBE_REFLECTION, .draws_lobe = true,
    .resolve = resolve, .eval = eval, .sample = sample,
};
