// SPDX-License-Identifier: Apache-2.0
// Media that stand in shapes, in the sensor or directly in the scene.
#include "scene/reader.h"

static uint32_t find(const struct reader *r, const struct object *o) {
    for (size_t i = 0; i < r->media.count; i++)
        if (LIST_AT(&r->media, struct object *, i) == o)
            return (uint32_t)i;
    return SCENE_NONE;
}

uint32_t medium_read(struct reader *r, struct xml_node *target, struct id_entry *entry) {
    const struct object *o =
        object_shared(r, r->options->registries.media, &r->media, target, entry);
    return o ? find(r, o) : SCENE_NONE;
}
