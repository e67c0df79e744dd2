// SPDX-License-Identifier: Apache-2.0
#include "world/unseen.h"

#include "bsdf/bsdf.h"

// Whether anything but constants decides what the material does.
static bool varies(const struct object *bsdf) {
    for (const struct param *p = bsdf->type->params; p && p->name; p++) {
        const struct texture_ref *ref = (const void *)((const char *)bsdf->data + p->offset);
        const bool is_texture = p->type == PARAM_TEXTURE || p->type == PARAM_TEXTURE_SCALAR;
        if (p->type == PARAM_BSDF || (is_texture && ref->texture))
            return true;
    }
    return false;
}

static bool is_unseen(const struct shape *s) {
    const struct bsdf_type *type = bsdf_type_of(s->bsdf);
    if (s->light != SCENE_NONE || s->interior != SCENE_NONE || s->exterior != SCENE_NONE)
        return false;
    if (type->lobes(s->bsdf->data) != (LOBE_NULL | LOBE_TRANSMISSION) || varies(s->bsdf))
        return false;
    const struct bsdf_point point = {.frame = {v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)}};
    const spectrum through = bsdf_null_transmittance(s->bsdf, &point, v3(0, 0, 1));
    return spectrum_min(through) == 1 && spectrum_max(through) == 1;
}

void world_drop_unseen(struct scene *s) {
    for (uint32_t i = 0; i < s->shape_count; i++) {
        struct shape *shape = &s->shapes[i];
        if (!is_unseen(shape))
            continue;
        mesh_finish(&shape->mesh);
        shape->mesh = (struct mesh){0};
        shape->kind = SHAPE_MESH;
    }
}
