// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_making.h"

#include <string.h>

const struct json *gltf_texture_of(const struct gltf_making *m, const struct json *object,
                                   const char *key) {
    const struct json *info = json_get(object, key);
    if (!info)
        return NULL;
    const int set = gltf_uv_set(info), own = m->out->wants.uv_set;
    if (set != own && set < GLTF_MOST_UV_SETS)
        m->out->wants.more_uvs |= (uint64_t)1 << set;
    if (set != own && strcmp(key, "normalTexture") == 0)
        gltf_warn(m->g, "a normal map is looked up by TEXCOORD_%d, but its tangents follow "
                  "TEXCOORD_%d", set, own);
    return info;
}

bool gltf_is_white(const double *v, int count) {
    for (int i = 0; i < count; i++)
        if (v[i] != 1)
            return false;
    return true;
}

static void add_constant(const struct gltf_making *m, struct xml_node *parent, const char *name,
                         const double *factor, int channels) {
    if (channels == 3)
        tree_triple(m->r, parent, "rgb", name, factor);
    else
        tree_number(m->r, parent, name, factor[0]);
}

bool gltf_add_factor(const struct gltf_making *m, struct xml_node *parent, const char *name,
                     const double *factor, int channels, const struct json *info,
                     const char *channel, bool raw) {
    struct gltf_texture_use use = {name, channel, raw, m->out->wants.uv_set};
    if (!info) {
        add_constant(m, parent, name, factor, channels);
        return true;
    }
    if (gltf_is_white(factor, channels))
        return gltf_add_texture(m->g, m->r, parent, info, &use);
    struct xml_node *product = tree_add(m->r, parent, "texture", "product", NULL);
    xml_set(product, "name", name, m->r->arena);
    use.name = "texture_0";
    const double grey[3] = {factor[0], factor[0], factor[0]};
    tree_triple(m->r, product, "rgb", "texture_1", channels == 3 ? factor : grey);
    return gltf_add_texture(m->g, m->r, product, info, &use);
}

bool gltf_add_number(const struct gltf_making *m, struct xml_node *parent, const char *name,
                     double factor, const struct json *info, const char *channel) {
    return gltf_add_factor(m, parent, name, &factor, 1, info, channel, true);
}

struct xml_node *gltf_under_attribute(const struct gltf_making *m, struct xml_node *parent,
                                      const char **name, const char *attribute) {
    struct xml_node *product = tree_add(m->r, parent, "texture", "product", NULL);
    xml_set(product, "name", *name, m->r->arena);
    struct xml_node *colours = tree_add(m->r, product, "texture", "mesh_attribute", NULL);
    xml_set(colours, "name", "texture_1", m->r->arena);
    tree_text(m->r, colours, "string", "name", attribute);
    *name = "texture_0";
    return product;
}

bool gltf_add_base_colour(const struct gltf_making *m, struct xml_node *node, const char *name) {
    if (m->colour_channels)
        node = gltf_under_attribute(m, node, &name, "vertex_color");
    return gltf_add_factor(m, node, name, m->base, 3,
                           gltf_texture_of(m, m->pbr, "baseColorTexture"), NULL, false);
}
