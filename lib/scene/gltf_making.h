// SPDX-License-Identifier: Apache-2.0
// A material of glTF while it is made, and its parameters: factors, textures, or products of both.
#pragma once

#include "scene/gltf.h"

// A material while it is made.
struct gltf_making {
    struct gltf *g;
    struct reader *r;
    const struct json *material, *pbr;
    const struct json *transmission, *volume, *clearcoat, *sheen, *anisotropy, *specular;
    int colour_channels; // of COLOR_0: 0, 3, 4
    double base[4], metallic, roughness, eta;
    struct gltf_material *out;
};

// The texture under that key, with the UV set it asks for noted; NULL: none.
const struct json *gltf_texture_of(const struct gltf_making *m, const struct json *object,
                                   const char *key);
// Adds the parameter `name`: a factor of 1 or 3 channels, times a texture's channel (NULL: colours)
// where there is one. false after an error message.
bool gltf_add_factor(const struct gltf_making *m, struct xml_node *parent, const char *name,
                     const double *factor, int channels, const struct json *info,
                     const char *channel, bool raw);
bool gltf_add_number(const struct gltf_making *m, struct xml_node *parent, const char *name,
                     double factor, const struct json *info, const char *channel);
// A parent for one factor of a product with a vertex attribute, which is put in already.
struct xml_node *gltf_under_attribute(const struct gltf_making *m, struct xml_node *parent,
                                      const char **name, const char *attribute);
bool gltf_add_base_colour(const struct gltf_making *m, struct xml_node *node, const char *name);
// Whether all factors are 1.
bool gltf_is_white(const double *v, int count);
