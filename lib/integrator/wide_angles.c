// SPDX-License-Identifier: Apache-2.0
#include "integrator/wide_angles.h"

#include "math/wide_arc.h"

static wide length_of(wide x, wide y, wide z) {
    return wide_sqrt(x * x + y * y + z * z);
}

// Arc cosine of cos(theta_h)^e with e the share of `along` in the square of h's tangent part, times
// n: tan^2 = cos(theta_h)^(-2 e) - 1 = expm1(e log1p(tan^2 theta_h)).
static wide power(wide along, wide across, wide z) {
    const wide a2 = along * along, r2 = a2 + across * across, none = {0};
    const wide_mask there = (z > 0) & (r2 > 0);
    const wide t2 = wide_select(there, r2 / (z * z), none), e = wide_select(there, a2 / r2, none);
    const wide tangent = wide_sqrt(wide_max(wide_expm1(e * wide_log1p(t2)), none));
    const wide gamma = wide_select(z > 0, wide_atan2(tangent, wide_of(1)), wide_of(PI / 2));
    return wide_negate(along < 0, gamma);
}

// atan(sqrt(2 n (-log cos theta_h) sin^2 phi_h))
static wide ratio(wide x, wide y, wide z, float n) {
    const wide y2 = y * y, r2 = x * x + y2, none = {0};
    const wide_mask there = (z > 0) & (r2 > 0);
    const wide t2 = wide_select(there, r2 / (z * z), none), e = wide_select(there, y2 / r2, none);
    const wide tangent = wide_sqrt(wide_max(wide_log1p(t2) * e * n, none));
    const wide gamma = wide_select(z > 0, wide_atan2(tangent, wide_of(1)), wide_of(PI / 2));
    return wide_negate(y < 0, gamma);
}

wide wide_gamma(const struct gamma *g, struct direction wo, const struct wide3 *wi) {
    const float ox = (float)wo.x, oy = (float)wo.y, oz = (float)wo.z;
    const wide hx = wi->x + ox, hy = wi->y + oy, hz = wi->z + oz, none = {0};
    switch (g->kind) {
    case GAMMA_THETA_H: return wide_atan2(wide_sqrt(hx * hx + hy * hy), hz);
    case GAMMA_THETA_D:
        return wide_atan2(length_of(wi->x - ox, wi->y - oy, wi->z - oz), length_of(hx, hy, hz));
    case GAMMA_THETA_I: return wide_atan2(wide_sqrt(wi->x * wi->x + wi->y * wi->y), wi->z);
    case GAMMA_THETA_O: return wide_of((float)atan2(sqrt(wo.x * wo.x + wo.y * wo.y), wo.z));
    case GAMMA_THETA_R:
        return 2 * wide_atan2(length_of(hx, hy, wi->z - oz),
                              length_of(wi->x - ox, wi->y - oy, wi->z + oz));
    case GAMMA_PHI_H: return wide_atan2(wide_abs(hy), wide_abs(hx));
    case GAMMA_POWER_U: return power(hx, hy, hz);
    case GAMMA_POWER_V: return power(hy, hx, hz);
    case GAMMA_RATIO: return ratio(hx, hy, hz, (float)g->n);
    case GAMMA_SLOPE_U: return wide_atan2(hx, hz);
    case GAMMA_SLOPE_V: return wide_atan2(hy, hz);
    case GAMMA_NONE:
    case GAMMA_COUNT: break;
    }
    return none;
}
