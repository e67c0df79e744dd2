// SPDX-License-Identifier: Apache-2.0
// The numbers of a generator (struct model_parameters) by their names: as JSON, and as a person
// sets them.
//
// Names are those of the fields: "reflectance", "diffuse", "eta", "k", "r0" (three numbers),
// "exponent_u", "exponent_v", "alpha_u", "alpha_v", "isotropy", "variant", "literal",
// "fixed_fresnel", "gamma" (of f_o, f_A, f_B), "quotient". A person may also say "exponent" and
// "alpha" for both directions.
#pragma once

#include "base/json.h"
#include "curve/model.h"

void parameters_to_json(const struct model_parameters *p, struct json *object);
// What is absent is as in model_defaults; there are no curves. Ranges are checked by model_make.
// false after an error message that names `at`.
bool parameters_from_json(struct model_parameters *p, const struct json *object, const char *at);

// Sets a number from "X" or, for colours, "R,G,B"; truth values and variants by name. false after
// an error message: no such name, or no such value.
bool parameters_set(struct model_parameters *p, const char *name, const char *text, const char *at);
// The names that parameters_set knows, separated by blanks.
const char *parameters_names(void);
