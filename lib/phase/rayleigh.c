// SPDX-License-Identifier: Apache-2.0
// Scattering by particles much smaller than the wavelength: p(cos) = 3 / (16 pi) (1 + cos^2).
//
// Inversion after Frisvad 2011, Importance sampling the Rayleigh phase function: with z = 2 (1 - 2u),
// x = cbrt(z + sqrt(z^2 + 1)), the cosine is 1/x - x.
#include "phase/phase.h"

static float pdf_sa(const void *data, vec3 p, struct deflection c) {
    (void)data;
    (void)p;
    const float cosine = 0.5f * (c.backward - c.forward);
    return 3.0f / 16 * INV_PI * (1 + cosine * cosine);
}

static struct deflection sample(const void *data, vec3 p, float u1, float u2) {
    (void)data;
    (void)p;
    (void)u1;
    const float z = 2 * (1 - 2 * u2);
    const float x = cbrtf(fabsf(z) + sqrtf(z * z + 1));
    const float cosine = clampf(copysignf(1 / x - x, -z), -1, 1);
    return (struct deflection){1 - cosine, 1 + cosine};
}

static float mean_cosine(const void *data, vec3 p) {
    (void)data;
    (void)p;
    return 0;
}

const struct phase_type phase_rayleigh = {
    .entry = {.name = "rayleigh", .help = "Rayleigh 1871: particles far below the wavelength",
              .size = 0},
    .pdf_sa = pdf_sa, .sample = sample, .mean_cosine = mean_cosine,
};
