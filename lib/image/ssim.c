// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "image/metrics.h"

enum { RADIUS = 5, WINDOW = 2 * RADIUS + 1 };

// Planes whose local means SSIM needs.
enum { X, Y, XX, YY, XY, MOMENTS };

struct ssim {
    const struct image *ref, *test;
    float gain;
    float *planes[MOMENTS]; // after the horizontal pass, `columns` wide
    float weights[WINDOW];
    int columns, rows;      // of windows
    int reach_x, reach_y;   // radius of the window, smaller in small pictures
    double *row_sums;
};

static float shown_luminance(const struct image *im, int x, int y, float gain) {
    const float *p = im->pixels + 3 * ((size_t)y * (size_t)im->width + (size_t)x);
    return metrics_display(rgb_luminance(p), gain);
}

static void make_weights(struct ssim *s) {
    for (int i = -RADIUS; i <= RADIUS; i++)
        s->weights[i + RADIUS] = (float)exp(-i * i / (2 * 1.5 * 1.5));
}

static float weight_sum(const struct ssim *s, int reach) {
    float sum = 0;
    for (int i = -reach; i <= reach; i++)
        sum += s->weights[i + RADIUS];
    return sum;
}

static void horizontal_pass(void *ctx, size_t row, int worker) {
    struct ssim *s = ctx;
    const float total = weight_sum(s, s->reach_x);
    (void)worker;
    for (int column = 0; column < s->columns; column++) {
        float sums[MOMENTS] = {0};
        for (int i = 0; i <= 2 * s->reach_x; i++) {
            const float w = s->weights[i - s->reach_x + RADIUS] / total;
            const float a = shown_luminance(s->ref, column + i, (int)row, s->gain);
            const float b = shown_luminance(s->test, column + i, (int)row, s->gain);
            sums[X] += w * a;
            sums[Y] += w * b;
            sums[XX] += w * a * a;
            sums[YY] += w * b * b;
            sums[XY] += w * a * b;
        }
        for (int m = 0; m < MOMENTS; m++)
            s->planes[m][row * (size_t)s->columns + (size_t)column] = sums[m];
    }
}

// Equation 13 of the paper, with alpha = beta = gamma = 1.
static double similarity(const double m[MOMENTS]) {
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    const double xx = m[XX] - m[X] * m[X], yy = m[YY] - m[Y] * m[Y], xy = m[XY] - m[X] * m[Y];
    return (2 * m[X] * m[Y] + c1) * (2 * xy + c2) /
           ((m[X] * m[X] + m[Y] * m[Y] + c1) * (xx + yy + c2));
}

static void vertical_pass(void *ctx, size_t row, int worker) {
    struct ssim *s = ctx;
    const double total = (double)weight_sum(s, s->reach_y);
    double sum = 0;
    (void)worker;
    for (int column = 0; column < s->columns; column++) {
        double m[MOMENTS] = {0};
        for (int i = 0; i <= 2 * s->reach_y; i++) {
            const double w = (double)s->weights[i - s->reach_y + RADIUS] / total;
            const size_t at = (row + (size_t)i) * (size_t)s->columns + (size_t)column;
            for (int k = 0; k < MOMENTS; k++)
                m[k] += w * (double)s->planes[k][at];
        }
        sum += similarity(m);
    }
    s->row_sums[row] = sum;
}

static int reach_for(int size) {
    return size >= WINDOW ? RADIUS : (size - 1) / 2;
}

double ssim_measure(const struct image *ref, const struct image *test, double exposure,
                    int threads) {
    struct ssim s = {.ref = ref, .test = test, .gain = (float)exp2(exposure)};
    s.reach_x = reach_for(ref->width);
    s.reach_y = reach_for(ref->height);
    s.columns = ref->width - 2 * s.reach_x;
    s.rows = ref->height - 2 * s.reach_y;
    make_weights(&s);
    for (int m = 0; m < MOMENTS; m++)
        s.planes[m] = mem_array((size_t)s.columns * (size_t)ref->height, sizeof(float));
    s.row_sums = mem_array((size_t)s.rows, sizeof *s.row_sums);
    thread_for(threads, (size_t)ref->height, horizontal_pass, &s);
    thread_for(threads, (size_t)s.rows, vertical_pass, &s);
    double sum = 0;
    for (int row = 0; row < s.rows; row++)
        sum += s.row_sums[row];
    for (int m = 0; m < MOMENTS; m++)
        mem_free(s.planes[m]);
    mem_free(s.row_sums);
    return sum / ((double)s.columns * s.rows);
}
