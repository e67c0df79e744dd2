// SPDX-License-Identifier: Apache-2.0
// A later hop of the symbolic response (integrator/symbolic.h) whose terms have factors of their own: each
// reflects to where it did, and edits change how much. Directions are drawn as the material does as it
// is, so every mark that the path came with goes on by every term, weighted by what that term reflects
// there; products that are the same in another order become one.
#pragma once

#include "integrator/symbolic.h"

const struct closure *symbolic_resolve_terms(const struct symbolic *self, struct chain *chain,
                                             const struct symbolic_object *o, const struct surface *s,
                                             vec3 wo, struct closure_stack *stack);
