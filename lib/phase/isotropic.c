// SPDX-License-Identifier: Apache-2.0
// All directions alike.
#include "phase/phase.h"

static float pdf_sa(const void *data, vec3 p, struct deflection c) {
    (void)data;
    (void)p;
    (void)c;
    return 0.25f * INV_PI;
}

static struct deflection sample(const void *data, vec3 p, float u1, float u2) {
    (void)data;
    (void)p;
    (void)u1;
    return (struct deflection){2 * u2, 2 - 2 * u2};
}

static float mean_cosine(const void *data, vec3 p) {
    (void)data;
    (void)p;
    return 0;
}

const struct phase_type phase_isotropic = {
    .entry = {.name = "isotropic", .help = "the same in all directions", .size = 0},
    .pdf_sa = pdf_sa, .sample = sample, .mean_cosine = mean_cosine,
};
