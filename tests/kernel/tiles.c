// SPDX-License-Identifier: Apache-2.0
// Every kernel gives the bits of its C twin, and the twin what its formula says in double.
#include "replay/tiles.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "check.h"
#include "cl/compute.h"
#include "kernels/tile.h"

enum { TILES = 7, COEFFICIENTS = 24, COLUMNS = 5, TERMS = 6, ROW = TILE_CHANNELS * TILE_LANES };

static float random_float(void) {
    return (float)rand() / (float)RAND_MAX * 2 - 0.5f;
}

static float *random_floats(size_t n) {
    float *f = mem_array(n, sizeof *f);
    for (size_t i = 0; i < n; i++)
        f[i] = random_float();
    return f;
}

static uint16_t *to_bf16(const float *f, size_t n) {
    uint16_t *h = mem_array(n, sizeof *h);
    for (size_t i = 0; i < n; i++)
        h[i] = bf16_from_float(f[i]);
    return h;
}

struct fixture {
    struct compute_device *device; // or NULL
    size_t values;                 // of t
    float *t[2];                   // what is stored, as float
    void *stored[2];               // as enum tensor_storage has it
    float *weight;
    uint32_t term[TERMS];
};

static void fixture_init(struct fixture *f) {
    f->values = (size_t)TILES * COEFFICIENTS * COLUMNS * ROW;
    f->t[TENSOR_F32] = random_floats(f->values);
    f->stored[TENSOR_F32] = f->t[TENSOR_F32];
    uint16_t *h = to_bf16(f->t[TENSOR_F32], f->values);
    f->stored[TENSOR_BF16] = h;
    f->t[TENSOR_BF16] = mem_array(f->values, sizeof(float));
    for (size_t i = 0; i < f->values; i++)
        f->t[TENSOR_BF16][i] = bf16_to_float(h[i]);
    f->weight = random_floats((size_t)COEFFICIENTS * COLUMNS * TILE_CHANNELS);
    for (uint32_t k = 0; k < TERMS; k++)
        f->term[k] = (uint32_t)rand() % COEFFICIENTS;
}

static void fixture_finish(struct fixture *f) {
    compute_close(f->device);
    mem_free(f->t[0]);
    mem_free(f->t[1]);
    mem_free(f->stored[TENSOR_BF16]);
    mem_free(f->weight);
}

// Relative distance of a float sum from the same one in double, in units of its largest rounding.
static double sum_error(const float *sums, const double *truth, const double *size, size_t n,
                        uint32_t terms) {
    double worst = 0;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, fabs((double)sums[i] - truth[i]) / (size[i] * 0x1p-24 * (terms + 1)));
    return worst;
}

// What row (tile, c) of t adds to 192 sums.
static void add_truth(const float *t, size_t row, const float *weight, double *truth, double *size) {
    for (int i = 0; i < ROW; i++) {
        const double v = (double)weight[i / TILE_LANES] * (double)t[row * ROW + (size_t)i];
        truth[i] += v;
        size[i] += fabs(v);
    }
}

static const char *const suffix[] = {"f32", "bf16"};

// Runs a kernel that writes `n` floats (which hold `start` before) and compares bits.
static void kernel_agrees(struct fixture *f, const char *file, const char *name,
                          struct compute_arg *args, uint32_t count, size_t items, const float *start,
                          const float *twin, size_t n) {
    float *got = mem_array(n, sizeof *got);
    struct compute_buffer out = compute_buffer_create(f->device, n * sizeof *got);
    for (uint32_t i = 0; i < count; i++)
        if (args[i].kind == COMPUTE_ARG_BUFFER && !args[i].buffer)
            args[i].buffer = &out;
    struct compute_kernel *k = compute_kernel(f->device, file, name);
    CHECK(k && out.handle);
    CHECK(compute_write(f->device, &out, 0, start, n * sizeof *start));
    CHECK(k && compute_run(f->device, k, items, args, count));
    CHECK(compute_read(f->device, &out, 0, got, n * sizeof *got));
    size_t different = 0;
    for (size_t i = 0; i < n; i++)
        different += memcmp(&got[i], &twin[i], sizeof *got) != 0;
    printf("%s: %zu of %zu values differ from the twin\n", name, different, n);
    CHECK(different == 0);
    compute_buffer_destroy(&out);
    mem_free(got);
}

