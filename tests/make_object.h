// SPDX-License-Identifier: Apache-2.0
// Objects of any registry without a scene file: defaults from the parameter table, overrides as text.
//
//     make_object(&arena, &bsdfs, "roughconductor", "alpha=0.3 distribution=ggx eta=0.2,0.9,1.1",
//                 NULL);
//
// Words are separated by blanks. Numbers, names of choices, true/false, names of dielectrics
// (PARAM_IOR), one or three numbers for colours, three for points and vectors; transforms stay the
// identity. `children` (NULL-terminated, may be NULL) fill the slots of nested materials, textures
// and integrators in the order of the table. What is wrong ends the test with a message.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "bsdf/bsdf.h"
#include "texture/texture.h"

struct object *make_object(struct arena *arena, const struct registry *registry, const char *name,
                           const char *overrides, const struct object *const *children);

// The same, prepared.
struct object *make_bsdf(struct arena *arena, const char *name, const char *overrides,
                         const struct object *const *children);
struct object *make_texture(struct arena *arena, const char *name, const char *overrides,
                            const struct object *const *children);
