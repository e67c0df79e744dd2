// SPDX-License-Identifier: Apache-2.0
// Light samples of which one is kept: each is uniform, the mean that the kept one stands for is the
// integral, whatever it is chosen by, and many lanes at once give the bits of one.
#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "integrator/candidates.h"
#include "math/hash.h"

// By what a candidate is chosen, and what it brings: blocked above 0.7. Density 1.
static float value_at(float x) {
    return 0.1f + x * x * x * x;
}

static double brings(float x) {
    return x < 0.7f ? 9 * pow((double)x, 8) : 0;
}

static double estimate(struct rng *rng, uint32_t count) {
    struct candidates_seen seen = {0, rng_float(rng)};
    const float u = rng_float(rng);
    float kept = 0, of_kept = 0;
    for (uint32_t k = 0; k < count; k++) {
        const float x = candidate_number(u, candidate_shift(k, count).x);
        if (candidate_takes(&seen, value_at(x))) {
            kept = x;
            of_kept = value_at(x);
        }
    }
    return brings(kept) * (double)(seen.sum / (of_kept * (float)count));
}

// Eight z-tests of 2^20 estimates against 0.7^9, each with a false-alarm rate of 1e-6.
static void kept_one_stands_for_all(void) {
    enum { ESTIMATES = 1 << 20 };
    const double expected = pow(0.7, 9);
    for (uint32_t count = 1; count <= MOST_CANDIDATES; count++) {
        struct rng rng = {count};
        double sum = 0, squares = 0;
        for (int i = 0; i < ESTIMATES; i++) {
            const double e = estimate(&rng, count);
            sum += e;
            squares += e * e;
        }
        const double mean = sum / ESTIMATES;
        const double error = sqrt((squares / ESTIMATES - mean * mean) / ESTIMATES);
        const double z = (mean - expected) / error;
        printf("%u candidates: mean %.6f, expected %.6f, standard error %.6f, z %.2f\n", count, mean,
               expected, error, z);
        CHECK(fabs(z) < 4.89);
    }
}

// Never 1, for the largest number and for shifts that round.
static void numbers_stay_below_one(void) {
    const float last = 0x1.fffffep-1f;
    for (uint32_t count = 1; count <= MOST_CANDIDATES; count++)
        for (uint32_t k = 0; k < count; k++) {
            const struct candidate_shift s = candidate_shift(k, count);
            const float shifts[] = {s.choice, s.x, s.y};
            for (int i = 0; i < 3; i++) {
                CHECK(candidate_number(0, shifts[i]) == shifts[i]);
                CHECK(shifts[i] * 0x1p24f == floorf(shifts[i] * 0x1p24f));
                for (float u = last; u > 0.99999f; u -= 0x1p-24f)
                    CHECK(candidate_number(u, shifts[i]) >= 0 && candidate_number(u, shifts[i]) < 1);
            }
        }
}

// Every number of the grid is met once: neighbours stay neighbours, and only one step goes round.
static void grid_is_met_evenly(void) {
    const float step = 0x1p-24f;
    for (uint32_t k = 1; k < MOST_CANDIDATES; k++) {
        const float shift = candidate_shift(k, MOST_CANDIDATES).x;
        uint32_t wrong = 0;
        for (uint32_t i = 1; i < 1u << 24; i++) {
            const float a = candidate_number((float)(i - 1) * step, shift);
            const float b = candidate_number((float)i * step, shift);
            wrong += b - a != step;
        }
        CHECK(wrong == 1);
    }
}

static float any_value(struct rng *rng) {
    const float extremes[] = {0, 1e-45f, 1e-38f, 1, 1e30f, 3e38f, INFINITY, -0.0f};
    const uint32_t n = rng_u32(rng) % 16;
    return n < 8 ? extremes[n] : rng_float(rng);
}

static void lanes_decide_as_one(void) {
    struct rng rng = {7};
    int different = 0;
    for (int turn = 0; turn < 1000; turn++) {
        struct candidates_seen one[WIDE_LANES] = {{0, 0}};
        struct candidates_seen_wide all = {{0}, {0}};
        for (int i = 0; i < WIDE_LANES; i++)
            one[i].u = all.u[i] = rng_float(&rng);
        for (int k = 0; k < MOST_CANDIDATES; k++) {
            wide value;
            for (int i = 0; i < WIDE_LANES; i++)
                value[i] = any_value(&rng);
            const uint32_t takes = wide_bits(candidates_take(&all, value));
            for (int i = 0; i < WIDE_LANES; i++) {
                different += candidate_takes(&one[i], value[i]) != (takes >> i & 1);
                different += memcmp(&one[i].sum, (float *)&all.sum + i, 4) != 0;
                different += memcmp(&one[i].u, (float *)&all.u + i, 4) != 0;
            }
        }
    }
    printf("lanes: %d differences\n", different);
    CHECK(different == 0);
}

static void lanes_have_the_numbers_of_one(void) {
    struct rng rng = {8};
    for (int turn = 0; turn < 1000; turn++) {
        const float u = rng_float(&rng);
        const struct candidate_shift s = candidate_shift(rng_u32(&rng) % 8, 8);
        CHECK(candidate_numbers(wide_of(u), s.y)[3] == candidate_number(u, s.y));
    }
}

// For the film to reject, wherever it stands.
static void infinite_one_is_kept(void) {
    for (int at = 0; at < 3; at++) {
        struct candidates_seen seen = {0, 0.999f};
        int kept = -1;
        for (int k = 0; k < 3; k++)
            if (candidate_takes(&seen, k == at ? INFINITY : 1))
                kept = k;
        CHECK(kept == at && seen.sum == INFINITY);
    }
}

int main(void) {
    kept_one_stands_for_all();
    numbers_stay_below_one();
    grid_is_met_evenly();
    lanes_decide_as_one();
    lanes_have_the_numbers_of_one();
    infinite_one_is_kept();
    return check_result();
}
