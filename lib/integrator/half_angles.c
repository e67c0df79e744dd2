// SPDX-License-Identifier: Apache-2.0
#include "integrator/half_angles.h"

#include "curve/arc.h"

static const double LEAST = 1e-6; // as curve/angles.c has it

static wide_double length_of(wide_double x, wide_double y, wide_double z) {
    return wide_double_sqrt(x * x + y * y + z * z);
}

struct half_angles half_angles_between(struct half_directions wo, struct half_directions wi) {
    struct half_angles a;
    const wide_double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z, r2 = x * x + y * y;
    a.wo = wo;
    a.wi = wi;
    a.length = wide_double_sqrt(r2 + z * z);
    const wide_double l = wide_double_max(a.length, wide_double_of(LEAST));
    a.cos_d = l / 2;
    a.sin_d = length_of(wi.x - wo.x, wi.y - wo.y, wi.z - wo.z) / 2;
    a.cos_h = z / l;
    a.sin_h = wide_double_sqrt(r2) / l;
    a.known = 0;
    return a;
}

// arc_quarter, with its bits.
static wide_double half_arc_quarter(wide_double y, wide_double x) {
    const double quarter = 0.78539816339744830962, more = 6.123233995736765886130e-17;
    const wide_double low = wide_double_min(y, x), high = wide_double_select(y < x, x, y);
    const wide_long far = low > 0.66 * high, there = high > 0;
    const wide_double top = wide_double_select(far, low - high, low);
    const wide_double bottom = wide_double_select(far, low + high, high), none = {0};
    const wide_double t =
        wide_double_select(there, top / wide_double_select(there, bottom, none + 1), none);
    const wide_double z = t * t;
    const wide_double a = ARC_TANGENT(t, z);
    const wide_double angle = wide_double_select(far, quarter + (a + 0.5 * more), a);
    return wide_double_select(y <= x, angle, 2 * quarter - (angle - more));
}

static wide_double upper(wide_double sine, wide_double cosine) {
    return half_arc_quarter(sine, wide_double_max(cosine, wide_double_of(0)));
}

static wide_double compute(enum gamma_kind kind, const struct half_angles *a) {
    const struct half_directions i = a->wi, o = a->wo;
    wide_double v = {0};
    switch (kind) {
    case GAMMA_THETA_H: v = upper(a->sin_h, a->cos_h); break;
    case GAMMA_THETA_D: v = half_arc_quarter(a->sin_d, a->cos_d); break;
    case GAMMA_THETA_I: v = upper(wide_double_sqrt(i.x * i.x + i.y * i.y), i.z); break;
    case GAMMA_THETA_R:
        return 2 * half_arc_quarter(length_of(i.x + o.x, i.y + o.y, i.z - o.z),
                                length_of(i.x - o.x, i.y - o.y, i.z + o.z));
    default: break;
    }
    return wide_double_min(v, wide_double_of(CURVE_END));
}

bool half_gamma_fits(enum gamma_kind kind) {
    return kind == GAMMA_THETA_H || kind == GAMMA_THETA_D || kind == GAMMA_THETA_I ||
           kind == GAMMA_THETA_R;
}

wide_double half_gamma_at(enum gamma_kind kind, struct half_angles *a) {
    if (!(a->known >> kind & 1))
        a->gamma[kind] = compute(kind, a);
    a->known |= 1u << kind;
    return a->gamma[kind];
}