static struct compute_buffer to_device(struct fixture *f, const void *data, size_t bytes) {
    struct compute_buffer b = compute_buffer_create(f->device, bytes);
    CHECK(b.handle && compute_write(f->device, &b, 0, data, bytes));
    return b;
}

static struct tensor_data stored(const struct fixture *f, enum tensor_storage s) {
    return (struct tensor_data){.data = f->stored[s], .storage = s};
}

static void dot(struct fixture *f, enum tensor_storage s) {
    const size_t n = (size_t)TILES * ROW;
    const uint32_t c = COEFFICIENTS * COLUMNS;
    float *twin = mem_array(n, sizeof *twin), *zero = mem_array(n, sizeof *zero);
    double *truth = mem_array(n, sizeof *truth), *size = mem_array(n, sizeof *size);
    tiles_dot(stored(f, s), f->weight, c, TILES, twin, 2);
    for (size_t tile = 0; tile < TILES; tile++)
        for (uint32_t i = 0; i < c; i++)
            add_truth(f->t[s], tile * c + i, f->weight + 3 * i, truth + tile * ROW, size + tile * ROW);
    CHECK(sum_error(twin, truth, size, n, c) <= 1);
    if (f->device) {
        char name[32];
        struct compute_buffer t = to_device(f, f->stored[s], f->values * tensor_value_size(s));
        struct compute_buffer w = to_device(f, f->weight, c * 3 * sizeof(float));
        struct compute_arg args[] = {COMPUTE_BUFFER(&t), COMPUTE_BUFFER(&w), COMPUTE_UINT(c),
                                     COMPUTE_BUFFER(NULL), COMPUTE_UINT(0)};
        snprintf(name, sizeof name, "dot_%s", suffix[s]);
        kernel_agrees(f, "dot", name, args, 5, TILES, zero, twin, n);
        compute_buffer_destroy(&t);
        compute_buffer_destroy(&w);
    }
    mem_free(twin), mem_free(zero), mem_free(truth), mem_free(size);
}

static void add_terms(struct fixture *f, enum tensor_storage s) {
    const size_t tiles = (size_t)TILES * COLUMNS, n = tiles * ROW;
    float *start = random_floats(n), *twin = mem_array(n, sizeof *twin);
    double *truth = mem_array(n, sizeof *truth), *size = mem_array(n, sizeof *size);
    memcpy(twin, start, n * sizeof *twin);
    tiles_add_terms(stored(f, s), f->weight, f->term, TERMS, COEFFICIENTS, tiles, twin, 2);
    for (size_t i = 0; i < n; i++)
        truth[i] = (double)start[i], size[i] = fabs(truth[i]);
    for (size_t tile = 0; tile < tiles; tile++)
        for (uint32_t k = 0; k < TERMS; k++)
            add_truth(f->t[s], tile * COEFFICIENTS + f->term[k], f->weight + 3 * k,
                      truth + tile * ROW, size + tile * ROW);
    CHECK(sum_error(twin, truth, size, n, TERMS) <= 1);
    if (f->device) {
        char name[32];
        struct compute_buffer t = to_device(f, f->stored[s], f->values * tensor_value_size(s));
        struct compute_buffer w = to_device(f, f->weight, TERMS * 3 * sizeof(float));
        struct compute_buffer terms = to_device(f, f->term, sizeof f->term);
        struct compute_arg args[] = {COMPUTE_BUFFER(&t), COMPUTE_BUFFER(&w), COMPUTE_BUFFER(&terms),
                                     COMPUTE_UINT(TERMS), COMPUTE_UINT(COEFFICIENTS),
                                     COMPUTE_BUFFER(NULL), COMPUTE_UINT(0)};
        snprintf(name, sizeof name, "add_terms_%s", suffix[s]);
        kernel_agrees(f, "dot", name, args, 7, tiles, start, twin, n);
        compute_buffer_destroy(&t);
        compute_buffer_destroy(&w);
        compute_buffer_destroy(&terms);
    }
    mem_free(start), mem_free(twin), mem_free(truth), mem_free(size);
}

