// SPDX-License-Identifier: Apache-2.0
// Assertions of the tests: a test is a plain main that returns check_result(). Exit 77 skips.
#pragma once

#include <math.h>
#include <stdio.h>

static int check_failures, check_count;

// Goes on after a failure, so that one run shows them all.
#define CHECK(condition)                                                                           \
    do {                                                                                           \
        check_count++;                                                                             \
        if (!(condition)) {                                                                        \
            check_failures++;                                                                      \
            printf("%s:%d: failed: %s\n", __FILE__, __LINE__, #condition);                         \
        }                                                                                          \
    } while (0)

// |actual - expected| <= tolerance; NaN fails.
#define CHECK_NEAR(actual, expected, tolerance)                                                    \
    do {                                                                                           \
        const double a_ = (actual), e_ = (expected), t_ = (tolerance);                             \
        check_count++;                                                                             \
        if (!(fabs(a_ - e_) <= t_)) {                                                              \
            check_failures++;                                                                      \
            printf("%s:%d: failed: %s = %.9g, expected %.9g +- %.3g\n", __FILE__, __LINE__,        \
                   #actual, a_, e_, t_);                                                           \
        }                                                                                          \
    } while (0)

// The larger of two differences; NaN is the worst of all, where fmax drops it.
static inline double worst_of(double a, double b) {
    return a >= b || isnan(a) ? a : b;
}

static inline int check_result(void) {
    printf("%d checks, %d failed\n", check_count, check_failures);
    return check_failures ? 1 : check_count == 0;
}
