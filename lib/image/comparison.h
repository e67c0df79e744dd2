// SPDX-License-Identifier: Apache-2.0
// Everything `relume compare` says about two picture files.
#pragma once

#include "image/flip.h"
#include "image/metrics.h"
#include "image/ztest.h"

enum comparison_map {
    COMPARISON_MAP_FLIP,   // HDR-FLIP in the magma map
    COMPARISON_MAP_SIGNED, // (test - ref) / (ref + 0.01 mean): red above, blue below, white at +-1
};

extern const char *const comparison_map_names[]; // NULL-terminated

struct comparison_request {
    const char *ref, *test;
    // Of a single-sample estimate of ref, or a picture with a layer `variance`: do the z-test; NULL: no.
    // With the latter the layers of ref and test, where both have one, are what counts.
    const char *variance;
    // Per pixel, of test and of ref, for the z-test; 0: what the files' attributes "relume.samples" or
    // "samples" say (times the pixels of a box of `downsample`), and 32000 where ref has none.
    double samples, ref_samples;
    double eps, exposure; // as in struct metrics_input
    double pixels_per_degree;
    int downsample;       // box; a picture that is this much larger than the other, or both
    int threads;
    const char *map_path; // PNG to write, or NULL
    enum comparison_map map;
};

struct comparison {
    int width, height;
    struct metrics metrics;
    struct estimate flip_hdr, flip_ldr;
    struct flip_exposures exposures;
    bool tested;
    double samples, ref_samples; // that the z-test took
    struct ztest_result ztest;
};

// Reads both files (and layers `variance` in them: squared standard errors, which one sample cannot
// tell: no interval is then known), takes the part of the
// larger one that a crop covers, and measures. false after an error message.
bool comparison_run(const struct comparison_request *request, struct comparison *result);
