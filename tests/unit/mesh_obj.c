// SPDX-License-Identifier: Apache-2.0
#include "check.h"
#include "mesh_read.h"

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

static void obj_reads_triangle(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "f 1 2 3\n", &m));
    CHECK(m.vertex_count == 3 && m.triangle_count == 1);
    CHECK(m.positions[1][0] == 1 && m.positions[2][1] == 1 && m.positions[0][2] == 0);
    CHECK(has_triangle(&m, 0, 0, 1, 2));
    CHECK(!m.uvs && m.attribute_count == 0);
    mesh_finish(&m);
}

static void obj_without_normals_gets_computed_ones(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "f 1 2 3\n", &m));
    CHECK(m.normals_computed && m.normals[0][2] == 1 && m.normals[2][0] == 0);
    mesh_finish(&m);
}

static void obj_face_normals_drops_normals(void) {
    const char *text = TRIANGLE "vn 0 0 1\nf 1//1 2//1 3//1\n";
    const struct mesh_options options = {.face_normals = true};
    struct mesh m;
    CHECK(read_mesh_data("obj", text, strlen(text), &options, &m));
    CHECK(!m.normals);
    mesh_finish(&m);
}

static void obj_makes_normals_unit(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "vn 0 3e-30 -4e-30\nf 1//1 2//1 3//1\n", &m));
    CHECK(!m.normals_computed);
    CHECK_NEAR(m.normals[0][1], 0.6, 1e-6);
    CHECK_NEAR(m.normals[2][2], -0.8, 1e-6);
    mesh_finish(&m);
}

static void obj_corner_without_normal_takes_computed_one(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "vn 1 0 0\nvn 0 0 0\nf 1//1 2 3//2\n", &m));
    CHECK(m.normals[0][0] == 1 && m.normals[1][2] == 1 && m.normals[2][2] == 1);
    mesh_finish(&m);
}

static void obj_joins_equal_corners_only(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "v 1 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 2/1 4/2 3/2\n",
                    &m));
    CHECK(m.vertex_count == 5); // vertex 3 stands with two texture coordinates
    CHECK(has_triangle(&m, 0, 0, 1, 2) && has_triangle(&m, 1, 1, 3, 4));
    CHECK(m.positions[4][1] == 1 && m.uvs[4][0] == 1 && m.uvs[2][1] == 1);
    mesh_finish(&m);
}

static void obj_flips_v_unless_told_not_to(void) {
    const char *text = TRIANGLE "vt 0.25 0.25\nf 1/1 2/1 3/1\n";
    const struct mesh_options options = {.flip_uvs = true};
    struct mesh m;
    CHECK(read_mesh("obj", text, &m));
    CHECK(m.uvs[0][0] == 0.25f && m.uvs[0][1] == 0.75f);
    mesh_finish(&m);
    CHECK(read_mesh_data("obj", text, strlen(text), &options, &m));
    CHECK(m.uvs[0][0] == 0.25f && m.uvs[0][1] == 0.25f);
    mesh_finish(&m);
}

static void obj_reads_negative_indices(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "f -3 -2 -1\nv 5 5 5\nf -4 -1 -2\n", &m));
    CHECK(has_triangle(&m, 0, 0, 1, 2) && has_triangle(&m, 1, 0, 3, 2));
    CHECK(m.positions[3][0] == 5);
    mesh_finish(&m);
}

static void obj_reads_indices_that_point_ahead(void) {
    struct mesh m;
    CHECK(read_mesh("obj", "f 1 2 3\n" TRIANGLE, &m));
    CHECK(m.positions[m.indices[0][1]][0] == 1);
    mesh_finish(&m);
}

static void obj_makes_fans_of_polygons(void) {
    struct mesh m;
    CHECK(read_mesh("obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n", &m));
    CHECK(m.triangle_count == 3);
    CHECK(has_triangle(&m, 0, 0, 1, 2) && has_triangle(&m, 1, 0, 2, 3) &&
          has_triangle(&m, 2, 0, 3, 4));
    mesh_finish(&m);
}

static void obj_reads_any_white_space(void) {
    struct mesh m;
    const char *text = "\xef\xbb\xbf# byte order mark\r\n\tv   0 0\t0  \r\nv 1 \\\r\n 0 0\r"
                       "v 0 1 0 # comment\n";
    CHECK(!read_mesh("obj", text, &m)); // comments stand on lines of their own
    CHECK(captured_has("found '#', expected a number"));
    text = "\xef\xbb\xbf# byte order mark\r\n\tv   0 0\t0  \r\nv 1 \\\r\n 0 0\r"
           "v 0 1 0\n f 1\\\n  2 3   ";
    CHECK(read_mesh("obj", text, &m));
    CHECK(m.vertex_count == 3 && has_triangle(&m, 0, 0, 1, 2) && m.positions[1][0] == 1);
    mesh_finish(&m);
}

static void obj_reads_number_formats(void) {
    struct mesh m;
    CHECK(read_mesh("obj", "v +1. -2.5e+1 .5E-1\nv 1e-50 123456789.123456789123456789 -0\n"
                           "v 3.4028234e38 0.000000000000000000000000000001e30 7\nf 1 2 3", &m));
    CHECK(m.positions[0][0] == 1 && m.positions[0][1] == -25 && m.positions[0][2] == 0.05f);
    CHECK(m.positions[1][0] == 0 && m.positions[1][1] == 123456789.123456789f);
    CHECK(m.positions[2][0] == 3.4028234e38f && m.positions[2][1] == 1);
    mesh_finish(&m);
}

