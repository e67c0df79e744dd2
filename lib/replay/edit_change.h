// SPDX-License-Identifier: Apache-2.0
// Changes to the objects of an edit tensor, as a person says them.
//
//     set      OBJECT.PARAM=V or OBJECT.TERM.PARAM=V: the model makes its curves anew with that number
//              (curve/parameters.h); curves whose formula does not change keep what was edited.
//              Numbers are relative to the scene's textures: reflectance=0.5 halves.
//              OBJECT.TERM.scale=V: f_q itself. V is a number or, for colours, R,G,B.
//              A lobe that is too sharp for the curve's bins is warned of, once for an object
//     curve    OBJECT.TERM.f_A=FILE.csv (curve/curve.h), brought to the term's own basis
//     operate  OBJECT.TERM.f_A:amplify-y,a,b,c,d,m[,base];... (curve/operators.h); f_A.r, f_A.gb:
//              in these channels only
//     reset    OBJECT: as it was in the scene
//     light    NAME=R,G,B or NAME=X: a factor of the tensor of that light; materials stay
#pragma once

#include "replay/edit_tensor.h"

// What a change touched: one curve of an object; EDIT_NOTHING: numbers outside the curves alone.
struct edit_touch {
    uint32_t object, curve;
    bool several; // more than one curve
};

enum edit_kind { EDIT_SET, EDIT_CURVE, EDIT_OPERATE, EDIT_RESET, EDIT_LIGHT };

// false after an error message that names `at`; then nothing is changed.
bool edit_apply(struct edit_tensor *e, enum edit_kind kind, const char *text, const char *at,
                struct edit_touch *touch);
