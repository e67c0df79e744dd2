// SPDX-License-Identifier: Apache-2.0
// The response of a surface, as an integrator asks for it.
//
// The physical response answers with the material itself. Another response may answer with the
// values of a basis in place of the material, for precomputation; integrators never know which.
#pragma once

#include "world/world.h"

struct trace_context;

enum response_way {
    RESPONSE_ALONE, // one by one, by resolve
    RESPONSE_WORLD, // together, by the world's material
    RESPONSE_OWN,   // together, by the response's
};

struct response {
    // The material at a surface seen from wo (local), on ctx->stack; NULL: black. `depth` counts the
    // scattering events of the lane's path before this one.
    const struct closure *(*resolve)(const struct response *self, const struct trace_context *ctx,
                                     int lane, uint32_t depth, const struct surface *s, vec3 wo);
    // How a shape's points, which the world shades together (world_shape.wide_kind), are shaded
    // here. NULL: one by one.
    enum response_way (*way)(const struct response *self, const struct trace_context *ctx, int lane,
                             uint32_t depth, uint32_t shape);
    const struct wide_bsdf *own; // of RESPONSE_OWN
    // Takes note of a vertex that is shaded together, in place of resolve; returns the data of its
    // material, of which the world knows where that is the world's. NULL: nothing to note.
    const void *(*note)(const struct response *self, const struct trace_context *ctx, int lane,
                        uint32_t depth, uint32_t shape);
};

extern const struct response response_physical;
