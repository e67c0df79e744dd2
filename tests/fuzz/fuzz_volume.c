// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "fuzz.h"
#include "volume/grid.h"

static const char *grid_fault(const struct grid *g) {
    if (!transform_is_finite(&g->to_file))
        return "stands nowhere";
    const size_t n = grid_values(g);
    for (size_t i = 0; i < n; i++)
        if (!(g->values[i] >= 0 && isfinite(g->values[i])))
            return "has a value that is not finite, or negative";
    return NULL;
}

static bool read_volume(const char *path) {
    struct grid g;
    if (!grid_read(path, NULL, &g))
        return false;
    const char *fault = grid_fault(&g);
    if (fault) {
        fprintf(stderr, "%s: was read, but %s\n", path, fault);
        abort();
    }
    grid_finish(&g);
    return true;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-volume", read_volume);
}
