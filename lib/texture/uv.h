// SPDX-License-Identifier: Apache-2.0
// The mapping from a surface's (u, v) to a texture's that textures share.
#pragma once

#include "math/transform.h"
#include "texture/texture.h"

// Parameters, and after uv_prepare their product as a 2x3 matrix.
struct uv_mapping {
    struct transform to_uv;                   // only x, y and the translation count
    float uscale, vscale, uoffset, voffset;   // Mitsuba 0.5/0.6; applied first
    float m[2][3];
    bool identity;
};

#define UV_PARAMS(type, member)                                                                    \
    {"to_uv", PARAM_TRANSFORM, offsetof(type, member.to_uv), .def = "identity", .unit = "",       \
     .help = "transform of texture coordinates"},                                                  \
    {"uscale", PARAM_FLOAT, offsetof(type, member.uscale), .def = "1", .unit = "",                \
     .help = "factor on u"},                                                                       \
    {"vscale", PARAM_FLOAT, offsetof(type, member.vscale), .def = "1", .unit = "",                \
     .help = "factor on v"},                                                                       \
    {"uoffset", PARAM_FLOAT, offsetof(type, member.uoffset), .def = "0", .unit = "",              \
     .help = "added to u"},                                                                        \
    {"voffset", PARAM_FLOAT, offsetof(type, member.voffset), .def = "0", .unit = "",              \
     .help = "added to v"}

void uv_prepare(struct uv_mapping *map);

static inline struct vec2 uv_apply(const struct uv_mapping *map, struct vec2 uv) {
    if (map->identity)
        return uv;
    return (struct vec2){map->m[0][0] * uv.x + map->m[0][1] * uv.y + map->m[0][2],
                         map->m[1][0] * uv.x + map->m[1][1] * uv.y + map->m[1][2]};
}

// A gradient in the texture's coordinates, as one in the surface's.
static inline struct vec2 uv_gradient(const struct uv_mapping *map, struct vec2 g) {
    return (struct vec2){map->m[0][0] * g.x + map->m[1][0] * g.y,
                         map->m[0][1] * g.x + map->m[1][1] * g.y};
}
