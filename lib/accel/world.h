// SPDX-License-Identifier: Apache-2.0
// Internal: what `accel.c` builds and `queries.c` asks.
#pragma once

#include "accel/accel.h"
#include "accel/few.h"
#include "accel/placed_quadric.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#define EMBREE_4 1
#else
#include <embree3/rtcore.h>
#define EMBREE_4 0
#endif

#include <stdatomic.h>

struct accel {
    RTCDevice device;
    RTCScene world;
    RTCScene *groups; // one per shapegroup
    uint32_t group_count, shape_count;
    bool has_instances;
    struct placed_quadric *quadrics; // by shape index; NULL: the scene has none
    struct few *few;                 // NULL: the scene is too large for it
    struct few *blockers;            // of such a scene, the first to try; NULL: none
    atomic_llong bytes;
};
