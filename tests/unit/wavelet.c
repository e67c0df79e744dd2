// SPDX-License-Identifier: Apache-2.0
// Wavelet transforms of curves, and following an edit by few terms.
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "curve/function.h"
#include "curve/incremental.h"
#include "curve/wavelet.h"
#include "math/hash.h"

static void wavelets_are_orthonormal(void) {
    for (int w = 0; w < WAVELET_COUNT; w++)
        for (size_t n = 1; n <= 256; n *= 2) {
            static double s[256 * 256], scratch[512];
            double worst = 0;
            for (size_t i = 0; i < n; i++) {
                memset(s + i * n, 0, n * sizeof *s);
                s[i * n + i] = 1;
                wavelet_forward_d((enum wavelet)w, s + i * n, n, scratch);
            }
            for (size_t i = 0; i < n; i++)
                for (size_t j = 0; j < n; j++) {
                    double dot = 0;
                    for (size_t k = 0; k < n; k++)
                        dot += s[i * n + k] * s[j * n + k];
                    worst = fmax(worst, fabs(dot - (i == j)));
                }
            CHECK(worst < 1e-12);
        }
}

static void transforms_go_back_and_forth(void) {
    struct rng rng = {3};
    for (int w = 0; w < WAVELET_COUNT; w++) {
        static double x[64 * 128], y[64 * 128], scratch[256];
        static float f[256], g[256], work[256];
        for (int i = 0; i < 64 * 128; i++)
            x[i] = y[i] = (double)rng_float(&rng);
        wavelet_forward_matrix((enum wavelet)w, y, 64, 128, scratch);
        for (int i = 0; i < 256; i++)
            f[i] = g[i] = rng_float(&rng);
        wavelet_inverse_matrix((enum wavelet)w, y, 64, 128, scratch);
        for (int i = 0; i < 64 * 128; i++)
            CHECK_NEAR(y[i], x[i], 1e-13);
        wavelet_forward_f((enum wavelet)w, g, 256, work);
        wavelet_inverse_f((enum wavelet)w, g, 256, work);
        for (int i = 0; i < 256; i++)
            CHECK_NEAR(g[i], f[i], 3e-6);
    }
}

// Daubechies' filters keep straight lines out of the details (where nothing wraps around).
static void daubechies_details_vanish_on_lines(void) {
    double x[64], scratch[64];
    for (int i = 0; i < 64; i++)
        x[i] = 3 + 0.25 * i;
    wavelet_forward_d(WAVELET_DAUB4, x, 64, scratch);
    for (int i = 32; i < 63; i++)
        CHECK_NEAR(x[i], 0, 1e-13);
    CHECK(fabs(x[63]) > 0.1); // the jump from the end back to the start
}

static int descending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

// Terms needed for relative errors of 1 %, 0.1 % and 0.01 %, as published with the method.
static void terms_needed_are_as_known(void) {
    static const double exponents[] = {4, 16, 64, 200, 1024, 4096};
    static const int known[6][3] = {{19, 36, 97}, {21, 41, 105}, {22, 43, 77},
                                    {23, 43, 55}, {24, 31, 36}, {23, 25, 28}};
    for (int e = 0; e < 6; e++) {
        struct arena arena = {0};
        double scratch[256], total = 0, left;
        const struct basis b = basis_make(&arena, BASIS_BOX, 256, SPACING_UNIFORM);
        struct curve c = curve_make(&arena, &b, 1);
        const struct curve_function f = {.kind = FUNCTION_COS_POWER, .p = {exponents[e]}};
        function_project(&c, 0, &f, FILTER_MEAN);
        wavelet_forward_d(WAVELET_DAUB4, c.values, 256, scratch);
        for (int i = 0; i < 256; i++)
            total += c.values[i] *= c.values[i];
        qsort(c.values, 256, sizeof(double), descending);
        int n = 0;
        left = total;
        for (int k = 0; k < 3; k++) {
            for (; left > pow(10, -4 - 2 * k) * total; n++)
                left -= c.values[n];
            if (n != known[e][k])
                printf("exponent %g: %d terms, known %d\n", exponents[e], n, known[e][k]);
            CHECK(n == known[e][k]);
        }
        arena_finish(&arena);
    }
}

// ---- incremental ----------------------------------------------------------------------------

// Table 7.1 of Ben-Artzi 2007: boxes, one term a frame, T = (3, 5, 2).
static void the_published_example_is_met(void) {
    static const double wanted[3][3] = {{4, 2, 1}, {4, 3, 1}, {4, 2, 0}}, T[3] = {3, 5, 2};
    static const double perfect[3] = {24, 29, 22}, step[3] = {12, 15, -5}, shown[3] = {12, 27, 22};
    double effective[3] = {0}, R = 0;
    struct incremental s = {3, 1, effective, NULL};
    for (int t = 0; t < 3; t++) {
        uint32_t index[3], order[3];
        double difference[3], exact = 0, change = 0;
        const size_t n = incremental_step(&s, wanted[t], 1, index, difference, order);
        CHECK(n == 1);
        for (size_t i = 0; i < n; i++)
            change += difference[i] * T[index[i]];
        for (int i = 0; i < 3; i++)
            exact += wanted[t][i] * T[i];
        R += change;
        CHECK(exact == perfect[t] && change == step[t] && R == shown[t]);
    }
    CHECK(effective[0] == 4 && effective[1] == 2 && effective[2] == 0);
}

static void any_edit_is_reached(void) {
    double wanted[256], effective[256] = {0}, weight[256], difference[256];
    uint32_t index[256], order[256];
    struct rng rng = {2};
    for (int i = 0; i < 256; i++) {
        wanted[i] = i % 3 ? (double)rng_float(&rng) - 0.5 : 0;
        weight[i] = (double)rng_float(&rng);
    }
    struct incremental s = {256, 1, effective, weight};
    size_t frames = 0, n;
    double last = INFINITY;
    while ((n = incremental_step(&s, wanted, 30, index, difference, order)) > 0) {
        for (size_t i = 0; i < n; i++) {
            const double u = fabs(difference[i]) * weight[index[i]];
            CHECK(u <= last); // the most urgent first, in all frames
            last = u;
        }
        CHECK(n == 30 || frames == 5);
        frames++;
    }
    CHECK(frames == 6); // 170 terms
    CHECK(memcmp(wanted, effective, sizeof wanted) == 0);
}

int main(void) {
    wavelets_are_orthonormal();
    transforms_go_back_and_forth();
    daubechies_details_vanish_on_lines();
    terms_needed_are_as_known();
    the_published_example_is_met();
    any_edit_is_reached();
    return check_result();
}
