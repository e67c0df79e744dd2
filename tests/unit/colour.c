// SPDX-License-Identifier: Apache-2.0
// Colours of spectra against the values that Mitsuba 3.9.1 (scalar_rgb) prints for them, and named
// materials. Mitsuba computes in float: 2e-6 of the largest channel.
#include "check.h"
#include "math/colour.h"
#include "math/ior.h"

static void check(spectrum c, double r, double g, double b) {
    const double tolerance = 2e-6 * fmax(r, fmax(g, b));
    CHECK_NEAR(c[0], r, tolerance);
    CHECK_NEAR(c[1], g, tolerance);
    CHECK_NEAR(c[2], b, tolerance);
    CHECK(c[3] == 0);
}

static void sampled(void) {
    const double w[] = {400, 500, 600, 700};
    const double lamp[] = {0, 8, 15.6, 18.4}, red[] = {0, 0.1, 0.6, 0.9};
    const double index[] = {0.2, 0.8, 1.5, 1.8};
    check(colour_from_samples(w, lamp, 4, false), 20.710836, 10.854634, 2.771152);
    check(colour_from_samples(w, red, 4, true), 0.77751607, 0.30252782, 0.012683385);
    check(colour_from_samples(w, index, 4, true), 1.7072029, 1.1030052, 0.43762106);
}

// Whether D65 is white, and no light is black.
static void simple(void) {
    const double w[] = {300, 900}, one[] = {1, 1}, none[] = {0, 0};
    check(colour_from_samples(w, one, 2, true), 0.99898529, 0.99887371, 0.99880159);
    const spectrum black = colour_from_samples(w, none, 2, false);
    CHECK(spectrum_is_black(black));
    const double nothing = 5;
    CHECK(spectrum_is_black(colour_from_samples(&nothing, &nothing, 1, false)));
    check(3 * colour_equal_energy(), 3.6143818, 2.844873, 2.7267482);
    CHECK_NEAR(spectrum_luminance(colour_equal_energy()), 1, 1e-5);
}

// Two values at one wavelength are a step, and must not divide by zero.
static void step(void) {
    const double w[] = {360, 550, 550, 830}, v[] = {0, 0, 1, 1};
    const spectrum c = colour_from_samples(w, v, 4, false);
    CHECK(spectrum_is_finite(c) && c[0] > 1);
}

// Chromaticities of Planck's law for the CIE 1931 observer (Wyszecki and Stiles 1982, table 1(3.11)),
// and its luminance from 1 nm tables of the observer.
static void blackbody(void) {
    const struct {
        double kelvin, x, y;
    } known[] = {{3000, 0.4369, 0.4041}, {6500, 0.3135, 0.3237}, {10000, 0.2807, 0.2884}};
    for (int i = 0; i < 3; i++) {
        const spectrum c = colour_blackbody(known[i].kelvin);
        const double X = 0.412453 * c[0] + 0.357580 * c[1] + 0.180423 * c[2];
        const double Y = 0.212671 * c[0] + 0.715160 * c[1] + 0.072169 * c[2];
        const double Z = 0.019334 * c[0] + 0.119193 * c[1] + 0.950227 * c[2];
        CHECK_NEAR(X / (X + Y + Z), known[i].x, 5e-4);
        CHECK_NEAR(Y / (X + Y + Z), known[i].y, 5e-4);
    }
    CHECK_NEAR(spectrum_luminance(colour_blackbody(5000)) / 12579.71, 1, 1e-3);
    CHECK(spectrum_is_finite(colour_blackbody(100)) && spectrum_is_finite(colour_blackbody(1e6)));
}

static void transfer(void) {
    for (int i = 0; i <= 1000; i++) {
        const float v = (float)i / 1000;
        CHECK_NEAR(colour_linear_to_srgb(colour_srgb_to_linear(v)), v, 1e-6);
    }
    CHECK_NEAR(colour_srgb_to_linear(0.5f), 0.21404114, 1e-7);
    CHECK(colour_srgb_to_linear(0) == 0 && colour_srgb_to_linear(1) == 1);
    CHECK_NEAR(colour_srgb_to_linear(-0.5f), -0.21404114, 1e-7);
}

static void indices(void) {
    spectrum eta, k;
    float ior;
    CHECK(ior_conductor_find("Au", &eta, &k));
    check(eta, 0.14303598, 0.37530708, 1.4420453);
    check(k, 3.9829969, 2.3855565, 1.6033592);
    CHECK(ior_conductor_find("none", &eta, &k));
    check(eta, 0, 0, 0);
    check(k, 1, 1, 1);
    CHECK(!ior_conductor_find("au", &eta, &k) && !ior_conductor_find("", &eta, &k));
    CHECK(ior_dielectric_find("bk7", &ior));
    CHECK_NEAR(ior, 1.5046, 1e-7);
    CHECK(!ior_dielectric_find("bk8", &ior));
    size_t n = 0;
    for (const char *name; (name = ior_conductor_name(n)); n++)
        CHECK(ior_conductor_find(name, &eta, &k) && spectrum_min(eta) >= 0 && spectrum_min(k) >= 0);
    CHECK(n >= 70);
    for (n = 0; ior_dielectric_name(n); n++)
        CHECK(ior_dielectric_find(ior_dielectric_name(n), &ior) && ior >= 1);
}

int main(void) {
    sampled();
    simple();
    step();
    blackbody();
    transfer();
    indices();
    return check_result();
}