// A layer that is cleared and all of them added up.
static void layers(struct fixture *f) {
    enum { LAYERS = 5, CLEARED = 2 };
    const size_t n = (size_t)TILES * ROW;
    float *start = random_floats(LAYERS * n), *twin = mem_array(n, sizeof *twin);
    float *zero = mem_array(n, sizeof *zero), *cleared = mem_array(LAYERS * n, sizeof *cleared);
    double worst = 0;
    memcpy(cleared, start, LAYERS * n * sizeof *cleared);
    memset(cleared + CLEARED * n, 0, n * sizeof *cleared);
    tiles_add_layers(cleared, LAYERS, TILES, twin, 2);
    for (size_t i = 0; i < n; i++) {
        double truth = 0;
        for (size_t l = 0; l < LAYERS; l++)
            truth += l == CLEARED ? 0 : (double)start[l * n + i];
        worst = fmax(worst, fabs(truth - (double)twin[i]));
    }
    CHECK(worst < 1e-6);
    if (f->device) {
        struct compute_buffer l = to_device(f, cleared, LAYERS * n * sizeof *cleared);
        struct compute_arg args[] = {COMPUTE_BUFFER(&l), COMPUTE_UINT(LAYERS), COMPUTE_UINT(TILES),
                                     COMPUTE_BUFFER(NULL)};
        struct compute_arg clear[] = {COMPUTE_BUFFER(NULL), COMPUTE_UINT(CLEARED * TILES)};
        kernel_agrees(f, "layers", "add_layers", args, 4, TILES, zero, twin, n);
        kernel_agrees(f, "layers", "clear_layer", clear, 2, TILES, start, cleared, LAYERS * n);
        compute_buffer_destroy(&l);
    }
    mem_free(start), mem_free(twin), mem_free(zero), mem_free(cleared);
}

// Runs of different lengths, none and long ones among them, with coefficients in any order.
static void contract(struct fixture *f, enum tensor_storage s) {
    enum { REDUCED = 4 * TILE_REDUCED + 5, RUNS = 5, MOST = 400, ALL = RUNS * MOST };
    const uint32_t coefficients = COEFFICIENTS * COLUMNS;
    const size_t n = (size_t)TILES * REDUCED * ROW;
    float *twin = mem_array(n, sizeof *twin), *zero = mem_array(n, sizeof *zero);
    double *truth = mem_array(n, sizeof *truth), *size = mem_array(n, sizeof *size);
    float *weight = random_floats(ALL * TILE_CHANNELS);
    uint32_t start[RUNS + 1] = {0}, index[ALL], target[ALL];
    for (uint32_t r = 0; r < RUNS; r++) {
        const uint32_t from = r * TILE_REDUCED;
        start[r + 1] = start[r] + (uint32_t)rand() % MOST * (r != 3);
        for (uint32_t i = start[r]; i < start[r + 1]; i++) {
            index[i] = (uint32_t)rand() % coefficients;
            target[i] = from + (uint32_t)rand() % (r + 1 < RUNS ? TILE_REDUCED : REDUCED - from);
        }
    }
    const struct contraction c = {REDUCED, TILE_REDUCED, start, index, target, weight};
    tiles_contract(stored(f, s), &c, coefficients, TILES, twin, 2);
    for (size_t tile = 0; tile < TILES; tile++)
        for (size_t i = 0; i < start[RUNS]; i++) {
            const size_t at = (tile * REDUCED + target[i]) * ROW;
            add_truth(f->t[s], tile * coefficients + index[i], weight + 3 * i, truth + at, size + at);
        }
    for (size_t i = 0; i < n; i++)
        size[i] += size[i] > 0 ? 0 : 1e-30; // nothing gives exactly 0
    CHECK(sum_error(twin, truth, size, n, MOST) <= 1);
    if (f->device) {
        char name[32];
        const uint32_t first = 2; // tiles that are left out
        struct compute_buffer t = to_device(f, f->stored[s], f->values * tensor_value_size(s));
        struct compute_buffer w = to_device(f, weight, ALL * TILE_CHANNELS * sizeof *weight);
        struct compute_buffer i = to_device(f, index, sizeof index);
        struct compute_buffer to = to_device(f, target, sizeof target);
        struct compute_buffer b = to_device(f, start, sizeof start);
        struct compute_arg args[] = {COMPUTE_BUFFER(&t), COMPUTE_BUFFER(&to), COMPUTE_BUFFER(&w),
                                     COMPUTE_BUFFER(&i), COMPUTE_BUFFER(&b),
                                     COMPUTE_UINT(coefficients), COMPUTE_UINT(REDUCED),
                                     COMPUTE_UINT(first), COMPUTE_BUFFER(NULL)};
        snprintf(name, sizeof name, "contract_%s", suffix[s]);
        kernel_agrees(f, "contract", name, args, 9, (TILES - first) * RUNS, zero,
                      twin + first * REDUCED * ROW, (TILES - first) * (size_t)REDUCED * ROW);
        compute_buffer_destroy(&t);
        compute_buffer_destroy(&w);
        compute_buffer_destroy(&to);
        compute_buffer_destroy(&i);
        compute_buffer_destroy(&b);
    }
    mem_free(twin), mem_free(zero), mem_free(truth), mem_free(size), mem_free(weight);
}

