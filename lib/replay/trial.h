// SPDX-License-Identifier: Apache-2.0
// Trials: the objects of an edit tensor as they are and in edits far from that, for which the error
// of an approximation is measured.
//
// The edits give all objects an albedo of a half at once, by curves that are constant, a broad lobe
// and the sharpest one that their bins carry (basis_exponent).
#pragma once

#include "replay/edit_tensor.h"

enum { TRIALS = 4 };

extern const char *const trial_names[TRIALS];

// Changes the objects, from how they are to how a trial has them; trial_restore undoes it.
struct trial_memory {
    struct arena arena;
    double *values;
};
void trial_apply(struct edit_tensor *e, int trial, struct trial_memory *m);
void trial_restore(struct edit_tensor *e, struct trial_memory *m);

// weights[block][coefficient][channel] of the objects as they are, f_q included; memory of the arena.
float **trial_weights(const struct edit_tensor *e, struct arena *arena);
