// SPDX-License-Identifier: Apache-2.0
// The pilot of adaptive sampling: a few samples that only tell where the picture is noisy.
#pragma once

#include "driver/job.h"
#include "sink/sample_map.h"

// Renders the pilot of a job and makes the map that gives the picture the least noise (as
// film_noise has it) for its mean number of samples; memory from the arena. The same on every
// machine. false after an error message: the sampler's points cannot be gone on with, or stopped.
bool pilot_run(const struct job *job, struct arena *arena, struct sample_map *map);
