// SPDX-License-Identifier: Apache-2.0
#include "volume/bounds.h"

enum { CELL = 8, MOST_CELLS = 128 };

static void raise(const struct bounds_source *s, const int range[3][2], float *most) {
    const struct grid *g = s->grid;
    for (int z = range[2][0]; z <= range[2][1]; z++)
        for (int y = range[1][0]; y <= range[1][1]; y++)
            for (int x = range[0][0]; x <= range[0][1]; x++) {
                const size_t i = ((size_t)s->index(s->user, 2, z) * (size_t)g->size[1] +
                                  (size_t)s->index(s->user, 1, y)) * (size_t)g->size[0] +
                                 (size_t)s->index(s->user, 0, x);
                for (int c = 0; c < g->channels; c++)
                    most[c] = maxf(most[c], g->values[i * (size_t)g->channels + (size_t)c]);
            }
}

void bounds_build(struct volume_bounds *b, const struct bounds_source *source,
                  const struct affine *to_voxels, struct arena *arena) {
    const struct grid *g = source->grid;
    vec3 scale = {0};
    for (int k = 0; k < 3; k++) {
        const int n = (g->size[k] + CELL / 2) / CELL;
        b->cells[k] = n < 1 ? 1 : n > MOST_CELLS ? MOST_CELLS : n;
        scale[k] = (float)b->cells[k] / (float)g->size[k];
    }
    b->to_local = (struct affine){to_voxels->x * scale, to_voxels->y * scale,
                                  to_voxels->z * scale, to_voxels->o * scale};
    b->lanes = g->channels;
    const size_t cells = (size_t)b->cells[0] * (size_t)b->cells[1] * (size_t)b->cells[2];
    float *most = arena_alloc(arena, cells * (size_t)b->lanes * sizeof *most);
    b->most = most;
    for (int z = 0; z < b->cells[2]; z++)
        for (int y = 0; y < b->cells[1]; y++)
            for (int x = 0; x < b->cells[0]; x++, most += b->lanes) {
                const int cell[3] = {x, y, z};
                int range[3][2];
                for (int k = 0; k < 3; k++)
                    source->range(source->user, k, (float)cell[k] / scale[k],
                                  (float)(cell[k] + 1) / scale[k], range[k]);
                raise(source, (const int (*)[2])range, most);
            }
}

spectrum bounds_maximum(const struct volume_bounds *b) {
    const size_t cells = (size_t)b->cells[0] * (size_t)b->cells[1] * (size_t)b->cells[2];
    spectrum most = {0};
    for (size_t i = 0; i < cells; i++)
        for (int k = 0; k < SPECTRUM_LANES; k++)
            most[k] = maxf(most[k], b->most[i * (size_t)b->lanes + (size_t)(b->lanes == 1 ? 0 : k)]);
    return most;
}
