// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "base/mem.h"
#include "mesh/reader.h"

static void take(struct mesh *m, uint32_t vertices, uint32_t triangles) {
    *m = (struct mesh){.vertex_count = vertices, .triangle_count = triangles};
    m->positions = mesh_alloc_positions(vertices);
    m->normals = mem_array(vertices, sizeof *m->normals);
    m->uvs = mem_array(vertices, sizeof *m->uvs);
    m->indices = mem_array(triangles, sizeof *m->indices);
}

void mesh_make_rectangle(struct mesh *m) {
    static const uint32_t faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
    take(m, 4, 2);
    for (int i = 0; i < 4; i++) { // counter-clockwise from (-1, -1)
        m->uvs[i][0] = i == 1 || i == 2;
        m->uvs[i][1] = i >= 2;
        for (int k = 0; k < 2; k++)
            m->positions[i][k] = 2 * m->uvs[i][k] - 1;
        m->normals[i][2] = 1;
    }
    memcpy(m->indices, faces, sizeof faces);
}

// Vertices, uvs and the diagonals of the faces are those of Mitsuba 3 (facts of the format: a
// texture must look the same there).
void mesh_make_cube(struct mesh *m) {
    static const signed char corners[24][3] = {
        {1, -1, -1},  {1, -1, 1},  {-1, -1, 1}, {-1, -1, -1}, // y = -1
        {1, 1, -1},   {-1, 1, -1}, {-1, 1, 1},  {1, 1, 1},    // y = +1
        {1, -1, -1},  {1, 1, -1},  {1, 1, 1},   {1, -1, 1},   // x = +1
        {1, -1, 1},   {1, 1, 1},   {-1, 1, 1},  {-1, -1, 1},  // z = +1
        {-1, -1, 1},  {-1, 1, 1},  {-1, 1, -1}, {-1, -1, -1}, // x = -1
        {1, 1, -1},   {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}, // z = -1
    };
    static const signed char axis[6] = {1, 1, 0, 2, 0, 2}, sign[6] = {-1, 1, 1, 1, -1, -1};
    static const signed char uvs[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    take(m, 24, 12);
    for (int i = 0; i < 24; i++) {
        for (int k = 0; k < 3; k++)
            m->positions[i][k] = corners[i][k];
        for (int k = 0; k < 2; k++)
            m->uvs[i][k] = uvs[i % 4][k];
        m->normals[i][axis[i / 4]] = sign[i / 4];
    }
    for (uint32_t f = 0; f < 6; f++) {
        const uint32_t two[2][3] = {{4 * f, 4 * f + 1, 4 * f + 2}, {4 * f + 3, 4 * f, 4 * f + 2}};
        memcpy(m->indices[2 * f], two, sizeof two);
    }
}
