// SPDX-License-Identifier: Apache-2.0
#include "bsdf/editable_albedo.h"

#include "math/half_vector.h"

enum { SAMPLES = 256 };

struct probe {
    double f;                        // mean of the channels
    double q;                        // density it was drawn with
    double pdf[CURVE_STRATEGIES];    // of each strategy
};

// f cos_i of one term, per unit of its factor.
static spectrum term_value(const struct form *f, const struct form_term *t,
                           struct angles *a) {
    double v[CURVE_CHANNELS];
    form_term_eval(f, t, a, v);
    return spectrum_rgb((float)fmin(v[0], 1e30), (float)fmin(v[1], 1e30), (float)fmin(v[2], 1e30));
}

// Fills `probes` for one direction of the eye and returns the albedo.
static spectrum probe_angle(const struct editable *self, uint32_t term, double cos_o,
                            struct probe *probes) {
    const struct curve_sampler *s = &self->sampler[term];
    const struct direction wo = {sqrt((1 - cos_o) * (1 + cos_o)), 0, cos_o};
    spectrum sum = spectrum_grey(0);
    for (int i = 0; i < SAMPLES; i++) {
        // the sequence of the plastic number (Roberts 2018)
        const double u = fmod(0.5 + 0.7548776662466927 * i, 1);
        const double v = fmod(0.5 + 0.5698402909980532 * i, 1);
        const struct direction wi = curve_sampler_sample(s, wo, (i + 0.5) / SAMPLES, u, v);
        struct probe *p = &probes[i];
        *p = (struct probe){0};
        if (!(wi.z > 0))
            continue;
        struct angles a = angles_between(wo, wi);
        const spectrum f = term_value(&self->form, &self->form.term[term], &a);
        for (uint32_t k = 0; k < s->count; k++) {
            p->pdf[k] = curve_strategy_pdf_sa(&s->strategy[k], wo, wi, &a);
            p->q += s->strategy[k].share * p->pdf[k];
        }
        p->f = (double)spectrum_mean(f);
        if (p->q > 0)
            sum += f / ((float)p->q * SAMPLES);
    }
    return spectrum_clamp(sum, 0, 1e30f);
}

// Second moment of f / pdf over the square of its mean, for other shares than it was drawn with.
static double relative_moment(const struct probe *probes, const double *shares, uint32_t count) {
    double first = 0, second = 0;
    for (int i = 0; i < SAMPLES; i++) {
        const struct probe *p = &probes[i];
        double pdf = 0;
        for (uint32_t k = 0; k < count; k++)
            pdf += shares[k] * p->pdf[k];
        if (!(p->f > 0 && p->q > 0))
            continue;
        first += p->f / p->q;
        second += p->f / p->q * (p->f / pdf);
    }
    return first > 0 ? second / (first * first) : 0;
}

// Shares are tried on a grid: of the cosine, and of the first curve in what is left.
enum { COSINES = 4, SPLITS = 5, CANDIDATES = COSINES * SPLITS };

static void candidate(int index, uint32_t count, double shares[CURVE_STRATEGIES]) {
    static const double cosines[COSINES] = {0.05, 0.15, 0.4, 0.8};
    const double split = count > 2 ? 1 - 0.25 * (index % SPLITS) : 1;
    shares[0] = count > 1 ? cosines[index / SPLITS] : 1;
    shares[1] = (1 - shares[0]) * split;
    shares[2] = (1 - shares[0]) * (1 - split);
}

static void measure_term(struct editable *self, uint32_t term) {
    struct curve_sampler *s = &self->sampler[term];
    double cost[CANDIDATES] = {0}, shares[CURVE_STRATEGIES];
    for (int i = 0; i < EDITABLE_ANGLES; i++) {
        struct probe probes[SAMPLES];
        const double cos_o = fmax((double)i / (EDITABLE_ANGLES - 1), 0.01);
        self->albedo[term][i] = probe_angle(self, term, cos_o, probes);
        for (int c = 0; c < CANDIDATES; c++) {
            candidate(c, s->count, shares);
            cost[c] += relative_moment(probes, shares, s->count);
        }
    }
    int best = 0;
    for (int c = 1; c < CANDIDATES; c++)
        best = cost[c] < cost[best] ? c : best;
    candidate(best, s->count, shares);
    for (uint32_t k = 0; k < s->count; k++)
        s->strategy[k].share = shares[k];
}

void editable_measure(struct editable *self) {
    for (uint32_t t = 0; t < self->form.terms; t++)
        measure_term(self, t);
}
