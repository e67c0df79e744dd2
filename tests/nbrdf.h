// SPDX-License-Identifier: Apache-2.0
// The MERL materials as small networks (Sztrajman et al. 2021, Neural BRDF Representation and
// Importance Sampling), from the shared data: ground truth for tables made of them.
//
// Record: W1[6][21], b1[21], W2[21][21], b2[21], W3[21][3], b3[3] as float32; input
// (sin theta_h, 0, cos theta_h, d) with the difference vector d; f = max(0, exp(.) - 1).
#pragma once

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "table/merl.h"

struct nbrdf {
    float w1[6][21], b1[21], w2[21][21], b2[21], w3[21][3], b3[3];
};

// Network `index` of merl_nbrdf.f32; false: there is no shared data.
static inline bool nbrdf_load(int index, struct nbrdf *n) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    char path[4096];
    if (!shared)
        return false;
    snprintf(path, sizeof path, "%s/brdf/merl-nbrdf/merl_nbrdf.f32", shared);
    FILE *f = fopen(path, "rb");
    const bool good = f && fseek(f, (long)sizeof *n * index, SEEK_SET) == 0 &&
                      fread(n, sizeof *n, 1, f) == 1;
    if (f)
        fclose(f);
    return good;
}

// x W + b, rectified
static inline void nbrdf_layer(const float *x, int in, const float *w, const float *b, int out,
                               float *y) {
    for (int j = 0; j < out; j++) {
        float sum = b[j];
        for (int i = 0; i < in; i++)
            sum += x[i] * w[i * out + j];
        y[j] = sum;
    }
}

static inline void nbrdf_eval(const struct nbrdf *n, double theta_h, double theta_d, double phi_d,
                              float rgb[3]) {
    const float x[6] = {(float)sin(theta_h), 0, (float)cos(theta_h),
                        (float)(sin(theta_d) * cos(phi_d)), (float)(sin(theta_d) * sin(phi_d)),
                        (float)cos(theta_d)};
    float a[21], b[21];
    nbrdf_layer(x, 6, n->w1[0], n->b1, 21, a);
    for (int i = 0; i < 21; i++)
        a[i] = maxf(a[i], 0);
    nbrdf_layer(a, 21, n->w2[0], n->b2, 21, b);
    for (int i = 0; i < 21; i++)
        b[i] = maxf(b[i], 0);
    nbrdf_layer(b, 21, n->w3[0], n->b3, 3, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] = maxf(expf(rgb[c]) - 1, 0);
}

// The network at the nodes of a MERL table; owned by the caller (mem_free).
static inline float (*nbrdf_table(const struct nbrdf *n))[3] {
    float(*rgb)[3] = mem_array(MERL_CELLS, sizeof *rgb);
    for (int i = 0; i < MERL_THETA_H; i++)
        for (int j = 0; j < MERL_THETA_D; j++)
            for (int k = 0; k < MERL_PHI_D; k++) {
                const double u = i / 90.0;
                nbrdf_eval(n, u * u * M_PI / 2, j * M_PI / 180, k * M_PI / 180,
                           rgb[merl_index(i, j, k)]);
            }
    return rgb;
}
