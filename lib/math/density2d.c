// SPDX-License-Identifier: Apache-2.0
#include "math/density2d.h"

#include <string.h>

static void build_slice(const struct density2d *d, float *data, float *rows, float *columns) {
    const int w = d->width, h = d->height;
    double below = 0, before = 0;
    for (int y = 0; y < h; y++) {
        double sum = 0;
        for (int x = 0; x + 1 < w; x++) {
            sum += 0.5 / (w - 1) * ((double)data[y * w + x] + (double)data[y * w + x + 1]);
            columns[y * (w - 1) + x] = (float)sum;
        }
        if (y > 0) {
            below += 0.5 / (h - 1) * (before + sum);
            rows[y - 1] = (float)below;
        }
        before = sum;
    }
    const float scale = (float)(1 / below);
    for (int i = 0; i < w * h; i++)
        data[i] *= scale;
    for (int i = 0; i < (w - 1) * h; i++)
        columns[i] *= scale;
    for (int i = 0; i < h - 1; i++)
        rows[i] *= scale;
}

static bool is_black(const float *data, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += (double)data[i];
    return !(sum > 1e-30);
}

void density2d_init(struct density2d *d, const float *values, int width, int height,
                    const int counts[2], const float *const params[2], struct arena *arena) {
    const size_t slices = (size_t)counts[0] * (size_t)counts[1];
    const size_t n = (size_t)width * (size_t)height, rows = (size_t)height - 1;
    const size_t columns = (size_t)(width - 1) * (size_t)height;
    *d = (struct density2d){width, height, {counts[0], counts[1]}, {params[0], params[1]},
                            arena_alloc(arena, slices * n * sizeof(float)),
                            arena_alloc(arena, slices * rows * sizeof(float)),
                            arena_alloc(arena, slices * columns * sizeof(float))};
    memcpy(d->data, values, slices * n * sizeof(float));
    for (size_t s = 0; s < slices; s++) {
        float *data = d->data + s * n;
        if (is_black(data, n))
            for (size_t i = 0; i < n; i++)
                data[i] = 1;
        build_slice(d, data, d->rows + s * rows, d->columns + s * columns);
    }
}

// The interval [i, i + 1] of p and where in it.
static int find_interval(const float *values, int count, float p, float *t) {
    *t = 0;
    if (count == 1)
        return 0;
    int lo = 0, hi = count - 1;
    while (hi - lo > 1) {
        const int middle = (lo + hi) / 2;
        if (values[middle] < p)
            lo = middle;
        else
            hi = middle;
    }
    *t = clampf((p - values[lo]) / (values[lo + 1] - values[lo]), 0, 1);
    return lo;
}

struct slice_mix slice_mix_at(const int counts[2], const float *const params[2], float p0,
                              float p1) {
    struct slice_mix mix = {0};
    float t0, t1;
    const int i0 = find_interval(params[0], counts[0], p0, &t0);
    const int i1 = find_interval(params[1], counts[1], p1, &t1);
    for (int k = 0; k < 4; k++) {
        const int a = k >> 1, b = k & 1;
        const float weight = (a ? t0 : 1 - t0) * (b ? t1 : 1 - t1);
        if (weight > 0) {
            mix.slice[mix.count] = (uint32_t)((i0 + a) * counts[1] + i1 + b);
            mix.weight[mix.count++] = weight;
        }
    }
    return mix;
}

static float look(const float *table, size_t stride, const struct slice_mix *mix, int index) {
    float sum = 0;
    for (int k = 0; k < mix->count; k++)
        sum += mix->weight[k] * table[mix->slice[k] * stride + (size_t)index];
    return sum;
}

// Four corners of the patch that holds p, and p inside it.
struct patch {
    int x, y;
    float fx, fy;
};

static struct patch patch_at(int width, int height, struct vec2 p) {
    const float x = clampf(p.x, 0, 1) * (float)(width - 1);
    const float y = clampf(p.y, 0, 1) * (float)(height - 1);
    struct patch c = {(int)x, (int)y, 0, 0};
    c.x = c.x > width - 2 ? width - 2 : c.x;
    c.y = c.y > height - 2 ? height - 2 : c.y;
    c.fx = x - (float)c.x;
    c.fy = y - (float)c.y;
    return c;
}

float grid_eval(const float *values, int width, int height, struct vec2 p) {
    const struct patch c = patch_at(width, height, p);
    const float *v = values + (size_t)c.y * (size_t)width + c.x;
    return lerpf(c.fy, lerpf(c.fx, v[0], v[1]), lerpf(c.fx, v[width], v[width + 1]));
}

