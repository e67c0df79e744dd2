// SPDX-License-Identifier: Apache-2.0
#include "image/comparison_report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/log.h"

struct line {
    const char *name, *label;
    double value, error;
};

enum { LINES = 7 };

static void list_lines(const struct comparison *c, struct line lines[LINES]) {
    const struct metrics *m = &c->metrics;
    const struct line all[LINES] = {
        {"mean", "mean ratio", m->mean_ratio.value, m->mean_ratio.error},
        {"mse", "MSE", m->mse.value, m->mse.error},
        {"relmse", "relMSE", m->relmse.value, m->relmse.error},
        {"psnr", "PSNR (dB)", m->psnr.value, m->psnr.error},
        {"ssim", "SSIM", m->ssim.value, m->ssim.error},
        {"flip", "HDR-FLIP", c->flip_hdr.value, c->flip_hdr.error},
        {"ldr-flip", "LDR-FLIP", c->flip_ldr.value, c->flip_ldr.error},
    };
    memcpy(lines, all, sizeof all);
}

// How bad a metric's value is: the larger, the worse.
static double badness(const struct line *l) {
    if (strcmp(l->name, "mean") == 0)
        return fabs(l->value - 1);
    if (strcmp(l->name, "ssim") == 0)
        return 1 - l->value;
    return strcmp(l->name, "psnr") == 0 ? -l->value : l->value;
}

bool comparison_check_limit(const char *text, const struct comparison *c, bool *exceeded) {
    struct line lines[LINES];
    list_lines(c, lines);
    char *end;
    const size_t n = strcspn(text, "=");
    const double limit = text[n] ? strtod(text + n + 1, &end) : NAN;
    for (int i = 0; i < LINES; i++)
        if (strlen(lines[i].name) == n && strncmp(lines[i].name, text, n) == 0) {
            if (isnan(limit) || *end || end == text + n + 1)
                break;
            *exceeded = !(badness(&lines[i]) <= limit);
            return true;
        }
    log_error("--fail-above: found '%s', expected METRIC=X with mean, mse, relmse, psnr, ssim, flip "
              "or ldr-flip",
              text);
    return false;
}

static void add_level(struct json *out, const char *name, const struct ztest_level *l) {
    struct json *o = json_add_object(out, name);
    json_add_number(o, "share", l->share);
    json_add_number(o, "expected_share", 1 - l->p_limit);
    json_add_number(o, "least_share", l->least_share);
    json_add_count(o, "values", (int64_t)l->values);
    json_add_number(o, "largest_z", l->largest_z);
    json_add_number(o, "p_limit", l->p_limit);
    json_add_bool(o, "pass", l->pass);
}

void comparison_print_json(const struct comparison *c) {
    struct line lines[LINES];
    list_lines(c, lines);
    struct json *out = json_new_object();
    json_add_count(out, "width", c->width);
    json_add_count(out, "height", c->height);
    for (int i = 0; i < LINES; i++) {
        struct json *o = json_add_object(out, lines[i].name);
        json_add_number(o, "value", lines[i].value);
        json_add_number(o, "error", lines[i].error);
    }
    json_add_number(out, "mse_noise", c->metrics.mse_noise);
    json_add_number(out, "relmse_noise", c->metrics.relmse_noise);
    json_add_number(out, "eps", c->metrics.eps);
    json_add_count(out, "left_out", (int64_t)c->metrics.left_out);
    if (c->tested) {
        struct json *z = json_add_object(out, "ztest");
        json_add_number(z, "samples", c->samples);
        json_add_number(z, "ref_samples", c->ref_samples);
        add_level(z, "pixels", &c->ztest.pixels);
        add_level(z, "blocks", &c->ztest.blocks);
        add_level(z, "mean", &c->ztest.mean);
        json_add_number(z, "relative_difference", c->ztest.relative_difference);
        json_add_number(z, "relative_error", c->ztest.relative_error);
        json_add_bool(z, "pass", c->ztest.pass);
    }
    json_print(out, true);
    json_destroy(out);
}

static void print_level(const char *name, const struct ztest_level *l) {
    printf("z-test %-8s %7.3f %% of %zu values agree (noise alone: %.7g %%, asked: %.2f %%), largest z "
           "%.2f: %s\n", name, 100 * l->share, l->values, 100 * (1 - l->p_limit),
           100 * l->least_share, l->largest_z, l->pass ? "pass" : "FAIL");
}

void comparison_print(const struct comparison *c) {
    struct line lines[LINES];
    list_lines(c, lines);
    for (int i = 0; i < LINES; i++) {
        printf("%-12s %.6g", lines[i].label, lines[i].value);
        if (isfinite(lines[i].error))
            printf(" +- %.2g (95 %%)", 1.96 * lines[i].error);
        else if (isfinite(c->metrics.mse_noise))
            printf(" +- not known");
        putchar('\n');
    }
    if (isfinite(c->metrics.mse_noise))
        printf("noise alone: MSE %.6g, relMSE %.6g\n", c->metrics.mse_noise,
               c->metrics.relmse_noise);
    if (!c->tested)
        return;
    print_level("pixels", &c->ztest.pixels);
    print_level("blocks", &c->ztest.blocks);
    print_level("mean", &c->ztest.mean);
    printf("mean luminance differs by %+.4f %% +- %.4f %% (one standard error)\n",
           100 * c->ztest.relative_difference, 100 * c->ztest.relative_error);
}
