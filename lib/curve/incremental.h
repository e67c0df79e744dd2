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
#pragma once

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
