// SPDX-License-Identifier: Apache-2.0
// Maps from the unit square to the domains that are sampled, each with its density.
#pragma once

#include "math/elementary.h"
#include "math/vec.h"

// Concentric map of Shirley and Chiu 1997. pdf = 1/pi per unit area.
static inline struct vec2 warp_disk(struct vec2 u) {
    const float x = 2 * u.x - 1, y = 2 * u.y - 1;
    if (x == 0 && y == 0)
        return (struct vec2){0, 0};
    float sine, cosine;
    if (fabsf(x) > fabsf(y)) {
        sincos_octant((PI / 4) * (y / x), &sine, &cosine);
        return (struct vec2){x * cosine, x * sine};
    }
    sincos_octant((PI / 4) * (x / y), &sine, &cosine); // of pi/2 - phi
    return (struct vec2){y * sine, y * cosine};
}

// pdf_sa = cos/pi, z up
static inline vec3 warp_cosine_hemisphere(struct vec2 u) {
    const struct vec2 d = warp_disk(u);
    return v3(d.x, d.y, safe_sqrt(1 - d.x * d.x - d.y * d.y));
}

// pdf_sa = 1/(4 pi)
static inline vec3 warp_sphere(struct vec2 u) {
    const float z = 1 - 2 * u.x;
    const float r = safe_sqrt(1 - z * z);
    float sine, cosine;
    sincos_turn(u.y, &sine, &cosine);
    return v3(r * cosine, r * sine, z);
}

// Barycentric coordinates, uniform over a triangle (Heitz 2019, A low-distortion map).
static inline struct vec2 warp_triangle(struct vec2 u) {
    if (u.y > u.x) {
        u.x *= 0.5f;
        u.y -= u.x;
    } else {
        u.y *= 0.5f;
        u.x -= u.y;
    }
    return u;
}