// Orthonormal: the transform keeps the sum of squares of each lane.
static void daubechies4(struct fixture *f) {
    enum { J = 16 };
    const size_t n = (size_t)TILES * J * ROW;
    float *start = random_floats(n), *twin = mem_array(n, sizeof *twin);
    float *scratch = mem_array(n, sizeof *scratch);
    double worst = 0;
    memcpy(twin, start, n * sizeof *twin);
    tiles_daubechies4(twin, scratch, J, 99, TILES, 2);
    for (size_t tile = 0; tile < TILES; tile++)
        for (size_t i = 0; i < ROW; i++) {
            double before = 0, after = 0;
            for (size_t c = 0; c < J; c++) {
                before += pow((double)start[(tile * J + c) * ROW + i], 2);
                after += pow((double)twin[(tile * J + c) * ROW + i], 2);
            }
            worst = fmax(worst, fabs(after / before - 1));
        }
    printf("daubechies4: sums of squares change by %.2g\n", worst);
    CHECK(worst < 1e-6);
    if (f->device) {
        struct compute_buffer s = compute_buffer_create(f->device, n * sizeof *scratch);
        struct compute_arg args[] = {COMPUTE_BUFFER(NULL), COMPUTE_BUFFER(&s), COMPUTE_UINT(J),
                                     COMPUTE_UINT(99)};
        kernel_agrees(f, "wavelet", "daubechies4", args, 4, (size_t)TILES * TILE_ROW, start, twin, n);
        compute_buffer_destroy(&s);
    }
    mem_free(start), mem_free(twin), mem_free(scratch);
}

