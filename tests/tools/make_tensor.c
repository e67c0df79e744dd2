// SPDX-License-Identifier: Apache-2.0
// Writes a small tensor of random numbers (edit_sample.h), for tests of the program.
//
// usage: make_tensor OUT.safetensors [linear|polynomial|more|tiny|relight]
#include <string.h>

#include "edit_sample.h"

static const struct {
    const char *name;
    struct sample_options options;
} kinds[] = {
    {"linear", {.polynomial = false}},
    {"polynomial", {.polynomial = true}},
    {"more", {.seed = 1}}, // of the scene of "linear"
    {"tiny", {.polynomial = true, .bins = 2}},
    {"tiny16", {.bins = 2, .storage = TENSOR_BF16}},
};

int main(int argc, char **argv) {
    const char *kind = argc > 2 ? argv[2] : "linear";
    if (argc < 2)
        return 1;
    if (strcmp(kind, "relight") == 0)
        return sample_write_relight(argv[1]) ? 0 : 1;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kinds[i].name, kind) == 0)
            return sample_write(&kinds[i].options, argv[1]) ? 0 : 1;
    return 1;
}
