// SPDX-License-Identifier: Apache-2.0
// Precomputing how a picture depends on its materials under direct light: a tensor for `relume edit`.
//
// What no edit changes (other surfaces, lights that are seen) is path-traced with direct light, in
// the same positions of a pixel, and stands in the tensor's fixed picture.
//
// The lights' index is what samples are elsewhere: 400 lights are refined to 4000 by the range
// 400:4000, a tensor of what changes, without what does not depend on them (other lights, the fixed
// picture). Ranges that follow each other merge to the tensor of all (transport/tensor_remake.h).
#pragma once

#include "driver/edit_plan.h"
#include "driver/job.h"
#include "integrator/light_loop.h"

struct edit_options {
    struct job_options job;        // scene, size, ...; spp: positions in a pixel, 0: 16
    const char *const *edit;       // materials to be turned into editable ones
    size_t edit_count;
    uint32_t lights;               // triangles of the sky
    uint32_t first;                // only what more than so many of them change; 0: all
    uint32_t light_samples;        // of other lights, and of everything fixed, at each position
    const char *packets;           // "auto", "pixels", "lights" (integrator/light_loop.h)
    double tolerance;              // of shares (curve/overlap.h)
    bool unshadowed;               // nothing hides the sky, for comparison
    bool as_points;                // triangles count as points, for comparison
    const char *output;
    enum tensor_storage storage;
    bool resume;                   // go on from OUTPUT.part, and leave it there when stopped
    double most_memory;            // bytes for workers; 0: half of what there is
    bool dry_run;
    const char *command, *version;
    void (*progress)(void *user, double done);
    void *user;
};

struct edit_report {
    uint32_t objects, blocks, lights, positions;
    uint64_t pixels, coefficients; // pixels that show objects; numbers in the file, all blocks
    uint64_t file_bytes, sums_bytes, rays;
    const char *packets;
    double shadow_seconds, sum_seconds; // of processor time
    double fixed_seconds, seconds;      // of the fixed picture; of all; dry run: expected
    bool stopped;
};

// false after an error message.
bool precompute_edit(const struct edit_options *o, struct edit_report *report);
