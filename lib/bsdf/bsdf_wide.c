// SPDX-License-Identifier: Apache-2.0
#include "bsdf/bsdf_wide.h"

static const struct texture_ref *texture_of(const struct wide_points *points, size_t offset,
                                            int lane) {
    return (const void *)((const char *)points->data[lane] + offset);
}

struct wide3 wide_textures(const struct wide_points *points, size_t offset) {
    const float *row[WIDE_LANES];
    spectrum textured[WIDE_LANES];
    wide f[4];
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct object *t = texture_of(points, offset, i)->texture;
        if (t && texture_type_of(t)->send_for)
            texture_type_of(t)->send_for(t->data, &points->at[i]);
    }
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct texture_ref *r = texture_of(points, offset, i);
        row[i] = (const float *)(const void *)&r->value;
        if (r->texture) {
            textured[i] = texture_eval(r, &points->at[i]);
            row[i] = (const float *)(const void *)&textured[i];
        }
    }
    wide_gather4(row, f);
    return (struct wide3){f[0], f[1], f[2]};
}
