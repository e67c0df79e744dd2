// SPDX-License-Identifier: Apache-2.0
// Indices of refraction by the names of materials.
#pragma once

#include <stddef.h>

#include "math/vec.h"

// Real indices that materials take, on either side of a boundary.
#define IOR_LEAST 1e-3f
#define IOR_MOST 1e3f

// Complex index eta + i k of a conductor ("Au", "Cu", "Al", ...; upper and lower case differ) as
// linear Rec.709 triples. "none" is the perfect mirror: eta 0, k 1, of which the Fresnel
// reflectance is 1. false: no such material.
bool ior_conductor_find(const char *name, spectrum *eta, spectrum *k);
// Names of the conductors, sorted; NULL when i is past the last.
const char *ior_conductor_name(size_t i);
// Of a mistyped name, upper and lower case disregarded; NULL where nothing is near.
const char *ior_conductor_nearest(const char *name);

// Real index of a dielectric ("vacuum", "air", "water", "bk7", "diamond", ...). false: unknown.
bool ior_dielectric_find(const char *name, float *ior);
const char *ior_dielectric_name(size_t i);
