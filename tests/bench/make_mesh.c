// SPDX-License-Identifier: Apache-2.0
// Makes a binary PLY mesh of about N triangles, and a scene with it, to measure how loading and
// rendering scale.
//
// usage: make_mesh N NAME      writes NAME.ply and NAME.xml
//
// The mesh is a unit sphere with bumps of many sizes: a square grid folded over the sphere like an
// octahedron (Engelhardt and Dachsbacher 2008, Octahedron Environment Maps), so that triangles
// have about equal sizes, and about as many vertices as half the triangles.
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "math/vec.h"

// The point of the unit sphere for (u, v) in [-1, 1]^2.
static vec3 octahedron(float u, float v) {
    float z = 1 - fabsf(u) - fabsf(v), x = u, y = v;
    if (z < 0) {
        x = copysignf(1 - fabsf(v), u);
        y = copysignf(1 - fabsf(u), v);
    }
    return normalize(v3(x, y, z));
}

// Radius over direction: eight octaves of a smooth function of the point, so seams fit.
static float radius(vec3 p) {
    float r = 1, amplitude = 0.06f, frequency = 3;
    for (int i = 0; i < 8; i++, amplitude *= 0.5f, frequency *= 2.1f) {
        const vec3 q = p * frequency;
        r += amplitude * sinf(q[0] + 1.3f * (float)i) * sinf(q[1] + 0.7f) * sinf(q[2] + 2.1f);
    }
    return r;
}

static bool write_mesh(FILE *f, uint32_t n) {
    fprintf(f,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\n"
            "property float y\nproperty float z\nelement face %u\n"
            "property list uchar int vertex_indices\nend_header\n",
            (n + 1) * (n + 1), 2 * n * n);
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++) {
            vec3 p = octahedron(2 * (float)i / (float)n - 1, 2 * (float)j / (float)n - 1);
            p *= radius(p);
            fwrite(&p, sizeof(float), 3, f);
        }
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            // diagonals along the folds of the octahedron
            const bool rising = (i < n / 2) == (j < n / 2);
            const uint32_t two[2][3] = {{a, b, rising ? c : d}, {rising ? b : a, d, c}};
            for (int k = 0; k < 2; k++) {
                fputc(3, f);
                fwrite(two[k], sizeof two[k], 1, f);
            }
        }
    return fclose(f) == 0;
}

static bool write_scene(FILE *f, const char *name) {
    const char *slash = name;
    for (const char *c = name; *c; c++)
        if (*c == '/')
            slash = c + 1;
    fprintf(f,
            "<scene version=\"3.0.0\">\n"
            "    <integrator type=\"path\"><integer name=\"max_depth\" value=\"4\"/></integrator>\n"
            "    <sensor type=\"perspective\">\n"
            "        <float name=\"fov\" value=\"40\"/>\n"
            "        <transform name=\"to_world\">\n"
            "            <lookat origin=\"0, 1, 3.2\" target=\"0, 0, 0\" up=\"0, 1, 0\"/>\n"
            "        </transform>\n"
            "        <film type=\"hdrfilm\">\n"
            "            <integer name=\"width\" value=\"512\"/>\n"
            "            <integer name=\"height\" value=\"512\"/>\n"
            "            <rfilter type=\"box\"/>\n"
            "        </film>\n"
            "        <sampler type=\"independent\"/>\n"
            "    </sensor>\n"
            "    <emitter type=\"constant\"/>\n"
            "    <shape type=\"ply\">\n"
            "        <string name=\"filename\" value=\"%s.ply\"/>\n"
            "        <bsdf type=\"diffuse\"/>\n"
            "    </shape>\n"
            "</scene>\n",
            slash);
    return fclose(f) == 0;
}

int main(int argc, char **argv) {
    char path[4096];
    const double triangles = argc == 3 ? atof(argv[1]) : 0;
    if (!(triangles >= 2 && triangles <= 4e9)) {
        fprintf(stderr, "usage: make_mesh N NAME (N triangles, 2 to 4e9)\n");
        return 2;
    }
    const uint32_t n = 2 * (uint32_t)fmax(1, round(sqrt(triangles / 2) / 2)); // even: folds fit
    snprintf(path, sizeof path, "%s.ply", argv[2]);
    FILE *mesh = fopen(path, "wb");
    if (!mesh || !write_mesh(mesh, n)) {
        perror(path);
        return 1;
    }
    snprintf(path, sizeof path, "%s.xml", argv[2]);
    FILE *scene = fopen(path, "w");
    if (!scene || !write_scene(scene, argv[2])) {
        perror(path);
        return 1;
    }
    printf("%s.ply: %u triangles, %u vertices\n", argv[2], 2 * n * n, (n + 1) * (n + 1));
    return 0;
}
