// SPDX-License-Identifier: Apache-2.0
#include <math.h>

#include "check.h"
#include "mesh_read.h"

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define INDICES "property list uchar int vertex_indices\n"
#define ASCII "ply\nformat ascii 1.0\n"
#define POINTS "0 0 0\n1 0 0\n0 1 0\n"

static void ply_reads_text(void) {
    struct mesh m;
    CHECK(read_mesh("ply", ASCII "comment hello\nelement vertex 3\n" XYZ "element face 1\n" INDICES
                           "end_header\n" POINTS "3 0 1 2\n", &m));
    CHECK(m.vertex_count == 3 && m.triangle_count == 1 && has_triangle(&m, 0, 0, 1, 2));
    CHECK(m.positions[2][1] == 1 && m.normals_computed && m.normals[0][2] == 1);
    CHECK(captured[0] == '\0');
    mesh_finish(&m);
}

static void ply_reads_crlf_and_blanks(void) {
    struct mesh m;
    CHECK(read_mesh("ply", "ply\r\nformat  ascii 1.0 \r\nelement vertex 3\r\n  property float x\r\n"
                           "property float y\r\nproperty float z\r\n\r\nelement face 1\r\n"
                           "property list uchar int vertex_index\r\nend_header\r\n"
                           "0 0 0\r\n1 0 0 0\r\n1 0 3 0 1 2", &m));
    CHECK(m.positions[2][1] == 1 && has_triangle(&m, 0, 0, 1, 2));
    mesh_finish(&m);
}

// One vertex per type around, and a face: the same mesh in both byte orders.
static size_t binary_mesh(bool big, char *out) {
    static const char head[] =
        " 1.0\nelement vertex 3\nproperty short y\nproperty double x\nproperty uchar flags\n"
        "property list ushort int extra\nproperty float z\nelement face 1\n"
        "property uint id\nproperty list int8 ushort vertex_indices\nend_header\n";
    size_t n = (size_t)sprintf(out, "ply\nformat binary_%s_endian%s", big ? "big" : "little", head);
    const double x[3] = {0, 1e-3, -2};
    const short y[3] = {-300, 0, 7};
    const float z[3] = {.5f, 0, 3e30f};
#define PUT(value)                                                                                 \
    for (size_t b_ = 0; b_ < sizeof(value); b_++)                                                  \
    out[n++] = ((const char *)&(value))[big ? sizeof(value) - 1 - b_ : b_]
    for (unsigned short i = 0; i < 3; i++) {
        PUT(y[i]);
        PUT(x[i]);
        out[n++] = (char)(200 + i);
        PUT(i); // a list of i integers
        for (int k = 0; k < i; k++)
            PUT(k);
        PUT(z[i]);
    }
    const unsigned id = 4000000000u;
    PUT(id);
    out[n++] = 3;
    for (unsigned short i = 0; i < 3; i++)
        PUT(i);
#undef PUT
    return n;
}

static void ply_reads_both_byte_orders_and_all_types(void) {
    for (int big = 0; big < 2; big++) {
        struct mesh m;
        char data[1024];
        const size_t n = binary_mesh(big, data);
        CHECK(read_mesh_data("ply", data, n, NULL, &m));
        CHECK(m.positions[0][1] == -300 && m.positions[1][0] == 1e-3f);
        CHECK(m.positions[2][2] == 3e30f && m.positions[2][0] == -2 && m.positions[0][2] == .5f);
        CHECK(has_triangle(&m, 0, 0, 1, 2));
        const struct mesh_attribute *flags = mesh_find_attribute(&m, "vertex_flags");
        const struct mesh_attribute *id = mesh_find_attribute(&m, "face_id");
        CHECK(flags && flags->data[2] == 202);
        CHECK(id && id->per_face && id->data[0] == 4e9f);
        mesh_finish(&m);
        for (size_t cut = n - 1; cut > 300; cut--) // every truncation behind the header
            CHECK(!read_mesh_data("ply", data, cut, NULL, &m) && captured_has("mesh-test-"));
    }
}

