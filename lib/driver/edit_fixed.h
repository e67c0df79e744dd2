// SPDX-License-Identifier: Apache-2.0
// What no edit of materials changes: the picture in which whatever can be edited is black.
#pragma once

#include "driver/edit_plan.h"
#include "driver/job.h"

// Renders it into three planes of the whole picture. false: it was stopped, or after an error message.
bool edit_fixed_render(struct job *job, const struct edit_plan *plan, float *planes);
