// SPDX-License-Identifier: Apache-2.0
// Products of tiles against the speed of memory: full products with 32 and 16 bits, an update of 30
// terms, OpenCL and C, and plain reading, interleaved; medians. Then, for as many pixels as have the
// same bytes and beside reading again, curve switching: either axis of 128x128 coefficients contracted;
// and freezing: 84 products of albedos times 64 bins, contracted to the 4 powers of one albedo.
//
// usage: replay [PIXELS [COEFFICIENTS]]     (262144 and 256)
#include "replay/replay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "replay/measure.h"
#include "replay/tiles.h"

enum { REPEATS = 11, TERMS = 30, KINDS = 2 };

struct measured {
    double times[REPEATS];
};

static double median(struct measured *m) {
    return measure_median(m->times, REPEATS);
}

// Adds up memory, sixteen sums at a time.
struct reading {
    const float *data;
    size_t floats, parts;
    double *sums;
};

static void read_part(void *ctx, size_t part, int worker) {
    const struct reading *r = ctx;
    const size_t n = r->floats / r->parts;
    const float *p = r->data + part * n;
    float sum[64] = {0};
    (void)worker;
    for (size_t i = 0; i + 64 <= n; i += 64)
        for (size_t k = 0; k < 64; k++)
            sum[k] += p[i + k];
    for (size_t k = 0; k < 64; k++)
        r->sums[part] += (double)sum[k];
}

static double time_reading(const float *data, size_t bytes) {
    double sums[64] = {0};
    struct reading r = {data, bytes / sizeof *data, 64, sums};
    const double start = time_seconds();
    thread_for(0, r.parts, read_part, &r);
    const double end = time_seconds();
    volatile double keep = sums[0];
    (void)keep;
    return end - start;
}

struct bench {
    struct tensor tensor[KINDS];
    struct tensor_block block[KINDS];
    struct replay *replay[KINDS][2]; // by storage; with a device, without
    float *weights;
    uint32_t terms[TERMS];
};

static void make_tensors(struct bench *b, uint64_t pixels, uint32_t coefficients) {
    uint32_t *list = mem_array(pixels, sizeof *list);
    for (uint64_t i = 0; i < pixels; i++)
        list[i] = (uint32_t)i;
    for (int s = TENSOR_F32; s <= TENSOR_BF16; s++) {
        b->block[s] = (struct tensor_block){
            .object = "", .term = "", .axis_count = 1, .groups = 1, .coefficients = coefficients,
            .axes = {{"theta_h", TENSOR_BOX, coefficients, NULL}}, .channels = 3,
            .pixel_count = pixels, .pixels = list, .storage = (enum tensor_storage)s};
        const size_t bytes = tensor_bytes(&b->block[s]);
        uint16_t *values = mem_array(bytes, 1);
        for (size_t i = 0; i < bytes / 2; i++)
            values[i] = (uint16_t)(0x3f00 + ((uint32_t)i * 2654435761u >> 24)); // 0.5 to 2, as float too
        b->block[s].values = values;
        b->tensor[s] = (struct tensor){.width = (uint32_t)pixels, .height = 1, .block_count = 1,
                                       .blocks = &b->block[s]};
        for (int k = 0; k < 2; k++)
            b->replay[s][k] =
                replay_create(&b->tensor[s], &(struct replay_options){.no_device = k == 1});
    }
    b->weights = mem_array(3 * (size_t)coefficients, sizeof *b->weights);
    for (uint32_t i = 0; i < 3 * coefficients; i++)
        b->weights[i] = 1 / (float)(i + 1);
    for (uint32_t i = 0; i < TERMS; i++)
        b->terms[i] = i * (coefficients / TERMS);
}

static double time_product(const struct bench *b, struct replay *r) {
    const double start = time_seconds();
    replay_product(r, 0, b->weights);
    replay_wait(r);
    return time_seconds() - start;
}

static double time_update(const struct bench *b, struct replay *r) {
    const double start = time_seconds();
    replay_update(r, 0, b->terms, b->weights, TERMS);
    replay_wait(r);
    return time_seconds() - start;
}

// ---- curve switching and freezing -----------------------------------------------------------

enum {
    SIDE = 128,
    OBJECTS = 6, BOUNCES = 4, BINS = 64, // of the Cornell box of Ben-Artzi 2007, table 6.1
    POWERS = BOUNCES,
};

static struct contraction map_to(const uint32_t *target, uint32_t coefficients, uint32_t reduced,
                                 struct arena *arena) {
    double *weight = mem_array(3 * (size_t)coefficients, sizeof *weight);
    for (uint32_t i = 0; i < 3 * coefficients; i++)
        weight[i] = 1 / (double)(i % SIDE + 1);
    const struct contraction c =
        contraction_of(TENSOR_F32, coefficients, reduced, target, weight, arena);
    mem_free(weight);
    return c;
}

// The map that keeps axis `kept` of a matrix and sums the other up.
static struct contraction switching(int kept, struct arena *arena) {
    uint32_t target[SIDE * SIDE];
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        target[i] = kept == 0 ? i / SIDE : i % SIDE;
    return map_to(target, SIDE * SIDE, SIDE, arena);
}

