// SPDX-License-Identifier: Apache-2.0
// Cells drawn over a grid: as often as was asked for, evenly spread, with totals and intervals that hold.
#include "check.h"

#include "base/mem.h"
#include "math/balanced_sample.h"

enum { ACROSS = 13, DOWN = 9, CELLS = ACROSS * DOWN, WANTED = 40, DRAWS = 20000 };

// Sizes from 1 to 3, and one that is drawn whatever happens.
static void make_sizes(double *size) {
    for (uint32_t i = 0; i < CELLS; i++)
        size[i] = 1 + 2 * (hash_u32(i) * 0x1p-32);
    size[50] = 100;
}

// What is measured: exponentially distributed, so that a few cells have much.
static double value_of(uint32_t cell) {
    return -log((hash_u32(1000 + cell) + 0.5) * 0x1p-32);
}

// Frequencies of the cells are their probabilities: the largest of 116 normal deviates is below 4.2 but in
// 3 of 1000 tests. The mean total is the total, within 4.2 standard errors.
static void cells_are_drawn_as_often_as_asked(void) {
    double size[CELLS], values[CELLS], none[CELLS] = {0}, told[CELLS] = {0}, total = 0, mean = 0, squares = 0;
    double worst = 0, told_variance = 0;
    int drawn[CELLS] = {0}, covered = 0;
    make_sizes(size);
    for (uint32_t i = 0; i < CELLS; i++)
        total += value_of(i);
    for (uint32_t t = 0; t < DRAWS; t++) {
        struct balanced_sample s;
        struct rng rng = {hash_u64(t)};
        balanced_sample_draw(&s, ACROSS, DOWN, size, WANTED, &rng);
        CHECK(s.count == WANTED && s.cells == CELLS);
        for (uint32_t i = 0; i < s.count; i++) {
            drawn[s.cell[i]]++;
            told[s.cell[i]] = s.probability[i];
            values[i] = value_of(s.cell[i]);
        }
        const struct measured m = balanced_sample_total(&s, values, none);
        mean += m.value / DRAWS;
        squares += (m.value - total) * (m.value - total) / DRAWS;
        told_variance += m.error * m.error / DRAWS;
        covered += total >= m.low && total <= m.high;
        balanced_sample_finish(&s);
    }
    CHECK(told[50] == 1 && drawn[50] == DRAWS);
    for (uint32_t i = 0; i < CELLS; i++)
        if (i != 50)
            worst = fmax(worst, fabs(drawn[i] - DRAWS * told[i]) / sqrt(DRAWS * told[i] * (1 - told[i])));
    printf("largest deviate %.2f; total %.2f of %.2f, spread %.2f, told %.2f; %.1f %% held\n", worst, mean,
           total, sqrt(squares), sqrt(told_variance), 100.0 * covered / DRAWS);
    CHECK(worst < 4.2);
    CHECK(fabs(mean - total) < 4.2 * sqrt(squares / DRAWS));
    CHECK(fabs(squares / told_variance - 1) < 0.25 && covered > 0.89 * DRAWS && covered < 0.99 * DRAWS);
}

// A slope is followed: the total is far nearer than that of independent draws, and so is the interval.
static void cells_are_spread(void) {
    enum { SIDE = 32, SLOPE_DRAWS = 400 };
    double size[SIDE * SIDE], values[64], none[64] = {0}, squares = 0, told = 0, variance = 0, mean = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        size[i] = 1;
        mean += (i % SIDE + i / SIDE) / (double)(SIDE * SIDE);
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        variance += pow(i % SIDE + i / SIDE - mean, 2) / (SIDE * SIDE - 1);
    for (uint32_t t = 0; t < SLOPE_DRAWS; t++) {
        struct balanced_sample s;
        struct rng rng = {hash_u64(t)};
        balanced_sample_draw(&s, SIDE, SIDE, size, 64, &rng);
        for (uint32_t i = 0; i < s.count; i++)
            values[i] = s.cell[i] % SIDE + s.cell[i] / SIDE;
        const struct measured m = balanced_sample_total(&s, values, none);
        squares += pow(m.value / (SIDE * SIDE) - mean, 2) / SLOPE_DRAWS;
        told += pow(m.error / (SIDE * SIDE), 2) / SLOPE_DRAWS;
        balanced_sample_finish(&s);
    }
    const double independent = variance / 64 * (1 - 64.0 / (SIDE * SIDE));
    printf("a slope: %.4f of independent draws' variance, told %.4f\n", squares / independent,
           told / independent);
    CHECK(squares < 0.1 * independent && told < 0.5 * independent && told > squares);
}

// All cells: nothing but their noise is left. One, or sizes that are none: finite.
static void ends_are_met(void) {
    double size[6] = {1, 2, 3, 4, 5, 6}, values[6] = {1, 1, 1, 1, 1, 1}, noise[6] = {4, 4, 4, 4, 4, 4};
    struct balanced_sample s;
    struct rng rng = {1};
    balanced_sample_draw(&s, 3, 2, size, 100, &rng);
    struct measured m = balanced_sample_total(&s, values, noise);
    CHECK(s.count == 6 && m.value == 6);
    CHECK_NEAR(m.error, sqrt(24), 1e-12);
    balanced_sample_finish(&s);
    size[2] = NAN;
    balanced_sample_draw(&s, 3, 2, size, 3, &rng);
    CHECK(s.count == 3 && s.probability[0] == 0.5 && s.probability[2] == 0.5);
    balanced_sample_finish(&s);
    size[2] = 3;
    balanced_sample_draw(&s, 3, 2, size, 1, &rng);
    m = balanced_sample_total(&s, values, noise);
    CHECK(s.count == 1 && m.error > 0 && isfinite(m.high));
    balanced_sample_finish(&s);
}

int main(void) {
    cells_are_drawn_as_often_as_asked();
    cells_are_spread();
    ends_are_met();
    return check_result();
}
