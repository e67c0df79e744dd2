// SPDX-License-Identifier: Apache-2.0
#include "bsdf/bsdf.h"

#include <assert.h>
#include <string.h>

static const struct entry *const entries[] = {
#define X(name) &bsdf_##name.entry,
#include "bsdf/list.h"
#undef X
    NULL,
};

const struct registry bsdfs = {"bsdf", entries};

// A closure takes at most this much of the stack.
enum { CLOSURE_BYTES = 384, MOST_NESTED = sizeof((struct closure_stack *)0)->bytes / CLOSURE_BYTES };

// Number of materials in the tree under o, o included; stops counting above the limit.
static int count_nested(const struct object *o, int count) {
    count++;
    for (const struct param *p = o->type->params; p && p->name && count <= MOST_NESTED; p++) {
        if (p->type != PARAM_BSDF)
            continue;
        const struct object *child;
        memcpy(&child, (const char *)o->data + p->offset, sizeof child);
        if (child)
            count = count_nested(child, count);
    }
    return count;
}

bool bsdf_check_nesting(const struct object *o) {
    if (count_nested(o, 0) <= MOST_NESTED)
        return true;
    log_error_at(o->at, "%s: more than %d materials are nested", o->type->name, MOST_NESTED);
    return false;
}

void *closure_alloc(struct closure_stack *stack, const struct bsdf_type *type, size_t size,
                    uint32_t lobes) {
    const size_t bytes = (size + 15) & ~(size_t)15;
    assert(size <= CLOSURE_BYTES && stack->used + bytes <= sizeof stack->bytes);
    struct closure *c = (void *)(stack->bytes + stack->used);
    stack->used += bytes;
    c->type = type;
    c->lobes = lobes;
    return c;
}

spectrum closure_eval_delta(const struct closure *c, vec3 wi, float *pdf_sa) {
    (void)c;
    (void)wi;
    *pdf_sa = 0;
    return spectrum_grey(0);
}
