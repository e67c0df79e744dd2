// SPDX-License-Identifier: Apache-2.0
// Reading meshes from memory in tests: the text goes to a file, its messages into `captured`.
#pragma once

#include <stdlib.h>

#include "capture.h"
#include "mesh/mesh.h"

static inline bool read_mesh_data(const char *extension, const void *data, size_t size,
                                  const struct mesh_options *options, struct mesh *m) {
    char path[64];
    snprintf(path, sizeof path, "mesh-test-%ld.%s", (long)getpid(), extension);
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) != 0) {
        printf("%s: cannot be written\n", path);
        exit(1);
    }
    const struct mesh_options none = {0};
    capture_begin();
    const bool good = mesh_reader_for(path)->read(path, options ? options : &none, m);
    capture_end();
    remove(path);
    return good;
}

// Reads the text as the format of the extension with default options.
static inline bool read_mesh(const char *extension, const char *text, struct mesh *m) {
    return read_mesh_data(extension, text, strlen(text), NULL, m);
}

// True when the text is refused with a message that has `expected` in it, names the file, and
// leaves the mesh empty.
static inline bool refuses(const char *extension, const char *text, const char *expected) {
    struct mesh m;
    const bool read = read_mesh(extension, text, &m);
    const bool empty = !m.positions && !m.indices && m.vertex_count == 0;
    if (!read && empty && captured_has(expected) && captured_has("mesh-test-"))
        return true;
    printf("%s, expected '%s', message: %s\n", read ? "was read" : "was refused", expected,
           captured);
    if (read)
        mesh_finish(&m);
    return false;
}

static inline bool has_triangle(const struct mesh *m, uint32_t i, uint32_t a, uint32_t b,
                                uint32_t c) {
    return i < m->triangle_count && m->indices[i][0] == a && m->indices[i][1] == b &&
           m->indices[i][2] == c;
}
