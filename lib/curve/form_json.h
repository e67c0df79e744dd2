// SPDX-License-Identifier: Apache-2.0
// Forms as JSON, as tensors carry them: numbers come back with the same bits (json_to_text), and
// nothing that is read is believed unchecked. Parameters of generators: curve/parameters.h.
//
//     form       {"terms": [term, ...], "curves": [curve, ...]}
//     term       {"name", "scale": [r, g, b], "quotient": quotient, "f_o": slot, "f_A", "f_B"},
//                slots without curve are absent
//     slot       {"gamma": "theta_h", "n": exponent of GAMMA_RATIO, "curve": index}
//     curve      {"name", "basis": "box" | "hat", "knots": [...] radians, "values": [[...], ...]},
//                one list of values for all channels or three; or
//                {"name", "functions": [function, function, function]}
//     function   {"kind": "cos_power", "p": [p0, p1]}
//     quotient   {"kind": "v_cavity", "n", "roughness", "isotropy", "facets": [...],
//                "fresnel": [function, function, function]}, the last two where there are any
#pragma once

#include "base/json.h"
#include "curve/form.h"

// Adds "terms" and "curves" to an object. terms (or NULL) receives the object of each term, for
// more to be added.
void form_to_json(const struct form *f, struct json *object, struct json *terms[FORM_TERMS]);

// What the form refers to lives in the arena. false after an error message that names `at`.
bool form_from_json(struct form *f, const struct json *object, struct arena *arena, const char *at);
