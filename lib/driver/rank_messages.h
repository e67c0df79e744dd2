// SPDX-License-Identifier: Apache-2.0
// Messages between the processes of driver/ranks.h.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum { RANK_TAG_FREE = 16 }; // tags below are those of pictures

// Any size; the receiver must ask for as much.
void rank_send(int rank, int tag, const void *data, size_t size);
void rank_receive(int rank, int tag, void *data, size_t size);
// Whether a message waits, and from whom.
bool rank_waits(int tag, int *rank);
