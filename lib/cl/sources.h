// SPDX-License-Identifier: Apache-2.0
// The texts of kernels/*.cl, put into the program when it is built. Internal to the module.
#pragma once

struct compute_source {
    const char *name; // of the file, without .cl
    const char *text; // with the headers it includes in their places
};

extern const struct compute_source compute_sources[]; // ends with a NULL name