static void compose(struct fixture *f, bool has_factor) {
    enum { PIXELS = TILES * TILE_LANES - 11, PLANE = 1000 };
    const float scale[3] = {0.7f, 1.3f, 2.1f};
    float *out = random_floats((size_t)TILES * ROW), *factor = random_floats((size_t)TILES * ROW);
    float *start = random_floats(3 * PLANE), *twin = mem_array(3 * PLANE, sizeof *twin);
    uint32_t pixel[PIXELS];
    for (uint32_t i = 0; i < PIXELS; i++)
        pixel[i] = 2 * i;
    memcpy(twin, start, 3 * PLANE * sizeof *twin);
    tiles_compose(out, pixel, PIXELS, scale, has_factor ? factor : NULL, twin, PLANE, 2);
    double worst = 0;
    for (uint32_t i = 0; i < PIXELS; i++)
        for (uint32_t c = 0; c < 3; c++) {
            const size_t at = (size_t)(i / TILE_LANES) * ROW + c * TILE_LANES + i % TILE_LANES;
            const size_t to = c * PLANE + pixel[i];
            const double truth = (double)start[to] +
                                 (double)scale[c] * (has_factor ? (double)factor[at] : 1) *
                                     (double)out[at];
            worst = fmax(worst, fabs(truth - (double)twin[to]));
        }
    CHECK(worst < 2e-6 && twin[1] == start[1]);
    if (f->device) {
        struct compute_buffer o = to_device(f, out, (size_t)TILES * ROW * 4);
        struct compute_buffer p = to_device(f, pixel, sizeof pixel), s = to_device(f, scale, 12);
        struct compute_buffer k = to_device(f, factor, (size_t)TILES * ROW * 4);
        struct compute_arg args[] = {COMPUTE_BUFFER(&o), COMPUTE_BUFFER(&p), COMPUTE_UINT(PIXELS),
                                     COMPUTE_BUFFER(&s), COMPUTE_BUFFER(&k),
                                     COMPUTE_UINT(has_factor), COMPUTE_BUFFER(NULL),
                                     COMPUTE_UINT(PLANE)};
        kernel_agrees(f, "picture", "compose", args, 8, TILES, start, twin, 3 * PLANE);
        compute_buffer_destroy(&o);
        compute_buffer_destroy(&p);
        compute_buffer_destroy(&s);
        compute_buffer_destroy(&k);
    }
    mem_free(out), mem_free(factor), mem_free(start), mem_free(twin);
}

// pow is not the same function everywhere: a step of 8 bits may differ.
static void tone_map(struct fixture *f) {
    enum { PLANE = 5000 };
    float *frame = random_floats(3 * PLANE);
    uint8_t twin[4 * PLANE], got[4 * PLANE];
    int most = 0;
    frame[0] = NAN;
    frame[1] = INFINITY;
    frame[2] = 0.5f;
    tiles_tone_map(frame, PLANE, 1, twin, 2);
    CHECK(twin[0] == 0 && twin[4] == 255 && twin[8] == 188 && twin[3] == 255);
    if (f->device) {
        struct compute_buffer in = to_device(f, frame, 3 * PLANE * sizeof *frame);
        struct compute_buffer out = compute_buffer_create(f->device, sizeof got);
        const struct compute_arg args[] = {COMPUTE_BUFFER(&in), COMPUTE_UINT(PLANE), COMPUTE_FLOAT(1),
                                           COMPUTE_BUFFER(&out)};
        struct compute_kernel *k = compute_kernel(f->device, "picture", "tone_map");
        CHECK(k && compute_run(f->device, k, PLANE, args, 4));
        CHECK(compute_read(f->device, &out, 0, got, sizeof got));
        for (int i = 0; i < 4 * PLANE; i++)
            most = abs(got[i] - twin[i]) > most ? abs(got[i] - twin[i]) : most;
        printf("tone_map: differs by at most %d of 255\n", most);
        CHECK(most <= 1);
        compute_buffer_destroy(&in);
        compute_buffer_destroy(&out);
    }
    mem_free(frame);
}

static int forks;

static void count_fork(void) {
    forks++;
}

// Once a driver has threads, a child may wait for ever for a lock that one of them held.
static void opens_again_without_a_child(const struct fixture *f) {
    CHECK(pthread_atfork(count_fork, NULL, NULL) == 0);
    struct compute_device *d = compute_open();
    CHECK(forks == 0 && (d != NULL) == (f->device != NULL));
    compute_close(d);
}

int main(void) {
    struct fixture f = {.device = compute_open()};
    fixture_init(&f);
    opens_again_without_a_child(&f);
    for (int s = TENSOR_F32; s <= TENSOR_BF16; s++) {
        dot(&f, (enum tensor_storage)s);
        add_terms(&f, (enum tensor_storage)s);
        contract(&f, (enum tensor_storage)s);
    }
    daubechies4(&f);
    layers(&f);
    compose(&f, false);
    compose(&f, true);
    tone_map(&f);
    if (f.device)
        printf("device: %s, kernels built in %.2f s\n", compute_name(f.device),
               compute_build_seconds(f.device));
    else
        printf("no OpenCL device: only the twins were checked\n");
    fixture_finish(&f);
    return check_result();
}
