// SPDX-License-Identifier: Apache-2.0
// The product of two textures, plus a constant: factors of materials that came from other formats.
#include "texture/texture.h"

struct product {
    struct texture_ref factor[2];
    spectrum offset;
};

static const struct param params[] = {
    {"texture_0", PARAM_TEXTURE, offsetof(struct product, factor[0]), .unit = "",
     .help = "the first factor"},
    {"texture_1", PARAM_TEXTURE, offsetof(struct product, factor[1]), .def = "1", .unit = "",
     .help = "the second factor"},
    {"offset", PARAM_INDEX, offsetof(struct product, offset), .def = "0", .unit = "",
     .help = "added to the product"},
    PARAM_END,
};

static spectrum eval(const void *data, const struct texture_point *at) {
    const struct product *self = data;
    return texture_eval(&self->factor[0], at) * texture_eval(&self->factor[1], at) + self->offset;
}

// Exact where one factor is constant.
static spectrum mean(const void *data) {
    const struct product *self = data;
    return texture_mean(&self->factor[0]) * texture_mean(&self->factor[1]) + self->offset;
}

static struct texture_range range(const void *data, const struct mesh *mesh) {
    const struct product *self = data;
    const struct texture_range a = texture_range(&self->factor[0], mesh);
    const struct texture_range b = texture_range(&self->factor[1], mesh);
    struct texture_range products = {a.least * b.least, a.least * b.least};
    texture_range_add(&products, a.least * b.most);
    texture_range_add(&products, a.most * b.least);
    texture_range_add(&products, a.most * b.most);
    return (struct texture_range){products.least + self->offset, products.most + self->offset};
}

static void size(const void *data, int *width, int *height) {
    const struct product *self = data;
    *width = *height = 1;
    for (int i = 0; i < 2; i++) {
        int w = 1, h = 1;
        if (self->factor[i].texture)
            texture_size(self->factor[i].texture, &w, &h);
        *width = w > *width ? w : *width;
        *height = h > *height ? h : *height;
    }
}

const struct texture_type texture_product = {
    .entry = {.name = "product", .help = "two textures multiplied", .params = params,
              .size = sizeof(struct product)},
    .eval = eval, .mean = mean, .range = range, .size = size,
};
