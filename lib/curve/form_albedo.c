// SPDX-License-Identifier: Apache-2.0
#include "curve/form_albedo.h"

#include <math.h>

double form_view_mean(const struct curve *c, uint32_t channel) {
    enum { STEPS = 2048 };
    double sum = 0, all = 0;
    for (int i = 0; i < STEPS; i++) {
        const double gamma = CURVE_END * (i + 0.5) / STEPS, w = sin(2 * gamma);
        sum += w * curve_at(c, channel, gamma);
        all += w;
    }
    return sum / all;
}

static const struct curve *curve_in(const struct form *f, const struct form_term *t,
                                    enum form_slot_name slot) {
    return t->slots[slot].gamma.kind == GAMMA_NONE ? NULL : f->curve[t->slots[slot].curve].f[0].table;
}

void form_term_outer(const struct form *f, uint32_t term, double value[CURVE_CHANNELS]) {
    const struct form_term *t = &f->term[term];
    const struct curve *o = curve_in(f, t, SLOT_O);
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
        value[k] = t->scale[k] * (o ? form_view_mean(o, k) : 1);
}

void form_term_albedo(const struct form *f, uint32_t term, const double *e,
                      double value[CURVE_CHANNELS]) {
    const struct form_term *t = &f->term[term];
    const struct curve *a = curve_in(f, t, SLOT_A), *b = curve_in(f, t, SLOT_B);
    const uint32_t rows = a ? a->basis.count : 1, columns = b ? b->basis.count : 1;
    form_term_outer(f, term, value);
    for (uint32_t c = 0; c < CURVE_CHANNELS; c++) {
        double sum = 0;
        for (uint32_t j = 0; j < rows; j++)
            for (uint32_t k = 0; k < columns; k++)
                sum += (a ? curve_values(a, c)[j] : 1) * (b ? curve_values(b, c)[k] : 1) *
                       e[((size_t)j * columns + k) * CURVE_CHANNELS + c];
        value[c] *= sum;
    }
}
