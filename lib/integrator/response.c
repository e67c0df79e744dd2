// SPDX-License-Identifier: Apache-2.0
#include "integrator/response.h"

static const struct closure *resolve(const struct response *self, const struct surface *s, vec3 wo,
                                     struct closure_stack *stack) {
    (void)self;
    return bsdf_resolve(s->bsdf, &s->point, wo, stack);
}

const struct response response_physical = {resolve};
