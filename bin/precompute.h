// SPDX-License-Identifier: Apache-2.0
// What the command line of `relume precompute` says, for each kind of tensor.
#pragma once

#include "base/options.h"
#include "driver/job.h"

struct precompute_values {
    struct receiver receiver;
    const char *kind, *scene, *output, *basis, *integrator, *sampler, *series, *tail, *later, *samples,
        *budget, *light;
    int spp, size[2], crop[4], max_depth, seed, threads, bounces;
    int lights, light_samples, packets;
    double memory, seconds, checkpoint, noise;
    bool resume, half, dry_run, lenient, quiet, json, direct, unshadowed;
    struct option_list defines, edit, group;
};

extern const char *const precompute_packets[]; // "auto", "pixels", "lights", NULL

// Whether it is to be made in ranges of samples or by and by, which edit with --bounces can.
static inline bool precompute_is_progressive(const struct precompute_values *v) {
    return v->samples || v->seconds > 0 || v->noise > 0 || v->checkpoint > 0 || v->resume;
}

// The scene as asked for.
struct job_options precompute_job(const struct precompute_values *v,
                                  const struct scene_define *defines);

// The exit code. The first hands over to the second unless --direct was asked for.
int precompute_edit_run(const struct precompute_values *v, const char *command,
                        const struct scene_define *defines);
int precompute_polynomial_run(const struct precompute_values *v, const char *command,
                              const struct scene_define *defines);
