// SPDX-License-Identifier: Apache-2.0
// What a replay holds, for the files that work on it.
#pragma once

#include "cl/compute.h"
#include "kernels/tile.h"
#include "replay/replay.h"

enum {
    REPLAY_ROW = TILE_CHANNELS * TILE_LANES, // floats of a coefficient of a tile
    REPLAY_CHUNK_ARGS = 4,                   // at most
};

// Consecutive tiles of a block that one buffer of the device holds.
struct replay_chunk {
    size_t first, tiles;
    bool resident; // stays on the device; others are sent each time
    struct compute_buffer values;
};

struct replay_block {
    const struct tensor_block *tensor;
    float *sums;   // [tile][channel][lane]
    float *layers; // [layer][tile][channel][lane]; sums where there is one layer
    struct replay_chunk *chunks;
    size_t chunk_count;
    bool dirty; // sums are on the device, not here
    struct compute_buffer out, weights, terms; // out: the layers
    struct compute_buffer total;               // of the layers, where there are more than one
    struct compute_buffer entries, starts;     // of TENSOR_ROWS
};

struct replay {
    const struct tensor *tensor;
    struct compute_device *device; // NULL: twins
    bool borrowed;                 // the device is another's
    int threads;
    uint32_t layers;
    size_t room;      // bytes of the device that are left for values
    bool reads_ahead; // replay_read_ahead does
    char name[300];
    struct replay_block *blocks;
};

// The values of a chunk on the device, between open and close. false after an error message.
bool replay_open_chunk(struct replay *r, const struct replay_block *b, struct replay_chunk *c);
void replay_close_chunk(struct replay_chunk *c);
// While the device works on the chunk before: asks for this one where the memory cannot keep them all,
// and waits for that one. false after an error message.
bool replay_read_ahead(struct replay *r, const struct replay_block *b, size_t chunk);

// The arguments that say where a chunk's coefficients are; their number.
uint32_t replay_chunk_args(const struct replay_block *b, const struct replay_chunk *c,
                           struct compute_arg args[REPLAY_CHUNK_ARGS]);

// Kernel `name` for the storage of a block: of `file`, or of rows.cl. NULL after an error message.
struct compute_kernel *replay_kernel(struct replay *r, const struct replay_block *b,
                                     const char *file, const char *name);
