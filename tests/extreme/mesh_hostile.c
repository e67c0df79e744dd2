// SPDX-License-Identifier: Apache-2.0
// Mesh files made to break readers: those that are right after all are read, every other one is
// refused with a message that names it. No file may take more than 10 s or 1 GiB (memory_limit.h).
#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "capture.h"
#include "check.h"
#include "memory_limit.h"
#include "mesh_check.h"

enum { SECONDS = 10 };

static const char *const folders[] = {"assimp/OBJ", "assimp/PLY", "assimp/invalid", "magnum-obj",
                                      "magnum-ply", NULL};

// Everything else is damaged, in another encoding, or holds no face.
static const char *const good[] = {
    "box_without_lineending.obj", "concave_polygon.obj", "cube_mtllib_after_g.obj",
    "multiple_spaces.obj", "only_a_part_of_vertexcolors.obj", "regr_3429812.obj",
    "space_in_material_name.obj", "testmixed.obj", "mesh-primitive-triangles.obj",
    "mesh-quads.obj", "cube_binary.ply", "cube_binary_header_with_RN_newline.ply",
    "cube_binary_starts_with_nl.ply", "crlf.ply", "custom-components-duplicate.ply",
    "positions-colors-normals-texcoords-float-objectid-uint-indices-int-be.ply",
    "positions-float-indices-uint.ply",
    "positions-short-colors-uchar-texcoords-ushort-indices-char.ply",
    "positions-ushort-normals-short-objectid-uchar-indices-uchar-be.ply",
    "triangle-fast-path-be.ply", "whitespace.ply"};

static bool is_good(const char *name) {
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (strcmp(name, good[i]) == 0)
            return true;
    return false;
}

static void check_file(const char *folder, const char *name, int *read) {
    char path[4096], extension[16];
    const struct mesh_options options = {0};
    struct mesh m;
    snprintf(path, sizeof path, "%s/hostile/%s/%s", getenv("RELUME_SHARED_DATA"), folder, name);
    file_extension(path, extension, sizeof extension);
    if (strcmp(extension, "mtl") == 0)
        return;
    const struct mesh_reader_type *type =
        strcmp(extension, "obj") == 0 ? &mesh_reader_obj : &mesh_reader_ply;
    printf("%s: ", name);
    fflush(stdout); // should the alarm end the test here
    capture_begin();
    alarm(SECONDS);
    const bool ok = type->read(path, &options, &m);
    alarm(0);
    capture_end();
    printf("%s %s", ok ? "read" : "refused", *captured ? captured : "\n");
    CHECK(ok == is_good(name));
    CHECK(ok ? !mesh_fault(&m) : captured_has(path));
    *read += ok;
    if (ok)
        mesh_finish(&m);
}

int main(void) {
    int read = 0;
    if (!getenv("RELUME_SHARED_DATA"))
        return 77;
    memory_limit();
    for (const char *const *f = folders; *f; f++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/hostile/%s", getenv("RELUME_SHARED_DATA"), *f);
        DIR *d = opendir(path);
        CHECK(d);
        for (struct dirent *e = d ? readdir(d) : NULL; e; e = readdir(d))
            if (e->d_name[0] != '.')
                check_file(*f, e->d_name, &read);
        if (d)
            closedir(d);
    }
    CHECK(read == (int)(sizeof good / sizeof *good));
    return check_result();
}
