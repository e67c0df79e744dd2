// SPDX-License-Identifier: Apache-2.0
// Curves: bases, projection, files, operators, areas of facets.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "capture.h"
#include "check.h"
#include "curve/model.h"
#include "curve/operators.h"
#include "math/hash.h"

static const double DEGREE = CURVE_END / 90;

// ---- bases ----------------------------------------------------------------------------------

static void functions_sum_to_one(void) {
    struct rng rng = {1};
    for (int i = 0; i < 4; i++) {
        struct arena arena = {0};
        const enum basis_kind kind = i % 2 ? BASIS_HAT : BASIS_BOX;
        const struct basis b = basis_make(&arena, kind, 37, i < 2 ? SPACING_UNIFORM
                                                                  : SPACING_QUADRATIC);
        struct basis any = b;
        any.spacing = SPACING_ANY;
        for (int n = 0; n < 10000; n++) {
            uint32_t index[2], same[2];
            double value[2];
            const double at = n == 0 ? CURVE_END : CURVE_END * (double)rng_float(&rng);
            const uint32_t count = basis_at(&b, at, index, value);
            CHECK(count == (kind == BASIS_HAT ? 2u : 1u));
            CHECK_NEAR(value[0] + (count > 1 ? value[1] : 0), 1, 1e-15);
            CHECK(index[count - 1] < b.count);
            const uint32_t k = basis_interval(&b, at);
            CHECK(at >= b.knots[k] && at <= b.knots[k + 1]);
            CHECK(k == basis_interval(&any, at) && basis_place(&b, k, at) == basis_place(&any, k, at));
            CHECK(basis_at(&any, at, same, value) == count && same[0] == index[0]);
        }
        double value[2];
        uint32_t index[2];
        CHECK(basis_at(&b, 1.6, index, value) == 0);
        CHECK(basis_at(&b, (double)(float)CURVE_END, index, value) > 0); // rounded up in float
        arena_finish(&arena);
    }
}

// At what part of a right angle a lobe falls to exp(-1/2) of its top, as cos(g)^n does at 1 / sqrt(n).
static void lobes_have_exponents(void) {
    const struct curve_function lobes[] = {
        {FUNCTION_COS_POWER, .p = {900}}, {FUNCTION_BECKMANN, .p = {0.05}},
        {FUNCTION_GAUSSIAN, .p = {0.05}}, {FUNCTION_SCHLICK_Z, .p = {0.005}}};
    for (size_t i = 0; i < sizeof lobes / sizeof *lobes; i++) {
        const double spread = 1 / sqrt(function_exponent(&lobes[i]));
        const double fall = function_value(&lobes[i], spread) / function_value(&lobes[i], 0);
        CHECK_NEAR(fall, exp(-0.5), lobes[i].kind == FUNCTION_SCHLICK_Z ? 0.04 : 2e-3);
    }
    const struct curve_function flat = {FUNCTION_CONSTANT, .p = {900}};
    CHECK(function_exponent(&flat) <= 0);
}

static void bins_carry_exponents(void) {
    struct arena arena = {0};
    for (int i = 0; i < 2; i++) {
        const enum basis_kind kind = i ? BASIS_HAT : BASIS_BOX;
        const struct basis even = basis_make(&arena, kind, 128, SPACING_UNIFORM);
        const struct basis fine = basis_make(&arena, kind, 32, SPACING_QUADRATIC);
        const struct basis few = basis_make(&arena, kind, 2, SPACING_UNIFORM);
        CHECK_NEAR(basis_exponent(&even), pow(128 / 5.2, 2), 1e-9);
        CHECK_NEAR(basis_exponent(&few), pow(2 / 5.2, 2), 1e-12);
        CHECK(basis_exponent(&fine) > 5 * pow(32 / 5.2, 2));
    }
    arena_finish(&arena);
}

// ---- projection -----------------------------------------------------------------------------

