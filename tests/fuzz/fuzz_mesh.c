// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz.h"
#include "mesh_check.h"

static bool read_mesh(const char *path) {
    const int n = atoi(strrchr(path, '-') + 1); // of the case
    const struct mesh_options options = {.shape_index = n / 10 % 2, .face_normals = n % 7 == 0,
                                         .shape_name = n % 13 == 0 ? "right" : NULL};
    struct mesh m;
    if (!mesh_reader_for(path)->read(path, &options, &m))
        return false;
    const char *fault = mesh_fault(&m);
    if (fault) {
        fprintf(stderr, "%s: was read, but %s\n", path, fault);
        abort();
    }
    mesh_finish(&m);
    return true;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-mesh", read_mesh);
}
