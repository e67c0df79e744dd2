// SPDX-License-Identifier: Apache-2.0
#include "light/area_picture.h"

#include "base/mem.h"

enum { LEAST_SIZE = 16, MOST_SIZE = 256, POINTS = 2 }; // table; looked up in POINTS^2 places a cell

// Cells of the table by luminance; every cell keeps a hundredth of the mean, so that none is out of
// reach. Returns the variance of the cells over the squared mean.
static double fill(const struct texture_ref *radiance, const struct area_mesh *mesh, int n,
                   float *cells) {
    double sum = 0, sum2 = 0;
    for (int i = 0; i < n * n; i++) {
        cells[i] = 0;
        for (int k = 0; k < POINTS * POINTS; k++) {
            struct light_sample s;
            struct texture_point at;
            const struct vec2 xy = {((float)(i % n) + ((float)(k % POINTS) + 0.5f) / POINTS) / (float)n,
                                    ((float)(i / n) + ((float)(k / POINTS) + 0.5f) / POINTS) / (float)n};
            area_mesh_place_at(mesh, xy, &s, &at);
            const float v = spectrum_luminance(texture_eval(radiance, &at));
            cells[i] += clampf(v, 0, 1e30f) / (POINTS * POINTS);
        }
        sum += (double)cells[i];
        sum2 += (double)cells[i] * (double)cells[i];
    }
    const double mean = sum / (n * n);
    for (int i = 0; i < n * n; i++)
        cells[i] = 0.99f * cells[i] + (float)(0.01 * mean);
    return mean > 0 ? sum2 / (n * n) / (mean * mean) - 1 : 0;
}

void area_picture_init(struct area_picture *t, const struct texture_ref *radiance,
                       const struct area_mesh *mesh) {
    const double worth = 0.05; // variance over mean^2, below which uniform sampling is as good
    int width, height;
    *t = (struct area_picture){0};
    if (!radiance->texture || mesh->kind != POLYGON_RECTANGLE)
        return;
    texture_size(radiance->texture, &width, &height);
    const int texels = width > height ? width : height;
    const int n = texels <= LEAST_SIZE ? 4 * LEAST_SIZE : texels < MOST_SIZE ? texels : MOST_SIZE;
    float *cells = mem_array((size_t)n * (size_t)n, sizeof *cells);
    float *rows = mem_array((size_t)n, sizeof *rows);
    if (fill(radiance, mesh, n, cells) > worth) {
        t->size = n;
        t->columns = mem_array((size_t)n, sizeof *t->columns);
        for (int y = 0; y < n; y++) {
            distribution_init(&t->columns[y], cells + (size_t)y * (size_t)n, (uint32_t)n);
            rows[y] = (float)t->columns[y].total;
        }
        distribution_init(&t->rows, rows, (uint32_t)n);
    }
    mem_free(cells);
    mem_free(rows);
}

void area_picture_finish(struct area_picture *t) {
    for (int y = 0; y < t->size; y++)
        distribution_finish(&t->columns[y]);
    distribution_finish(&t->rows);
    mem_free(t->columns);
    *t = (struct area_picture){0};
}

static float cell_density(const struct area_picture *t, uint32_t row, uint32_t column) {
    const float n = (float)t->size;
    return n * distribution_pmf(&t->rows, row) * n * distribution_pmf(&t->columns[row], column);
}

struct vec2 area_picture_sample(const struct area_picture *t, struct vec2 u, float *density) {
    float pmf, x, y;
    const uint32_t row = distribution_sample(&t->rows, u.y, &pmf, &y);
    const uint32_t column = distribution_sample(&t->columns[row], u.x, &pmf, &x);
    *density = cell_density(t, row, column);
    return (struct vec2){((float)column + x) / (float)t->size, ((float)row + y) / (float)t->size};
}

float area_picture_density(const struct area_picture *t, struct vec2 xy) {
    const int n = t->size;
    const int x = (int)(clampf(xy.x, 0, 1) * (float)n), y = (int)(clampf(xy.y, 0, 1) * (float)n);
    return cell_density(t, (uint32_t)(y < n ? y : n - 1), (uint32_t)(x < n ? x : n - 1));
}
