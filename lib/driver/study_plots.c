// SPDX-License-Identifier: Apache-2.0
// The plots of a study: relMSE over samples (or what else was varied), seconds and memory.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "driver/study_report.h"
#include "image/plot.h"

enum { WIDTH = 600, HEIGHT = 400, MOST_TICKS = 10 };

bool study_has_axis(const struct study *study, enum study_axis axis) {
    if (axis == STUDY_ALONG && study->along < 0)
        return false;
    for (size_t i = 0; i < study->point_count; i++)
        if (study_position(study, &study->points[i], axis) > 0)
            return true;
    return false;
}

static const char *axis_name(const struct study *study, enum study_axis axis) {
    return axis == STUDY_SECONDS ? "seconds" : axis == STUDY_BYTES ? "memory"
                                 : study->options->factors->items[study->along].name;
}

static const char *axis_label(const struct study *study, enum study_axis axis) {
    const char *name = axis_name(study, axis);
    return axis == STUDY_SECONDS ? "seconds of a run" : axis == STUDY_BYTES ? "memory, MB"
           : strcmp(name, "spp") == 0 ? "samples per pixel" : name;
}

static struct plot_point plot_point(const struct study *study, const struct study_point *p,
                                    enum study_axis axis, struct arena *arena) {
    const struct measured *m = &p->error.mse;
    char label[512];
    study_label(study, p, label, sizeof label);
    return (struct plot_point){
        .x = study_position(study, p, axis) * (axis == STUDY_BYTES ? 1e-6 : 1),
        .y = m->value, .low = m->low, .high = m->high,
        .marked = axis == STUDY_BYTES ? p->front_bytes : axis == STUDY_SECONDS && p->front_seconds,
        .tip = arena_printf(arena, "%s: relMSE %.3g, squared bias %.2g, %.3g s, %.3g MB", label,
                            m->value, p->error.bias2.value, p->seconds, p->bytes * 1e-6)};
}

static struct plot_series plot_series(const struct study *study, const struct study_series *s,
                                      enum study_axis axis, struct arena *arena) {
    const struct line_fit *f = &s->fits[axis];
    struct plot_point *points = arena_alloc(arena, (s->count + 1) * sizeof *points);
    for (size_t i = 0; i < s->count; i++)
        points[i] = plot_point(study, &study->points[s->points[i]], axis, arena);
    const char *name = *s->name ? s->name : "relMSE";
    const bool fitted = s->fitted[axis];
    return (struct plot_series){
        .name = fitted ? arena_printf(arena, "%s: slope %.3f ± %.3f", name, f->slope, f->slope_error)
                       : name,
        .points = points, .count = s->count, .fitted = fitted, .slope = f->slope,
        .intercept = f->intercept + (axis == STUDY_BYTES ? 6 * f->slope : 0)}; // bytes to MB
}

// The values that were tried.
static const double *ticks(const struct study *study, struct arena *arena) {
    const struct study_factor *f = &study->options->factors->items[study->along];
    double *out = arena_alloc(arena, f->count * sizeof *out);
    for (size_t i = 0; i < f->count; i++)
        out[i] = strtod(f->values[i], NULL);
    return out;
}

void study_plot(const struct study *study, enum study_axis axis, int width, int height, FILE *out) {
    const struct study_options *o = study->options;
    struct arena arena = {0};
    struct plot_series *series = arena_alloc(&arena, (study->series_count + 1) * sizeof *series);
    for (size_t i = 0; i < study->series_count; i++)
        series[i] = plot_series(study, &study->series[i], axis, &arena);
    const size_t values = axis == STUDY_ALONG ? o->factors->items[study->along].count : 0;
    const size_t tick_count = values <= MOST_TICKS ? values : 0;
    const bool ruled = o->has_target && o->metric == STUDY_RELMSE;
    const struct plot p = {
        .x_ticks = tick_count ? ticks(study, &arena) : NULL, .x_tick_count = tick_count,
        .title = arena_printf(&arena, "error against %s", axis == STUDY_ALONG &&
                              strcmp(axis_name(study, axis), "spp") == 0 ? "samples"
                                                                        : axis_name(study, axis)),
        .x_label = axis_label(study, axis), .y_label = "relMSE", .series = series,
        .series_count = study->series_count, .rule = ruled ? o->target : 0, .rule_label = "target",
        .width = width, .height = height + 18 * (int)study->series_count};
    plot_svg(&p, out);
    arena_finish(&arena);
}

static bool write_plot(const struct study *study, enum study_axis axis) {
    struct file_text t;
    char path[4096];
    snprintf(path, sizeof path, "%s/error-%s.svg", study->options->directory, axis_name(study, axis));
    if (!file_text_begin(&t, path))
        return false;
    study_plot(study, axis, WIDTH, HEIGHT, t.f);
    return file_text_end(&t);
}

bool study_write_plots(const struct study *study) {
    bool good = true;
    for (int axis = 0; axis < STUDY_AXES; axis++)
        if (study_has_axis(study, (enum study_axis)axis))
            good = write_plot(study, (enum study_axis)axis) && good;
    return good;
}
