// SPDX-License-Identifier: Apache-2.0
#include "replay/tiles.h"

#include <math.h>
#include <string.h>

#include "base/thread.h"
#include "kernels/tile.h"

enum { ROW = TILE_CHANNELS * TILE_LANES }; // floats of a coefficient of a tile

struct run {
    struct tensor_data t;
    const float *weight;
    const uint32_t *term;
    uint32_t terms, coefficients;
    const struct contraction *contraction;
    float *out, *scratch;
};

static void add_floats(const float *restrict row, const float *weight, float *restrict sum) {
    for (int channel = 0; channel < TILE_CHANNELS; channel++) {
        const float w = weight[channel];
        const int first = channel * TILE_LANES, end = first + TILE_LANES;
        for (int i = first; i < end; i++)
            sum[i] += w * row[i];
    }
}

static void add_bf16(const uint16_t *restrict row, const float *weight, float *restrict sum) {
    for (int channel = 0; channel < TILE_CHANNELS; channel++) {
        const float w = weight[channel];
        const int first = channel * TILE_LANES, end = first + TILE_LANES;
        for (int i = first; i < end; i++)
            sum[i] += w * bf16_to_float(row[i]);
    }
}

// A row of numbers of one kind.
static inline void add_row(const struct tensor_data *t, size_t row, const float *weight, float *sum) {
    if (t->storage == TENSOR_F32)
        add_floats((const float *)t->data + row * ROW, weight, sum);
    else
        add_bf16((const uint16_t *)t->data + row * ROW, weight, sum);
}

// sum += sum_k weight[k] row[index[k]], or row[k] where index is NULL; one channel after the other.
static void add_rows(const struct run *r, size_t tile, const uint32_t *index, const float *weight,
                     uint32_t count, float *sum) {
    if (r->t.storage == TENSOR_ROWS) {
        rows_add(&r->t.rows, r->t.data, r->coefficients, tile, index, weight, count, sum);
        return;
    }
    for (uint32_t k = 0; k < count; k++, weight += TILE_CHANNELS)
        add_row(&r->t, tile * r->coefficients + (index ? index[k] : k), weight, sum);
}

static void dot_tile(void *ctx, size_t tile, int worker) {
    const struct run *r = ctx;
    float sum[ROW] = {0};
    (void)worker;
    add_rows(r, tile, NULL, r->weight, r->coefficients, sum);
    memcpy(r->out + tile * ROW, sum, sizeof sum);
}

void tiles_dot(struct tensor_data t, const float *weight, uint32_t coefficients, size_t tiles,
               float *out, int threads) {
    struct run r = {.t = t, .weight = weight, .coefficients = coefficients,
                    .out = out};
    thread_for(threads, tiles, dot_tile, &r);
}

static void add_terms_tile(void *ctx, size_t tile, int worker) {
    const struct run *r = ctx;
    (void)worker;
    add_rows(r, tile, r->term, r->weight, r->terms, r->out + tile * ROW);
}

void tiles_add_terms(struct tensor_data t, const float *weight,
                     const uint32_t *term, uint32_t terms, uint32_t coefficients, size_t tiles,
                     float *out, int threads) {
    struct run r = {.t = t, .weight = weight, .term = term, .terms = terms,
                    .coefficients = coefficients, .out = out};
    thread_for(threads, tiles, add_terms_tile, &r);
}

struct layers {
    const float *from;
    uint32_t count;
    size_t tiles;
    float *out;
};

static void add_layers_tile(void *ctx, size_t tile, int worker) {
    const struct layers *l = ctx;
    float sum[ROW] = {0};
    (void)worker;
    for (size_t k = 0; k < l->count; k++)
        for (size_t i = 0; i < ROW; i++)
            sum[i] += l->from[(k * l->tiles + tile) * ROW + i];
    memcpy(l->out + tile * ROW, sum, sizeof sum);
}

void tiles_add_layers(const float *layer, uint32_t layers, size_t tiles, float *out, int threads) {
    struct layers l = {layer, layers, tiles, out};
    thread_for(threads, tiles, add_layers_tile, &l);
}

static void add_run(const struct run *r, size_t tile, const struct contraction *c, uint32_t run,
                    float *out) {
    const uint32_t first = c->start[run], end = c->start[run + 1];
    const float *weight = c->weight + (size_t)first * TILE_CHANNELS;
    if (c->together == 1) {
        add_rows(r, tile, c->index + first, weight, end - first, out + (size_t)run * ROW);
        return;
    }
    for (uint32_t i = first; i < end; i++, weight += TILE_CHANNELS)
        add_row(&r->t, tile * r->coefficients + c->index[i], weight, out + (size_t)c->target[i] * ROW);
}

