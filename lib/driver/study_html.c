// SPDX-License-Identifier: Apache-2.0
// The page of a study: one file that needs no network and no script.
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "driver/study_report.h"
#include "image/plot.h"

enum { PLOT_WIDTH = 600, PLOT_HEIGHT = 380 };

static const char style[] =
    "body{font:14px/1.4 sans-serif;color:#222;background:#fff;margin:0 auto;padding:16px;"
    "max-width:1232px}h1{font-size:20px;margin:0 0 4px}h2{font-size:16px;margin:22px 0 6px}"
    "p{margin:4px 0;max-width:100ch}code{background:#f2f2f2;padding:1px 4px;overflow-wrap:anywhere}"
    ".plots{display:flex;flex-wrap:wrap;gap:16px}.plots div{max-width:100%;overflow-x:auto}"
    ".answer{font-size:16px;border-left:4px solid #b00020;"
    "padding:2px 10px;margin:8px 0}table{border-collapse:collapse}th,td{padding:3px 8px;"
    "text-align:right;border-bottom:1px solid #ddd;white-space:nowrap}th{background:#f6f6f6}"
    ".settings{font-size:13px;overflow-x:auto}.settings td{font-variant-numeric:tabular-nums}"
    ".settings th{white-space:normal;vertical-align:bottom}.settings td:first-child{white-space:normal}"
    "th:first-child,td:first-child{text-align:left}tr.front td{background:#eef6ee}"
    ".pictures{display:flex;flex-wrap:wrap;gap:14px}figure{margin:0;font-size:12px;max-width:410px}"
    "img{image-rendering:pixelated;margin-right:4px;display:inline-block}";

// A cell "1.2e-3 ± 0.1e-3".
static void cell(const struct measured *m, FILE *f) {
    fprintf(f, "<td>%.3g", m->value);
    if (isfinite(m->high))
        fprintf(f, " ± %.2g", m->high - m->value);
    fprintf(f, "</td>");
}

static void write_head(const struct study *study, FILE *f) {
    const struct study_options *o = study->options;
    char text[1024];
    fprintf(f, "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
               "<title>relume study</title><style>%s</style></head><body>\n<h1>Study of ", style);
    plot_escape(o->job.scene, f);
    fprintf(f, "</h1>\n<p><code>");
    plot_escape(o->command, f);
    fprintf(f, "</code></p>\n<p>%d x %d pixels, %zu settings, %d runs of each%s; reference: ",
            study->reference.rgb.width, study->reference.rgb.height, study->point_count, o->repeat,
            o->even ? " and more of those with fewer samples" : "");
    plot_escape(o->reference ? o->reference : "reference.exr, rendered as the scene says", f);
    fprintf(f, "%s. relume %s.</p>\n", study->reference.variance.pixels
               ? ", whose own noise is taken off" : ", whose noise is not known and counts as bias",
            o->version);
    if (study->noisy_reference)
        fprintf(f, "<p class=\"answer\">The reference is noisy: its relMSE of %.2g is more than a fifth "
                   "of the least error here. Small errors and biases are not to be trusted.</p>\n",
                study->reference.noise);
    if (study->stopped)
        fprintf(f, "<p class=\"answer\">Stopped early: some settings or runs are missing.</p>\n");
    if (o->has_target) {
        study_target_text(study, text, sizeof text);
        fprintf(f, "<p class=\"answer\">");
        plot_escape(text, f);
        fprintf(f, "</p>\n");
    }
}

static void write_exponent(bool known, const struct line_fit *fit, FILE *f) {
    if (known)
        fprintf(f, "<td>%.3f ± %.3f</td>", fit->slope, fit->slope_error);
    else
        fprintf(f, "<td>-</td>");
}

static void write_exponents(const struct study *study, FILE *f) {
    fprintf(f, "<div class=\"settings\"><h2>Exponents of relMSE</h2>\n<table><tr><th>series</th>");
    if (study->along >= 0) {
        const char *name = study->options->factors->items[study->along].name;
        fprintf(f, "<th>over %s</th><th>of variance</th>", name);
    }
    fprintf(f, "<th>over seconds</th><th>over memory</th></tr>\n");
    for (size_t i = 0; i < study->series_count; i++) {
        const struct study_series *s = &study->series[i];
        fprintf(f, "<tr><td>");
        plot_escape(*s->name ? s->name : "all", f);
        fprintf(f, "</td>");
        if (study->along >= 0) {
            write_exponent(s->fitted[STUDY_ALONG], &s->fits[STUDY_ALONG], f);
            write_exponent(s->variance_fitted, &s->variance_fit, f);
        }
        write_exponent(s->fitted[STUDY_SECONDS], &s->fits[STUDY_SECONDS], f);
        write_exponent(s->fitted[STUDY_BYTES], &s->fits[STUDY_BYTES], f);
        fprintf(f, "</tr>\n");
    }
    fprintf(f, "</table>\n<p>Given where three points or more span a factor of 1.5.</p></div>\n");
}

