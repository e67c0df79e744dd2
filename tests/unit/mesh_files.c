// SPDX-License-Identifier: Apache-2.0
// Files of others, from the shared data: sizes and bounds as a few lines of Python find them.
#include <stdlib.h>

#include "check.h"
#include "mesh_check.h"

static const struct expected {
    const char *path;
    int index;
    uint32_t vertices, triangles;
    double low[3], high[3];
} files[] = {
    {"scenes/meshes/spot.obj", 0, 3225, 5856,
     {-0.471552, -0.736784, -0.668909}, {0.471552, 0.953646, 1.049}},
    {"scenes/meshes/stanford-dragon-res3.obj", 0, 139602, 46540,
     {-1.400002, -0.027672, -0.558762}, {1.247998, 1.901167, 0.637687}},
    {"scenes/meshes/suzanne.obj", 0, 507, 968,
     {-3.86125, 0.267311, 3.25233}, {-1.126875, 2.236061, 4.955455}},
    {"scenes/meshes/utah-teapot-uv.obj", 0, 8334, 15704,
     {-71.892532, 0, -47.928356}, {82.293999, 79.006561, 47.928356}},
    {"common/meshes/sphere.obj", 0, 16639, 32512, {-1, -1, -1}, {1.000001, 1, 1.000002}},
    {"scenes/bitterli/classroom/models/Mesh052.obj", 0, 14976, 29856,
     {-0.130605, 2.36572, -0.120684}, {0.191664, 3.028352, 0.127903}},
    {"scenes/meshes/bunny_lowres.ply", 0, 453, 948,
     {-0.0931466, 0.0336204, -0.056644}, {0.0581591, 0.181897, 0.0578008}},
    {"scenes/meshes/sphere.ply", 0, 422, 840, {-126, -127, -127}, {125, 126, 127}},
    {"scenes/meshes/stanford-bunny.ply", 0, 35947, 69451,
     {-0.094689898, 0.032987401, -0.0618736}, {0.061009102, 0.187321007, 0.058799699}},
    {"scenes/meshes/teapot.ply", 0, 1177, 2256, {-3, -2, 0}, {3.42963, 2, 3.15}},
    {"scenes/mitsuba-tests/mesh_attributes/meshes/sphere_attribute.ply", 0, 1192, 528,
     {-0.999999, -0.999999, -1}, {0.999999, 1, 1}},
    {"scenes/meshes/mitsuba-loader-tests/ply/cbox_smallbox.ply", 0, 24, 12,
     {82, 0, 65}, {290, 165, 272}},
    {"scenes/meshes/mitsuba-loader-tests/obj/cbox_smallbox.obj", 0, 24, 12,
     {82, 0, 65}, {290, 165, 272}},
    {"scenes/meshes/mitsuba-loader-tests/obj/rectangle_normals_uv.obj", 0, 4, 2,
     {-2.85, 0, -7.6}, {2.85, 0, 0.599999}},
    {"scenes/meshes/mitsuba-loader-tests/ply/rectangle_normals_uv.ply", 0, 4, 2,
     {-2.85, 0, -7.6}, {2.85, 0, 0.599999}},
    {"scenes/meshes/mitsuba-loader-tests/serialized/rectangle_normals_uv.serialized", 0, 4, 2,
     {-2.85, 0, -7.6}, {2.85, 0, 0.599999}},
    {"scenes/matpreview/matpreview.serialized", 2, 29439, 57152,
     {-1.219943, -1.219943, -1.176495}, {1.003021, 1.219943, 1.013164}},
    {"scenes/sponza-dabrovic/sponza.serialized", 36, 706, 813,
     {-0.92875, 0, -7.5825}, {0.92875, 3.577727, -7.2}},
};

static bool read_file(const char *path, int index, struct mesh *m) {
    char full[4096];
    snprintf(full, sizeof full, "%s/%s", getenv("RELUME_SHARED_DATA"), path);
    const struct mesh_options options = {.shape_index = index};
    return mesh_reader_for(full)->read(full, &options, m);
}

static void file_has_the_expected_size(const struct expected *e) {
    struct mesh m;
    printf("%s %d\n", e->path, e->index);
    CHECK(read_file(e->path, e->index, &m));
    const char *fault = mesh_fault(&m);
    CHECK(!fault);
    if (fault)
        return;
    CHECK(m.vertex_count == e->vertices && m.triangle_count == e->triangles);
    for (int k = 0; k < 3; k++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < m.vertex_count; i++) {
            low = fminf(low, m.positions[i][k]);
            high = fmaxf(high, m.positions[i][k]);
        }
        CHECK_NEAR(low, e->low[k], 1e-6 * (1 + fabs(e->low[k])));
        CHECK_NEAR(high, e->high[k], 1e-6 * (1 + fabs(e->high[k])));
    }
    mesh_finish(&m);
}

static void attributes_of_the_mitsuba_test_are_found(void) {
    struct mesh m;
    CHECK(read_file("scenes/mitsuba-tests/mesh_attributes/meshes/sphere_attribute.ply", 0, &m));
    const struct mesh_attribute *v = mesh_find_attribute(&m, "vertex_color");
    const struct mesh_attribute *f = mesh_find_attribute(&m, "face_color");
    const struct mesh_attribute *w = mesh_find_attribute(&m, "face_weight");
    CHECK(m.attribute_count == 3 && v && f && w);
    CHECK(v->channels == 3 && !v->per_face && f->channels == 3 && f->per_face);
    CHECK(w->channels == 1 && w->per_face);
    mesh_finish(&m);
}

// The same rectangle in three formats. Mitsuba made the serialized one from the OBJ, whose v it
// flips; the PLY holds v as the OBJ does, and is not flipped.
static void formats_agree_on_a_rectangle(void) {
    static const char *const paths[] = {
        "scenes/meshes/mitsuba-loader-tests/obj/rectangle_normals_uv.obj",
        "scenes/meshes/mitsuba-loader-tests/ply/rectangle_normals_uv.ply",
        "scenes/meshes/mitsuba-loader-tests/serialized/rectangle_normals_uv.serialized"};
    double sums[3][3] = {{0}}; // of u, v and the y of normals
    for (int i = 0; i < 3; i++) {
        struct mesh m;
        CHECK(read_file(paths[i], 0, &m));
        for (uint32_t j = 0; j < m.vertex_count; j++) {
            sums[i][0] += m.uvs[j][0];
            sums[i][1] += i == 1 ? 1 - m.uvs[j][1] : m.uvs[j][1];
            sums[i][2] += m.normals[j][1];
        }
        mesh_finish(&m);
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(sums[i][k], sums[0][k], 1e-5);
    }
}

int main(void) {
    if (!getenv("RELUME_SHARED_DATA"))
        return 77;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        file_has_the_expected_size(&files[i]);
    attributes_of_the_mitsuba_test_are_found();
    formats_agree_on_a_rectangle();
    return check_result();
}
