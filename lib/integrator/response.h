// SPDX-License-Identifier: Apache-2.0
// The response of a surface, as an integrator asks for it.
//
// The physical response answers with the material itself. Another response may answer with the
// values of a basis in place of the material, for precomputation; integrators never know which.
#pragma once

#include "world/world.h"

struct trace_context;

struct response {
    // The material at a surface seen from wo (local), on ctx->stack; NULL: black. `depth` counts the
    // scattering events of the lane's path before this one.
    const struct closure *(*resolve)(const struct response *self, const struct trace_context *ctx,
                                     int lane, uint32_t depth, const struct surface *s, vec3 wo);
    // Whether the material by which the world shades a shape's points together
    // (world_shape.wide_kind) is the answer there. NULL: never.
    bool (*is_wide)(const struct response *self, const struct trace_context *ctx, int lane,
                    uint32_t depth, uint32_t shape);
    // Takes note of a vertex that is shaded so, in place of resolve. NULL: nothing to note.
    void (*note)(const struct response *self, const struct trace_context *ctx, int lane,
                 uint32_t depth, uint32_t shape);
};

extern const struct response response_physical;
