// SPDX-License-Identifier: Apache-2.0
// One tensor of an editing session (replay/edit.h): its materials as they are edited, and the products
// that make its picture.
#pragma once

#include "replay/edit_change.h"

struct edit_settings {
    bool no_device;     // only the C twins
    int threads;        // 0: default
    size_t most_memory; // as struct replay_options has it
    bool focus;         // freeze what is not edited
    uint32_t terms;     // coefficients that a frame may change; 0: all. Needs focus
};

struct edit_cost {
    double switch_seconds;        // contracting when the focus last moved
    uint64_t coefficients, bytes; // read by the last frame
};

struct edit_part;

// The tensor must outlive it; path is for messages. NULL after an error message.
struct edit_part *edit_part_create(const struct tensor *t, const char *path,
                                   const struct edit_settings *o);
void edit_part_destroy(struct edit_part *e); // NULL is fine

struct edit_tensor *edit_part_objects(struct edit_part *e);
const char *edit_part_device(const struct edit_part *e);

// A change of materials. false after an error message.
bool edit_part_change(struct edit_part *e, enum edit_kind kind, const char *text, const char *at);

// Sums, waited for; and the picture of the sums, three planes. false after an error message.
bool edit_part_follow(struct edit_part *e);
bool edit_part_compose(struct edit_part *e, float *frame);
bool edit_part_is_exact(const struct edit_part *e);
void edit_part_forget(struct edit_part *e);
struct edit_cost edit_part_last_cost(const struct edit_part *e);
// Of the picture times a factor.
void edit_part_variance(struct edit_part *e, const float factor[CURVE_CHANNELS], float *variance);
