// SPDX-License-Identifier: Apache-2.0
// The polynomial sink: bins what integrators find by the marks of its chain (sink/chain.h), and leaves
// the materials for later.
//
// For each pixel and each object that it shows first there is a sum per place (a bin of a term) and
// group; for what shows no editable surface at all, one more, the fixed picture. All samples of a
// tile are summed in one visit, in double, even and odd ones apart, and left as the floats of the
// file. Where that takes too much memory a tile is visited in several strips.
//
// What a sample adds is rounded to a multiple of the quantum, 2^-30 of the picture or so. Sums of
// fewer than 2^53 quanta are then exact, so that ranges of samples add up to the same bits in
// whatever order and whatever pieces.
#pragma once

#include "sink/first_seen.h"
#include "transport/tensor.h"

enum { EDIT_MOST_TERMS = 8, EDIT_MOST_PARTS = SINK_TILE / 4 };

// One object as its pixels see it: a block of the tensor for each term.
struct edit_sums_object {
    uint32_t terms, places;          // in all
    uint32_t first[EDIT_MOST_TERMS]; // place of a term's first bin
    uint32_t bins[EDIT_MOST_TERMS];
    void *values[EDIT_MOST_TERMS], *halves[EDIT_MOST_TERMS]; // [tiles][group, bin][3][64], or NULL
    double *sums[EDIT_MOST_TERMS]; // as in the file, to be gone on with; or NULL
    // The block of an earlier tensor that these samples are added to, with sums; or NULL.
    const struct tensor_block *base[EDIT_MOST_TERMS];
};

// Cells of a strip, as they are summed.
struct edit_sums_cells {
    double *values; // mem_free them
    size_t count;
};

struct edit_sums_options {
    struct sink_area area;
    int width, height;               // of the whole picture
    uint32_t samples;                // a pixel has got in all, with the earlier tensor's: even
    double quantum;                  // a power of two; 0: none
    uint32_t groups;
    uint32_t last;                   // light of so many scattering events is multiplied; 0: none
    spectrum gain;                   // by this
    const struct edit_sums_object *objects; // those of `seen`, the last for fixed surfaces
    const struct first_seen *seen;   // of the same samples
    enum tensor_storage storage;
    uint32_t parts;                  // strips of a tile: 1, 2, 4, 8
    float *fixed;                    // 3 planes of the whole picture
    double *fixed_sums;              // the same as sums, or NULL
    const double *fixed_base;        // of the earlier tensor, or NULL
    struct edit_sums_cells *handed;  // by strip: where sums go instead of the arrays; or NULL
};

struct edit_sums;

// Options are copied; the memory they point to must outlive the sums.
struct edit_sums *edit_sums_create(const struct edit_sums_options *options);
void edit_sums_destroy(struct edit_sums *e);
// Tiles as a tracer counts them: strips.
uint32_t edit_sums_tile_count(const struct edit_sums *e);
struct sink *edit_sums_sink(void *edit_sums);
// Stores the cells of a strip that were handed over by another process with the same options.
void edit_sums_take(struct edit_sums *e, uint32_t strip, const double *values, size_t count);
uint64_t edit_sums_rejected(const struct edit_sums *e); // samples that were not finite

// Bytes of memory that the largest strip needs.
size_t edit_sums_worker_bytes(const struct edit_sums_options *options);
