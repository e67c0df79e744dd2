// SPDX-License-Identifier: Apache-2.0
#include "mesh/mesh.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"

static const struct entry *const entries[] = {
#define X(name) &mesh_reader_##name.entry,
#include "mesh/list.h"
#undef X
    NULL,
};

const struct registry mesh_readers = {"mesh format", entries};

const struct mesh_reader_type *mesh_reader_for(const char *path) {
    char extension[16];
    file_extension(path, extension, sizeof extension);
    for (const struct entry *const *e = entries; *e; e++) {
        const struct mesh_reader_type *type = (const void *)*e;
        for (const char *const *x = type->extensions; *x; x++)
            if (strcmp(*x, extension) == 0)
                return type;
    }
    log_error("%s: is not a mesh format that is read (obj, ply, serialized)", path);
    return NULL;
}

void mesh_finish(struct mesh *m) {
    mem_free(m->positions);
    mem_free(m->normals);
    mem_free(m->uvs);
    mem_free(m->indices);
    for (uint32_t i = 0; i < m->attribute_count; i++)
        mem_free(m->attributes[i].data);
    mem_free(m->attributes);
    *m = (struct mesh){0};
}

const struct mesh_attribute *mesh_find_attribute(const struct mesh *m, const char *name) {
    for (uint32_t i = 0; i < m->attribute_count; i++)
        if (strcmp(m->attributes[i].name, name) == 0)
            return &m->attributes[i];
    return NULL;
}

static void transform_unit_normal(const struct transform *inverse, float n[3], double sign) {
    const double in[3] = {n[0], n[1], n[2]};
    double out[3];
    transform_normal(inverse, in, out);
    const double l = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int k = 0; k < 3; k++)
        n[k] = l > 0 ? (float)(sign * out[k] / l) : 0;
}

bool mesh_transform(struct mesh *m, const struct transform *to_world) {
    struct transform inverse;
    if (!transform_invert(to_world, &inverse))
        return false;
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        float *p = m->positions[i];
        const double in[3] = {p[0], p[1], p[2]};
        double out[3];
        transform_point(to_world, in, out);
        for (int k = 0; k < 3; k++)
            p[k] = (float)out[k];
    }
    if (transform_determinant3(to_world) < 0)
        for (uint32_t i = 0; i < m->triangle_count; i++) {
            const uint32_t swap = m->indices[i][1];
            m->indices[i][1] = m->indices[i][2];
            m->indices[i][2] = swap;
        }
    // angles, and with them weights, are those of the transformed mesh
    if (m->normals_computed)
        mesh_compute_normals(m);
    else
        for (uint32_t i = 0; m->normals && i < m->vertex_count; i++)
            transform_unit_normal(&inverse, m->normals[i], 1);
    return true;
}
