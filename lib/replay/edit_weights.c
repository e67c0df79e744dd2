// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_weights.h"

#include <math.h>

#include "curve/form_albedo.h"

static const struct form_term *term_of(const struct edit_tensor *e, uint32_t block) {
    const struct edited_block *b = &e->blocks[block];
    return b->object == EDIT_NOTHING ? NULL : &e->objects[b->object].form.term[b->term];
}

void edit_scale(const struct edit_tensor *e, uint32_t block, float scale[CURVE_CHANNELS]) {
    const struct form_term *t = term_of(e, block);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        scale[k] = t ? (float)t->scale[k] : 1;
}

bool edit_view_factor(const struct edit_tensor *e, uint32_t block, float *factor) {
    const struct form_term *t = term_of(e, block);
    const struct tensor_block *b = &e->tensor->blocks[block];
    if (!t || !edit_has_slot(t, SLOT_O))
        return false;
    const struct curve *c = e->objects[e->blocks[block].object].curve[t->slots[SLOT_O].curve];
    for (uint64_t i = 0; i < tensor_tiles(b) * TENSOR_LANES; i++) {
        uint32_t index[2];
        double value[2];
        const uint32_t n = basis_at(&c->basis, (double)b->view[i], index, value);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++) {
            double sum = 0;
            for (uint32_t m = 0; m < n; m++)
                sum += value[m] * curve_values(c, k)[index[m]];
            factor[(i / TENSOR_LANES * CURVE_CHANNELS + k) * TENSOR_LANES + i % TENSOR_LANES] =
                (float)sum;
        }
    }
    return true;
}

// ---- factors ------------------------------------------------------------------------------------

static const struct curve *curve_in(const struct edited_object *o, const struct form_term *t,
                                    enum form_slot_name slot) {
    return edit_has_slot(t, slot) ? o->curve[t->slots[slot].curve] : NULL;
}

static void albedo_value(const struct edited_object *o, double value[CURVE_CHANNELS]) {
    for (int k = 0; k < CURVE_CHANNELS; k++)
        value[k] = 0;
    for (uint32_t t = 0; t < o->form.terms; t++) {
        double own[CURVE_CHANNELS];
        form_term_albedo(&o->form, t, o->albedo[t], own);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            value[k] += o->share[t][k] * own[k];
    }
}

static void albedo_sum(const struct edit_tensor *e, const struct edited_factor *f,
                       double value[CURVE_CHANNELS]) {
    for (int k = 0; k < CURVE_CHANNELS; k++)
        value[k] = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        double own[CURVE_CHANNELS];
        albedo_value(&e->objects[f->members[i].object], own);
        for (int k = 0; k < CURVE_CHANNELS; k++)
            value[k] += f->members[i].weight[k] * own[k];
    }
}

// Where function j of a basis lies: its bin, or halfway to its neighbours.
static void support(const struct basis *b, uint32_t j, double *lo, double *hi) {
    if (b->kind == BASIS_BOX) {
        *lo = b->knots[j];
        *hi = b->knots[j + 1];
        return;
    }
    *lo = j > 0 ? 0.5 * (b->knots[j - 1] + b->knots[j]) : b->knots[0];
    *hi = j + 1 < b->count ? 0.5 * (b->knots[j] + b->knots[j + 1]) : b->knots[j];
}

// Mean over a bin of the first axis, and all of the other, of the curves' product, with e as weights.
static double coarse_mean(const struct edited_object *o, const struct edited_factor *f,
                          uint32_t channel) {
    const struct form_term *t = &o->form.term[f->term];
    const struct curve *a = curve_in(o, t, SLOT_A), *b = curve_in(o, t, SLOT_B);
    const uint32_t rows = a ? a->basis.count : 1, columns = b ? b->basis.count : 1;
    const struct curve *first = rows > 1 ? a : b;
    double sum = 0, all = 0;
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t k = 0; k < columns; k++) {
            double lo = 0, hi = 1, over = 1;
            if (rows > 1 || columns > 1) {
                support(&first->basis, rows > 1 ? j : k, &lo, &hi);
                over = fmin(hi, f->knots[f->bin + 1]) - fmax(lo, f->knots[f->bin]);
            }
            if (!(over > 0))
                continue;
            const size_t at = ((size_t)j * columns + k) * CURVE_CHANNELS + channel;
            const double e = over / (hi - lo) * (o->albedo[f->term] ? o->albedo[f->term][at] : 1);
            sum += e * (a ? curve_values(a, channel)[j] : 1) * (b ? curve_values(b, channel)[k] : 1);
            all += e;
        }
    return all > 0 ? sum / all : 0;
}

void edit_factor_value(const struct edit_tensor *e, const struct edited_factor *f,
                       double value[CURVE_CHANNELS]) {
    const struct edited_object *o = &e->objects[f->members[0].object];
    if (f->term == EDIT_NOTHING) {
        albedo_sum(e, f, value);
        return;
    }
    form_term_outer(&o->form, f->term, value);
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
        value[k] *= coarse_mean(o, f, k);
}

void edit_group_value(const struct edited_group *g, const double (*values)[CURVE_CHANNELS],
                      const bool *with, double product[CURVE_CHANNELS]) {
    for (int k = 0; k < CURVE_CHANNELS; k++)
        product[k] = 1;
    for (uint32_t i = 0; i < g->count; i++)
        for (int k = 0; k < CURVE_CHANNELS && (!with || with[g->factors[i]]); k++)
            product[k] *= values[g->factors[i]][k];
}

// ---- weights ------------------------------------------------------------------------------------

void edit_weights(const struct edit_tensor *e, uint32_t block,
                  const double (*groups)[CURVE_CHANNELS], uint32_t group_count, unsigned axes,
                  double *weights) {
    const struct edited_block *own = &e->blocks[block];
    const struct tensor_block *b = &e->tensor->blocks[block];
    const struct curve *c[TENSOR_MOST_AXES] = {NULL, NULL};
    uint32_t bins[TENSOR_MOST_AXES] = {1, 1};
    for (uint32_t i = 0; i < b->axis_count; i++)
        if (axes >> i & 1) {
            c[i] = e->objects[own->object].curve[edit_axis_curve(e, block, i)];
            bins[i] = b->axes[i].bins;
        }
    for (uint32_t g = 0; g < group_count; g++)
        for (uint32_t i = 0; i < bins[0]; i++)
            for (uint32_t j = 0; j < bins[1]; j++)
                for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
                    *weights++ = groups[g][k] * (c[0] ? curve_values(c[0], k)[i] : 1) *
                                 (c[1] ? curve_values(c[1], k)[j] : 1);
}
