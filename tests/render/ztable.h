// SPDX-License-Identifier: Apache-2.0
// A table of measured means against expected values; seeds are fixed, so a pass stays a pass. All tests
// of a file together raise a false alarm with the stated probability (Sidak), or each row holds to
// three standard errors, where a new seed fails more often: both say so.
#pragma once

#include "check.h"
#include "render/picture.h"
#include "statistics.h"

// Standard errors come from at least 240 degrees of freedom (16 replicates of 16 pixels), so
// that a deviate in their units is nearly normal.
enum { ZTABLE_MOST = 512 };

struct ztable_row {
    char name[96];
    double expected, floor;
    struct measured got;
    double p;
};

static struct ztable_row ztable[ZTABLE_MOST];
static int ztable_count;

// `floor`: a difference that rounding alone may make.
static inline void ztable_add(const char *name, double expected, struct measured got,
                              double floor) {
    struct ztable_row *r = &ztable[ztable_count++];
    if (ztable_count > ZTABLE_MOST)
        exit(1);
    snprintf(r->name, sizeof r->name, "%s", name);
    r->expected = expected;
    r->got = got;
    r->floor = floor;
    const double beyond = fmax(fabs(got.mean - expected) - floor, 0);
    if (!(fabs(got.mean - expected) <= INFINITY))
        r->p = 0; // NaN
    else
        r->p = beyond > 0 ? normal_p_value(beyond / got.error) : 1;
}

// A floor of 4 ulp for each bounce.
static inline double ulp_floor(double expected, double bounces) {
    return 4 * 0x1p-23 * expected * bounces;
}

// Rows below the limit are failures.
static inline void ztable_print(double limit) {
    printf("%-58s %12s %12s %10s %7s\n", "test", "expected", "measured", "std.error", "p");
    for (int i = 0; i < ztable_count; i++) {
        const struct ztable_row *r = &ztable[i];
        printf("%-58s %12.8g %12.9g %10.2e %7.4f%s\n", r->name, r->expected, r->got.mean,
               r->got.error, r->p, r->p > limit ? "" : "  FAILED");
        CHECK(r->p > limit);
    }
}

static inline void ztable_finish(double false_alarms) {
    const double limit = sidak(false_alarms, ztable_count);
    ztable_print(limit);
    printf("%d tests, false alarms of all together %g, each p > %.3g\n", ztable_count,
           false_alarms, limit);
}

// Each row within three standard errors, and the squares of all deviates together neither too large
// nor too small for chi-square, which raises a false alarm with the stated probability: errors that
// are told too large hide nothing. Rows whose floor counts are no deviates and left out there.
static inline void ztable_finish_within_three(double false_alarms) {
    const double outside = normal_p_value(3); // by chance
    double squares = 0;
    int degrees = 0;
    ztable_print(outside);
    for (int i = 0; i < ztable_count; i++) {
        const struct ztable_row *r = &ztable[i];
        if (r->got.error < 4 * r->floor)
            continue;
        const double z = (r->got.mean - r->expected) / r->got.error;
        squares += z * z;
        degrees++;
    }
    const double p = chi2_p_value(squares, degrees);
    printf("%d tests, each within 3 standard errors: of a new seed %.2g are expected outside, any with "
           "probability %.2g\nchi-square %.1f of %d, p %.3f, false alarms %g\n", ztable_count,
           ztable_count * outside, -expm1(ztable_count * log1p(-outside)), squares, degrees, p,
           false_alarms);
    CHECK(p > false_alarms / 2 && p < 1 - false_alarms / 2);
}