float grid_eval_mix(const float *values, int width, int height, size_t stride,
                    const struct slice_mix *mix, struct vec2 p) {
    float sum = 0;
    for (int k = 0; k < mix->count; k++)
        sum += mix->weight[k] * grid_eval(values + mix->slice[k] * stride, width, height, p);
    return sum;
}

static size_t data_stride(const struct density2d *d) {
    return (size_t)d->width * (size_t)d->height;
}

// Integral along the row between y and y + 1, up to column x (0: none).
static float along(const struct density2d *d, const struct slice_mix *mix, int y, float fy, int x) {
    const int w = d->width - 1;
    const size_t stride = (size_t)w * (size_t)d->height;
    if (x == 0)
        return 0;
    return lerpf(fy, look(d->columns, stride, mix, y * w + x - 1),
                 look(d->columns, stride, mix, (y + 1) * w + x - 1));
}

static float below(const struct density2d *d, const struct slice_mix *mix, int y) {
    return y == 0 ? 0 : look(d->rows, (size_t)d->height - 1, mix, y - 1);
}

// Densities at the left and right end of the patch's row.
static void row_ends(const struct density2d *d, const struct slice_mix *mix, const struct patch *c,
                     float *left, float *right) {
    const int i = c->y * d->width + c->x;
    const size_t s = data_stride(d);
    *left = lerpf(c->fy, look(d->data, s, mix, i), look(d->data, s, mix, i + d->width));
    *right = lerpf(c->fy, look(d->data, s, mix, i + 1), look(d->data, s, mix, i + 1 + d->width));
}

// x in [0,1] at which the integral of a + (b - a) x reaches `area`.
static float sample_segment(float area, float a, float b) {
    if (!(a + b > 0))
        return 0.5f;
    if (fabsf(a - b) > 1e-4f * (a + b))
        return clampf((a - safe_sqrt(a * a + 2 * area * (b - a))) / (a - b), 0, 1);
    return clampf(2 * area / (a + b), 0, 1);
}

static float segment_area(float x, float a, float b) {
    return x * lerpf(0.5f * x, a, b);
}

// The row of patches that holds a share v of the whole.
static int find_row(const struct density2d *d, const struct slice_mix *mix, float v) {
    int lo = 0, hi = d->height - 1;
    while (hi - lo > 1) {
        const int middle = (lo + hi) / 2;
        if (below(d, mix, middle) < v)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

// The patch of the row up to which the integral along it is h.
static int find_column(const struct density2d *d, const struct slice_mix *mix, int y, float fy,
                       float h) {
    int lo = 0, hi = d->width - 1;
    while (hi - lo > 1) {
        const int middle = (lo + hi) / 2;
        if (along(d, mix, y, fy, middle) < h)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

struct vec2 density2d_sample(const struct density2d *d, const struct slice_mix *mix, struct vec2 u,
                             float *pdf) {
    struct patch c = {0};
    const float dx = (float)(d->width - 1), dy = (float)(d->height - 1);
    const float v = clampf(u.y, 1e-7f, 1 - 0x1p-24f);
    c.y = find_row(d, mix, v);
    const float r0 = along(d, mix, c.y, 0, d->width - 1), r1 = along(d, mix, c.y, 1, d->width - 1);
    c.fy = sample_segment((v - below(d, mix, c.y)) * dy, r0, r1);
    const float h = clampf(u.x, 1e-7f, 1 - 0x1p-24f) * lerpf(c.fy, r0, r1);
    c.x = find_column(d, mix, c.y, c.fy, h);
    float left, right;
    row_ends(d, mix, &c, &left, &right);
    c.fx = sample_segment((h - along(d, mix, c.y, c.fy, c.x)) * dx, left, right);
    *pdf = lerpf(c.fx, left, right);
    return (struct vec2){((float)c.x + c.fx) / dx, ((float)c.y + c.fy) / dy};
}

struct vec2 density2d_invert(const struct density2d *d, const struct slice_mix *mix, struct vec2 p,
                             float *pdf) {
    const struct patch c = patch_at(d->width, d->height, p);
    float left, right;
    row_ends(d, mix, &c, &left, &right);
    *pdf = lerpf(c.fx, left, right);
    const float r0 = along(d, mix, c.y, 0, d->width - 1), r1 = along(d, mix, c.y, 1, d->width - 1);
    const float h = along(d, mix, c.y, c.fy, c.x) +
                    segment_area(c.fx, left, right) / (float)(d->width - 1);
    const float whole = lerpf(c.fy, r0, r1);
    const float v = below(d, mix, c.y) + segment_area(c.fy, r0, r1) / (float)(d->height - 1);
    return (struct vec2){whole > 0 ? clampf(h / whole, 0, 1) : 0.5f, clampf(v, 0, 1)};
}
