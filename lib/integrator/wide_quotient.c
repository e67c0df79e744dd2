// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_quotient.h"

#include <math.h>

void wide_quotient_init(struct wide_quotient *w, const struct quotient *q, struct arena *arena) {
    *w = (struct wide_quotient){q, q->kind != QUOTIENT_FACETS &&
                                       (q->kind != QUOTIENT_ASHIKHMIN || !(q->n > 0)), NULL};
    if (!q->has_fresnel || !w->fits)
        return;
    w->fresnel = arena_alloc(arena, CURVE_CHANNELS * sizeof *w->fresnel);
    for (int c = 0; c < CURVE_CHANNELS; c++)
        for (int i = 0; i < FRESNEL_STEPS + 2; i++) {
            const double cosine = i < FRESNEL_STEPS ? (double)i / FRESNEL_STEPS : 1;
            w->fresnel[c][i] = (float)function_value(&q->fresnel[c], acos(cosine));
        }
}

static wide at_least(wide cosine) {
    return wide_max(cosine, wide_of((float)QUOTIENT_LEAST));
}

static wide mask_of(float r, wide v) {
    return at_least(r * (1 - v) + v);
}

static wide schlick(const struct quotient *q, wide i, float o, wide hx, wide hy) {
    const float r = (float)q->roughness, p = (float)q->isotropy;
    const wide x2 = hx * hx, y2 = hy * hy, r2 = x2 + y2, one = wide_of(1);
    const wide cos2 = wide_select(r2 > 0, x2 / wide_select(r2 > 0, r2, one), one);
    return wide_sqrt(p / (p * p * (1 - cos2) + cos2)) / (mask_of(r, i) * mask_of(r, wide_of(o)));
}

static wide schlick_rest(const struct quotient *q, wide i, float o) {
    const float r = (float)q->roughness, d_o = r * (1 - o);
    const wide di = r * (1 - i);
    return (di * o + d_o * i + di * d_o) /
           wide_max((i + di) * (o + d_o), wide_of((float)(QUOTIENT_LEAST * QUOTIENT_LEAST)));
}

static wide value(const struct quotient *q, struct direction wo, const struct wide3 *wi, wide cos_d,
                  wide hx, wide hy, wide hz) {
    const float o = (float)wo.z;
    const wide i = wi->z, lo = wide_of(o), li = at_least(i), one = wide_of(1);
    const wide ro = at_least(lo);
    switch (q->kind) {
    case QUOTIENT_V_CAVITY: {
        const wide s = hz / (cos_d * cos_d); // 2 cos_h / cos_d
        return wide_min(1 / (li * ro), wide_min(s / li, s / ro));
    }
    case QUOTIENT_ASHIKHMIN: return 1 / (cos_d * wide_max(li, ro));
    case QUOTIENT_WARD: return 1 / wide_sqrt(li * ro);
    case QUOTIENT_WARD_DUER: return 1 / (li * ro);
    case QUOTIENT_WARD_BOUNDED: {
        const wide s = at_least(i + lo), t = 4 * cos_d / (s * s);
        return t * t;
    }
    case QUOTIENT_SCHLICK: return schlick(q, i, o, hx, hy);
    case QUOTIENT_SCHLICK_REST: return schlick_rest(q, i, o);
    case QUOTIENT_OREN_NAYAR:
        return wide_max(wi->x * (float)wo.x + wi->y * (float)wo.y, wide_of(0)) / wide_max(li, ro);
    case QUOTIENT_ONE:
    case QUOTIENT_FACETS:
    case QUOTIENT_COUNT: break;
    }
    return one;
}

void wide_quotient_cos(const struct wide_quotient *w, struct direction wo, const struct wide3 *wi,
                       wide out[CURVE_CHANNELS]) {
    const wide hx = wi->x + (float)wo.x, hy = wi->y + (float)wo.y, hz = wi->z + (float)wo.z;
    const wide l = wide_sqrt(hx * hx + hy * hy + hz * hz);
    const wide cos_d = wide_max(0.5f * l, wide_of(5e-7f)); // as curve/angles.c has it
    const wide_mask above = wi->z > 0;
    const wide v = wide_select(above, value(w->quotient, wo, wi, cos_d, hx, hy, hz) * wi->z, wide_of(0));
    for (int c = 0; c < CURVE_CHANNELS; c++)
        out[c] = v;
    if (!w->fresnel)
        return;
    const wide place = wide_min(cos_d, wide_of(1)) * FRESNEL_STEPS;
    for (int i = 0; i < WIDE_LANES; i++) {
        const int k = (int)place[i];
        const float t = place[i] - (float)k;
        for (int c = 0; c < CURVE_CHANNELS; c++)
            out[c][i] *= w->fresnel[c][k] + t * (w->fresnel[c][k + 1] - w->fresnel[c][k]);
    }
}
