// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "fuzz.h"
#include "mesh_check.h"

static bool read_mesh(const char *path) {
    const struct mesh_options options = {.flip_uvs = true};
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
