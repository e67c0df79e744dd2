// SPDX-License-Identifier: Apache-2.0
#include "math/wide_microfacet.h"

static wide polynomial8(const float c[9], wide w) {
    const wide w2 = w * w, w4 = w2 * w2;
    return ((c[0] + c[1] * w) + (c[2] + c[3] * w) * w2) +
           ((c[4] + c[5] * w) + (c[6] + c[7] * w) * w2) * w4 + c[8] * (w4 * w4);
}

static wide erf_inverse_wide(wide x) {
    const wide w = -wide_log(wide_max((1 - x) * (1 + x), wide_of(1.2e-7f)));
    const wide_mask far = ~(w < 5);
    wide p = polynomial8(erf_inverse_middle, w - 2.5f);
    if (wide_any(far))
        p = wide_select(far, polynomial8(erf_inverse_tail, wide_sqrt(w) - 3), p);
    return p * x;
}

static wide clamp_wide(wide x, float lo, float hi) {
    return wide_min(wide_max(x, wide_of(lo)), wide_of(hi));
}

static struct wide3 sample_ggx(const struct wide_microfacet *m, struct wide3 v, const wide u[2]) {
    const struct wide3 s =
        wide_normalize((struct wide3){m->alpha_u * v.x, m->alpha_v * v.y, v.z});
    const wide hz = (1 - u[1]) * (1 + s.z), cz = hz - s.z;
    const wide r = wide_sqrt(wide_max((1 - cz) * (1 + cz), wide_of(0)));
    wide sine, cosine;
    wide_sincos_turn(u[0], &sine, &cosine);
    const wide hx = r * cosine + s.x, hy = r * sine + s.y;
    return wide_normalize(
        (struct wide3){m->alpha_u * hx, m->alpha_v * hy, wide_max(hz, wide_of(1e-20f))});
}

// Halley's steps of those lanes that still go on; the others keep what they have.
static wide find_slope(wide c, wide u, wide_mask going) {
    const float inv_sqrt_pi = 0.56418958f, half_sqrt_pi = 0.88622693f;
    const wide e_end = wide_exp(-c * c), end = 1 - wide_erfc_given_exp(c, e_end);
    const wide total = c * (1 + end) + inv_sqrt_pi * e_end;
    const wide grazing = end - (end + 1) * (1 - wide_erfc_given_exp(wide_sqrt(-wide_log(u)), u));
    const wide t = 1 / (1 + 0.3f * c * c);
    wide x = (1 - t) * ((1 + end) * u - 1) + t * grazing;
    wide lo = wide_of(-1), hi = end, found = wide_of(0);
    for (int i = 0; i < 12 && wide_any(going); i++) {
        x = wide_select((x > lo) & (x < hi), x, 0.5f * (lo + hi));
        const wide s = erf_inverse_wide(x);
        const wide e = wide_exp(-s * s), slope = half_sqrt_pi / e;
        const wide g = c * (1 + x) + inv_sqrt_pi * e - u * total, g1 = c - s;
        hi = wide_select(g > 0, x, hi);
        lo = wide_select(g > 0, lo, x);
        const wide dx = -2 * g * g1 / (2 * g1 * g1 + g * slope), ds = dx * slope;
        const wide_mask close = wide_abs(ds) * (1 + 0.5f * s * s) < 0.1f;
        const wide last = s + ds / (1 - ds * (s + ds * (1 + s * s) * (1.0f / 3)));
        found = wide_select(going, wide_select(close, last, s), found);
        going &= ~close;
        x += dx;
    }
    return found;
}

static wide sample_slope(wide c, wide u) {
    u = clamp_wide(u, 1e-7f, 1 - 1e-7f);
    const wide_mask upright = c > 1e4f;
    const wide s = find_slope(c, u, ~upright);
    const wide found = wide_select(s < c, s, c);
    return wide_any(upright) ? wide_select(upright, erf_inverse_wide(2 * u - 1), found) : found;
}

static struct wide3 sample_beckmann(const struct wide_microfacet *m, struct wide3 v,
                                    const wide u[2]) {
    const wide none = {0}, t = wide_sqrt(wide_microfacet_stretch2(m, v));
    const wide c = v.z / wide_max(t, wide_of(1e-30f));
    const wide along = sample_slope(c, u[0]);
    const wide across = erf_inverse_wide(2 * clamp_wide(u[1], 3e-8f, 1 - 6e-8f) - 1);
    const wide inv = wide_select(t > 0, 1 / t, none);
    const wide cos_phi = wide_select(t > 0, m->alpha_u * v.x * inv, wide_of(1));
    const wide sin_phi = m->alpha_v * v.y * inv;
    const wide x = cos_phi * along - sin_phi * across;
    const wide y = sin_phi * along + cos_phi * across;
    return wide_normalize((struct wide3){-m->alpha_u * x, -m->alpha_v * y, wide_of(1)});
}

struct wide3 wide_microfacet_sample(const struct wide_microfacet *m, struct wide3 v,
                                    const wide u[2]) {
    return m->type == MICROFACET_GGX ? sample_ggx(m, v, u) : sample_beckmann(m, v, u);
}
