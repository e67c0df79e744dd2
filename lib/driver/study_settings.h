// SPDX-License-Identifier: Apache-2.0
// The settings that a study varies: integrator, sampler, spp, time, and any parameter that the table
// of an integrator or a sampler names.
#pragma once

#include "base/options.h"
#include "driver/job.h"

enum { STUDY_MOST_FACTORS = 12, STUDY_MOST_COMBINATIONS = 100000 };

struct study_factor {
    const char *name;    // with underscores
    const char **values; // as typed
    size_t count;
};

struct study_factors {
    struct study_factor items[STUDY_MOST_FACTORS];
    size_t count;
};

// From texts "NAME=VALUE,VALUE". false after an error message.
bool study_factors_parse(const struct option_list *texts, struct arena *arena,
                         struct study_factors *factors);

// One value a factor; NULL where the method has no such parameter.
struct study_combination {
    const char *values[STUDY_MOST_FACTORS];
};

// All combinations that differ, the last factor varying fastest. The scene, read without settings,
// tells what it uses where no factor does. NULL after an error message: a name that no method of the
// study has, or a value out of range.
struct study_combination *study_combine(const struct study_factors *factors, const struct scene *scene,
                                        struct arena *arena, size_t *count);

// Puts a combination into the options of a job. `setting` must live as long as the job is opened.
struct study_setting {
    const struct study_factors *factors;
    const struct study_combination *combination;
};
void study_apply(const struct study_setting *setting, struct job_options *job);
