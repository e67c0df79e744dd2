// SPDX-License-Identifier: Apache-2.0
// One generalised cosine lobe (Lafortune, Foo, Torrance and Greenberg 1997, Non-Linear
// Approximation of Reflectance Functions):
//
//     f = (C_x o_x i_x + C_y o_y i_y + C_z o_z i_z)^n
//
// Phong's lobe is C = (-1, -1, 1). With |C| <= 1 in every component, (n + 2) / (2 pi) f has an
// albedo of at most 1: the sum is |C wo| times a cosine, and Phong's albedo bounds the rest.
#pragma once

#include "math/phong.h"

// C wo, component by component: the axis of the lobe, not of unit length.
static inline struct direction lafortune_axis(struct direction c, struct direction wo) {
    return (struct direction){c.x * wo.x, c.y * wo.y, c.z * wo.z};
}

static inline double lafortune_brdf(struct direction c, double n, struct direction wo,
                                    struct direction wi) {
    return cosine_power(direction_dot(lafortune_axis(c, wo), wi), n);
}
