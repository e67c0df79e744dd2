// SPDX-License-Identifier: Apache-2.0
// A material that no generator of curves is near to, as factors fitted to its values.
#pragma once

#include "curve/form.h"
#include "driver/material.h"

// Adds a term to an empty form; memory from the arena. Says what the factors miss. false after an
// error message: the material is not a plain reflection.
bool brdf_factor(const struct material *m, const char *path, struct form *f, struct arena *arena);
