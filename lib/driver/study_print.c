// SPDX-License-Identifier: Apache-2.0
// What a study says in words: exponents, the front, the target.
#include <math.h>
#include <string.h>

#include "base/progress.h"
#include "driver/study_report.h"

// Where the law of a series meets the target: the axis' value, or NaN.
static double where_met(const struct study_series *s, enum study_axis axis, double target) {
    const struct line_fit *f = &s->fits[axis];
    if (!s->fitted[axis] || !(f->slope < -0.05))
        return NAN;
    return pow(10, (log10(target) - f->intercept) / f->slope);
}

static void best_guess(const struct study *study, char *text, size_t size) {
    const struct study_options *o = study->options;
    double best = INFINITY;
    for (size_t i = 0; o->metric == STUDY_RELMSE && i < study->series_count; i++) {
        const struct study_series *s = &study->series[i];
        const double seconds = where_met(s, STUDY_SECONDS, o->target);
        const double along = where_met(s, STUDY_ALONG, o->target);
        if (!(seconds < best))
            continue;
        char time[32], at[64] = "";
        best = seconds;
        progress_format_seconds(seconds, time, sizeof time);
        if (isfinite(along))
            snprintf(at, sizeof at, "%s=%.3g", o->factors->items[study->along].name, along);
        snprintf(text, size, "By the fitted laws, %s%s%s would reach it in about %s.", s->name,
                 *s->name && *at ? " " : "", at, time);
    }
}

void study_target_text(const struct study *study, char *text, size_t size) {
    const struct study_options *o = study->options;
    char setting[512], guess[700] = "";
    best_guess(study, guess, sizeof guess);
    if (study->cheapest == study->point_count) {
        snprintf(text, size, "No setting that was tried reaches %s = %g. %s",
                 study_metric_names[o->metric], o->target, guess);
        return;
    }
    const struct study_point *p = &study->points[study->cheapest];
    study_label(study, p, setting, sizeof setting);
    snprintf(text, size, "The cheapest setting that reaches %s = %g is %s: %.3g in %.3g s. %s",
             study_metric_names[o->metric], o->target, setting, study_metric_of(p, o->metric),
             p->seconds, guess);
}

static void print_fit(const char *axis, bool known, const struct line_fit *f) {
    if (known)
        printf("  ~ %s^(%.3f +- %.3f)", axis, f->slope, f->slope_error);
}

void study_print(const struct study *study) {
    const struct study_factors *factors = study->options->factors;
    char text[1024];
    printf("%-44s %10s %9s  %-21s %-21s\n", "setting", "seconds", "MB", "relMSE (+- 95 %)",
           "squared bias");
    for (size_t i = 0; i < study->point_count; i++) {
        const struct study_point *p = &study->points[i];
        const struct measured *m = &p->error.mse, *b = &p->error.bias2;
        study_label(study, p, text, sizeof text);
        printf("%-44s %10.4g %9.3g%c %9.3g +- %-8.2g %9.2g +- %-8.2g\n", text, p->seconds,
               p->bytes * 1e-6, p->front_seconds ? '*' : ' ', m->value, m->high - m->value, b->value,
               b->high - b->value);
    }
    printf("* on the Pareto front of error and seconds\n");
    for (size_t i = 0; i < study->series_count; i++) {
        const struct study_series *s = &study->series[i];
        if (!s->fitted[STUDY_ALONG] && !s->fitted[STUDY_SECONDS] && !s->fitted[STUDY_BYTES])
            continue;
        printf("%s relMSE", s->name);
        print_fit(study->along >= 0 ? factors->items[study->along].name : "", s->fitted[STUDY_ALONG],
                  &s->fits[STUDY_ALONG]);
        print_fit("seconds", s->fitted[STUDY_SECONDS], &s->fits[STUDY_SECONDS]);
        print_fit("bytes", s->fitted[STUDY_BYTES], &s->fits[STUDY_BYTES]);
        printf("\n");
    }
    if (study->options->has_target) {
        study_target_text(study, text, sizeof text);
        printf("%s\n", text);
    }
}
