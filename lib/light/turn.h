// SPDX-License-Identifier: Apache-2.0
// Angles of directions as shares of a full turn, without the library's atan2.
#pragma once

#include "math/vec.h"

// atan2(y, x) / (2 pi) in [0, 1), to 1e-7; 0 for the zero vector (polynomial of Cephes, Moshier
// 1992: a tangent up to 1 is brought below tan(pi/8)).
static inline float turn_of(float y, float x) {
    const float ax = fabsf(x), ay = fabsf(y);
    const float small = minf(ax, ay), big = maxf(ax, ay);
    const bool upper = small > 0.41421356f * big;
    const float t = upper ? (small - big) / (small + big) : big > 0 ? small / big : 0;
    const float z = t * t;
    const float p = ((8.05374449538e-2f * z - 1.38776856032e-1f) * z + 1.99777106478e-1f) * z -
                    3.33329491539e-1f;
    float turn = (p * z * t + t) * (1 / TWO_PI) + (upper ? 0.125f : 0);
    turn = ay > ax ? 0.25f - turn : turn;
    turn = x < 0 ? 0.5f - turn : turn;
    turn = y < 0 ? 1 - turn : turn;
    return turn < 1 ? turn : 0;
}
