// SPDX-License-Identifier: Apache-2.0
// Reconstruction filters by importance sampling: every sample belongs to one pixel.
//
// A filter is separable, f(x) f(y), with x in pixels from the pixel's centre. A sample is placed
// with density |f| / integral |f|, and carries weight sign(f) * integral |f| / integral f. Filters
// with negative lobes are stratified by sign: the sampled number u first chooses the sign.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/vec.h"

struct filter_type {
    struct entry entry;
    // *radius: support is [-radius, radius], > 0. false after an error message.
    bool (*prepare)(struct object *self, float *radius);
    float (*eval)(const void *data, float x); // any scale; 0 outside the support
};

#define X(name) extern const struct filter_type filter_##name;
#include "filter/list.h"
#undef X

extern const struct registry filters;

// A filter ready for sampling: tables made from eval by code that all filters share.
struct filter_sampler {
    float radius;
    struct filter_table *table; // NULL: box, which needs none
};

extern const struct filter_sampler filter_sampler_box; // a pixel itself

bool filter_sampler_init(struct filter_sampler *s, struct object *filter);
void filter_sampler_finish(struct filter_sampler *s);
// Offset from the pixel's centre and the weight of the sample (mean 1 over all u).
struct vec2 filter_sample(const struct filter_sampler *s, struct vec2 u, float *weight);
