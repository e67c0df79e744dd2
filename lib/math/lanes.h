// SPDX-License-Identifier: Apache-2.0
// Four numbers at once, for data structures that look at four children together. Comparisons give
// masks (ivec4, all bits of a lane) for lanes_select.
#pragma once

#include "math/vec.h"

typedef float float4 __attribute__((vector_size(16)));

static inline float4 lanes_all(float x) {
    return (float4){x, x, x, x};
}

static inline float4 lanes_select(ivec4 mask, float4 yes, float4 no) {
    return (float4)((mask & (ivec4)yes) | (~mask & (ivec4)no));
}

static inline float4 lanes_min(float4 a, float4 b) {
    return lanes_select(a < b, a, b);
}

static inline float4 lanes_max(float4 a, float4 b) {
    return lanes_select(a > b, a, b);
}

// 0 for negative numbers
static inline float4 lanes_sqrt(float4 x) {
    const float4 y = lanes_max(x, lanes_all(0));
    return (float4){sqrtf(y[0]), sqrtf(y[1]), sqrtf(y[2]), sqrtf(y[3])};
}
