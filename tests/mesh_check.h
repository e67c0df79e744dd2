// SPDX-License-Identifier: Apache-2.0
// What holds for every mesh that was read, whatever the file.
#pragma once

#include <math.h>

#include "mesh/mesh.h"

static inline bool all_finite(const float *x, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i]))
            return false;
    return true;
}

// What is wrong with the mesh, or NULL.
static inline const char *mesh_fault(const struct mesh *m) {
    const size_t n = m->vertex_count, t = m->triangle_count;
    if (!m->positions || !m->indices || n == 0 || t == 0)
        return "it is empty";
    for (size_t i = 0; i < 3 * t; i++)
        if (m->indices[i / 3][i % 3] >= n)
            return "an index is out of range";
    if (!all_finite(m->positions[0], 3 * (n + 1))) // the padding belongs to it
        return "a position is not finite";
    if (m->uvs && !all_finite(m->uvs[0], 2 * n))
        return "a texture coordinate is not finite";
    for (size_t i = 0; m->normals && i < n; i++) {
        const float *v = m->normals[i];
        if (!(fabs(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) - 1) < 1e-5))
            return "a normal is not unit";
    }
    for (uint32_t i = 0; i < m->attribute_count; i++) {
        const struct mesh_attribute *a = &m->attributes[i];
        if (a->channels < 1 || a->channels > 3 ||
            !all_finite(a->data, (a->per_face ? t : n) * (size_t)a->channels))
            return "an attribute is not sound";
    }
    return NULL;
}
