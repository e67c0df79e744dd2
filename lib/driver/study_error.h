// SPDX-License-Identifier: Apache-2.0
// Errors of repeated runs against a reference that has noise of its own.
#pragma once

#include "image/image.h"
#include "math/repeats.h"

// Its noise is taken off the errors. What this leaves is small only while the noise is: the weights
// and the variance hang together with it where its samples are skewed.
struct study_reference {
    struct image rgb, variance; // variance.pixels == NULL: not known, and counts as bias
    double eps;                 // 1e-3 mean(rgb)^2: errors are divided by rgb^2 + eps
    double mean;                // luminance
    double noise;               // the relMSE that its own noise makes; 0: not known
};

// Takes colour and the layer `variance` (squared standard errors) of a picture. false after an error
// message that names `path`.
bool study_reference_take(struct study_reference *ref, const struct image *im, const char *path);
void study_reference_finish(struct study_reference *ref);

// Linear Rec.709 pictures of the runs, of the reference's size. *relmse: of each run.
struct repeats study_errors(const struct study_reference *ref, const struct image *runs, int count,
                            double *relmse);

// Pictures to look at: small, displayed, as "data:image/png;base64,...", free with mem_free. `temp`
// is a path that may be written and is removed. NULL after an error message.
char *study_thumbnail(const struct study_reference *ref, const struct image *im, const char *temp);
// (im - ref) / (ref + 0.01 mean): red above, blue below, white at twice that.
char *study_difference(const struct study_reference *ref, const struct image *im, const char *temp);
