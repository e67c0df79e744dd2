// SPDX-License-Identifier: Apache-2.0
// microfacet.h and microfacet.c for the lanes of one distribution, operation by operation.
// Derivations stand there.
#pragma once

#include <stddef.h>

#include "math/microfacet.h"
#include "math/wide_maps.h"

struct wide_microfacet {
    enum microfacet_type type;
    wide alpha_u, alpha_v, inv_u, inv_v, norm;
};

// Of struct microfacet, lane by lane.
static inline struct wide_microfacet wide_microfacet_gather(
    enum microfacet_type type, const struct microfacet *const m[WIDE_LANES]) {
    const float *row[WIDE_LANES];
    wide f[4];
    _Static_assert(offsetof(struct microfacet, inv_v) ==
                       offsetof(struct microfacet, alpha_u) + 3 * sizeof(float),
                   "what is gathered together lies together");
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = &m[i]->alpha_u;
    wide_gather4(row, f);
    return (struct wide_microfacet){type, f[0], f[1], f[2], f[3], INV_PI * f[2] * f[3]};
}

static inline wide wide_microfacet_D(const struct wide_microfacet *m, struct wide3 h) {
    const wide z2 = h.z * h.z, x = h.x * m->inv_u, y = h.y * m->inv_v;
    const wide r2 = x * x + y * y;
    wide d;
    if (m->type == MICROFACET_GGX)
        d = m->norm / ((r2 + z2) * (r2 + z2));
    else
        d = m->norm * wide_exp(-r2 / z2) / (z2 * z2);
    return (wide)((wide_int)d & (h.z > 1e-6f));
}

static inline wide wide_microfacet_stretch2(const struct wide_microfacet *m, struct wide3 v) {
    const wide x = m->alpha_u * v.x, y = m->alpha_v * v.y;
    return x * x + y * y;
}

static inline wide wide_erfc_given_exp(wide a, wide e) {
    const wide t = 1 / (1 + 0.3275911f * a);
    return t * (0.254829592f +
                t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f)))) *
           e;
}

static inline wide wide_microfacet_area(const struct wide_microfacet *m, struct wide3 v) {
    const wide least = wide_of(1e-20f);
    const wide z = wide_max(v.z, wide_of(0)), t2 = wide_microfacet_stretch2(m, v);
    if (m->type == MICROFACET_GGX)
        return wide_max(0.5f * (z + wide_sqrt(z * z + t2)), least);
    const wide t = wide_sqrt(t2), a = z / t, e = wide_exp(-a * a);
    const wide shadowed = z + 0.5f * (t * 0.56418958f * e - z * wide_erfc_given_exp(a, e));
    return wide_select(z * z >= 16 * t2, wide_max(z, least), shadowed);
}

static inline wide wide_microfacet_G1(const struct wide_microfacet *m, struct wide3 v) {
    return wide_min(wide_max(v.z, wide_of(0)) / wide_microfacet_area(m, v), wide_of(1));
}

// Normals with the density of visible ones.
struct wide3 wide_microfacet_sample(const struct wide_microfacet *m, struct wide3 v,
                                    const wide u[2]);
