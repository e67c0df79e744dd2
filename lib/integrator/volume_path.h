// SPDX-License-Identifier: Apache-2.0
// Path tracing through participating media, for the integrators that differ in how they track.
//
// Depth counts scattering events, of surfaces and media; surfaces that are passed straight through
// do not count (as in Mitsuba's volpath; path counts them).
#pragma once

#include "integrator/vertex.h"

struct volume_path {
    int max_depth, rr_depth;
    bool hide_emitters, strict_normals;
    int light_choice;
    bool spectral; // medium/tracking.h: follow one lane and carry the densities of all
};

#define VOLUME_PATH_PARAMS                                                                         \
    {"max_depth", PARAM_INT, offsetof(struct volume_path, max_depth), .def = "-1", .min = -1,      \
     .max = 1e6, .unit = "",                                                                       \
     .help = "most edges of a path: 1 sees emitters, 2 adds direct light; -1: no limit"},          \
        {"rr_depth", PARAM_INT, offsetof(struct volume_path, rr_depth), .def = "3", .min = 1,      \
         .max = 1e6, .unit = "", .help = "edges after which Russian roulette may end a path"},     \
        {"hide_emitters", PARAM_BOOL, offsetof(struct volume_path, hide_emitters), .def = "false", \
         .unit = "", .help = "do not show lights that are seen directly"},                         \
        {"strict_normals", PARAM_BOOL, offsetof(struct volume_path, strict_normals),               \
         .def = "false", .unit = "",                                                               \
         .help = "drop directions on which shading and geometric normal disagree"},                \
        INTEGRATOR_LIGHT_CHOICE(struct volume_path, light_choice),                                 \
        {"version", PARAM_IGNORED}, INTEGRATOR_IGNORED

bool volume_path_prepare(struct object *self, struct integrator_wants *wants);
void volume_path_trace(const void *data, struct trace_context *ctx,
                       const struct path_start starts[SINK_LANES]);
