// SPDX-License-Identifier: Apache-2.0
// What the points of a study say together: series with their power laws, fronts, the target.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "driver/study.h"

const char *const study_metric_names[] = {"relmse", "variance", "bias2", NULL};

double study_metric_of(const struct study_point *p, enum study_metric metric) {
    return metric == STUDY_RELMSE ? p->error.mse.value
           : metric == STUDY_VARIANCE ? p->error.variance.value : p->error.bias2.value;
}

static bool number_of(const char *text, double *value) {
    return text && text_number(&text, value) && *text == '\0';
}

double study_position(const struct study *study, const struct study_point *p, enum study_axis axis) {
    double value = NAN;
    if (axis == STUDY_ALONG && study->along >= 0)
        number_of(p->values[study->along], &value);
    return axis == STUDY_SECONDS ? p->seconds : axis == STUDY_BYTES ? p->bytes : value;
}

// ---- series -----------------------------------------------------------------------------------

static bool is_numeric(const struct study_factor *f) {
    double value;
    for (size_t i = 0; i < f->count; i++)
        if (!number_of(f->values[i], &value) || !(value > 0))
            return false;
    return f->count > 1;
}

// spp where it varies, else the last factor of positive numbers.
static int find_along(const struct study_factors *f) {
    int along = -1;
    for (size_t i = 0; i < f->count; i++)
        if (is_numeric(&f->items[i]) && (along < 0 || strcmp(f->items[along].name, "spp") != 0))
            along = (int)i;
    return along;
}

static void label(const struct study *study, const struct study_point *p, int leave_out, char *text,
                  size_t size) {
    const struct study_factors *f = study->options->factors;
    text[0] = '\0';
    for (size_t i = 0; i < f->count; i++) {
        const size_t used = strlen(text);
        if ((int)i != leave_out && f->items[i].count > 1 && p->values[i])
            snprintf(text + used, size - used, "%s%s=%s", used ? " " : "", f->items[i].name,
                     p->values[i]);
    }
}

void study_label(const struct study *study, const struct study_point *p, char *text, size_t size) {
    label(study, p, -1, text, size);
    if (!*text)
        snprintf(text, size, "as the scene says");
}

static void sort_into_series(struct study *study) {
    char name[512];
    study->series = arena_alloc(&study->arena, (study->point_count + 1) * sizeof *study->series);
    for (size_t i = 0; i < study->point_count; i++) {
        struct study_point *p = &study->points[i];
        label(study, p, study->along, name, sizeof name);
        size_t s = 0;
        while (s < study->series_count && strcmp(study->series[s].name, name) != 0)
            s++;
        if (s == study->series_count)
            study->series[study->series_count++] = (struct study_series){
                .name = arena_strdup(&study->arena, name),
                .points = arena_alloc(&study->arena, study->point_count * sizeof(size_t))};
        study->series[s].points[study->series[s].count++] = i;
        p->series = s;
    }
}

// ---- power laws -------------------------------------------------------------------------------

enum { LEAST_FITTED = 3 };
static const double LEAST_SPAN = 1.5; // of the axis: less says nothing about an exponent

static bool fit(const struct study *study, const struct study_series *s, enum study_axis axis,
                bool of_variance, struct line_fit *out) {
    double *x = mem_array(3 * s->count, sizeof *x), *y = x + s->count, *error = y + s->count;
    double lowest = INFINITY, highest = 0;
    int n = 0;
    for (size_t i = 0; i < s->count; i++) {
        const struct study_point *p = &study->points[s->points[i]];
        const struct measured *m = of_variance ? &p->error.variance : &p->error.mse;
        const double at = study_position(study, p, axis);
        if (!(at > 0) || !(m->value > 0))
            continue;
        lowest = fmin(lowest, at);
        highest = fmax(highest, at);
        x[n] = log10(at);
        y[n] = log10(m->value);
        error[n++] = m->error / m->value / M_LN10;
    }
    const bool good = n >= LEAST_FITTED && highest > LEAST_SPAN * lowest &&
                      line_fit(x, y, error, n, out);
    mem_free(x);
    return good;
}

static void fit_series(const struct study *study, struct study_series *s) {
    for (int axis = 0; axis < STUDY_AXES; axis++)
        s->fitted[axis] = fit(study, s, (enum study_axis)axis, false, &s->fits[axis]);
    s->variance_fitted = fit(study, s, STUDY_ALONG, true, &s->variance_fit);
}

// ---- fronts and target ------------------------------------------------------------------------

// Whether no other point has less error at no more cost (V. Pareto 1906).
static bool is_on_front(const struct study *study, const struct study_point *p, enum study_axis axis) {
    const double cost = study_position(study, p, axis), error = p->error.mse.value;
    for (size_t i = 0; i < study->point_count; i++) {
        const struct study_point *q = &study->points[i];
        const double c = study_position(study, q, axis), e = q->error.mse.value;
        if (c <= cost && e <= error && (c < cost || e < error))
            return false;
    }
    return cost > 0;
}

static const double MOST_NOISE = 0.2; // of the reference, as a share of the least error

static bool reference_is_noisy(const struct study *study) {
    double least = INFINITY;
    for (size_t i = 0; i < study->point_count; i++)
        least = fmin(least, study->points[i].error.mse.value);
    return study->reference.noise > MOST_NOISE * fmax(least, 0);
}

static size_t find_cheapest(const struct study *study) {
    const struct study_options *o = study->options;
    size_t best = study->point_count;
    for (size_t i = 0; o->has_target && i < study->point_count; i++)
        if (study_metric_of(&study->points[i], o->metric) <= o->target &&
            (best == study->point_count || study->points[i].seconds < study->points[best].seconds))
            best = i;
    return best;
}

void study_analyse(struct study *study) {
    study->along = find_along(study->options->factors);
    sort_into_series(study);
    for (size_t s = 0; s < study->series_count; s++)
        fit_series(study, &study->series[s]);
    for (size_t i = 0; i < study->point_count; i++) {
        struct study_point *p = &study->points[i];
        p->front_seconds = is_on_front(study, p, STUDY_SECONDS);
        p->front_bytes = is_on_front(study, p, STUDY_BYTES);
    }
    study->noisy_reference = reference_is_noisy(study);
    study->cheapest = find_cheapest(study);
}