static void ply_reads_normals_and_uvs(void) {
    static const char *const names[3][2] = {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}};
    for (int i = 0; i < 3; i++) {
        char text[1024];
        struct mesh m;
        snprintf(text, sizeof text,
                 ASCII "element vertex 3\n" XYZ "property float %s\nproperty float %s\n"
                       "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
                       INDICES "end_header\n0 0 0 .1 .2 0 0 2\n1 0 0 .3 .4 0 0 2\n"
                       "0 1 0 .5 .6 0 0 2\n3 0 1 2\n", names[i][0], names[i][1]);
        CHECK(read_mesh("ply", text, &m));
        CHECK(m.uvs && m.uvs[1][0] == .3f && m.uvs[2][1] == .6f);
        CHECK(!m.normals_computed && m.normals[1][2] == 1 && m.attribute_count == 0);
        mesh_finish(&m);
    }
}

static void ply_makes_fans_with_face_attributes(void) {
    struct mesh m;
    CHECK(read_mesh("ply", ASCII "element vertex 4\n" XYZ "element face 3\n"
                           "property float weight_0\n" INDICES
                           "property float color_0\nproperty float color_1\n"
                           "property float color_2\nend_header\n" POINTS "1 1 0\n"
                           "1 3 0 1 2 .1 .2 .3\n2 4 0 1 3 2 .4 .5 .6\n3 2 0 1 0 0 0\n", &m));
    CHECK(m.triangle_count == 3);
    CHECK(has_triangle(&m, 1, 0, 1, 3) && has_triangle(&m, 2, 0, 3, 2));
    const struct mesh_attribute *color = mesh_find_attribute(&m, "face_color");
    const struct mesh_attribute *weight = mesh_find_attribute(&m, "face_weight");
    CHECK(color && color->per_face && color->channels == 3 && color->data[8] == .6f);
    CHECK(weight && weight->channels == 1 && weight->data[0] == 1 && weight->data[2] == 2);
    CHECK(captured_has("1 faces with fewer than 3 corners"));
    mesh_finish(&m);
}

static void ply_names_attributes_as_mitsuba(void) {
    struct mesh m;
    CHECK(read_mesh("ply", ASCII "element vertex 3\n" XYZ
                           "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                           "property float a_x\nproperty float a_y\nproperty float a_z\n"
                           "property float b_r\nproperty float b_g\nproperty float b_b\n"
                           "property float c_1\nproperty float c_2\nproperty float c_3\n"
                           "property float d_0\nproperty float e_1\nproperty float temperature\n"
                           "element face 1\n" INDICES "end_header\n"
                           "0 0 0 0 255 128 1 2 3 4 5 6 7 8 9 10 11 12\n"
                           "0 1 0 0 255 128 1 2 3 4 5 6 7 8 9 10 11 12\n"
                           "1 0 0 0 255 128 1 2 3 4 5 6 7 8 9 10 11 12\n3 0 1 2\n", &m));
    static const struct {
        const char *name;
        int channels;
        float last;
    } expected[] = {{"vertex_color", 3, .2158605f}, {"vertex_a", 3, 3},    {"vertex_b_color", 3, 6},
                    {"vertex_c", 3, 9},             {"vertex_d", 1, 10},   {"vertex_e", 1, 11},
                    {"vertex_temperature", 1, 12}};
    CHECK(m.attribute_count == 7);
    for (int i = 0; i < 7; i++) {
        const struct mesh_attribute *a = mesh_find_attribute(&m, expected[i].name);
        CHECK(a && a->channels == expected[i].channels && !a->per_face);
        CHECK_NEAR(a ? a->data[3 * a->channels - 1] : NAN, expected[i].last, 1e-6);
    }
    mesh_finish(&m);
}

static void ply_steps_over_unknown_elements(void) {
    struct mesh m;
    CHECK(read_mesh("ply", ASCII "element junk 2\nproperty list int float stuff\nproperty char c\n"
                           "element face 1\n" INDICES "element vertex 3\n" XYZ "element tail 1\n"
                           "property int i\nend_header\n2 nan x 1\n0 1\n3 2 1 0\n" POINTS "9\n",
                    &m));
    CHECK(has_triangle(&m, 0, 2, 1, 0) && m.positions[1][0] == 1);
    CHECK(captured_has("element junk is skipped") && captured_has("element tail is skipped"));
    mesh_finish(&m);
}

