// SPDX-License-Identifier: Apache-2.0
#include "integrator/integrator.h"

static const struct closure *resolve(const struct response *self, const struct trace_context *ctx,
                                     int lane, uint32_t depth, const struct surface *s, vec3 wo) {
    (void)self, (void)lane, (void)depth;
    return bsdf_resolve(s->bsdf, &s->point, wo, ctx->stack);
}

const struct response response_physical = {.resolve = resolve};
