// SPDX-License-Identifier: Apache-2.0
// The tensor sink: bins what integrators find by source and leaves the emission for later.
//
// Works through all samples of a tile in one visit, in double, and leaves their means as the floats
// of the file: a tile's sums are all that is in memory. Even and odd samples, which must be drawn as
// two replicates, make the two half-sums of transport/tensor.h.
#pragma once

#include "sink/source_basis.h"
#include "sink/tile_grid.h"
#include "transport/tensor.h"

struct tensor_sums_options {
    struct sink_area area;      // pixels of the picture
    int width, height;          // of the whole picture
    uint32_t samples;           // a pixel gets in all: even
    struct source_basis basis;
    enum tensor_storage storage;
    void *values, *halves;      // of the one block, [tiles][coefficients][3][64]; NULL: all is
                                // traced and nothing kept
    float *fixed;               // 3 planes of the whole picture
};

struct tensor_sums;

// Options are copied; the memory they point to must outlive the sums.
struct tensor_sums *tensor_sums_create(const struct tensor_sums_options *options);
void tensor_sums_destroy(struct tensor_sums *t);
uint32_t tensor_sums_tile_count(const struct tensor_sums *t);
struct sink *tensor_sums_sink(void *tensor_sums);
uint64_t tensor_sums_rejected(const struct tensor_sums *t); // samples that were not finite

// The pixels of the block in the order of the sums: y * width + x, as many as the area has.
void tensor_sums_pixels(const struct tensor_sums_options *options, uint32_t *pixels);
// Bytes of memory a worker needs.
size_t tensor_sums_worker_bytes(const struct source_basis *basis);
