// SPDX-License-Identifier: Apache-2.0
// Whether path tracing will converge on a scene: light that only comes through smooth glass or by way
// of mirrors.
//
// From a surface behind smooth glass a light cannot be sampled, since glass bends and splits what
// goes through; it is found when a direction that the surface's material sampled happens to end in
// it. A delta light never is.
//
// The rule: from what the camera sees, and from what that sees with one diffuse bounce (512 points
// together), samples of each light are looked for along straight lines. What is met on the way
// is smooth glass, something opaque, or nothing. A sample behind glass is hard when a cosine
// distribution would find it less than once in 200 directions. A light is told of when hard samples
// bring more than 5 % of all light that these points have. A delta light none of whose light
// reaches them is told of where the scene has mirrors or smooth glass. Straight lines are not those
// of refraction.
//
// Likewise what mirrors, and glass that reflects, throw on these points, found by paths that come
// near the light (convergence_mirror.c). Its chance is that of a flat mirror close by: the light
// looks as large as from the mirror. Bent mirrors make it look larger or smaller.
#pragma once

#include "base/json.h"
#include "driver/job.h"

// A warning for each such light, and the array "will_not_converge" of objects.
void convergence_add(const struct job *job, struct json *out);
