// SPDX-License-Identifier: Apache-2.0
// Tensors: how the pixels of a picture depend on lights or materials, as a file and in memory.
//
// A tensor is a list of blocks. A block holds, for a list of pixels, one coefficient per basis
// function and colour channel; the pixel is the sum over its blocks of coefficients times weights,
// plus the fixed picture. Where a pixel shows several objects it stands in several lists, and its
// coefficients carry its coverage.
//
// The file is a safetensors container: u64 length of the header, little-endian; the header, JSON,
// padded with spaces so that the data begin at a multiple of 128; then the arrays, each aligned to
// 128 bytes; the bytes between are arrays "padding.OFFSET". Arrays of block N:
//
//     N.pixels   U32 [n]             index y * width + x of each pixel, all different
//     N.values   F32 or BF16 [tiles, coefficients, channels, 64]   mean of the two half-sums
//     N.halves   same                half their difference; absent where the tensor has no noise
//     N.value_rows, N.half_rows   U32 [tiles, coefficients]; N.value_starts, N.half_starts
//                U64 [tiles + 1]   of storage ROWS, whose values and halves are U8 [bytes]: where and
//                    how each row is stored (transport/rows.h)
//     N.sums     F64 [tiles, coefficients, 2 channels, 64]   sums of the even samples' channels, then
//                    of the odd ones', from which more samples go on; or absent
//     N.view     F32 [tiles, 64]     angle between normal and eye for f_o, radians; or absent
//     N.views    F64 [2, tiles, 64]  sum of those angles over the samples, and how many; or absent
//     N.weights  F32 [coefficients, channels]   the weights of the scene as it was; or absent
//     N.edges0   F64 [bins + 1]      bin edges of the first axis, radians (N.edges1: of the second);
//                    [bins]          of a hat basis: its nodes
//
// and "fixed" F32 [3, height, width], what no weight changes, or absent; "fixed_sums" F64, the same as
// a sum over all samples, or absent. Tiles are 64 pixels in the
// order of the list; lanes beyond its end are zero. The order of coefficients is (group, bin of
// axis 0, bin of axis 1), the last running fastest. What the blocks mean stands as a JSON text
// under "relume" in the header's "__metadata__"; the field descriptions are those of the structs.
//
// Errors: let a and b be two independent estimates of a pixel (from the two halves); the picture is
// their mean, and the same weights on `halves` give (a - b) / 2, whose square estimates its
// variance. A sum over many pixels of it is the squared error to be expected.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/json.h"
#include "transport/bfloat16.h"
#include "transport/rows.h"

enum { TENSOR_LANES = 64, TENSOR_ALIGN = 128, TENSOR_MOST_AXES = 2 };

// How coefficients are stored: all alike, or each row in its own way (transport/rows.h).
enum tensor_storage { TENSOR_F32, TENSOR_BF16, TENSOR_ROWS };

enum tensor_basis { TENSOR_BOX, TENSOR_HAT };

// One variable of a curve: bins of an angle (curve/angles.h), radians, or nodes of a hat basis, with
// knots as in curve/basis.h.
struct tensor_axis {
    const char *name; // parametrisation: "theta_h", ...; or what the coefficients are: "light"
    enum tensor_basis basis;
    uint32_t bins;
    const double *edges; // tensor_edges(axis), increasing; NULL where bins are not intervals
};

static inline uint64_t tensor_edges(const struct tensor_axis *a) {
    return (uint64_t)a->bins + (a->basis == TENSOR_BOX);
}

struct tensor_block {
    const char *object, *term; // as `relume edit --list` shows them
    uint32_t axis_count;
    struct tensor_axis axes[TENSOR_MOST_AXES];
    uint32_t groups;       // coefficients per bin: 1, or products of other objects' albedos
    uint32_t coefficients; // groups times the bins of all axes
    uint32_t channels;     // 3
    uint64_t pixel_count;
    const uint32_t *pixels;
    enum tensor_storage storage;
    const void *values;
    const void *halves; // NULL: no noise
    struct tensor_rows value_rows, half_rows; // of TENSOR_ROWS
    const float *view;  // NULL: none
    const double *sums, *views; // NULL: none
    const float *weights; // NULL: none
};

struct tensor {
    uint32_t width, height;
    const struct json *meta; // everything else that the metadata say; owned by the file
    uint32_t block_count;
    struct tensor_block *blocks;
    const float *fixed; // 3 planes; NULL: black
    const double *fixed_sums; // NULL: none
};

static inline uint64_t tensor_tiles(const struct tensor_block *b) {
    return (b->pixel_count + TENSOR_LANES - 1) / TENSOR_LANES;
}