// Integral of a curve times a measure, exactly for the basis.
static double integral(const struct curve *c, bool sine) {
    double sum = 0;
    for (uint32_t i = 0; i < basis_intervals(&c->basis); i++) {
        const double a = c->basis.knots[i], b = c->basis.knots[i + 1];
        for (int j = 0; j < 64; j++) {
            const double x = a + (b - a) * (j + 0.5) / 64;
            sum += curve_at(c, 0, x) * (sine ? sin(x) : 1) * (b - a) / 64;
        }
    }
    return sum;
}

static double cos_power_sine_integral(double n) {
    return 1 / (n + 1); // of cos^n(x) sin(x)
}

static void means_keep_the_integral(void) {
    static const double exponents[] = {0, 1, 30, 1000, 1e5, 1e7};
    for (int e = 0; e < 6; e++)
        for (int kind = 0; kind < 2; kind++)
            for (uint32_t count = 2; count <= 512; count *= 4) {
                struct arena arena = {0};
                const struct basis b = basis_make(&arena, (enum basis_kind)kind, count,
                                                  SPACING_UNIFORM);
                struct curve c = curve_make(&arena, &b, 1);
                const struct curve_function f = {.kind = FUNCTION_COS_POWER, .p = {exponents[e]}};
                function_project(&c, 0, &f, FILTER_SINE);
                const double expected = cos_power_sine_integral(exponents[e]);
                CHECK_NEAR(integral(&c, true) / expected, 1, 2e-4); // of the midpoints
                arena_finish(&arena);
            }
}

// Peak loss and relative L2 error of boxes, as tabulated with the published method.
static void boxes_lose_peaks_as_known(void) {
    static const struct {
        double n;
        uint32_t size;
        double loss, l2;
    } known[] = {{200, 64, 0.02, 0.071}, {200, 128, 0.005, 0.035}, {1024, 64, 0.094, 0},
                 {1024, 128, 0.025, 0}, {1024, 256, 0.0064, 0.040}, {200, 32, 0, 0.140}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        struct arena arena = {0};
        const struct basis b = basis_make(&arena, BASIS_BOX, known[i].size, SPACING_UNIFORM);
        struct curve c = curve_make(&arena, &b, 1);
        const struct curve_function f = {.kind = FUNCTION_COS_POWER, .p = {known[i].n}};
        function_project(&c, 0, &f, FILTER_MEAN);
        double top = 0, bottom = 0;
        for (int k = 0; k < 100000; k++) {
            const double x = CURVE_END * (k + 0.5) / 100000, v = function_value(&f, x);
            top += (curve_at(&c, 0, x) - v) * (curve_at(&c, 0, x) - v);
            bottom += v * v;
        }
        if (known[i].loss > 0)
            CHECK_NEAR(1 - curve_at(&c, 0, 0), known[i].loss, 0.03 * known[i].loss + 5e-4);
        if (known[i].l2 > 0)
            CHECK_NEAR(sqrt(top / bottom), known[i].l2, 0.02 * known[i].l2);
        arena_finish(&arena);
    }
}

static void resampling_keeps_what_fits(void) {
    struct arena arena = {0};
    const struct basis b = basis_make(&arena, BASIS_BOX, 32, SPACING_UNIFORM);
    const struct basis fine = basis_make(&arena, BASIS_BOX, 128, SPACING_UNIFORM);
    struct curve c = curve_make(&arena, &b, 3), d = curve_make(&arena, &fine, 3),
                 e = curve_make(&arena, &b, 3);
    struct rng rng = {4};
    for (int i = 0; i < 96; i++)
        c.values[i] = (double)rng_float(&rng);
    curve_resample(&d, &c, FILTER_SINE);
    curve_resample(&e, &d, FILTER_SINE);
    for (int i = 0; i < 96; i++)
        CHECK_NEAR(e.values[i], c.values[i], 1e-12);
    arena_finish(&arena);
}

// ---- files ----------------------------------------------------------------------------------