// Powers of the first object's albedo in all products of up to `left` more albedos, ascending from
// `least`, as groups are numbered.
static uint32_t list_powers(uint32_t least, uint32_t left, uint32_t power, uint32_t *powers) {
    uint32_t n = 0;
    powers[n++] = power;
    for (uint32_t o = least; o < OBJECTS && left > 0; o++)
        n += list_powers(o, left - 1, power + (o == 0), powers + n);
    return n;
}

// The map that keeps one object's curve and the powers of its albedo.
static struct contraction freezing(uint32_t *coefficients, struct arena *arena) {
    uint32_t powers[OBJECTS * OBJECTS * OBJECTS], target[OBJECTS * OBJECTS * OBJECTS * BINS];
    *coefficients = list_powers(0, BOUNCES - 1, 0, powers) * BINS;
    for (uint32_t i = 0; i < *coefficients; i++)
        target[i] = powers[i / BINS] * BINS + i % BINS;
    return map_to(target, *coefficients, POWERS * BINS, arena);
}

// Takes the values of a tensor as those of a smaller one with more coefficients.
static void time_contraction(const struct bench *b, const char *what, uint32_t coefficients,
                             struct contraction c) {
    struct tensor_block block = b->block[TENSOR_F32];
    block.pixel_count = block.pixel_count * block.coefficients / coefficients / TENSOR_LANES *
                        TENSOR_LANES;
    block.coefficients = coefficients;
    block.axes[0].bins = coefficients;
    const struct tensor t = {.width = (uint32_t)block.pixel_count, .height = 1, .block_count = 1,
                             .blocks = &block};
    const double gb = (double)tensor_bytes(&block) * 1e-9;
    float *out = mem_array(tensor_tiles(&block) * c.reduced * 3 * TENSOR_LANES, sizeof *out);
    struct replay *r[2];
    struct measured read, m[2];
    for (int k = 0; k < 2; k++)
        r[k] = replay_create(&t, &(struct replay_options){.no_device = k == 1});
    for (int i = -1; i < REPEATS; i++) { // the first, which is warming up, is written over
        read.times[i < 0 ? 0 : i] = time_reading(block.values, tensor_bytes(&block));
        for (int k = 0; k < 2; k++) {
            const double start = time_seconds();
            replay_contract(r[k], 0, &c, out);
            m[k].times[i < 0 ? 0 : i] = time_seconds() - start;
        }
    }
    const double limit = gb / median(&read);
    for (int k = 0; k < 2; k++) {
        const double s = median(&m[k]);
        printf("%-12.12s %s, %u coefficients to %u: %.1f ms for %llu pixels, %.1f GB/s = %.2f of "
               "reading\n", replay_device(r[k]), what, coefficients, c.reduced, s * 1e3,
               (unsigned long long)block.pixel_count, gb / s, gb / s / limit);
        replay_destroy(r[k]);
    }
    mem_free(out);
}

static void time_contractions(const struct bench *b) {
    struct arena arena = {0};
    uint32_t coefficients;
    const struct contraction frozen = freezing(&coefficients, &arena);
    time_contraction(b, "switching to the first curve", SIDE * SIDE, switching(0, &arena));
    time_contraction(b, "switching to the second curve", SIDE * SIDE, switching(1, &arena));
    time_contraction(b, "freezing all objects but one", coefficients, frozen);
    arena_finish(&arena);
}

int main(int argc, char **argv) {
    const uint64_t pixels = argc > 1 ? strtoull(argv[1], NULL, 10) : 262144;
    const uint32_t coefficients = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 256;
    struct bench b = {0};
    make_tensors(&b, pixels, coefficients);
    struct measured read = {{0}}, product[KINDS][2], update[KINDS][2];
    const size_t bytes = tensor_bytes(&b.block[TENSOR_F32]);
    for (int warm = 0; warm < 2; warm++)
        for (int i = 0; i < (warm ? REPEATS : 1); i++) {
            read.times[i] = time_reading(b.block[TENSOR_F32].values, bytes);
            for (int s = 0; s < KINDS; s++)
                for (int k = 0; k < 2; k++) {
                    product[s][k].times[i] = time_product(&b, b.replay[s][k]);
                    update[s][k].times[i] = time_update(&b, b.replay[s][k]);
                }
        }
    const double limit = median(&read);
    printf("%llu pixels x %u coefficients x 3 channels, %.0f MB as 32 bits; reading takes %.1f ms, "
           "%.1f GB/s\n", (unsigned long long)pixels, coefficients, (double)bytes * 1e-6, limit * 1e3,
           (double)bytes * 1e-9 / limit);
    for (int k = 0; k < 2; k++)
        for (int s = 0; s < KINDS; s++) {
            const double p = median(&product[s][k]), u = median(&update[s][k]);
            const double gb = (double)tensor_bytes(&b.block[s]) * 1e-9;
            printf("%-12.12s %2d bits: product %6.1f ms, %.1f GB/s = %.2f of reading; %u terms %5.2f ms, "
                   "%.1f times faster\n", replay_device(b.replay[s][k]), s == TENSOR_F32 ? 32 : 16,
                   p * 1e3, gb / p, gb / p / ((double)bytes * 1e-9 / limit), TERMS, u * 1e3, p / u);
        }
    time_contractions(&b);
    for (int s = 0; s < KINDS; s++)
        for (int k = 0; k < 2; k++)
            replay_destroy(b.replay[s][k]);
    return 0;
}
