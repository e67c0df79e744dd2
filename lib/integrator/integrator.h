// SPDX-License-Identifier: Apache-2.0
// Integrators: the order in which a path is sampled, connected to lights and handed to the sink.
//
// Paths are traced together by groups of 16 that start side by side, so that camera and shadow rays
// may run as packets; each lane's random numbers and contributions are those it would have alone.
// What a group gives may not depend on the other groups of a call.
// Depth counts path edges as Mitsuba does: max_depth 1 sees emitters only, 2 adds direct light,
// -1 is unlimited. A surface that is passed straight through (a mask) ends an edge too, as there.
#pragma once

#include "integrator/response.h"
#include "math/ray.h"
#include "sampler/sampler.h"
#include "sink/sink.h"
#include "world/world.h"

struct path_start {
    struct ray ray;
    struct sampler sampler; // after the sensor took its dimensions
    // What the ray has found already, of a meter that is no shape of the scene; NULL: to be traced.
    // The same for all of a call.
    const struct surface *surface;
};

// What one worker needs, and counts.
struct trace_context {
    const struct world *world;
    const struct response *response;
    struct sink *sink;
    struct closure_stack *stack;
    uint32_t lanes; // of this call: a multiple of SINK_LANES, at most what the type declares
    uint64_t rays, shadow_rays, paths;
    uint64_t truncated; // paths that met the hard cap on events: the picture is too dark there
};

static inline const struct closure *response_resolve(const struct trace_context *ctx, int lane,
                                                     uint32_t depth, const struct surface *s,
                                                     vec3 wo) {
    ctx->stack->used = 0;
    return ctx->response->resolve(ctx->response, ctx, lane, depth, s, wo);
}

// A path of unlimited depth that neither leaves nor dies is cut here, and counted.
enum { INTEGRATOR_MOST_EVENTS = 4096 };

// What an integrator wants the film to keep, filled by prepare.
struct integrator_wants {
    bool moments;
    uint32_t aovs; // enum film_aov
    enum light_choice_mode light_choice;
};

struct integrator_type {
    struct entry entry;
    // Checks the parameters. false after an error message. NULL: nothing to do.
    bool (*prepare)(struct object *self, struct integrator_wants *wants);
    void (*trace)(const void *data, struct trace_context *ctx, const struct path_start *starts);
    // Looks at the world before lights are chosen and anything is traced, and may put lights of its own
    // in the place of infinite ones; what it makes lives in the arena. false after an error message.
    // NULL: nothing to do. (integrator_enter reaches nested ones.)
    bool (*enter)(struct object *self, struct world *w, struct arena *arena);
    // What it has to keep for its picture, after enter. NULL: it is not what it keeps that counts.
    uint64_t (*bytes)(const void *data);
    uint32_t most_lanes; // of one call; 0: SINK_LANES
    bool sees_media;
    bool meters; // heeds path_start.surface, or its nested integrator does
};

// How lights are chosen, for integrators that sample them: an int, to be passed on by prepare.
#define INTEGRATOR_LIGHT_CHOICE(type, member)                                                      \
    {"light_choice", PARAM_CHOICE, offsetof(type, member), .def = "auto", .unit = "",              \
     .help = "auto: by a light tree where lights, or triangles that emit, are many",               \
     .choices = light_choice_modes}

// How other renderers cut up their work; here it cannot change the picture.
#define INTEGRATOR_IGNORED                                                                         \
    {"samples_per_pass", PARAM_IGNORED}, {"timeout", PARAM_IGNORED}, {"block_size", PARAM_IGNORED}

#define X(name) extern const struct integrator_type integrator_##name;
#include "integrator/list.h"
#undef X

extern const struct registry integrators;

// Finds what is seen first, and nothing else.
extern const struct object integrator_first_hits;

// Whether an integrator, with what is nested in it, can begin paths at path_start.surface.
bool integrator_meters(const struct object *integrator);
// Whether it makes a picture: one that nests others makes theirs, or none.
bool integrator_lights(const struct object *integrator);

// Lets an integrator and what is nested in it look at the world. Lights are to be chosen after it.
bool integrator_enter(struct object *integrator, struct world *w, struct arena *arena);

static inline const struct integrator_type *integrator_type_of(const struct object *o) {
    return (const struct integrator_type *)o->type;
}