static void files_come_back_the_same(void) {
    char path[] = "/tmp/relume-curve-XXXXXX";
    const int fd = mkstemp(path);
    CHECK(fd >= 0);
    close(fd);
    struct rng rng = {5};
    for (int i = 0; i < 8; i++) {
        struct arena arena = {0};
        const struct basis b = basis_make(&arena, i & 1 ? BASIS_HAT : BASIS_BOX, 19,
                                          i & 2 ? SPACING_UNIFORM : SPACING_QUADRATIC);
        struct curve c = curve_make(&arena, &b, i & 4 ? 3 : 1), d;
        for (uint32_t k = 0; k < c.channels * 19; k++)
            c.values[k] = exp(40 * (double)rng_float(&rng) - 20);
        CHECK(curve_write(&c, path));
        CHECK(curve_read(&d, &arena, path));
        CHECK(d.channels == c.channels && basis_equal(&c.basis, &d.basis));
        CHECK(d.basis.spacing == b.spacing);
        CHECK(memcmp(c.values, d.values, sizeof(double) * 19 * c.channels) == 0);
        arena_finish(&arena);
    }
    unlink(path);
}

static void good_files_are_read(void) {
    struct arena arena = {0};
    struct curve c;
    CHECK(curve_parse(&c, &arena, "# mine\r\n\nfrom,to,value\r\n0,30,1\r\n30,90,2e1\r\n",
                      "a.csv"));
    CHECK(c.basis.kind == BASIS_BOX && c.basis.count == 2 && c.basis.spacing == SPACING_ANY);
    CHECK(curve_at(&c, 2, 29.9 * DEGREE) == 1 && curve_at(&c, 0, 30.1 * DEGREE) == 20);
    CHECK(curve_parse(&c, &arena, "at,r,g,b\n0, 0,1,2\n 45 ,1,1,1\n90,0,0,0", "a.csv"));
    CHECK(c.basis.kind == BASIS_HAT && c.channels == 3 && c.basis.spacing == SPACING_UNIFORM);
    CHECK_NEAR(curve_at(&c, 2, 22.5 * DEGREE), 1.5, 1e-14);
    arena_finish(&arena);
}

