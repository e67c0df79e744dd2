// SPDX-License-Identifier: Apache-2.0
// Albedos of an editable material's terms, and how its strategies of sampling share.
#pragma once

#include "bsdf/editable_data.h"

// Fills self->albedo, and the shares of self->sampler so that samples vary least.
void editable_measure(struct editable *self);

static inline spectrum editable_albedo(const struct editable *self, uint32_t term, double cos_o) {
    const float x = (float)cos_o * (EDITABLE_ANGLES - 1);
    const int i = x < EDITABLE_ANGLES - 1 ? (int)x : EDITABLE_ANGLES - 2;
    const float t = x - (float)i;
    return self->albedo[term][i] * (1 - t) + self->albedo[term][i + 1] * t;
}
