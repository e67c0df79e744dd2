// SPDX-License-Identifier: Apache-2.0
// Writes a small edit tensor of random numbers (edit_sample.h), for tests of the program.
//
// usage: make_tensor OUT.safetensors [polynomial]
#include <string.h>

#include "edit_sample.h"

int main(int argc, char **argv) {
    const struct sample_options o = {.polynomial = argc > 2 && strcmp(argv[2], "polynomial") == 0};
    return argc > 1 && sample_write(&o, argv[1]) ? 0 : 1;
}
