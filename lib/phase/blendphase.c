// SPDX-License-Identifier: Apache-2.0
// A mixture of two phase functions, whose shares may vary in space.
#include "phase/phase.h"

struct blendphase {
    struct volume_ref weight;
    const struct object *phases[2];
};

static const struct param params[] = {
    {"weight", PARAM_VOLUME, offsetof(struct blendphase, weight), .def = "0.5", .min = 0, .max = 1,
     .unit = "", .help = "share of the second phase function"},
    {"phase1", PARAM_PHASE, offsetof(struct blendphase, phases[0]), .help = "the first"},
    {"phase2", PARAM_PHASE, offsetof(struct blendphase, phases[1]), .help = "the second"},
    PARAM_END,
};

static float weight_at(const struct blendphase *b, vec3 p) {
    return clampf(volume_eval(&b->weight, p)[0], 0, 1);
}

static float pdf_sa(const void *data, vec3 p, struct deflection c) {
    const struct blendphase *b = data;
    const float w = weight_at(b, p);
    return lerpf(w, phase_type_of(b->phases[0])->pdf_sa(b->phases[0]->data, p, c),
                 phase_type_of(b->phases[1])->pdf_sa(b->phases[1]->data, p, c));
}

static struct deflection sample(const void *data, vec3 p, float u1, float u2) {
    const struct blendphase *b = data;
    const float w = weight_at(b, p);
    const bool second = u1 < w;
    const struct object *phase = b->phases[second];
    const float u = second ? u1 / w : (u1 - w) / (1 - w);
    return phase_type_of(phase)->sample(phase->data, p, minf(u, 0x1.fffffep-1f), u2);
}

static float mean_cosine(const void *data, vec3 p) {
    const struct blendphase *b = data;
    const float w = weight_at(b, p);
    return lerpf(w, phase_type_of(b->phases[0])->mean_cosine(b->phases[0]->data, p),
                 phase_type_of(b->phases[1])->mean_cosine(b->phases[1]->data, p));
}

const struct phase_type phase_blendphase = {
    .entry = {.name = "blendphase", .help = "mixture of two phase functions", .params = params,
              .size = sizeof(struct blendphase)},
    .pdf_sa = pdf_sa, .sample = sample, .mean_cosine = mean_cosine,
};