static void write_plots(const struct study *study, FILE *f) {
    static const enum study_axis order[] = {STUDY_SECONDS, STUDY_ALONG, STUDY_BYTES};
    fprintf(f, "<div class=\"plots\">\n");
    for (int i = 0; i < STUDY_AXES; i++)
        if (study_has_axis(study, order[i]))
            study_plot(study, order[i], PLOT_WIDTH, PLOT_HEIGHT, f);
    write_exponents(study, f);
    fprintf(f, "</div>\n<p>Bars are 95 %% confidence intervals; ringed points are on the Pareto front. "
               "Lines are least squares through the logarithms, slopes with their standard errors.</p>\n");
}

static void write_row(const struct study *study, const struct study_point *p, FILE *f) {
    char text[512];
    study_label(study, p, text, sizeof text);
    fprintf(f, "<tr%s><td>", p->front_seconds ? " class=\"front\"" : "");
    plot_escape(text, f);
    fprintf(f, "</td><td>%d</td><td>%.3g</td><td>%.3g - %.3g</td><td>%.3g</td><td>%.3g</td><td>%.3g</td>",
            p->run_count, p->seconds, p->fastest, p->slowest, p->cpu_seconds, p->load_seconds,
            p->bytes * 1e-6);
    cell(&p->error.mse, f);
    cell(&p->error.variance, f);
    cell(&p->error.bias2, f);
    fprintf(f, "</tr>\n");
}

static void write_table(const struct study *study, FILE *f) {
    fprintf(f, "<h2>Settings</h2>\n<div class=\"settings\"><table><tr><th>setting</th><th>runs</th>"
               "<th>seconds</th><th>from - to</th><th>processor s</th><th>reading s</th><th>MB</th><th>relMSE</th><th>variance</th>"
               "<th>squared bias</th></tr>\n");
    for (size_t i = 0; i < study->point_count; i++)
        write_row(study, &study->points[i], f);
    fprintf(f, "</table></div>\n<p>relMSE of one run = variance + squared bias, each relative to the "
               "reference; ± is half a 95 %% confidence interval. Seconds are medians of the "
               "runs. A squared bias that its interval cannot tell from 0 may be negative. Shaded: on the "
               "Pareto front of error and seconds. MB: most memory in use beyond what was before "
               "the scene was read.</p>\n");
}

static void write_picture(const char *title, const char *picture, const char *difference, FILE *f) {
    fprintf(f, "<figure><img alt=\"picture\" src=\"%s\">", picture);
    if (difference)
        fprintf(f, "<img alt=\"difference\" src=\"%s\">", difference);
    fprintf(f, "<figcaption>");
    plot_escape(title, f);
    fprintf(f, "</figcaption></figure>\n");
}

static void write_pictures(const struct study *study, FILE *f) {
    char text[600];
    fprintf(f, "<h2>Pictures</h2>\n<p>First run of each setting, and (picture - reference) / reference: "
               "red above, blue below, white at twice the reference.</p>\n<div class=\"pictures\">\n");
    write_picture("reference", study->reference_thumbnail, NULL, f);
    for (size_t i = 0; i < study->point_count; i++) {
        const struct study_point *p = &study->points[i];
        study_label(study, p, text, sizeof text - 40);
        const size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, ": relMSE %.3g", p->error.mse.value);
        write_picture(text, p->thumbnail, p->difference, f);
    }
    fprintf(f, "</div>\n</body></html>\n");
}

bool study_write_html(const struct study *study, const char *path) {
    struct file_text t;
    if (!file_text_begin(&t, path))
        return false;
    FILE *f = t.f;
    write_head(study, f);
    write_plots(study, f);
    write_table(study, f);
    write_pictures(study, f);
    return file_text_end(&t);
}