#define MESH(count, faces, points, face)                                                           \
    ASCII "element vertex " count "\n" XYZ "element face " faces "\n" INDICES                      \
          "end_header\n" points face

static void ply_refuses_bad_values(void) {
    CHECK(refuses("ply", MESH("3", "1", "0 0 0\n1 nan 0\n0 1 0\n", "3 0 1 2\n"),
                  ".ply:11: found 'nan', expected a number of type float"));
    CHECK(refuses("ply", MESH("3", "1", "0 0 0\n1 1e39 0\n0 1 0\n", "3 0 1 2\n"),
                  ".ply:11: found 1e+39 in y"));
    CHECK(refuses("ply", MESH("3", "1", POINTS, "3 0 1 3\n"), ".ply:13: found the index 3"));
    CHECK(refuses("ply", MESH("3", "1", POINTS, "3 0 1 -1\n"), ".ply:13: found the index -1"));
    CHECK(refuses("ply", MESH("3", "1", POINTS, "3 0 1 1.5\n"), "found '1.5', expected a number"));
    CHECK(refuses("ply", MESH("3", "1", POINTS, "-3 0 1 2\n"), "found '-3'"));
    CHECK(refuses("ply", MESH("3", "1", POINTS, "255 0 1 2\n"), "a list vertex_indices of 255"));
    CHECK(refuses("ply", MESH("3", "1", POINTS, "3 0 1"), "a list vertex_indices of 3"));
}

static void ply_refuses_counts_the_file_cannot_hold(void) {
    CHECK(refuses("ply", MESH("4294967294", "1", POINTS, "3 0 1 2\n"), "announces 4294967294"));
    CHECK(refuses("ply", MESH("3", "4294967294", POINTS, "3 0 1 2\n"), "of element face"));
    CHECK(refuses("ply", MESH("4294967296", "1", POINTS, "3 0 1 2\n"), ".ply:3: found '429496729"));
    CHECK(refuses("ply", MESH("-1", "1", POINTS, "3 0 1 2\n"), "expected a count"));
    CHECK(refuses("ply", ASCII "element vertex 3\n" XYZ "element face 4000000000\n" INDICES
                         "end_header\n" POINTS, "element face"));
}

static void ply_refuses_broken_headers(void) {
    CHECK(refuses("ply", "", ".ply:1: found 'end of line', expected the word ply"));
    CHECK(refuses("ply", "ply\n", ".ply:2: found the end of the file"));
    CHECK(refuses("ply", "ply\nelement vertex 3\n", "expected the format line first"));
    CHECK(refuses("ply", "ply\nformat ascii 2.0\n", "expected the version 1.0"));
    CHECK(refuses("ply", ASCII "element vertex\n", "expected a count"));
    CHECK(refuses("ply", ASCII "property float x\n", "expected an element"));
    CHECK(refuses("ply", ASCII "element vertex 3\nproperty quad x\n", "found 'quad'"));
    CHECK(refuses("ply", ASCII "element a 0\nelement a 0\n", "did not stand before"));
    CHECK(refuses("ply", ASCII "element a 0\nproperty list float int x\n", "an integer type"));
    CHECK(refuses("ply", ASCII "element face 0\n" INDICES "end_header\n", "no element vertex"));
    CHECK(refuses("ply", ASCII "element vertex 0\n" XYZ "end_header\n", "no element face"));
    CHECK(refuses("ply", ASCII "element vertex 0\nproperty float x\nelement face 0\n" INDICES
                         "end_header\n", "no properties x, y and z"));
    CHECK(refuses("ply", ASCII "element vertex 0\n" XYZ "element face 0\nend_header\n",
                  "no list vertex_indices"));
    CHECK(refuses("ply", MESH("0", "0", "", ""), "holds no faces"));
}

int main(void) {
    ply_reads_text();
    ply_reads_crlf_and_blanks();
    ply_reads_both_byte_orders_and_all_types();
    ply_reads_normals_and_uvs();
    ply_makes_fans_with_face_attributes();
    ply_names_attributes_as_mitsuba();
    ply_steps_over_unknown_elements();
    ply_refuses_bad_values();
    ply_refuses_counts_the_file_cannot_hold();
    ply_refuses_broken_headers();
    return check_result();
}
