// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdio.h>

#include "driver/brdf.h"
#include "image/chart.h"

enum { SIZE = 640, STEPS = 721, NET = 48 };

const char *const brdf_plot_names[] = {"cut", "lobe", "curve", NULL};

static const unsigned palette[] = {0x1f77b4, 0xd62728, 0x2ca02c, 0x9467bd, 0xff7f0e, 0x17becf};
static const unsigned axis_colour = 0xbbbbbb;

static vec3 direction(double theta, double phi) {
    return v3((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta));
}

// f cos_i; the eye stands at -x, so that mirrored light goes to +x.
static spectrum value(const struct material *m, double eye, vec3 wi) {
    struct closure_stack stack;
    const struct closure *c = material_at(m, direction(eye, M_PI), &stack);
    float pdf;
    return c ? closure_eval(c, wi, &pdf) : spectrum_grey(0);
}

static double radius(const struct material *m, double eye, vec3 wi) {
    return cbrt((double)spectrum_luminance(value(m, eye, wi)));
}

static double largest_radius(const struct material *m, const double *degrees, int count) {
    double most = 1e-30;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < STEPS; k++)
            most = fmax(most, radius(m, degrees[i] * M_PI / 180,
                                     direction(k * 2 * M_PI / (STEPS - 1), 0)));
    return most;
}

static void draw_axes(struct chart *c) {
    chart_begin_line(c, axis_colour, 1);
    chart_add_point(c, 20, SIZE / 2);
    chart_add_point(c, SIZE - 20, SIZE / 2);
    chart_begin_line(c, axis_colour, 1);
    chart_add_point(c, SIZE / 2, 20);
    chart_add_point(c, SIZE / 2, SIZE / 2);
}

static void label_angle(struct chart *c, int i, double degrees) {
    char text[32];
    snprintf(text, sizeof text, "%g", degrees);
    chart_begin_line(c, palette[i % 6], 3);
    chart_add_point(c, 24, SIZE - 20 - 18 * i);
    chart_add_point(c, 54, SIZE - 20 - 18 * i);
    chart_add_label(c, 62, SIZE - 15 - 18 * i, text);
}

static void draw_cuts(struct chart *c, const struct material *m, const double *degrees, int count) {
    const double scale = (SIZE / 2 - 30) / largest_radius(m, degrees, count);
    draw_axes(c);
    for (int i = 0; i < count; i++) {
        chart_begin_line(c, palette[i % 6], 1.5f);
        for (int k = 0; k < STEPS; k++) {
            const double theta = k * 2 * M_PI / (STEPS - 1);
            const double r = scale * radius(m, degrees[i] * M_PI / 180, direction(theta, 0));
            chart_add_point(c, SIZE / 2 + r * sin(theta), SIZE / 2 - r * cos(theta));
        }
        label_angle(c, i, degrees[i]);
    }
}

// Seen from the side and a little above.
static void add_projected(struct chart *c, vec3 w, double r) {
    const double x = r * (double)w[0], y = r * (double)w[1], z = r * (double)w[2];
    chart_add_point(c, SIZE / 2 + 0.94 * x + 0.34 * y,
                    SIZE / 2 - 0.94 * z - 0.34 * (0.94 * y - 0.34 * x));
}

static void draw_lobes(struct chart *c, const struct material *m, const double *degrees,
                       int count) {
    const double scale = (SIZE / 2 - 30) / largest_radius(m, degrees, count);
    draw_axes(c);
    for (int i = 0; i < count; i++) {
        const double eye = degrees[i] * M_PI / 180;
        for (int k = 0; k < 2 * NET; k++) { // circles, then meridians
            chart_begin_line(c, palette[i % 6], 0.6f);
            for (int j = 0; j <= 2 * NET; j++) {
                const double theta = k < NET ? M_PI * (k + 0.5) / NET : M_PI * j / (2 * NET);
                const double phi = k < NET ? M_PI * j / NET : 2 * M_PI * (k - NET) / NET;
                const vec3 w = direction(theta, phi);
                add_projected(c, w, scale * radius(m, eye, w));
            }
        }
        label_angle(c, i, degrees[i]);
    }
}

// Retro-reflection about the half vector: eye and light coincide at theta_h.
static spectrum half_value(const struct material *m, double theta_h) {
    struct closure_stack stack;
    const vec3 w = direction(theta_h, 0);
    const struct closure *c = material_at(m, w, &stack);
    float pdf;
    return c ? closure_eval(c, w, &pdf) * (1 / w[2]) : spectrum_grey(0);
}

static void draw_curves(struct chart *c, const struct material *m) {
    static const unsigned colours[3] = {0xd62728, 0x2ca02c, 0x1f77b4};
    enum { DECADES_BELOW = 4, DECADES = 8 }; // 1e-4 to 1e4 per sr
    const double x0 = 60, x1 = SIZE - 20, y0 = SIZE - 40, y1 = 20;
    for (int d = 0; d <= DECADES; d++) {
        char text[32];
        const double y = y0 + (y1 - y0) * d / DECADES;
        snprintf(text, sizeof text, "%g", pow(10, d - DECADES_BELOW));
        chart_begin_line(c, axis_colour, 1);
        chart_add_point(c, x0, y);
        chart_add_point(c, x1, y);
        chart_add_label(c, 4, y + 4, text);
    }
    for (int d = 0; d <= 90; d += 15) {
        char text[32];
        snprintf(text, sizeof text, "%d", d);
        chart_add_label(c, x0 + (x1 - x0) * d / 90 - 6, SIZE - 20, text);
    }
    for (int k = 0; k < 3; k++) {
        chart_begin_line(c, colours[k], 1.5f);
        for (int i = 0; i < 500; i++) {
            const double theta = 89.9 * i / 499;
            const double f = (double)half_value(m, theta * M_PI / 180)[k];
            const double decades = fmin(fmax(log10(fmax(f, 1e-30)) + DECADES_BELOW, 0), DECADES);
            chart_add_point(c, x0 + (x1 - x0) * theta / 90, y0 + (y1 - y0) * decades / DECADES);
        }
    }
}

bool brdf_draw(const struct material *m, enum brdf_plot plot, const double *degrees, int count,
               const char *path) {
    struct chart c = {.width = SIZE, .height = SIZE};
    if (plot == BRDF_PLOT_CUT)
        draw_cuts(&c, m, degrees, count);
    else if (plot == BRDF_PLOT_LOBE)
        draw_lobes(&c, m, degrees, count);
    else
        draw_curves(&c, m);
    const bool good = chart_write(&c, path);
    chart_finish(&c);
    return good;
}
