// SPDX-License-Identifier: Apache-2.0
// What a scene holds and what rendering it requires, for `relume info`.
#pragma once

#include "base/json.h"
#include "driver/job.h"

// Adds it to a JSON object; the job is open.
void scene_info_add(const struct job *job, struct json *out);