// Not of TENSOR_ROWS.
static inline size_t tensor_value_size(enum tensor_storage s) {
    return s == TENSOR_BF16 ? 2 : 4;
}

// Coefficients of all tiles and channels, lanes beyond the list's end among them.
static inline uint64_t tensor_value_count(const struct tensor_block *b) {
    return tensor_tiles(b) * b->coefficients * b->channels * TENSOR_LANES;
}

static inline uint64_t tensor_rows_bytes(const struct tensor_block *b, const struct tensor_rows *r) {
    return r->starts[tensor_tiles(b)] + tensor_tiles(b) * b->coefficients * sizeof *r->entries;
}

// Bytes of `values`.
static inline uint64_t tensor_bytes(const struct tensor_block *b) {
    return b->storage == TENSOR_ROWS ? tensor_rows_bytes(b, &b->value_rows)
                                     : tensor_value_count(b) * tensor_value_size(b->storage);
}

// Bytes of `values` and `halves`.
static inline uint64_t tensor_block_bytes(const struct tensor_block *b) {
    return tensor_bytes(b) + (!b->halves ? 0
                              : b->storage == TENSOR_ROWS ? tensor_rows_bytes(b, &b->half_rows)
                                                          : tensor_bytes(b));
}

// Coefficients as they lie in memory: the values of a block, or its halves.
struct tensor_data {
    const void *data;
    enum tensor_storage storage;
    struct tensor_rows rows;
};

static inline struct tensor_data tensor_values_of(const struct tensor_block *b) {
    return (struct tensor_data){b->values, b->storage, b->value_rows};
}

static inline struct tensor_data tensor_halves_of(const struct tensor_block *b) {
    return (struct tensor_data){b->halves, b->storage, b->half_rows};
}

// Reads [channel][lane] of a coefficient of a tile, however it is stored.
void tensor_row(const struct tensor_data *d, uint32_t coefficients, size_t tile, uint32_t coefficient,
                float values[ROW_VALUES]);
// The block without rows: of storage F32 if it had some, in memory that is made anew (and freed, what
// was there), to be freed by the caller.
struct tensor_block tensor_unpack(const struct tensor_block *b, float *memory[2]);

// Whether samples can be added to it exactly.
static inline bool tensor_has_sums(const struct tensor *t) {
    return t->fixed_sums != NULL;
}

// Where the sum of a coefficient's channel over the samples of one half stands in `sums`.
static inline size_t tensor_sum_at(const struct tensor_block *b, uint64_t lane, size_t coefficient,
                                   uint32_t half, uint32_t channel) {
    return (((lane / TENSOR_LANES * b->coefficients + coefficient) * 2 + half) * b->channels +
            channel) * TENSOR_LANES + lane % TENSOR_LANES;
}

// ---- reading ------------------------------------------------------------------------------------

struct tensor_file;

// Maps the file, and checks all of it but the values: sizes, overlaps, indices, edges. NULL after
// an error message that names the file.
struct tensor_file *tensor_open(const char *path);
const struct tensor *tensor_get(const struct tensor_file *f);
// Whether every value is finite; reads the whole file. false after an error message.
bool tensor_check_values(const struct tensor_file *f);
void tensor_close(struct tensor_file *f); // NULL is fine

// ---- writing ------------------------------------------------------------------------------------

struct tensor_writer;

// Begins a file for a tensor of this shape: everything but values, halves, sums and fixed is taken from
// `shape` and written at once; a block has halves or sums, and the tensor a fixed picture, where the
// pointer is not NULL (it is not read). meta: what else is known, merged into the metadata. Atomic: the file
// appears when the writer is closed, and nothing of it is left where the process is killed before (but on
// file systems without nameless files, PATH.PID.tmp). NULL after an error message.
struct tensor_writer *tensor_create(const char *path, const struct tensor *shape);
// The same for work that may be ended at any moment, even killed: the file is PATH.part until it is
// closed, and if there is one of the same shape and metadata it is gone on with. *marks: for `parts`
// parts of the work, to be set to 1 when one is done; those of the run before, or zeros.
struct tensor_writer *tensor_create_kept(const char *path, const struct tensor *shape, size_t parts,
                                         unsigned char **marks);
// Where the parts of the file lie in memory, to be filled: zero at first, from any thread.
void *tensor_values(struct tensor_writer *w, uint32_t block);
void *tensor_halves(struct tensor_writer *w, uint32_t block);
double *tensor_sums(struct tensor_writer *w, uint32_t block);
float *tensor_fixed(struct tensor_writer *w);
double *tensor_fixed_sums(struct tensor_writer *w);
// Completes the file. false after an error message.
bool tensor_finish(struct tensor_writer *w);
void tensor_abandon(struct tensor_writer *w); // PATH.part stays
