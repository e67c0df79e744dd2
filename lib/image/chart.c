// SPDX-License-Identifier: Apache-2.0
#include "image/chart.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "image/lettering.h"
#include "math/colour.h"

void chart_begin_line(struct chart *c, unsigned colour, float width) {
    mem_grow(&c->lines, &c->line_capacity, c->line_count + 1, sizeof *c->lines);
    c->lines[c->line_count++] = (struct chart_line){.colour = colour, .width = width};
}

void chart_add_point(struct chart *c, double x, double y) {
    struct chart_line *l = &c->lines[c->line_count - 1];
    mem_grow(&l->points, &l->capacity, 2 * l->count + 2, sizeof *l->points);
    l->points[2 * l->count] = (float)x;
    l->points[2 * l->count + 1] = (float)y;
    l->count++;
}

void chart_add_label(struct chart *c, double x, double y, const char *text) {
    mem_grow(&c->labels, &c->label_capacity, c->label_count + 1, sizeof *c->labels);
    struct chart_label *l = &c->labels[c->label_count++];
    l->x = (float)x;
    l->y = (float)y;
    snprintf(l->text, sizeof l->text, "%s", text);
}

void chart_finish(struct chart *c) {
    for (size_t i = 0; i < c->line_count; i++)
        mem_free(c->lines[i].points);
    mem_free(c->lines);
    mem_free(c->labels);
    *c = (struct chart){0};
}

// ---- SVG ------------------------------------------------------------------------------------

static bool write_svg(const struct chart *c, const char *path) {
    struct file_text t;
    if (!file_text_begin(&t, path))
        return false;
    FILE *f = t.f;
    fprintf(f, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\">\n"
               "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n", c->width, c->height);
    for (size_t i = 0; i < c->line_count; i++) {
        const struct chart_line *l = &c->lines[i];
        fprintf(f, "<polyline fill=\"none\" stroke=\"#%06x\" stroke-width=\"%g\" points=\"",
                l->colour, (double)l->width);
        for (size_t k = 0; k < l->count; k++)
            fprintf(f, "%.2f,%.2f ", (double)l->points[2 * k], (double)l->points[2 * k + 1]);
        fprintf(f, "\"/>\n");
    }
    for (size_t i = 0; i < c->label_count; i++)
        fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" font-family=\"sans-serif\" font-size=\"12\">%s"
                   "</text>\n", (double)c->labels[i].x, (double)c->labels[i].y, c->labels[i].text);
    fprintf(f, "</svg>\n");
    return file_text_end(&t);
}

// ---- PNG ------------------------------------------------------------------------------------

static float to_segment(float x, float y, const float *a) {
    const float dx = a[2] - a[0], dy = a[3] - a[1], l2 = dx * dx + dy * dy;
    float t = l2 > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / l2 : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return hypotf(x - a[0] - t * dx, y - a[1] - t * dy);
}

static int clamp_int(float v, int hi) {
    return v < 0 ? 0 : v > (float)hi ? hi : (int)v;
}

static void blend(struct image *im, int x, int y, unsigned colour, float coverage) {
    float *p = im->pixels + 3 * ((size_t)y * (size_t)im->width + (size_t)x);
    for (int k = 0; k < 3; k++) {
        const float display = (float)(colour >> (16 - 8 * k) & 255) / 255;
        p[k] += coverage * (colour_srgb_to_linear(display) - p[k]);
    }
}

static void draw_segment(struct image *im, const float *a, unsigned colour, float width) {
    const float margin = 0.5f * width + 1;
    const int x0 = clamp_int(fminf(a[0], a[2]) - margin, im->width - 1);
    const int x1 = clamp_int(fmaxf(a[0], a[2]) + margin, im->width - 1);
    const int y0 = clamp_int(fminf(a[1], a[3]) - margin, im->height - 1);
    const int y1 = clamp_int(fmaxf(a[1], a[3]) + margin, im->height - 1);
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++) {
            const float d = to_segment((float)x + 0.5f, (float)y + 0.5f, a);
            const float coverage = 0.5f * width + 0.5f - d;
            if (coverage > 0)
                blend(im, x, y, colour, coverage < 1 ? coverage : 1);
        }
}

static bool write_png(const struct chart *c, const char *path) {
    struct image im;
    if (!image_init(&im, c->width, c->height, 3))
        return false;
    for (size_t i = 0; i < 3 * (size_t)c->width * (size_t)c->height; i++)
        im.pixels[i] = 1;
    for (size_t i = 0; i < c->line_count; i++)
        for (size_t k = 0; k + 1 < c->lines[i].count; k++)
            draw_segment(&im, c->lines[i].points + 2 * k, c->lines[i].colour, c->lines[i].width);
    for (size_t i = 0; i < c->label_count; i++)
        lettering_draw(&im, (int)c->labels[i].x, (int)c->labels[i].y - 10, c->labels[i].text,
                       (const float[3]){0, 0, 0});
    const bool good = image_write_png(path, &im);
    image_finish(&im);
    return good;
}

bool chart_write(const struct chart *c, const char *path) {
    char extension[8];
    file_extension(path, extension, sizeof extension);
    if (strcmp(extension, "svg") == 0)
        return write_svg(c, path);
    if (strcmp(extension, "png") == 0)
        return write_png(c, path);
    log_error("%s: is no format of drawings; expected .svg or .png", path);
    return false;
}
