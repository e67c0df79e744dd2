// SPDX-License-Identifier: Apache-2.0
#include "bsdf/bsdf.h"

#include <assert.h>

static const struct entry *const entries[] = {
#define X(name) &bsdf_##name.entry,
#include "bsdf/list.h"
#undef X
    NULL,
};

const struct registry bsdfs = {"bsdf", entries};

void *closure_alloc(struct closure_stack *stack, const struct bsdf_type *type, size_t size,
                    uint32_t lobes) {
    const size_t bytes = (size + 15) & ~(size_t)15;
    assert(stack->used + bytes <= sizeof stack->bytes);
    struct closure *c = (void *)(stack->bytes + stack->used);
    stack->used += bytes;
    c->type = type;
    c->lobes = lobes;
    return c;
}
