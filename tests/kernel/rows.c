// SPDX-License-Identifier: Apache-2.0
// Tiles whose rows are stored in ways of their own: the kernels give the bits of their twins, whole
// and in chunks, and the twins what the decoded coefficients give.
#include "replay/tiles.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "check.h"
#include "replay/replay.h"
#include "rows_sample.h"

enum { PIXELS = 700, COEFFICIENTS = 50, TERMS = 9, REDUCED = 6, TILES = (PIXELS + 63) / 64 };

struct fixture {
    struct arena arena;
    struct tensor_block block;
    struct tensor tensor;
    float weights[3 * COEFFICIENTS];
};

static size_t count_different(const float *a, const float *b, size_t n) {
    size_t different = 0;
    for (size_t i = 0; i < n; i++)
        different += memcmp(&a[i], &b[i], sizeof *a) != 0;
    return different;
}

static void product(struct fixture *f, struct replay *r, float *frame) {
    uint32_t terms[TERMS];
    for (uint32_t i = 0; i < TERMS; i++)
        terms[i] = (7 * i + 3) % COEFFICIENTS;
    CHECK(replay_product(r, 0, f->weights));
    CHECK(replay_update(r, 0, terms, f->weights, TERMS));
    CHECK(replay_frame(r, NULL, frame));
}

static void contraction(struct fixture *f, struct replay *r, float *out) {
    uint32_t target[COEFFICIENTS];
    double weights[3 * COEFFICIENTS];
    struct arena arena = {0};
    for (uint32_t i = 0; i < COEFFICIENTS; i++)
        target[i] = (11 * i) % COEFFICIENTS * REDUCED / COEFFICIENTS;
    for (uint32_t i = 0; i < 3 * COEFFICIENTS; i++)
        weights[i] = (double)f->weights[i];
    const struct contraction c =
        contraction_of(TENSOR_ROWS, COEFFICIENTS, REDUCED, target, weights, &arena);
    CHECK(replay_contract(r, 0, &c, out));
    arena_finish(&arena);
}

static void twins_give_what_is_stored(struct fixture *f, const float *frame) {
    const struct tensor_data d = tensor_values_of(&f->block);
    double worst = 0;
    for (uint64_t p = 0; p < PIXELS; p++)
        for (uint32_t k = 0; k < 3; k++) {
            double truth = 0, size = 0;
            for (uint32_t c = 0; c < COEFFICIENTS; c++) {
                float row[ROW_VALUES];
                tensor_row(&d, COEFFICIENTS, p / 64, c, row);
                double weight = (double)f->weights[3 * c + k];
                for (uint32_t i = 0; i < TERMS; i++)
                    weight += (7 * i + 3) % COEFFICIENTS == c ? (double)f->weights[3 * i + k] : 0;
                truth += weight * (double)row[64 * k + p % 64];
                size += fabs(weight * (double)row[64 * k + p % 64]);
            }
            worst = fmax(worst, fabs(truth - (double)frame[k * PIXELS + p]) /
                                    (size * 0x1p-24 * (COEFFICIENTS + TERMS + 1)));
        }
    printf("twins: %.2g of the largest rounding\n", worst);
    CHECK(worst <= 1);
}

int main(void) {
    struct fixture f = {.arena = {0}};
    const size_t n = 3 * PIXELS, m = (size_t)TILES * REDUCED * ROW_VALUES;
    float *frame[3], *reduced[3];
    f.block = rows_sample(PIXELS, COEFFICIENTS, &f.arena);
    f.tensor = (struct tensor){.width = PIXELS, .height = 1, .block_count = 1, .blocks = &f.block};
    for (int i = 0; i < 3 * COEFFICIENTS; i++)
        f.weights[i] = (float)rand() / (float)RAND_MAX;
    for (int k = 0; k < 3; k++) {
        struct replay *r = replay_create(&f.tensor, &(struct replay_options){
            .no_device = k == 0, .most_memory = k == 2 ? 20000 : 0});
        CHECK(r != NULL);
        printf("%s\n", replay_device(r));
        frame[k] = mem_array(n, sizeof *frame[k]);
        reduced[k] = mem_array(m, sizeof *reduced[k]);
        product(&f, r, frame[k]);
        contraction(&f, r, reduced[k]);
        CHECK(count_different(frame[k], frame[0], n) == 0);
        CHECK(count_different(reduced[k], reduced[0], m) == 0);
        replay_destroy(r);
    }
    twins_give_what_is_stored(&f, frame[0]);
    for (int k = 0; k < 3; k++) {
        mem_free(frame[k]);
        mem_free(reduced[k]);
    }
    arena_finish(&f.arena);
    return check_result();
}
