// SPDX-License-Identifier: Apache-2.0
// The sky and sun models against the formulas evaluated in double on the original data set, and the
// sun's position against the worked example of Reda and Andreas 2004 (Solar Position Algorithm).
#include "check.h"
#include "light/sun_position.h"
#include "light/sunsky_model.h"

static float radians(double degrees) {
    return (float)(degrees * (M_PI / 180));
}

// Angles in degrees from the zenith and from the sun.
static spectrum evaluate(const struct sky_model *sky, double zenith, double gamma) {
    return sky_model_eval(sky, maxf(cosf(radians(zenith)), 0), cosf(radians(gamma)),
                          radians(gamma));
}

static void check_colour(spectrum s, double r, double g, double b, double tolerance) {
    CHECK_NEAR(s[0] / r, 1, tolerance);
    CHECK_NEAR(s[1] / g, 1, tolerance);
    CHECK_NEAR(s[2] / b, 1, tolerance);
}

static void check_sky(void) {
    struct sky_model sky;
    sky_model_init(&sky, 3, spectrum_grey(0.3f), 40 * (M_PI / 180));
    check_colour(evaluate(&sky, 30, 25), 0.04991184, 0.07191498,
                 0.11581076, 2e-5);
    sky_model_init(&sky, 5.5, spectrum_grey(0.8f), 10 * (M_PI / 180));
    check_colour(evaluate(&sky, 80, 60), 0.09833007, 0.10527425,
                 0.09628182, 2e-5);
    for (int t = 10; t <= 100; t++) // any parameters, any direction
        for (int e = 0; e <= 90; e += 15) {
            sky_model_init(&sky, t / 10.0, spectrum_rgb(0, 0.5f, 1), e * (M_PI / 180));
            for (int z = 0; z <= 90; z += 10)
                for (int g = 0; g <= 180; g += 20) {
                    const spectrum s = evaluate(&sky, z, g);
                    CHECK(spectrum_is_finite(s) && spectrum_min(s) >= 0);
                }
        }
}

static void check_sun(void) {
    struct sun_model sun;
    sun_model_init(&sun, 3, 40 * (M_PI / 180), radians(0.2679));
    check_colour(sun_model_eval(&sun, radians(40), 1), 25443.21761, 21460.59106, 16322.96051, 1e-4);
    check_colour(sun_model_eval(&sun, radians(40), 0.5f), 19058.28321, 15110.13358, 10401.25148,
                 1e-4);
    sun_model_init(&sun, 7.3, 5 * (M_PI / 180), radians(0.2679));
    check_colour(sun_model_eval(&sun, radians(5), 1), 2949.36070, 1205.85882, 190.43545, 2e-4);
    for (int e = 0; e <= 90; e++) {
        sun_model_init(&sun, 1 + e / 10.0, e * (M_PI / 180), radians(20));
        for (int k = 0; k <= 40; k++) {
            const spectrum s = sun_model_eval(&sun, radians(fmin(fmax(e - 20 + k, 0), 90)),
                                              (float)k / 40);
            CHECK(spectrum_is_finite(s) && spectrum_min(s) >= 0);
        }
    }
}

// Golden, Colorado, 17 October 2003 at 12:30:30: zenith 50.1116 degrees, azimuth 194.3402 east of
// north, without refraction 50.0945 + 0.0171.
static void check_position(void) {
    const struct sun_time t = {2003, 10, 17, 12, 30, 30, 39.742476, -105.1786, -7};
    const vec3 w = sun_position(&t);
    CHECK_NEAR(acos((double)w[2]) * (180 / M_PI), 50.112, 0.03);
    CHECK_NEAR(atan2((double)w[1], (double)w[0]) * (180 / M_PI), 194.3402 - 180, 0.03);
    CHECK_NEAR(length(w), 1, 1e-6);
}

int main(void) {
    check_sky();
    check_sun();
    check_position();
    return check_result();
}
