// SPDX-License-Identifier: Apache-2.0
// Damaged copies of good files, for readers to survive. A copy is a function of the good file and
// of the generator's state.
#pragma once

#include <stddef.h>

#include "math/hash.h"

struct mutant {
    unsigned char *data; // owned (mem_free)
    size_t size;
};

// One to four changes: bits and bytes set, values of 1 to 8 bytes replaced by extreme ones, parts
// cut off, deleted, doubled and swapped, numbers written in text replaced by words that are hard
// to read (nan, 1e39, -1, 4294967295, ...), lines doubled and deleted.
struct mutant mutate(const unsigned char *data, size_t size, struct rng *rng);
