// SPDX-License-Identifier: Apache-2.0
// What can be edited in a tensor, for a person or a program to read.
#pragma once

#include "base/json.h"
#include "replay/edit_tensor.h"

// Adds "objects": per object its name, model and numbers; per term its name as edits call it, f_q,
// pixels, and for each curve its angle, basis and coefficients.
void edit_list(const struct edit_tensor *e, struct json *out);
// The same as lines on standard output.
void edit_list_print(const struct edit_tensor *e);
