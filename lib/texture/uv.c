// SPDX-License-Identifier: Apache-2.0
#include "texture/uv.h"

void uv_prepare(struct uv_mapping *map) {
    const double scale[2] = {map->uscale, map->vscale};
    const double offset[2] = {map->uoffset, map->voffset};
    map->identity = true;
    for (int i = 0; i < 2; i++) {
        double moved = map->to_uv.m[i][3];
        for (int j = 0; j < 2; j++) {
            map->m[i][j] = (float)(map->to_uv.m[i][j] * scale[j]);
            moved += map->to_uv.m[i][j] * offset[j];
            map->identity = map->identity && map->m[i][j] == (i == j);
        }
        map->m[i][2] = (float)moved;
        map->identity = map->identity && moved == 0;
    }
}
