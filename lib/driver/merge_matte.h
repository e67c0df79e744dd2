// SPDX-License-Identifier: Apache-2.0
// Cryptomatte layers of a union: the means of the parts' layers, name by name, weighted by samples.
#pragma once

#include "image/image.h"

// Appends the layers that all the pictures of the paths have (of a journal: its picture) to their
// union. Parts are taken in the order of their samples until there are as many as one run takes, so
// that a union of ranges has the layers of that run; what a pixel's seventh name covers is lost. Says
// so where some pictures lack the layers. false: a picture cannot be read.
bool merge_mattes(const char *const *paths, size_t count, struct image *im);
