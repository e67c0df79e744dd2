// SPDX-License-Identifier: Apache-2.0
// Colour spaces of FLIP (2020 paper, section 4.1 and its supplement), with flip-evaluator's
// matrices: linear Rec.709, YCxCz (linear opponent space) and Hunt-adjusted CIELAB, all under D65.
#pragma once

#include <math.h>

static const float flip_white[3] = {0.950428545f, 1.0f, 1.088900371f};

static inline void flip_rgb_to_relative_xyz(const float rgb[3], float xyz[3]) {
    const float x = (10135552.f * rgb[0] + 8788810.f * rgb[1] + 4435075.f * rgb[2]) / 24577794.f;
    const float y = (2613072.f * rgb[0] + 8788810.f * rgb[1] + 887015.f * rgb[2]) / 12288897.f;
    const float z = (1425312.f * rgb[0] + 8788810.f * rgb[1] + 70074185.f * rgb[2]) / 73733382.f;
    xyz[0] = x / flip_white[0];
    xyz[1] = y / flip_white[1];
    xyz[2] = z / flip_white[2];
}

static inline void flip_rgb_to_ycxcz(const float rgb[3], float out[3]) {
    float r[3];
    flip_rgb_to_relative_xyz(rgb, r);
    out[0] = 116 * r[1] - 16;
    out[1] = 500 * (r[0] - r[1]);
    out[2] = 200 * (r[1] - r[2]);
}

static inline void flip_ycxcz_to_rgb(const float in[3], float rgb[3]) {
    const float ry = (in[0] + 16) / 116;
    const float x = (in[1] / 500 + ry) * flip_white[0], y = ry * flip_white[1];
    const float z = (ry - in[2] / 200) * flip_white[2];
    rgb[0] = 3.241003275f * x - 1.537398934f * y - 0.498615861f * z;
    rgb[1] = -0.969224334f * x + 1.875930071f * y + 0.041554224f * z;
    rgb[2] = 0.055639423f * x - 0.204011202f * y + 1.057148933f * z;
}

static inline float flip_lab_function(float t) {
    const float delta = 6.f / 29;
    return t > delta * delta * delta ? cbrtf(t) : t / (3 * delta * delta) + 4.f / 29;
}

// CIELAB with chroma scaled by the lightness (Hunt effect, equation 9 of the 2020 paper).
static inline void flip_rgb_to_hunt_lab(const float rgb[3], float lab[3]) {
    float r[3];
    flip_rgb_to_relative_xyz(rgb, r);
    const float fx = flip_lab_function(r[0]), fy = flip_lab_function(r[1]);
    const float fz = flip_lab_function(r[2]);
    lab[0] = 116 * fy - 16;
    lab[1] = 0.01f * lab[0] * 500 * (fx - fy);
    lab[2] = 0.01f * lab[0] * 200 * (fy - fz);
}

// HyAB distance: city block in lightness, Euclidean in chroma (equation 8).
static inline float flip_hyab(const float a[3], const float b[3]) {
    const float da = a[1] - b[1], db = a[2] - b[2];
    return fabsf(a[0] - b[0]) + sqrtf(da * da + db * db);
}