static void contract_tile(void *ctx, size_t tile, int worker) {
    const struct run *r = ctx;
    const struct contraction *c = r->contraction;
    float *out = r->out + tile * c->reduced * ROW;
    (void)worker;
    memset(out, 0, (size_t)c->reduced * ROW * sizeof *out);
    for (uint32_t k = 0; k < contraction_runs(c); k++)
        add_run(r, tile, c, k, out);
}

void tiles_contract(struct tensor_data t, const struct contraction *c, uint32_t coefficients,
                    size_t tiles, float *out, int threads) {
    struct run r = {.t = t, .contraction = c, .coefficients = coefficients,
                    .out = out};
    thread_for(threads, tiles, contract_tile, &r);
}

// ---- wavelets -----------------------------------------------------------------------------------

static const float D1 = 0.4829629131445341f, D2 = 0.8365163037378077f, D3 = 0.2241438680420134f,
                   D4 = -0.1294095225512603f;

static void daubechies4_tile(void *ctx, size_t tile, int worker) {
    const struct run *r = ctx;
    float *t = r->out + tile * r->coefficients * ROW, *s = r->scratch + tile * r->coefficients * ROW;
    (void)worker;
    for (uint32_t n = r->coefficients, step = 0; n >= 4 && step < r->terms; n /= 2, step++) {
        for (uint32_t k = 0; k < n / 2; k++) {
            const float *a = t + (size_t)(2 * k) * ROW, *b = a + ROW;
            const float *c = t + (size_t)((2 * k + 2) % n) * ROW;
            const float *d = t + (size_t)((2 * k + 3) % n) * ROW;
            float *low = s + (size_t)k * ROW, *high = s + (size_t)(n / 2 + k) * ROW;
            for (int i = 0; i < ROW; i++) {
                low[i] = D1 * a[i] + D2 * b[i] + D3 * c[i] + D4 * d[i];
                high[i] = D4 * a[i] - D3 * b[i] + D2 * c[i] - D1 * d[i];
            }
        }
        memcpy(t, s, (size_t)n * ROW * sizeof *t);
    }
}

void tiles_daubechies4(float *t, float *scratch, uint32_t coefficients, uint32_t steps,
                       size_t tiles, int threads) {
    struct run r = {.out = t, .scratch = scratch, .coefficients = coefficients, .terms = steps};
    thread_for(threads, tiles, daubechies4_tile, &r);
}

// ---- picture ------------------------------------------------------------------------------------

struct composition {
    const float *out, *scale, *factor;
    const uint32_t *pixel;
    float *frame;
    uint32_t pixels, plane;
};

static void compose_tile(void *ctx, size_t tile, int worker) {
    const struct composition *c = ctx;
    const uint32_t first = (uint32_t)tile * TILE_LANES;
    const uint32_t lanes = c->pixels - first < TILE_LANES ? c->pixels - first : TILE_LANES;
    (void)worker;
    for (uint32_t channel = 0; channel < TILE_CHANNELS; channel++)
        for (uint32_t lane = 0; lane < lanes; lane++) {
            const size_t i = tile * ROW + channel * TILE_LANES + lane;
            const float value = c->factor ? c->scale[channel] * c->factor[i] * c->out[i]
                                          : c->scale[channel] * c->out[i];
            c->frame[(size_t)channel * c->plane + c->pixel[first + lane]] += value;
        }
}

void tiles_compose(const float *out, const uint32_t *pixel, uint32_t pixels, const float scale[3],
                   const float *factor, float *frame, uint32_t plane, int threads) {
    struct composition c = {out, scale, factor, pixel, frame, pixels, plane};
    thread_for(threads, (pixels + TILE_LANES - 1) / TILE_LANES, compose_tile, &c);
}

struct tone_map {
    const float *frame;
    uint32_t plane;
    float exposure;
    uint8_t *rgba;
};

enum { PIXELS_AT_ONCE = 4096 };

static float srgb(float v) {
    v = v > 0 ? v : 0; // NaN too
    v = v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
    return v < 1 ? v : 1;
}

static void tone_map_pixels(void *ctx, size_t item, int worker) {
    const struct tone_map *m = ctx;
    const size_t first = item * PIXELS_AT_ONCE;
    const size_t end = first + PIXELS_AT_ONCE < m->plane ? first + PIXELS_AT_ONCE : m->plane;
    (void)worker;
    for (size_t i = first; i < end; i++) {
        for (size_t c = 0; c < 3; c++)
            m->rgba[4 * i + c] =
                (uint8_t)(255 * srgb(m->exposure * m->frame[c * m->plane + i]) + 0.5f);
        m->rgba[4 * i + 3] = 255;
    }
}

void tiles_tone_map(const float *frame, uint32_t plane, float exposure, uint8_t *rgba, int threads) {
    struct tone_map m = {frame, plane, exposure, rgba};
    thread_for(threads, (plane + PIXELS_AT_ONCE - 1) / PIXELS_AT_ONCE, tone_map_pixels, &m);
}
