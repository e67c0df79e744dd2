// SPDX-License-Identifier: Apache-2.0
// An editing session over an edit tensor: changes go in, pictures come out.
//
// Without focus a frame is a full product of every block whose weights changed, right for any tensor
// and any edit. A focus on one curve of an object, or on two, contracts all else first
// (replay/edit_focus.h), so that frames cost what those curves cost; it moves by itself to where changes
// happen: to two curves where both change between frames, or in turn. With `terms`
// frames are updated by that many wavelet coefficients each (curve/incremental.h) and are exact once
// changes pause; sums are then made anew, so that rounding does not add up.
//
// Tensors of the same scene under one light each (`precompute edit --light`) make one session: what each
// gives times a factor is added, so that lights and materials are edited together.
#pragma once

#include "replay/edit_part.h"

enum { EDIT_MOST_LIGHTS = 64 };

struct edit_light {
    const char *name; // of a light or its group; NULL: all lights of the scene
    float factor[CURVE_CHANNELS];
};

struct edit;

// The tensor must outlive it; path is for messages. NULL after an error message.
struct edit *edit_create(const struct tensor *t, const char *path, const struct edit_settings *o);
void edit_destroy(struct edit *e); // NULL is fine

// Another tensor, of the same scene under another light; both must say under which. false after an
// error message.
bool edit_add(struct edit *e, const struct tensor *t, const char *path);
// In the order of the tensors.
const struct edit_light *edit_lights(const struct edit *e, uint32_t *count);

struct edit_tensor *edit_objects(struct edit *e); // to be looked at
const char *edit_device(const struct edit *e);

// A change as replay/edit_change.h has it, of all tensors. false after an error message.
bool edit_change(struct edit *e, enum edit_kind kind, const char *text, const char *at);

// The picture of the objects as they are, three planes. false after an error message.
bool edit_frame(struct edit *e, float *frame);
// The two halves of a frame: sums, waited for; and the picture of the sums.
bool edit_follow(struct edit *e);
bool edit_compose(struct edit *e, float *frame);
// Frames until one is exact.
bool edit_settle(struct edit *e, float *frame);
// Whether the last frame was exact; with `terms` it may lag behind.
bool edit_is_exact(const struct edit *e);
// Asks for the next frame to be made anew, all of it.
void edit_forget(struct edit *e);

// What the tensor's own noise makes of the picture: variance per pixel (replay_variance).
void edit_variance(struct edit *e, float *variance);

struct edit_cost edit_last_cost(const struct edit *e);
