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
    const char *variance; // of a single-sample estimate of ref: do the z-test; NULL: no
    double samples;       // of test, per pixel, for the z-test; 0: from test's attribute "samples"
    double ref_samples;   // of ref
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
    struct ztest_result ztest;
};

// Reads both files (and layers `variance` in them: squared standard errors), takes the part of the
// larger one that a crop covers, and measures. false after an error message.
bool comparison_run(const struct comparison_request *request, struct comparison *result);
