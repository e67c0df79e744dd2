// SPDX-License-Identifier: Apache-2.0
// Plain materials in the editable form, by the nearest generator of curve/list.h.
#pragma once

#include "bsdf/bsdf.h"

// Turns a material that was read, but not yet prepared, into an editable one of the same look, in
// place: whatever refers to it refers to the new one. Says what was taken for what; an editable one
// stays as it is. false after an error message: nothing is near.
bool editable_convert(struct object *material, struct arena *arena);
// Whether one is.
bool editable_converts(const struct object *material);
