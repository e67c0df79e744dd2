// SPDX-License-Identifier: Apache-2.0
// What relume render says when the picture is written.
#pragma once

#include "driver/job.h"

struct render_outcome {
    const char *output;
    struct render_result render;
    uint64_t rejected, overflows, half_overflows; // values beyond the range of float, of half
    bool one_sample;       // a layer `variance` of one sample
    double clamp, clamped; // limit; share of light it removed, negative: there is none
    double keeping;        // seconds of the render that went to its journal and previews
};

// What makes the picture worse than asked for.
void render_report_warnings(const struct render_outcome *o);
void render_report(const struct render_outcome *o);
void render_report_json(const struct job *job, const struct render_outcome *o);
