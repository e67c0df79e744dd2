// SPDX-License-Identifier: Apache-2.0
// The numbers of a model that come nearest to curves which were edited by hand, for renderers that
// know the model and no curves.
#pragma once

#include "replay/edit_tensor.h"

struct nearest {
    struct model_parameters parameters;
    double factor[CURVE_CHANNELS]; // of the first term, beside the model's own
    double missing; // root of the sum over the curves of the squares that it misses, by theirs
};

// The object has a model. Exponents and roughness are looked for, and a factor of each curve;
// distances are weighted by sin(gamma) d gamma.
void nearest_find(const struct edited_object *o, struct nearest *n);
