// SPDX-License-Identifier: Apache-2.0
#include "driver/study_report.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/file.h"

// ---- CSV --------------------------------------------------------------------------------------

static const char *const measured_names[] = {"relmse", "bias2", "variance"};

static const struct measured *measured_of(const struct study_point *p, int i) {
    const struct measured *all[] = {&p->error.mse, &p->error.bias2, &p->error.variance};
    return all[i];
}

static void csv_number(FILE *f, double v) {
    if (isfinite(v))
        fprintf(f, ",%.9g", v);
    else
        fprintf(f, ",");
}

static void csv_head(const struct study *study, FILE *f) {
    const struct study_factors *factors = study->options->factors;
    for (size_t i = 0; i < factors->count; i++)
        fprintf(f, "%s,", factors->items[i].name);
    fprintf(f, "runs,samples,seconds,fastest,slowest,cpu_seconds,load_seconds,bytes");
    for (int k = 0; k < 3; k++)
        fprintf(f, ",%s,%s_error,%s_low,%s_high", measured_names[k], measured_names[k],
                measured_names[k], measured_names[k]);
    fprintf(f, ",front_seconds,front_bytes\n");
}

static void csv_point(const struct study *study, const struct study_point *p, FILE *f) {
    for (size_t i = 0; i < study->options->factors->count; i++)
        fprintf(f, "%s,", p->values[i] ? p->values[i] : "");
    fprintf(f, "%d", p->run_count);
    const double plain[] = {p->samples, p->seconds, p->fastest, p->slowest,
                            p->cpu_seconds, p->load_seconds, p->bytes};
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
        csv_number(f, plain[i]);
    for (int k = 0; k < 3; k++) {
        const struct measured *m = measured_of(p, k);
        csv_number(f, m->value);
        csv_number(f, m->error);
        csv_number(f, m->low);
        csv_number(f, m->high);
    }
    fprintf(f, ",%d,%d\n", p->front_seconds, p->front_bytes);
}

bool study_write_csv(const struct study *study, const char *path) {
    struct file_text t;
    if (!file_text_begin(&t, path))
        return false;
    FILE *f = t.f;
    csv_head(study, f);
    for (size_t i = 0; i < study->point_count; i++)
        csv_point(study, &study->points[i], f);
    return file_text_end(&t);
}

// ---- JSON -------------------------------------------------------------------------------------

static void json_fit(struct json *parent, const char *key, bool known, const struct line_fit *f) {
    if (!known)
        return;
    struct json *j = json_add_object(parent, key);
    json_add_number(j, "slope", f->slope);
    json_add_number(j, "error", f->slope_error);
    json_add_number(j, "intercept", f->intercept);
}

static void json_runs(struct json *point, const struct study_point *p) {
    struct json *runs = json_add_array(point, "runs");
    for (int i = 0; i < p->run_count; i++) {
        struct json *r = json_append_object(runs);
        json_add_count(r, "seed", p->runs[i].seed);
        json_add_count(r, "samples", (int64_t)p->runs[i].samples);
        json_add_number(r, "seconds", p->runs[i].seconds);
        json_add_number(r, "cpu_seconds", p->runs[i].cpu_seconds);
        json_add_number(r, "relmse", p->runs[i].relmse);
    }
}

static void json_point(const struct study *study, const struct study_point *p, struct json *points) {
    struct json *j = json_append_object(points), *settings = json_add_object(j, "settings");
    for (size_t i = 0; i < study->options->factors->count; i++)
        if (p->values[i])
            json_add_text(settings, study->options->factors->items[i].name, p->values[i]);
    json_add_text(j, "series", study->series[p->series].name);
    json_add_number(j, "samples", p->samples);
    json_add_number(j, "seconds", p->seconds);
    json_add_number(j, "fastest", p->fastest);
    json_add_number(j, "slowest", p->slowest);
    json_add_number(j, "cpu_seconds", p->cpu_seconds);
    json_add_number(j, "load_seconds", p->load_seconds);
    json_add_number(j, "bytes", p->bytes);
    for (int k = 0; k < 3; k++) {
        const struct measured *m = measured_of(p, k);
        struct json *value = json_add_object(j, measured_names[k]);
        json_add_number(value, "value", m->value);
        json_add_number(value, "error", m->error);
        json_add_number(value, "low", m->low);
        json_add_number(value, "high", m->high);
    }
    json_add_bool(j, "front_seconds", p->front_seconds);
    json_add_bool(j, "front_bytes", p->front_bytes);
    json_runs(j, p);
}

static void json_series(const struct study *study, struct json *j) {
    struct json *all = json_add_array(j, "series");
    for (size_t s = 0; s < study->series_count; s++) {
        const struct study_series *series = &study->series[s];
        struct json *one = json_append_object(all), *fits;
        json_add_text(one, "name", series->name);
        fits = json_add_object(one, "exponents");
        if (study->along >= 0) {
            const char *name = study->options->factors->items[study->along].name;
            json_fit(fits, name, series->fitted[STUDY_ALONG], &series->fits[STUDY_ALONG]);
        }
        json_fit(fits, "seconds", series->fitted[STUDY_SECONDS], &series->fits[STUDY_SECONDS]);
        json_fit(fits, "bytes", series->fitted[STUDY_BYTES], &series->fits[STUDY_BYTES]);
        json_fit(fits, "variance", series->variance_fitted, &series->variance_fit);
    }
}

struct json *study_json(const struct study *study) {
    const struct study_options *o = study->options;
    struct json *j = json_new_object(), *points;
    char text[1024];
    json_add_text(j, "command", o->command);
    json_add_text(j, "version", o->version);
    json_add_text(j, "scene", o->job.scene);
    json_add_text(j, "reference", o->reference ? o->reference : "reference.exr");
    json_add_count(j, "width", study->reference.rgb.width);
    json_add_count(j, "height", study->reference.rgb.height);
    json_add_number(j, "reference_noise", study->reference.noise);
    json_add_bool(j, "stopped", study->stopped);
    if (o->has_target) {
        struct json *target = json_add_object(j, "target");
        json_add_text(target, "metric", study_metric_names[o->metric]);
        json_add_number(target, "value", o->target);
        study_target_text(study, text, sizeof text);
        json_add_text(target, "answer", text);
        if (study->cheapest < study->point_count)
            json_add_count(target, "point", (int64_t)study->cheapest);
    }
    json_series(study, j);
    points = json_add_array(j, "points");
    for (size_t i = 0; i < study->point_count; i++)
        json_point(study, &study->points[i], points);
    return j;
}

bool study_write(const struct study *study) {
    char path[4096];
    const char *folder = study->options->directory;
    snprintf(path, sizeof path, "%s/study.json", folder);
    struct json *j = study_json(study);
    bool good = json_write(j, path);
    json_destroy(j);
    snprintf(path, sizeof path, "%s/study.csv", folder);
    good = study_write_csv(study, path) && good;
    snprintf(path, sizeof path, "%s/study.html", folder);
    good = study_write_html(study, path) && good;
    return study_write_plots(study) && good;
}
