// SPDX-License-Identifier: Apache-2.0
#include "bsdf/bsdf_wide.h"

struct wide3 wide_textures(const struct wide_points *points, size_t offset) {
    const float *row[WIDE_LANES];
    spectrum textured[WIDE_LANES];
    wide f[4];
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct texture_ref *r = (const void *)((const char *)points->data[i] + offset);
        row[i] = (const float *)(const void *)&r->value;
        if (r->texture) {
            textured[i] = texture_eval(r, &points->at[i]);
            row[i] = (const float *)(const void *)&textured[i];
        }
    }
    wide_gather4(row, f);
    return (struct wide3){f[0], f[1], f[2]};
}
