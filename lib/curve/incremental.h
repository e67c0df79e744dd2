// SPDX-License-Identifier: Apache-2.0
// Following an edited curve with a few coefficients a frame (incremental wavelet rendering:
// Ben-Artzi, Overbeck, Ramamoorthi 2006, eq. 7.3 to 7.5 of Ben-Artzi's thesis, 2007).
//
// The pictures that are shown belong to the coefficients c_eff; each frame moves c_eff towards the
// wanted ones by the terms that are furthest off, and adds the same terms' pictures:
//
//     diff = c - c_eff,  keep the K largest of diff,  c_eff += diff,  R += T . diff
//
// Frames without edits go on until c_eff = c; with all terms kept a frame is exact. A term of several
// channels counts by the root of the sum of squares.
//
// Where all of a curve changes (a light that turns), differences may be larger than what is wanted:
// half of all wavelets are of the finest band. Terms then stand in bands, whose pictures are kept apart,
// and a band is begun anew, at zero, where that is nearer: where the frame's terms, spent alike over
// all bands, leave less of
//
//     sum of min(wanted^2, t^2)    than of    sum of min(diff^2, t^2)
//
// with t such that as many terms are above it as the frame has. (Overbeck et al. 2006 part the work
// by bands too; their rule is not in Ben-Artzi's thesis. This one minimises what is left, since t^2 is
// what a term more would save.)
#pragma once

#include <stdbool.h>

#include <stddef.h>
#include <stdint.h>

struct incremental {
    size_t count, channels;
    double *effective;    // c_eff, [count][channels], owned by the caller
    const double *weight; // how much a term counts in the picture (its root mean square); NULL: 1
};

// Writes the terms of this frame, at most `most` and largest first, adds them to c_eff and returns
// how many there are. wanted: [count][channels]; difference: [most][channels]; order: scratch of
// `count` indices.
size_t incremental_step(struct incremental *s, const double *wanted, size_t most, uint32_t *index,
                        double *difference, uint32_t *order);

struct incremental_bands {
    uint32_t count;
    const uint8_t *of_term;
};

// Chooses the bands that are to be begun anew and does so in c_eff: rebuilt[band], whose pictures are
// to be set to zero. incremental_step then chooses the terms of the frame.
void incremental_rebuild(struct incremental *s, const struct incremental_bands *b,
                         const double *wanted, size_t most, bool *rebuilt);

// Bands of the wavelets of rows x columns cells (curve/wavelet.h): the finer of both levels. Writes
// of_term and returns their number, at most 17.
uint32_t incremental_bands_of(uint32_t rows, uint32_t columns, uint8_t *of_term);
