// SPDX-License-Identifier: Apache-2.0
#include "volume/volume.h"

static const struct entry *const entries[] = {
#define X(name) &volume_##name.entry,
#include "volume/list.h"
#undef X
    NULL,
};

const struct registry volumes = {"volume", entries};

const struct volume_bounds *volume_bounds(const struct volume_ref *r) {
    const struct volume_type *type = r->volume ? volume_type_of(r->volume) : NULL;
    return type && type->bounds ? type->bounds(r->volume->data) : NULL;
}
