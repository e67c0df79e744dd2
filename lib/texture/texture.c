// SPDX-License-Identifier: Apache-2.0
#include "texture/texture.h"

static const struct entry *const entries[] = {
#define X(name) &texture_##name.entry,
#include "texture/list.h"
#undef X
    NULL,
};

const struct registry textures = {"texture", entries};

void texture_range_add(struct texture_range *range, spectrum value) {
    for (int c = 0; c < 3; c++) {
        range->least[c] = minf(range->least[c], value[c]);
        range->most[c] = maxf(range->most[c], value[c]);
    }
}

void texture_size(const struct object *texture, int *width, int *height) {
    const struct texture_type *type = texture_type_of(texture);
    *width = *height = 1;
    if (type->size)
        type->size(texture->data, width, height);
}

struct vec2 texture_gradient(const struct texture_ref *r, const struct texture_point *at) {
    if (!r->texture)
        return (struct vec2){0, 0};
    const struct texture_type *type = texture_type_of(r->texture);
    if (type->gradient)
        return type->gradient(r->texture->data, at);
    const float h = 1e-3f;
    struct texture_point a = *at, b = *at;
    a.uv.x -= h;
    b.uv.x += h;
    const float du = texture_eval_scalar(r, &b) - texture_eval_scalar(r, &a);
    a.uv = b.uv = at->uv;
    a.uv.y -= h;
    b.uv.y += h;
    const float dv = texture_eval_scalar(r, &b) - texture_eval_scalar(r, &a);
    return (struct vec2){du / (2 * h), dv / (2 * h)};
}