static void obj_colours_of_vertices_become_an_attribute(void) {
    struct mesh m;
    CHECK(read_mesh("obj", "v 0 0 0\nv 1 0 0 .25 .5 .75\nv 0 1 0 1\nf 1 2 3\n", &m));
    const struct mesh_attribute *a = mesh_find_attribute(&m, "vertex_color");
    CHECK(a && a->channels == 3 && !a->per_face);
    CHECK(a && a->data[0] == 1 && a->data[3] == .25f && a->data[5] == .75f && a->data[8] == 1);
    mesh_finish(&m);
}

static void obj_selects_one_object_or_group(void) {
    const char *text = TRIANGLE "v 1 1 0\no first part\nf 1 2 3\ng a b\nf 3 2 4\no c\nf 1 2 4\n";
    struct mesh m;
    struct mesh_options options = {.shape_name = "b"};
    CHECK(read_mesh_data("obj", text, strlen(text), &options, &m));
    CHECK(m.triangle_count == 1 && m.positions[m.indices[0][2]][0] == 1);
    mesh_finish(&m);
    options.shape_name = "first part";
    CHECK(read_mesh_data("obj", text, strlen(text), &options, &m));
    CHECK(m.triangle_count == 2);
    mesh_finish(&m);
    options.shape_name = "part";
    CHECK(!read_mesh_data("obj", text, strlen(text), &options, &m));
    CHECK(captured_has("holds no object or group 'part'"));
}

static void obj_warns_of_what_it_skips(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "l 1 2\np 3\nf 1 2\nf 1 2 3\n", &m));
    CHECK(m.triangle_count == 1);
    CHECK(captured_has("warning") && captured_has("2 points and lines are skipped"));
    CHECK(captured_has("1 faces with fewer than 3 corners"));
    mesh_finish(&m);
}

static void obj_keeps_degenerate_triangles(void) {
    struct mesh m;
    CHECK(read_mesh("obj", TRIANGLE "f 1 1 1\nf 1 2 2\n", &m));
    CHECK(m.triangle_count == 2 && m.normals[0][0] == 1 && m.normals[0][1] == 0);
    mesh_finish(&m);
}

static void obj_refuses_what_is_no_number(void) {
    CHECK(refuses("obj", "v 0 nan 0\n", ".obj:1: found 'nan', expected a number"));
    CHECK(refuses("obj", "\nv 0 inf 0\n", ".obj:2: found 'inf'"));
    CHECK(refuses("obj", "v 0 1e39 0\n", "found '1e39', expected a number of single precision"));
    CHECK(refuses("obj", "v 0 0\n", "found 'end of line', expected another number"));
    CHECK(refuses("obj", "v 0 1,5 0\n", "found '1,5'"));
    CHECK(refuses("obj", "v 0 0 0 0 0\n", "expected 3 coordinates"));
    CHECK(refuses("obj", "v 0 0 0 1 1 1 1 1\n", "found '1', expected the end of the line"));
    CHECK(refuses("obj", "vn 1 0\n", ".obj:1"));
    CHECK(refuses("obj", "vt\n", ".obj:1"));
}

static void obj_refuses_indices_out_of_range(void) {
    CHECK(refuses("obj", TRIANGLE "f 1 2 4\n", ".obj:4: found the index 4, but the file has 3"));
    CHECK(refuses("obj", TRIANGLE "f 1 2 0\n", ".obj:4: found '0', expected an index"));
    CHECK(refuses("obj", TRIANGLE "f 1 2 -4\n", ".obj:4: found '-4'"));
    CHECK(refuses("obj", TRIANGLE "f 1 2 99999999999999999999\n", ".obj:4"));
    CHECK(refuses("obj", TRIANGLE "f 1 2 4294967295\n", ".obj:4"));
    CHECK(refuses("obj", TRIANGLE "f 1/1 2/1 3/1\n", "0 texture coordinates"));
    CHECK(refuses("obj", TRIANGLE "f 1//7 2 3\n", "0 normals"));
}

static void obj_refuses_broken_faces(void) {
    CHECK(refuses("obj", TRIANGLE "f\n", ".obj:4: found 'end of line'"));
    CHECK(refuses("obj", TRIANGLE "f 1 2 x\n", "found 'x', expected the index of a vertex"));
    CHECK(refuses("obj", TRIANGLE "f 1/2/3/4 2 3\n", "found '/4'"));
    CHECK(refuses("obj", TRIANGLE "f 1.5 2 3\n", "found '.5'"));
}

static void obj_refuses_what_is_no_mesh(void) {
    struct mesh m;
    CHECK(refuses("obj", "", "holds no faces"));
    CHECK(refuses("obj", TRIANGLE "p 1 2 3\n", "holds no faces"));
    CHECK(refuses("obj", "hello world\n", ".obj:1: found 'hello', expected a statement"));
    CHECK(refuses("obj", "\xff\xfev", "UTF-16"));
    CHECK(!read_mesh_data("obj", "v 0 0 0\n\0f", 10, NULL, &m));
    CHECK(captured_has("zero byte"));
}

int main(void) {
    obj_reads_triangle();
    obj_without_normals_gets_computed_ones();
    obj_face_normals_drops_normals();
    obj_makes_normals_unit();
    obj_corner_without_normal_takes_computed_one();
    obj_joins_equal_corners_only();
    obj_flips_v_unless_told_not_to();
    obj_reads_negative_indices();
    obj_reads_indices_that_point_ahead();
    obj_makes_fans_of_polygons();
    obj_reads_any_white_space();
    obj_reads_number_formats();
    obj_colours_of_vertices_become_an_attribute();
    obj_selects_one_object_or_group();
    obj_warns_of_what_it_skips();
    obj_keeps_degenerate_triangles();
    obj_refuses_what_is_no_number();
    obj_refuses_indices_out_of_range();
    obj_refuses_broken_faces();
    obj_refuses_what_is_no_mesh();
    return check_result();
}
