// SPDX-License-Identifier: Apache-2.0
// What a study leaves behind: tables for programs, and a page for people.
#pragma once

#include <stdio.h>

#include "base/json.h"
#include "driver/study.h"

// study.csv, study.json, study.html and a picture of each plot, error-NAME.svg, in the study's folder.
// false after an error message.
bool study_write(const struct study *study);

struct json *study_json(const struct study *study);

// A few lines for the terminal: exponents, the front, the target. To standard output.
void study_print(const struct study *study);
// The sentence about the target.
void study_target_text(const struct study *study, char *text, size_t size);

// For study_write.
bool study_write_csv(const struct study *study, const char *path);
bool study_write_html(const struct study *study, const char *path);
bool study_write_plots(const struct study *study);
void study_plot(const struct study *study, enum study_axis axis, int width, int height, FILE *out);
bool study_has_axis(const struct study *study, enum study_axis axis);
