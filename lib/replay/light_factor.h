// SPDX-License-Identifier: Apache-2.0
// Factors of lights, as a person says them: NAME=R,G,B or NAME=X.
#pragma once

#include <stddef.h>

// The length of the name; 0 after an error message that names `at`.
size_t light_factor_parse(const char *text, const char *at, float rgb[3]);
