// SPDX-License-Identifier: Apache-2.0
#include "phase/phase.h"

#include "math/elementary.h"
#include "phase/hg.h"

static const struct entry *const entries[] = {
#define X(name) &phase_##name.entry,
#include "phase/list.h"
#undef X
    NULL,
};

const struct registry phases = {"phase", entries};

float phase_pdf_sa(const struct object *phase, vec3 p, vec3 wo, vec3 wi) {
    const struct deflection c = {0.5f * length2(wi + wo), 0.5f * length2(wi - wo)};
    return phase_type_of(phase)->pdf_sa(phase->data, p, c);
}

vec3 phase_sample(const struct object *phase, vec3 p, vec3 wo, float u1, struct vec2 u2,
                  float *pdf_sa) {
    const struct phase_type *type = phase_type_of(phase);
    const struct deflection c = type->sample(phase->data, p, u1, u2.x);
    const struct frame frame = frame_from_normal(-wo);
    const float r = safe_sqrt(c.forward * c.backward);
    float sine, cosine;
    sincos_turn(u2.y, &sine, &cosine);
    *pdf_sa = type->pdf_sa(phase->data, p, c);
    const float along = c.forward < c.backward ? 1 - c.forward : c.backward - 1;
    return normalize(to_world(&frame, v3(r * cosine, r * sine, along)));
}

const struct object *phase_default(float mean_cosine, struct arena *arena) {
    struct object *o = arena_alloc(arena, sizeof *o);
    if (mean_cosine == 0) {
        o->type = &phase_isotropic.entry;
        return o;
    }
    struct hg *hg = arena_alloc(arena, sizeof *hg);
    hg->g = mean_cosine;
    o->type = &phase_hg.entry;
    o->data = hg;
    return o;
}