static void bad_files_are_refused(void) {
    static const char *const bad[][2] = {
        {"", "expected a line with the names"}, {"from,to\n", "expected \"from,to,value\""},
        {"at,value\n0,1\n", "expected 90"}, {"at,value\n0,1\n0,2\n90,1", "nodes that ascend"},
        {"at,value\n1,1\n90,2\n", "nodes that ascend"}, {"at,value\n90,2\n", "nodes that ascend"},
        {"from,to,value\n0,10,1\n11,90,1\n", "without gaps"},
        {"from,to,value\n0,0,1\n0,90,1\n", "bins in order"},
        {"from,to,value\n0,90,-1\n", "no negative number"},
        {"from,to,value\n0,90,nan\n", "a finite number"},
        {"from,to,value\n0,90,1e999\n", "a finite number"},
        {"from,to,value\n0,90\n", "a comma"}, {"from,to,value\n0,90,1,2\n", "the end of the line"},
        {"from,to,value\n0,90,x\n", "found \"x\""}, {"from,to,value\n0,180,1\n", "expected 90"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct arena arena = {0};
        struct curve c;
        capture_begin();
        const bool ok = curve_parse(&c, &arena, bad[i][0], "bad.csv");
        capture_end();
        CHECK(!ok);
        if (!captured_has(bad[i][1]) || !captured_has("bad.csv"))
            printf("said: %s\n", captured);
        CHECK(captured_has(bad[i][1]) && captured_has("bad.csv"));
        arena_finish(&arena);
    }
}

// ---- operators ------------------------------------------------------------------------------

static double wavy(const void *ctx, double x) {
    (void)ctx;
    return 2 + sin(5 * x);
}

static struct curve_operator operator_of(enum operator_kind kind, double m, double base) {
    return (struct curve_operator){kind, 0.3, 0.5, 0.8, 1.1, m, base};
}

static double edited(const struct curve_operator *o, uint32_t n, double x) {
    const struct edited_curve e = {wavy, NULL, o, n};
    return edited_curve_at(&e, x);
}

static void operators_act_inside_their_region_only(void) {
    const struct curve_operator all[] = {
        operator_of(OPERATOR_TRANSLATE_X, 0.02, 0), operator_of(OPERATOR_TRANSLATE_Y, 0.7, 0),
        operator_of(OPERATOR_AMPLIFY_X, 1.1, 0.6), operator_of(OPERATOR_AMPLIFY_Y, 3, 2.5)};
    for (int i = 0; i < 4; i++) {
        CHECK(operator_check(&all[i], "test"));
        for (int k = 0; k < 1000; k++) {
            const double x = CURVE_END * k / 1000;
            if (x < 0.3 || x > 1.1)
                CHECK(edited(&all[i], 1, x) == wavy(NULL, x));
        }
        // in the primary region, by the definitions
        CHECK_NEAR(edited(&all[0], 1, 0.6), wavy(NULL, 0.58), 1e-15);
        CHECK_NEAR(edited(&all[1], 1, 0.6), wavy(NULL, 0.6) + 0.7, 1e-15);
        CHECK_NEAR(edited(&all[2], 1, 0.7), wavy(NULL, 0.6 + 0.1 / 1.1), 1e-15);
        CHECK_NEAR(edited(&all[3], 1, 0.6), 2.5 + 3 * (wavy(NULL, 0.6) - 2.5), 1e-14);
        // a base is a fixed point
        CHECK(edited(&all[2], 1, 0.6) == wavy(NULL, 0.6));
    }
    const struct curve_operator there = operator_of(OPERATOR_TRANSLATE_Y, 0.7, 0),
                                back = operator_of(OPERATOR_TRANSLATE_Y, -0.7, 0);
    const struct curve_operator both[] = {there, back};
    for (int k = 0; k < 1000; k++)
        CHECK_NEAR(edited(both, 2, CURVE_END * k / 1000), wavy(NULL, CURVE_END * k / 1000), 1e-15);
}

// Differences of a jump or kink grow with 1/h, of a smooth curve they do not.
static void operators_are_smooth_at_their_ends(void) {
    const struct curve_operator all[] = {
        operator_of(OPERATOR_TRANSLATE_X, 0.02, 0), operator_of(OPERATOR_TRANSLATE_Y, 0.7, 0),
        operator_of(OPERATOR_AMPLIFY_X, 1.1, 0.6), operator_of(OPERATOR_AMPLIFY_Y, 3, 2.5)};
    const double ends[] = {0.3, 0.5, 0.8, 1.1}, h = 1e-3;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            double f[5];
            for (int j = 0; j < 5; j++)
                f[j] = edited(&all[i], 1, ends[k] + (j - 2) * h);
            const double slopes = (f[3] - f[2]) / h - (f[2] - f[1]) / h;
            const double third = (f[4] - 2 * f[3] + 2 * f[1] - f[0]) / (2 * h * h * h);
            CHECK(fabs(slopes) < 0.2 && fabs(third) < 600);
        }
}

static void folds_are_refused(void) {
    for (int i = 0; i < 4; i++) {
        const double limit = (i < 2 ? 0.2 : 0.3) / 8, sign = i < 2 ? 1 : -1;
        const bool over = i % 2;
        const struct curve_operator o =
            operator_of(OPERATOR_TRANSLATE_X, sign * limit * (over ? 1.001 : 0.999), 0);
        capture_begin();
        const bool ok = operator_check(&o, "edit");
        capture_end();
        CHECK(ok == !over);
        CHECK(!over || captured_has("fold"));
    }
    const struct curve_operator tear = {OPERATOR_TRANSLATE_Y, 0.3, 0.3, 0.8, 1.1, 1, 0};
    capture_begin();
    CHECK(!operator_check(&tear, "edit"));
    capture_end();
    CHECK(captured_has("tear"));
}

