// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "check.h"
#include "math/hash.h"

// Number of doubles between a and b, zero when they are equal.
static double ulps(double a, double b) {
    const double step = nextafter(fabs(b), INFINITY) - fabs(b);
    return fabs(a - b) / step;
}

// 60 000 random numbers of all sizes in five notations against the C library.
static void text_number_agrees_with_strtod(void) {
    static const char *const formats[] = {"%.17g", "%.9g", "%f", "%.3e", "%.25f"};
    struct rng rng = {7};
    double worst = 0;
    int wrong_floats = 0, unread = 0;
    for (int i = 0; i < 60000; i++) {
        char text[512];
        const double size = pow(10, 80 * (rng_float(&rng) - 0.5));
        const double x = (rng_float(&rng) - 0.5) * size + rng_float(&rng) * size * 1e-8;
        snprintf(text, sizeof text, formats[i % 5], x);
        const char *p = text;
        double y = NAN;
        unread += !text_number(&p, &y) || *p != '\0';
        const double expected = strtod(text, NULL);
        worst = expected != 0 ? fmax(worst, ulps(y, expected)) : worst;
        wrong_floats += (float)y != (float)expected;
    }
    CHECK(unread == 0);
    CHECK_NEAR(worst, 0, 1);
    CHECK(wrong_floats == 0);
}

static void text_number_survives_extremes(void) {
    static const struct {
        const char *text;
        double value;
    } cases[] = {
        {"0e999999999999", 0}, {"1e-999999999999", 0}, {"1e999999999999", INFINITY},
        {"-1e400", -INFINITY}, {"4.9e-324", 4.9e-324}, {"18446744073709551615", 0x1p64},
        {"1.7976931348623157e308", 0x1.fffffffffffffp1023}, {"00000000000000000000000000001", 1},
        {"1e", 1}, {"1e+", 1}, {"5.", 5}, {".5", .5}, {"+.5", .5}, {"-5.e0", -5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *p = cases[i].text;
        double y = NAN;
        CHECK(text_number(&p, &y) && y == cases[i].value);
    }
    char zeros[5002] = "0.";
    memset(zeros + 2, '0', 4998);
    zeros[5000] = '1'; // 1e-4999
    const char *p = zeros;
    double y = NAN;
    CHECK(text_number(&p, &y) && y == 0 && *p == '\0');
}

static void text_number_leaves_words_alone(void) {
    static const char *const words[] = {"nan", "inf", "", "-", "+", ".", "-.", "e5", "x", "--1"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        const char *p = words[i];
        double y;
        CHECK(!text_number(&p, &y) && p == words[i]);
    }
}

static void text_integer_clamps(void) {
    static const struct {
        const char *text;
        int64_t value;
    } cases[] = {{"0", 0}, {"-12", -12}, {"+7", 7}, {"4294967296", 4294967296},
                 {"99999999999999999999999", INT64_MAX}, {"-99999999999999999999999", -INT64_MAX}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *p = cases[i].text;
        int64_t y;
        CHECK(text_integer(&p, &y) && y == cases[i].value && *p == '\0');
    }
}

int main(void) {
    text_number_agrees_with_strtod();
    text_number_survives_extremes();
    text_number_leaves_words_alone();
    text_integer_clamps();
    return check_result();
}
