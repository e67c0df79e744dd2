// SPDX-License-Identifier: Apache-2.0
// A parameter's value from a word, as a command line gives it.
#pragma once

#include "base/registry.h"

enum { PARAM_VALUE_BYTES = 8 }; // room for any value that a word can give

// Whether a word can give a value of this type: truth values, numbers, choices, and texts,
// which are not copied; a file's name goes from the working directory.
bool param_takes_text(const struct param *p);
// Bytes of such a value.
size_t param_text_size(const struct param *p);
// Checks the range, too. false after an error message that names the parameter.
bool param_parse(const struct param *p, const char *text, void *value);
