// SPDX-License-Identifier: Apache-2.0
// Precomputing how a picture depends on its lighting: a tensor for `relume relight`.
#pragma once

#include "driver/job.h"
#include "transport/tensor.h"

struct relight_options {
    struct job_options job;  // scene, samples, size, ...
    const char *basis;       // "lights", "sh:N", "pixels:WxH", "haar:WxH", "daub4:WxH"
    const char *output;
    enum tensor_storage storage;
    double most_memory;      // bytes the sums of tiles may take; 0: half of what there is
    bool dry_run;            // only say what it would take
    const char *command, *version;
    void (*progress)(void *user, double done);
    void *user;
};

struct relight_report {
    uint32_t coefficients;
    uint64_t file_bytes, sums_bytes; // of the tensor; of the sums of tiles that are worked on
    uint64_t samples, paths, rays, rejected;
    double seconds;        // spent tracing; dry run: expected
    bool stopped;
};

// false after an error message.
bool precompute_relight(const struct relight_options *o, struct relight_report *report);
