// SPDX-License-Identifier: Apache-2.0
#include "sink/lighting.h"

#include "base/mem.h"
#include "math/quadrature.h"

enum { FINE_WIDTH = 4096 };

static void radiance_of(const struct sky *sky, const double d[3], double rgb[3]) {
    const spectrum e = sky->radiance(sky->ctx, v3((float)d[0], (float)d[1], (float)d[2]));
    for (int c = 0; c < 3; c++)
        rgb[c] = (double)e[c];
}

// ---- cells --------------------------------------------------------------------------------------

// Mean over a cell, sampled n by n in rows of equal solid angle.
static void mean_over_cell(const struct sky *sky, const struct source_basis *b, int x, int y, int n,
                           double mean[3]) {
    const double top = cos(M_PI * y / b->height), end = cos(M_PI * (y + 1) / b->height);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            const double c = top + (end - top) * (j + 0.5) / n;
            double d[3], rgb[3];
            latlong_direction(x + (i + 0.5) / n, acos(c) / M_PI * b->height, b->width, b->height, d);
            radiance_of(sky, d, rgb);
            for (int k = 0; k < 3; k++)
                mean[k] += rgb[k] / ((double)n * n);
        }
}

typedef void wavelet_matrix(enum wavelet w, double *x, size_t rows, size_t columns, double *scratch);

static void transform(const struct source_basis *b, wavelet_matrix *forward_or_back, float *weights) {
    const size_t longest = (size_t)(b->width > b->height ? b->width : b->height);
    double *plane = mem_array(b->count + 2 * longest, sizeof *plane);
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < b->count; i++)
            plane[i] = (double)weights[3 * i + k];
        forward_or_back(b->wavelet, plane, (size_t)b->height, (size_t)b->width, plane + b->count);
        for (uint32_t i = 0; i < b->count; i++)
            weights[3 * i + k] = (float)plane[i];
    }
    mem_free(plane);
}

// Cells are sampled about as finely as the texels of any environment that is in use.
static void project_on_cells(const struct source_basis *b, const struct sky *sky, float *weights) {
    const int n = b->width < FINE_WIDTH / 2 ? FINE_WIDTH / b->width : 2;
    for (int y = 0; y < b->height; y++)
        for (int x = 0; x < b->width; x++) {
            double mean[3] = {0};
            mean_over_cell(sky, b, x, y, n, mean);
            for (int k = 0; k < 3; k++)
                weights[3 * (y * b->width + x) + k] = (float)mean[k];
        }
    if (b->transformed)
        transform(b, wavelet_forward_matrix, weights);
}

// ---- harmonics ----------------------------------------------------------------------------------

// Exact for an environment of low order.
static void project_on_harmonics(const struct source_basis *b, const struct sky *sky, float *weights) {
    enum { WIDTH = 1024, HEIGHT = 512 };
    double *sum = mem_array((size_t)b->count * 3, sizeof *sum);
    double nodes[HEIGHT], shares[HEIGHT];
    gauss_legendre(HEIGHT, nodes, shares);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            double d[3], rgb[3], sh[SOURCE_MOST_SH];
            latlong_direction(x + 0.5, acos(1 - 2 * nodes[y]) / M_PI * HEIGHT, WIDTH, HEIGHT, d);
            radiance_of(sky, d, rgb);
            spherical_harmonics(d, b->order, sh);
            for (uint32_t i = 0; i < b->count; i++)
                for (int k = 0; k < 3; k++)
                    sum[3 * i + (uint32_t)k] += rgb[k] * sh[i] * shares[y] * 4 * M_PI / WIDTH;
        }
    for (uint32_t i = 0; i < 3 * b->count; i++)
        weights[i] = (float)sum[i];
    mem_free(sum);
}

// ---- all ----------------------------------------------------------------------------------------

void lighting_project(const struct source_basis *b, const struct sky *sky, float *weights) {
    if (b->kind == SOURCE_PIXELS)
        project_on_cells(b, sky, weights);
    else
        project_on_harmonics(b, sky, weights);
}

void lighting_unfold(const struct source_basis *b, float *weights) {
    if (b->kind == SOURCE_PIXELS && b->transformed)
        transform(b, wavelet_inverse_matrix, weights);
}

spectrum lighting_radiance(const struct source_basis *b, const float *weights, vec3 w) {
    const float to[3] = {w[0], w[1], w[2]};
    const double d[3] = {(double)w[0], (double)w[1], (double)w[2]};
    if (b->kind == SOURCE_PIXELS) {
        const float *p = weights + 3 * latlong_cell(to, b->width, b->height);
        return spectrum_rgb(p[0], p[1], p[2]);
    }
    double sh[SOURCE_MOST_SH], sum[3] = {0};
    spherical_harmonics(d, b->order, sh);
    for (uint32_t i = 0; i < b->count; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += sh[i] * (double)weights[3 * i + (uint32_t)k];
    return spectrum_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
}
