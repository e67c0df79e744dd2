// SPDX-License-Identifier: Apache-2.0
// The lighting of a relighting tensor's picture written back: a copy of a Mitsuba XML scene with other
// lights.
//
// Factors of lights change the numbers of their emitters: radiance, intensity, irradiance, scale; so
// must those of a `group` name. Another environment takes the place of all that were there; the scene's
// own is turned where it is.
#pragma once

#include "replay/relight.h"
#include "replay/scene_copy.h"

// scene: the file that the tensor of this metadata was made of. false after an error message.
bool save_lights(const struct relight_lighting *l, const struct json *meta, const char *scene,
                 const char *output);

// Changes the emission of the emitters of a name or group in a copy. false after an error message.
bool save_light_factor(struct scene_copy *c, const char *name, const double factor[3]);
