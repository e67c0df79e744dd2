// SPDX-License-Identifier: Apache-2.0
// A wrapper that asks the film for the second moments of another integrator's samples.
#include "integrator/integrator.h"

struct moment {
    const struct object *nested;
};

static const struct param params[] = {
    {"integrator", PARAM_INTEGRATOR, offsetof(struct moment, nested), .unit = "",
     .help = "the integrator whose samples are measured"},
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static bool prepare(struct object *self, struct integrator_wants *wants) {
    const struct moment *m = self->data;
    const struct integrator_type *nested = integrator_type_of(m->nested);
    wants->moments = true;
    return !nested->prepare || nested->prepare((struct object *)m->nested, wants);
}

static void trace(const void *data, struct trace_context *ctx,
                  const struct path_start starts[SINK_LANES]) {
    const struct moment *m = data;
    integrator_type_of(m->nested)->trace(m->nested->data, ctx, starts);
}

const struct integrator_type integrator_moment = {
    .entry = {.name = "moment", .help = "second moments of a nested integrator, as layer m2",
              .params = params, .size = sizeof(struct moment)},
    .prepare = prepare, .trace = trace, .meters = true,
};
