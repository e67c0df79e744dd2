// SPDX-License-Identifier: Apache-2.0
// How far an edited picture of a tensor is from the truth: random blocks of pixels of the edited
// scene are path-traced twice, independently.
//
// For a picture p and two independent traces u and v of the truth, the mean of (p - u)(p - v) is the
// squared error of p without the traces' own noise (of the tensor's noise, bins, lights, bounces and
// albedos alike). It is divided by p^2 + 1e-3 mean(p)^2 as relMSE is. Each trace is made of two, so that
// the products of all pairs tell their noise, too. Blocks of 4x4 pixels are drawn spread over the
// picture, more often where the tensor tells of noise (math/balanced_sample.h): their differences and
// the traces' noise give the confidence interval, of the whole picture. Errors lie in few places, which
// few blocks would miss: 128 of them are drawn where fewer were asked for, with fewer samples.
#pragma once

#include "driver/job.h"
#include "replay/edit_tensor.h"

struct verify_options {
    struct job_options job; // scene, spp, seed, threads; spp 0: 256
    const char *tensor, *edits; // edits: a session whose changes are made first; or NULL
    uint32_t pixels;        // about so many with spp samples each; fewer than 2048: see above
    bool all_bounces;       // the truth has all of them, not as many as the tensor
    bool no_device;
};

struct verify_result {
    uint32_t pixels, blocks, bounces; // bounces 0: all
    double relmse, relmse_error;      // error: half the width of the 95 % interval
    double noise;                     // of relmse, what the tensor's half-sums tell of: all pixels
    double bias;                      // mean of (p - u) over the mean of p: all of it one way
    double mean;                      // of the picture
    double seconds;
};

// false after an error message: not the tensor's scene, for one.
bool verify_edit(const struct verify_options *o, struct verify_result *r);
