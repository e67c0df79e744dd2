// SPDX-License-Identifier: Apache-2.0
// Ray queries. The only module that sees Embree (3.13 or 4.x).
//
// Rays need not be unit; hits report t in lengths of d. Single rays suit paths; the 16-wide forms
// suit rays that run side by side. A packet's results depend on all of its rays, so callers that
// promise bits always trace the same full packet.
#pragma once

#include "math/ray.h"
#include "math/wide.h"
#include "scene/scene.h"

struct accel;

struct accel_hit {
    float t;
    float u, v;         // barycentric weights of vertices 1 and 2
    uint32_t shape;     // SCENE_NONE: nothing was hit
    uint32_t primitive;
    uint32_t instance;  // or SCENE_NONE
};

enum { ACCEL_PACKET = 16 };

// Rays of a packet, lane by lane. One with tmax < tmin is not traced.
struct accel_rays {
    struct wide3 o, d;
    wide tmin, tmax;
};

struct accel_hits {
    wide t, u, v;
    wide_uint shape, primitive;
};

// Builds over the scene's own vertex arrays, which must outlive it. NULL after an error message.
struct accel *accel_create(const struct scene *scene, int threads);
void accel_destroy(struct accel *a);
size_t accel_bytes(const struct accel *a); // taken by the acceleration structure
// The RTCScene behind it, for benchmarks that compare with bare Embree calls.
void *accel_embree_scene(const struct accel *a);
const char *accel_version(void);           // "Embree 3.13.5"

// Has accel_occluded_each try the facets first that block most of these rays.
void accel_learn_blockers(struct accel *a, const struct scene *scene, const struct ray *rays,
                          uint32_t count);

// Call once on every thread that traces: sets the floating point mode (denormals are zero).
void accel_thread_init(void);

bool accel_intersect(const struct accel *a, const struct ray *ray, struct accel_hit *hit);
bool accel_occluded(const struct accel *a, const struct ray *ray);
// Whether packets may hold any rays: what a ray hits does not depend on the others, and packets are
// the faster way however they run.
bool accel_mixes_packets(const struct accel *a);
// Rays outside `active` (bit i: ray i) are not traced; their hits are left alone. coherent: the rays
// run much the same way.
void accel_intersect16(const struct accel *a, const struct ray rays[ACCEL_PACKET], uint32_t active,
                       bool coherent, struct accel_hit hits[ACCEL_PACKET]);
// Bit i of the result: ray i is blocked.
uint32_t accel_occluded16(const struct accel *a, const struct ray rays[ACCEL_PACKET],
                          uint32_t active, bool coherent);
// The same for any number of rays that have nothing in common: what each finds does not depend on the
// others. They pass the facets that were learnt first, side by side, which in a room block half of
// all shadow rays.
void accel_occluded_each(const struct accel *a, const struct ray *rays, uint32_t count,
                         bool *blocked);
