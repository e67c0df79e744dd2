// SPDX-License-Identifier: Apache-2.0
// Vectors and colours as values with operators: p = o + t * d reads like the page.
//
// Conventions: right-handed, y up as in Mitsuba; metres. vec3 and spectrum are four float lanes
// (the vector extension of gcc and clang, which only math/ relies on by name). A vec3 keeps lane 3
// at zero. A spectrum holds linear Rec.709 in lanes 0-2 with lane 3 at zero; code outside math/,
// image/ and the film never assumes that a lane is a channel: it uses the functions below.
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef float vec3 __attribute__((vector_size(16)));
typedef float spectrum __attribute__((vector_size(16)));
typedef int32_t ivec4 __attribute__((vector_size(16)));

struct vec2 {
    float x, y;
};

#define PI     3.14159265358979323846f
#define INV_PI 0.31830988618379067154f
#define TWO_PI 6.28318530717958647693f

// One instruction each, where fminf and fmaxf are calls because of NaN. A NaN in a gives b.
static inline float minf(float a, float b) {
    return a < b ? a : b;
}

static inline float maxf(float a, float b) {
    return a > b ? a : b;
}

static inline vec3 v3(float x, float y, float z) {
    return (vec3){x, y, z, 0};
}

static inline vec3 v3_load(const float p[3]) {
    return (vec3){p[0], p[1], p[2], 0};
}

// The same where a fourth float may be read (and is dropped).
static inline vec3 v3_load_padded(const float *p) {
    typedef float unaligned __attribute__((vector_size(16), aligned(4), may_alias));
    vec3 v = *(const unaligned *)p;
    v[3] = 0;
    return v;
}

static inline float dot(vec3 a, vec3 b) {
    const vec3 c = a * b;
    return c[0] + c[1] + c[2];
}

static inline vec3 cross(vec3 a, vec3 b) {
    return (vec3){a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0],
                  0};
}

static inline float length2(vec3 a) {
    return dot(a, a);
}

static inline float length(vec3 a) {
    return sqrtf(dot(a, a));
}

// Zero stays zero; any other finite length is safe. Extreme ones are first scaled by a power of two,
// so that scenes that differ by such a factor give the same bits.
static inline vec3 normalize(vec3 a) {
    float l2 = dot(a, a);
    if (__builtin_expect(!(l2 > 1e-30f && l2 < 1e30f), 0)) {
        const float m = maxf(fabsf(a[0]), maxf(fabsf(a[1]), fabsf(a[2])));
        if (!(m > 0) || !(m < INFINITY))
            return (vec3){0};
        const int e = ilogbf(m);
        a = v3(ldexpf(a[0], -e), ldexpf(a[1], -e), ldexpf(a[2], -e));
        l2 = dot(a, a);
    }
    return a * (1 / sqrtf(l2));
}

static inline vec3 reflect(vec3 w, vec3 n) {
    return 2 * dot(w, n) * n - w;
}

static inline float sqr(float x) {
    return x * x;
}

static inline float clampf(float x, float lo, float hi) {
    return minf(maxf(x, lo), hi);
}

static inline float lerpf(float t, float a, float b) {
    return (1 - t) * a + t * b;
}

// sqrt that takes rounding below zero for zero
static inline float safe_sqrt(float x) {
    return sqrtf(maxf(x, 0));
}

// ---- spectrum -------------------------------------------------------------------------------

enum { SPECTRUM_LANES = 3 }; // lanes that carry data in RGB mode

static inline spectrum spectrum_grey(float v) {
    return (spectrum){v, v, v, 0};
}

static inline spectrum spectrum_rgb(float r, float g, float b) {
    return (spectrum){r, g, b, 0};
}

static inline float spectrum_max(spectrum s) {
    return maxf(s[0], maxf(s[1], s[2]));
}

static inline float spectrum_min(spectrum s) {
    return minf(s[0], minf(s[1], s[2]));
}

static inline float spectrum_mean(spectrum s) {
    return (s[0] + s[1] + s[2]) * (1.0f / 3);
}

// CIE Y of linear Rec.709
static inline float spectrum_luminance(spectrum s) {
    return 0.212671f * s[0] + 0.715160f * s[1] + 0.072169f * s[2];
}

static inline bool spectrum_is_black(spectrum s) {
    return s[0] == 0 && s[1] == 0 && s[2] == 0;
}

static inline bool spectrum_is_finite(spectrum s) {
    return isfinite(s[0]) && isfinite(s[1]) && isfinite(s[2]);
}

static inline spectrum spectrum_clamp(spectrum s, float lo, float hi) {
    return (spectrum){clampf(s[0], lo, hi), clampf(s[1], lo, hi), clampf(s[2], lo, hi), 0};
}

// f applied to each lane that carries data
static inline spectrum spectrum_map(float (*f)(float), spectrum s) {
    return (spectrum){f(s[0]), f(s[1]), f(s[2]), 0};
}

// a / b, lane 3 kept zero
static inline spectrum spectrum_divide(spectrum a, spectrum b) {
    return (spectrum){a[0] / b[0], a[1] / b[1], a[2] / b[2], 0};
}

// The wavelengths a path carries. Empty in RGB mode; it travels with every evaluation so that a
// hero-wavelength mode can fill it later.
struct wavelengths {
    int count; // 0: RGB
};
