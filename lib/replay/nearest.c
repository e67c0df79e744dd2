// SPDX-License-Identifier: Apache-2.0
#include "replay/nearest.h"

#include <math.h>
#include <string.h>

static double weight_of(const struct basis *b, uint32_t j) {
    const uint32_t last = basis_knots(b) - 1, next = j < last ? j + 1 : last;
    const double from = b->knots[b->kind == BASIS_HAT && j > 0 ? j - 1 : j], to = b->knots[next];
    return sin((from + to) / 2) * (to - from);
}

// One channel: the best factor of the model's curve, and the squares that it leaves and that there are.
static double fit_channel(const struct curve *own, const struct curve *model, uint32_t k, double *left,
                          double *all) {
    double vv = 0, vm = 0, mm = 0;
    for (uint32_t j = 0; j < own->basis.count; j++) {
        const double w = weight_of(&own->basis, j), v = curve_values(own, k)[j];
        const double m = curve_values(model, k)[j];
        vv += w * v * v;
        vm += w * v * m;
        mm += w * m * m;
    }
    const double factor = mm > 0 ? vm / mm : 1;
    *left += fmax(vv - 2 * factor * vm + factor * factor * mm, 0);
    *all += vv;
    return factor;
}

static bool is_of_first_term(const struct form *f, uint32_t curve) {
    bool is = false;
    for (int s = 0; s < SLOTS; s++)
        is = is || (edit_has_slot(&f->term[0], (enum form_slot_name)s) && f->term[0].slots[s].curve == curve);
    return is;
}

// Of one curve, as a share of its own square; `factor` takes what is best for the first term's.
static double curve_distance(const struct edited_object *o, const struct form *f, uint32_t c,
                             struct arena *arena, double factor[CURVE_CHANNELS]) {
    struct curve made = curve_make(arena, &o->curve[c]->basis, CURVE_CHANNELS);
    double left = 0, all = 0;
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++) {
        function_project(&made, k, &f->curve[c].f[k], form_filter(&o->form, c));
        const double best = fit_channel(o->curve[c], &made, k, &left, &all);
        factor[k] *= is_of_first_term(f, c) ? best : 1;
    }
    return all > 0 ? left / all : 0;
}

static double distance(const struct edited_object *o, const struct model_parameters *p,
                       double factor[CURVE_CHANNELS]) {
    struct arena arena = {0};
    struct form f;
    double sum = 0;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        factor[k] = 1;
    if (model_make(o->model, p, &arena, &f, o->name))
        for (uint32_t c = 0; c < f.curves && c < o->form.curves; c++)
            sum += curve_distance(o, &f, c, &arena, factor);
    arena_finish(&arena);
    return sqrt(sum);
}

// Steps up and down in each number by ever smaller ratios, while that comes nearer.
static void search(const struct edited_object *o, struct nearest *n) {
    double *const numbers[] = {&n->parameters.exponent_u, &n->parameters.exponent_v,
                               &n->parameters.alpha_u, &n->parameters.alpha_v};
    static const double most[] = {1e7, 1e7, 100, 100}, least = 1e-3; // what models take, and less
    double factor[CURVE_CHANNELS];
    for (double ratio = 2; ratio > 1.005; ratio = sqrt(ratio))
        for (int i = 0; i < 8; i++) {
            double *number = numbers[i / 2];
            for (bool nearer = true; nearer;) {
                const double before = *number;
                *number *= i % 2 ? ratio : 1 / ratio;
                const bool fits = *number >= least && *number <= most[i / 2];
                const double d = fits ? distance(o, &n->parameters, factor) : INFINITY;
                nearer = d < n->missing - 1e-9;
                if (nearer) {
                    n->missing = d;
                    memcpy(n->factor, factor, sizeof factor);
                } else {
                    *number = before;
                }
            }
        }
}

void nearest_find(const struct edited_object *o, struct nearest *n) {
    n->parameters = o->parameters;
    n->missing = distance(o, &n->parameters, n->factor);
    if (n->missing > 1e-6)
        search(o, n);
    else
        n->missing = 0; // but for rounding
}
