// SPDX-License-Identifier: Apache-2.0
// The response of a surface, as an integrator asks for it.
//
// The physical response answers with the material itself. Another response may answer with the
// values of a basis in place of the material, for precomputation; integrators never know which.
#pragma once

#include "world/world.h"

struct response {
    // The material at a surface seen from wo (local); NULL: black.
    const struct closure *(*resolve)(const struct response *self, const struct surface *s, vec3 wo,
                                     struct closure_stack *stack);
};

extern const struct response response_physical;

static inline const struct closure *response_resolve(const struct response *r,
                                                     const struct surface *s, vec3 wo,
                                                     struct closure_stack *stack) {
    stack->used = 0;
    return r->resolve(r, s, wo, stack);
}
