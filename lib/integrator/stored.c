// SPDX-License-Identifier: Apache-2.0
// The picture of an edit tensor of the scene, stored within a budget (replay/budget.h): nothing is
// traced, so that a study of budgets shows what storage costs and adds, without any noise.
#include "base/mem.h"
#include "integrator/integrator.h"
#include "replay/budget.h"

static const char *const trials[] = {"none", "dull", "broad", "sharp", NULL}; // of replay/trial.h

struct stored {
    const char *filename;
    float relmse;
    int trial;
    // made by enter
    int width, height;
    float *frame; // three planes
    uint64_t bytes;
};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct stored, filename), .optional = true,
     .help = "the tensor"},
    {"budget", PARAM_FLOAT, offsetof(struct stored, relmse), .def = "0", .min = 0, .max = 1e6,
     .unit = "", .help = "relMSE that storage may add; 0: the tensor as it is"},
    {"edit", PARAM_CHOICE, offsetof(struct stored, trial), .def = "none", .unit = "",
     .help = "all objects become so, far from what they are", .choices = trials},
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static bool prepare(struct object *self, struct integrator_wants *wants) {
    const struct stored *s = self->data;
    (void)wants;
    if (!s->filename)
        log_error_at(self->at, "stored: expected \"filename\", the tensor");
    return s->filename != NULL;
}

static bool enter(struct object *self, struct world *w, struct arena *arena) {
    struct stored *s = self->data;
    struct budget_report report;
    const struct budget_options o = {.relmse = (double)s->relmse, .no_halves = true};
    s->width = w->scene->film.width;
    s->height = w->scene->film.height;
    s->frame = arena_alloc(arena, 3 * (size_t)s->width * (size_t)s->height * sizeof *s->frame);
    if (!budget_picture(s->filename, &o, s->trial, s->width, s->height, s->frame, &report))
        return false;
    s->bytes = report.value_bytes;
    return true;
}

static void trace(const void *data, struct trace_context *ctx, const struct path_start *starts) {
    const struct stored *s = data;
    const size_t plane = (size_t)s->width * (size_t)s->height;
    for (uint32_t lane = 0; lane < ctx->lanes; lane++) {
        const size_t x = starts[lane].sampler.pixel & 0xffff, y = starts[lane].sampler.pixel >> 16;
        if (x >= (size_t)s->width || y >= (size_t)s->height)
            continue;
        const float *at = s->frame + y * (size_t)s->width + x;
        sink_add(ctx->sink, (int)lane,
                 &(struct contribution){.weight = spectrum_grey(1),
                                        .emission = spectrum_rgb(at[0], at[plane], at[2 * plane])});
    }
}

static uint64_t bytes(const void *data) {
    return ((const struct stored *)data)->bytes;
}

const struct integrator_type integrator_stored = {
    .entry = {.name = "stored", .help = "the picture of an edit tensor, stored within a budget",
              .params = params, .size = sizeof(struct stored)},
    .prepare = prepare, .trace = trace, .enter = enter, .bytes = bytes,
};
