// SPDX-License-Identifier: Apache-2.0
// What a tensor's metadata tells of the scene it was made of: "scene", where it was; "scene hash", of
// its files; "defines", an object of the values of its parameters (-D); "light", the only one that shines.
#pragma once

#include "base/json.h"
#include "driver/job.h"

void origin_add(struct json *meta, const struct job *job, const struct job_options *o);

// Whether the scene that was opened is the one that `tensor` with this metadata was made of. false
// after an error message.
bool origin_agrees(const struct json *meta, const char *tensor, const struct job *job,
                   const struct job_options *o);
