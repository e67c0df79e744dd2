// SPDX-License-Identifier: Apache-2.0
// Henyey and Greenstein 1941, Diffuse radiation in the galaxy:
// p(cos) = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)).
//
// For g < 0 the same with |g| and the other direction. With f = 1 - cos the denominator is
// (1 - g)^2 + 2 g f, and the inversion of the distribution is
// f = (1 - g)^2 (1 - u) (1 + g + D) / D^2, D = (1 - g) (1 - u) + (1 + g) u:
// sums of positive terms, which lose no digits for any g in [0, 1).
#include "phase/hg.h"

#include "phase/phase.h"

static const struct param params[] = {
    {"g", PARAM_FLOAT, offsetof(struct hg, g), .def = "0.8", .min = -0.999999, .max = 0.999999,
     .unit = "", .help = "mean cosine of the deflection: positive scatters forward"},
    PARAM_END,
};

static float pdf_sa(const void *data, vec3 p, struct deflection c) {
    const float g = ((const struct hg *)data)->g, a = fabsf(g);
    (void)p;
    const float q = sqr(1 - a) + 2 * a * (g < 0 ? c.backward : c.forward);
    return 0.25f * INV_PI * (1 - a) * (1 + a) / (q * sqrtf(q));
}

static struct deflection sample(const void *data, vec3 p, float u1, float u2) {
    const float g = ((const struct hg *)data)->g, a = fabsf(g);
    (void)p;
    (void)u1;
    const float D = (1 - a) * (1 - u2) + (1 + a) * u2;
    const float f = minf(sqr((1 - a) / D) * (1 - u2) * (1 + a + D), 2);
    return g < 0 ? (struct deflection){2 - f, f} : (struct deflection){f, 2 - f};
}

static float mean_cosine(const void *data, vec3 p) {
    (void)p;
    return ((const struct hg *)data)->g;
}

const struct phase_type phase_hg = {
    .entry = {.name = "hg", .help = "Henyey and Greenstein 1941: a forward or backward peak",
              .params = params, .size = sizeof(struct hg)},
    .pdf_sa = pdf_sa, .sample = sample, .mean_cosine = mean_cosine,
};
