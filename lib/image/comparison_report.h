// SPDX-License-Identifier: Apache-2.0
// A comparison in words, in JSON, and against limits.
#pragma once

#include "image/comparison.h"

void comparison_print(const struct comparison *c);
void comparison_print_json(const struct comparison *c);

// A limit METRIC=X, of mean, mse, relmse, psnr, ssim, flip, ldr-flip: whether the metric is worse
// than X. Compared are |mean ratio - 1|, 1 - SSIM, -PSNR and the others as they are; NaN is worse
// than anything. false after an error message: the text is not of that form.
bool comparison_check_limit(const char *text, const struct comparison *c, bool *exceeded);
