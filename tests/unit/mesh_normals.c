// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <string.h>

#include "check.h"
#include "mesh/mesh.h"
#include "mesh_read.h"

// A corner of a cube: three faces meet at vertex 0; the one in z = 0 is cut in two triangles.
static const char *const corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\n"
                                  "f 1 5 2\nf 1 3 5\nf 1 2 4\nf 1 4 3\n";

static void normals_weigh_by_angle_not_by_number_of_faces(void) {
    struct mesh m;
    CHECK(read_mesh("obj", corner, &m));
    for (int k = 0; k < 3; k++) // all three faces have a right angle at vertex 0
        CHECK_NEAR(fabsf(m.normals[0][k]), 1 / sqrt(3), 1e-6);
    mesh_finish(&m);
}

static void normals_do_not_depend_on_scale(void) {
    for (int exponent = -36; exponent <= 36; exponent += 6) {
        struct mesh m;
        CHECK(read_mesh("obj", corner, &m));
        for (uint32_t i = 0; i < m.vertex_count; i++)
            for (int k = 0; k < 3; k++)
                m.positions[i][k] *= (float)pow(10, exponent);
        mesh_compute_normals(&m);
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(fabsf(m.normals[0][k]), 1 / sqrt(3), 1e-6);
        mesh_finish(&m);
    }
}

static void normals_of_a_cube_point_outwards(void) {
    struct mesh m;
    mesh_make_cube(&m); // its corners are apart, so each keeps its face's normal
    mesh_compute_normals(&m);
    for (uint32_t i = 0; i < m.vertex_count; i++) {
        double along = 0;
        for (int k = 0; k < 3; k++)
            along += m.normals[i][k] * m.positions[i][k];
        CHECK_NEAR(along, 1, 1e-6);
    }
    mesh_finish(&m);
}

// Angles change under a transform that is not a similarity, so weights must too.
static void computed_normals_follow_a_transform(void) {
    const struct transform stretch = transform_scale(1, 3, 0.5);
    struct mesh a, b;
    CHECK(read_mesh("obj", "v 0 0 0\nv 1 0 .2\nv 0 1 .3\nv -1 -.2 .1\nf 1 2 3\nf 1 3 4\n", &a));
    CHECK(read_mesh("obj", "v 0 0 0\nv 1 0 .1\nv 0 3 .15\nv -1 -.6 .05\nf 1 2 3\nf 1 3 4\n", &b));
    CHECK(mesh_transform(&a, &stretch));
    for (uint32_t i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(a.normals[i][k], b.normals[i][k], 1e-6);
    mesh_finish(&a);
    mesh_finish(&b);
}

static void given_normals_transform_by_the_inverse_transpose(void) {
    const struct transform stretch = transform_scale(1, 2, 1);
    struct mesh m;
    CHECK(read_mesh("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 1 0\nf 1//1 2//1 3//1\n", &m));
    CHECK(mesh_transform(&m, &stretch));
    CHECK_NEAR(m.normals[0][0], 2 / sqrt(5), 1e-6);
    CHECK_NEAR(m.normals[0][1], 1 / sqrt(5), 1e-6);
    mesh_finish(&m);
}

static void mirroring_keeps_normals_on_the_outside(void) {
    const struct transform mirror = transform_scale(-1, 1, 1);
    for (int computed = 0; computed < 2; computed++) {
        struct mesh m;
        mesh_make_cube(&m);
        if (computed)
            mesh_compute_normals(&m);
        CHECK(mesh_transform(&m, &mirror));
        for (uint32_t i = 0; i < m.triangle_count; i++) {
            const uint32_t *t = m.indices[i];
            const vec3 p = v3_load(m.positions[t[0]]);
            const vec3 n = cross(v3_load(m.positions[t[1]]) - p, v3_load(m.positions[t[2]]) - p);
            CHECK(dot(n, p) > 0 && dot(n, v3_load(m.normals[t[1]])) > 0);
        }
        mesh_finish(&m);
    }
}

static void rectangle_is_mitsubas(void) {
    struct mesh m;
    mesh_make_rectangle(&m);
    CHECK(m.vertex_count == 4 && m.triangle_count == 2);
    for (uint32_t i = 0; i < 4; i++) {
        CHECK(m.normals[i][2] == 1 && m.positions[i][2] == 0);
        CHECK(m.positions[i][0] == 2 * m.uvs[i][0] - 1 && m.positions[i][1] == 2 * m.uvs[i][1] - 1);
    }
    double area = 0;
    for (uint32_t i = 0; i < 2; i++) {
        const vec3 p = v3_load(m.positions[m.indices[i][0]]);
        area += cross(v3_load(m.positions[m.indices[i][1]]) - p,
                      v3_load(m.positions[m.indices[i][2]]) - p)[2] / 2;
    }
    CHECK(area == 4); // also: both wind around +z
    mesh_finish(&m);
}

static void cube_covers_each_side_with_the_unit_square(void) {
    struct mesh m;
    double area[3][2] = {{0}}, uv_area = 0;
    mesh_make_cube(&m);
    CHECK(m.vertex_count == 24 && m.triangle_count == 12);
    for (uint32_t i = 0; i < 12; i++) {
        const uint32_t *t = m.indices[i];
        const vec3 p = v3_load(m.positions[t[0]]);
        const vec3 n = cross(v3_load(m.positions[t[1]]) - p, v3_load(m.positions[t[2]]) - p);
        for (int k = 0; k < 3; k++)
            area[k][n[k] > 0] += fabsf(n[k]) / 2;
        const float *a = m.uvs[t[0]], *b = m.uvs[t[1]], *c = m.uvs[t[2]];
        uv_area += fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    for (int k = 0; k < 3; k++)
        CHECK(area[k][0] == 4 && area[k][1] == 4);
    CHECK(uv_area == 6);
    mesh_finish(&m);
}

int main(void) {
    normals_weigh_by_angle_not_by_number_of_faces();
    normals_do_not_depend_on_scale();
    normals_of_a_cube_point_outwards();
    computed_normals_follow_a_transform();
    given_normals_transform_by_the_inverse_transpose();
    mirroring_keeps_normals_on_the_outside();
    rectangle_is_mitsubas();
    cube_covers_each_side_with_the_unit_square();
    return check_result();
}
