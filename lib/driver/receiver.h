// SPDX-License-Identifier: Apache-2.0
// A mesh of a scene as what receives light, in place of the camera: its texels or its vertices.
#pragma once

#include "scene/scene.h"

struct receiver {
    const char *texels, *vertices; // a shape's name; NULL: the camera. At most one of them
};

// Puts the sensor into the scene; texels: W x H as the user says, else 256 x 256. The picture of
// vertices has rows of RECEIVER_ROW. false after an error message.
bool receiver_place(const struct receiver *r, const struct scene_options *reading, struct scene *s);

enum { RECEIVER_TEXELS = 256, RECEIVER_ROW = 256 };
