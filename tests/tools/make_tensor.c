// SPDX-License-Identifier: Apache-2.0
// Writes a small tensor of random numbers (edit_sample.h), for tests of the program.
//
// usage: make_tensor OUT.safetensors [linear|polynomial|more|tiny|tiny16|rows|relight]
#include <string.h>

#include "edit_sample.h"
#include "replay/budget.h"

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
    if (strcmp(kind, "rows") == 0) {
        struct budget_report report;
        return sample_write(&kinds[3].options, argv[1]) &&
                       budget_store(argv[1], argv[1], &(struct budget_options){.relmse = 1e-3,
                                                                               .command = ""}, &report)
                   ? 0 : 1;
    }
    if (strcmp(kind, "relight") == 0)
        return sample_write_relight(argv[1]) ? 0 : 1;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kinds[i].name, kind) == 0)
            return sample_write(&kinds[i].options, argv[1]) ? 0 : 1;
    return 1;
}
