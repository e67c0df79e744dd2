// SPDX-License-Identifier: Apache-2.0
// A wrapper that puts the environment as a basis of lighting keeps it in the place of the environment:
// what a relighting tensor of that basis shows, without the noise of one, to study how many terms
// a picture needs.
//
// The first infinite light stands for all: it is sampled where what is kept of the environment is
// bright (integrator/relit_light.h), and contributions that come from it get its emission, which a sink
// in between puts there because it may be negative.
#include "curve/largest.h"
#include "integrator/integrator.h"
#include "integrator/relit_light.h"

enum lighting_basis { AS_IT_IS, PIXELS, HAAR, DAUB4, HARMONICS };

static const char *const bases[] = {"none", "pixels", "haar", "daub4", "sh", NULL};

struct relit {
    const struct object *nested;
    int basis, width, terms;
    // made by enter
    struct source_basis source;
    float *weights;    // unfolded
    uint32_t stand_in; // the first infinite light
    const struct world *world;
};

static const struct param params[] = {
    {"integrator", PARAM_INTEGRATOR, offsetof(struct relit, nested), .unit = "",
     .help = "the integrator that sees the changed environment"},
    {"basis", PARAM_CHOICE, offsetof(struct relit, basis), .def = "none", .unit = "",
     .help = "of `relume precompute relight`; none: the environment as it is", .choices = bases},
    {"columns", PARAM_INT, offsetof(struct relit, width), .def = "64", .min = 2, .max = 256,
     .unit = "", .help = "cells around the horizon (half as many rows); a power of two for wavelets"},
    {"terms", PARAM_INT, offsetof(struct relit, terms), .def = "0", .min = 0, .max = 1 << 16,
     .unit = "", .help = "coefficients that are kept: the largest, of harmonics those of lowest "
                         "order (121 at most); 0: all"},
    INTEGRATOR_IGNORED,
    PARAM_END,
};

static bool prepare(struct object *self, struct integrator_wants *wants) {
    struct relit *r = self->data;
    const struct integrator_type *nested = integrator_type_of(r->nested);
    const bool wavelet = r->basis == HAAR || r->basis == DAUB4;
    if (r->width % 2 || (wavelet && !wavelet_fits((size_t)r->width))) {
        log_error_at(self->at, "relit: found %d columns; expected an even number, of wavelets a power "
                     "of two", r->width);
        return false;
    }
    return !nested->prepare || nested->prepare((struct object *)r->nested, wants);
}

// ---- the environment ----------------------------------------------------------------------------

static struct source_basis source_of(const struct relit *r) {
    struct source_basis b = {.kind = SOURCE_PIXELS, .width = r->width, .height = r->width / 2,
                             .count = (uint32_t)(r->width * (r->width / 2)),
                             .transformed = r->basis != PIXELS,
                             .wavelet = r->basis == DAUB4 ? WAVELET_DAUB4 : WAVELET_HAAR};
    if (r->basis == HARMONICS)
        b = (struct source_basis){.kind = SOURCE_SH, .order = SOURCE_MOST_ORDER,
                                  .count = SOURCE_MOST_SH};
    return b;
}

static bool enter(struct object *self, struct world *w, struct arena *arena) {
    struct relit *r = self->data;
    r->world = w;
    r->stand_in = w->infinite_count > 0 ? w->infinite[0] : UINT32_MAX;
    if (r->basis == AS_IT_IS || w->infinite_count == 0)
        return true;
    r->source = source_of(r);
    r->weights = arena_alloc(arena, 3 * (size_t)r->source.count * sizeof *r->weights);
    lighting_project(&r->source, &(struct sky){world_environment, w, 0}, r->weights);
    const uint32_t kept = (uint32_t)r->terms;
    if (kept > 0 && kept < r->source.count && r->source.kind == SOURCE_SH)
        memset(r->weights + 3 * (size_t)kept, 0, 3 * (r->source.count - kept) * sizeof *r->weights);
    else if (kept > 0 && kept < r->source.count)
        keep_largest(r->weights, r->source.count, kept);
    lighting_unfold(&r->source, r->weights);
    world_replace_light(w, r->stand_in, &relit_light_type,
                        relit_light_make(&r->source, r->weights, w->radius, arena));
    return true;
}

// ---- the sink in between ------------------------------------------------------------------------

struct relit_sink {
    struct sink sink; // first
    struct sink *to;
    const struct relit *relit;
};

static struct sink *behind(struct sink *s) {
    return ((struct relit_sink *)(void *)s)->to;
}

static void add(struct sink *s, int lane, const struct contribution *c) {
    const struct relit_sink *between = (const void *)s;
    const struct relit *r = between->relit;
    struct contribution changed = *c;
    const bool infinite = c->source < r->world->light_count &&
                          r->world->lights[c->source].type->infinite &&
                          !r->world->lights[c->source].type->delta;
    if (infinite)
        changed.emission = c->source == r->stand_in
                               ? lighting_radiance(&r->source, r->weights, c->wi)
                               : spectrum_grey(0);
    sink_add(between->to, lane, &changed);
}

static void surface(struct sink *s, int lane, const struct sink_surface *first) {
    behind(s)->type->surface(behind(s), lane, first);
}

static void covered(struct sink *s, int lane) {
    behind(s)->type->covered(behind(s), lane);
}

static const struct sink_type between_type = {.add = add, .surface = surface, .covered = covered};

static void trace(const void *data, struct trace_context *ctx, const struct path_start *starts) {
    const struct relit *r = data;
    const struct integrator_type *nested = integrator_type_of(r->nested);
    struct sink *to = ctx->sink;
    struct relit_sink between = {{&between_type, to->wants_surface, to->chains}, to, r};
    if (r->weights)
        ctx->sink = &between.sink;
    nested->trace(r->nested->data, ctx, starts);
    ctx->sink = to;
}

const struct integrator_type integrator_relit = {
    .entry = {.name = "relit", .help = "a nested integrator under the environment as a tensor's basis "
                                       "keeps it", .params = params, .size = sizeof(struct relit)},
    .prepare = prepare, .trace = trace, .enter = enter, .meters = true,
};