static void y_acts_before_x(void) {
    const struct curve_operator o[] = {operator_of(OPERATOR_TRANSLATE_X, 0.02, 0),
                                       {OPERATOR_TRANSLATE_Y, 0.55, 0.57, 0.59, 0.61, 1, 0}};
    const double x = 0.6; // the bump at 0.58 has moved here
    CHECK_NEAR(edited(o, 2, x), wavy(NULL, 0.58) + 1, 1e-15);
}

static void tables_keep_their_bits_outside(void) {
    struct arena arena = {0};
    struct curve_operator o[4];
    uint32_t n;
    CHECK(operators_parse("amplify-y,10,20,30,40,2,0.5;translate-x,50,60,70,80,-1", o, 4, &n, "t"));
    CHECK(n == 2 && o[1].kind == OPERATOR_TRANSLATE_X);
    for (int kind = 0; kind < 2; kind++) {
        const struct basis b = basis_make(&arena, (enum basis_kind)kind, 90, SPACING_UNIFORM);
        struct curve c = curve_make(&arena, &b, 3), d = c;
        struct rng rng = {8};
        d.values = arena_alloc(&arena, sizeof(double) * 270);
        for (int i = 0; i < 270; i++)
            d.values[i] = c.values[i] = (double)rng_float(&rng);
        curve_edit(&d, 1 << 1, o, n);
        for (int i = 0; i < 270; i++) {
            const int bin = i % 90;
            const bool edited = (bin >= 9 && bin <= 40) || (bin >= 49 && bin <= 80);
            const bool inside = i / 90 == 1 && edited;
            CHECK(inside || d.values[i] == c.values[i]);
        }
        CHECK_NEAR(d.values[90 + 25], fmax(0.5 + 2 * (c.values[90 + 25] - 0.5), 0), 1e-12);
    }
    static const char *const bad[] = {"amplify-z,1,2,3,4,5", "amplify-y,1,2,3,4", "amplify-y",
                                      "amplify-y,1,2,3,4,5,6,7", "amplify-y,1,2,x,4,5",
                                      "translate-y,40,30,50,60,1", "amplify-x,1,20,30,60,-1",
                                      "translate-y,1,2,3,4,nan"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        capture_begin();
        CHECK(!operators_parse(bad[i], o, 4, &n, "edit"));
        capture_end();
        CHECK(captured_has("edit: "));
    }
    arena_finish(&arena);
}

// ---- facets ---------------------------------------------------------------------------------

static double one(const void *ctx, double x) {
    (void)ctx;
    (void)x;
    return 1;
}

// Of all normals alike: the integral of (h.k)+ over the hemisphere is pi/2 (1 + cos theta).
static void facet_areas_are_known_for_even_facets(void) {
    static struct profile g;
    const double breaks[] = {0.2, 0.9, 1.1};
    profile_fit(&g, one, NULL);
    CHECK_NEAR(profile_at(&g, 0.3), 1, 1e-15);
    for (int i = 0; i <= 20; i++) {
        const double theta = CURVE_END * i / 20, expected = M_PI / 2 * (1 + cos(theta));
        CHECK_NEAR(facet_area(one, NULL, NULL, 0, theta), expected, 1e-13);
        CHECK_NEAR(facet_area(one, NULL, breaks, 3, theta), expected, 1e-10);
    }
}

int main(void) {
    functions_sum_to_one();
    lobes_have_exponents();
    bins_carry_exponents();
    means_keep_the_integral();
    boxes_lose_peaks_as_known();
    resampling_keeps_what_fits();
    files_come_back_the_same();
    good_files_are_read();
    bad_files_are_refused();
    operators_act_inside_their_region_only();
    operators_are_smooth_at_their_ends();
    folds_are_refused();
    y_acts_before_x();
    tables_keep_their_bits_outside();
    facet_areas_are_known_for_even_facets();
    return check_result();
}
