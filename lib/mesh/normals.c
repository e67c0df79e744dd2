// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "mesh/reader.h"

// Doubles throughout: squares of edges of 1e-30 and of 1e30 must be normal numbers.
struct d3 {
    double x, y, z;
};

static struct d3 edge(const float a[3], const float b[3]) {
    return (struct d3){(double)b[0] - a[0], (double)b[1] - a[1], (double)b[2] - a[2]};
}

static double dot3(struct d3 a, struct d3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct d3 cross3(struct d3 a, struct d3 b) {
    return (struct d3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Adds a face's unit normal to its vertices. With twice the area A = |a x b| of the triangle, the
// angle between sides a and b is atan2(A, a.b): exact for needles, where acos is not.
static void add_face(struct mesh *m, const uint32_t face[3]) {
    const float *p[3];
    for (int k = 0; k < 3; k++)
        p[k] = m->positions[face[k]];
    const struct d3 side[3] = {edge(p[0], p[1]), edge(p[1], p[2]), edge(p[2], p[0])};
    const struct d3 n = cross3(side[0], side[1]);
    const double area = sqrt(dot3(n, n));
    if (!(area > 0 && area < INFINITY))
        return;
    for (int k = 0; k < 3; k++) {
        const double angle = atan2(area, -dot3(side[k], side[(k + 2) % 3]));
        float *sum = m->normals[face[k]];
        sum[0] += (float)(n.x / area * angle);
        sum[1] += (float)(n.y / area * angle);
        sum[2] += (float)(n.z / area * angle);
    }
}

// false: its length is zero, n is unchanged.
static bool make_unit(float n[3]) {
    const double l = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
    if (!(l > 0))
        return false;
    for (int k = 0; k < 3; k++)
        n[k] = (float)(n[k] / l);
    return true;
}

void mesh_compute_normals(struct mesh *m) {
    mem_free(m->normals);
    m->normals = mem_array(m->vertex_count, sizeof *m->normals);
    m->normals_computed = true;
    for (uint32_t i = 0; i < m->triangle_count; i++)
        add_face(m, m->indices[i]);
    for (uint32_t i = 0; i < m->vertex_count; i++)
        if (!make_unit(m->normals[i]))
            m->normals[i][0] = 1;
}

// Normals of length zero become computed ones; the others become unit.
static void repair_normals(struct mesh *m) {
    uint32_t missing = 0;
    for (uint32_t i = 0; i < m->vertex_count; i++)
        missing += !make_unit(m->normals[i]);
    if (missing == 0)
        return;
    float(*given)[3] = m->normals;
    m->normals = NULL;
    mesh_compute_normals(m);
    for (uint32_t i = 0; i < m->vertex_count; i++)
        if (given[i][0] != 0 || given[i][1] != 0 || given[i][2] != 0)
            memcpy(m->normals[i], given[i], sizeof given[i]);
    mem_free(given);
    m->normals_computed = false;
}

float (*mesh_alloc_positions(size_t count))[3] {
    return mem_array(count + 1, 3 * sizeof(float));
}

bool mesh_complete(struct mesh *m, const char *path, const struct mesh_options *options,
                   bool flips) {
    if (m->triangle_count == 0) {
        log_error("%s: holds no faces, expected at least one", path);
        return false;
    }
    for (uint32_t i = 0; flips && m->uvs && i < m->vertex_count; i++)
        m->uvs[i][1] = 1 - m->uvs[i][1];
    if (options->face_normals) {
        mem_free(m->normals);
        m->normals = NULL;
    } else if (m->normals) {
        repair_normals(m);
    } else {
        mesh_compute_normals(m);
    }
    return true;
}

struct mesh_attribute *mesh_add_attribute(struct mesh *m, const char *path, const char *name,
                                          int channels, size_t count) {
    if (mesh_find_attribute(m, name)) {
        log_warn("%s: a second attribute %s is skipped", path, name);
        return NULL;
    }
    struct mesh_attribute *bigger = mem_array(m->attribute_count + 1, sizeof *bigger);
    if (m->attribute_count)
        memcpy(bigger, m->attributes, m->attribute_count * sizeof *bigger);
    mem_free(m->attributes);
    m->attributes = bigger;
    struct mesh_attribute *a = &bigger[m->attribute_count++];
    strncpy(a->name, name, sizeof a->name - 1);
    a->channels = channels;
    a->per_face = strncmp(name, "face_", 5) == 0;
    a->data = mem_array(count, (size_t)channels * sizeof(float));
    return a;
}

bool mesh_is_flat(const struct mesh *m) {
    const double tolerance = 1e-6;
    for (uint32_t t = 0; m->normals && t < m->triangle_count; t++) {
        const uint32_t *i = m->indices[t];
        const struct d3 n = cross3(edge(m->positions[i[0]], m->positions[i[1]]),
                                   edge(m->positions[i[0]], m->positions[i[2]]));
        const double length = sqrt(dot3(n, n));
        for (int k = 0; k < 3; k++) {
            const float *given = m->normals[i[k]];
            if (!(fabs(given[0] * length - n.x) <= tolerance * length &&
                  fabs(given[1] * length - n.y) <= tolerance * length &&
                  fabs(given[2] * length - n.z) <= tolerance * length && length > 0))
                return false;
        }
    }
    return true;
}
