// SPDX-License-Identifier: Apache-2.0
#include "math/colour.h"

#include "math/cie.h"

// Integral of cie_y (trapezoid at 5 nm, in float as Mitsuba 3 has it), and the factor that gives D65
// luminance 1 (Mitsuba 3, spectrum.h).
static const double y_integral = 106.7502593994140625;
static const double d65_integral = 98.99741751876255;

// XYZ to linear Rec.709, with the rounding Mitsuba prints
static const double from_xyz[3][3] = {
    {3.240479, -1.537150, -0.498535},
    {-0.969256, 1.875991, 0.041556},
    {0.055648, -0.204043, 1.057311},
};

static double interpolate(const double *table, double wavelength) {
    const double x = (wavelength - CIE_FIRST) / CIE_STEP;
    int i = (int)x;
    i = i < 0 ? 0 : i > CIE_SAMPLES - 2 ? CIE_SAMPLES - 2 : i;
    const double t = x - i;
    return (1 - t) * table[i] + t * table[i + 1];
}

static spectrum to_rgb(const double xyz[3]) {
    float rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)(from_xyz[c][0] * xyz[0] + from_xyz[c][1] * xyz[1] +
                         from_xyz[c][2] * xyz[2]);
    return spectrum_rgb(rgb[0], rgb[1], rgb[2]);
}

// Integrates value(wavelength) against the observer at the 1000 points Mitsuba uses.
static spectrum integrate(double (*value)(const void *data, double wavelength), const void *data) {
    enum { STEPS = 1000 };
    double xyz[3] = {0};
    for (int i = 0; i < STEPS; i++) {
        const double w = CIE_FIRST + i * (double)(CIE_LAST - CIE_FIRST) / (STEPS - 1);
        const double v = value(data, w);
        xyz[0] += interpolate(cie_x, w) * v;
        xyz[1] += interpolate(cie_y, w) * v;
        xyz[2] += interpolate(cie_z, w) * v;
    }
    for (int c = 0; c < 3; c++)
        xyz[c] *= (CIE_LAST - CIE_FIRST) / (STEPS * y_integral);
    return to_rgb(xyz);
}

struct samples {
    const double *x, *y;
    size_t count;
    bool lit;
};

static double sampled(const void *data, double w) {
    const struct samples *s = data;
    if (s->count < 2 || w < s->x[0] || w > s->x[s->count - 1])
        return 0;
    size_t lo = 0, hi = s->count - 1; // x[lo] <= w, interval [lo, lo + 1]
    while (hi - lo > 1) {
        const size_t middle = (lo + hi) / 2;
        if (s->x[middle] <= w)
            lo = middle;
        else
            hi = middle;
    }
    const double width = s->x[lo + 1] - s->x[lo];
    const double t = width > 0 ? (w - s->x[lo]) / width : 0;
    const double light = s->lit ? interpolate(cie_d65, w) / d65_integral : 1;
    return ((1 - t) * s->y[lo] + t * s->y[lo + 1]) * light;
}

spectrum colour_from_samples(const double *wavelengths, const double *values, size_t count,
                             bool lit) {
    const struct samples s = {wavelengths, values, count, lit};
    return integrate(sampled, &s);
}

spectrum colour_equal_energy(void) {
    const double one[3] = {1, 1, 1};
    return to_rgb(one);
}

static double planck(const void *data, double wavelength) {
    const double c = 2.99792458e8, h = 6.62607015e-34, k = 1.380649e-23; // SI 2019, exact
    const double kelvin = *(const double *)data, w = wavelength * 1e-9;
    return 1e-9 * 2 * h * c * c / (pow(w, 5) * expm1(h * c / (w * k * kelvin)));
}

spectrum colour_blackbody(double kelvin) {
    return integrate(planck, &kelvin);
}

float colour_srgb_to_linear(float v) {
    const float a = fabsf(v);
    return copysignf(a <= 0.04045f ? a / 12.92f : powf((a + 0.055f) / 1.055f, 2.4f), v);
}

float colour_linear_to_srgb(float v) {
    const float a = fabsf(v);
    return copysignf(a <= 0.0031308f ? a * 12.92f : 1.055f * powf(a, 1 / 2.4f) - 0.055f, v);
}
