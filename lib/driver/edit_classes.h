// SPDX-License-Identifier: Apache-2.0
// Classes: objects that have one factor at later hops together, since products of M factors are
// C(N - 1 + M, M) for N bounces.
//
// An object alone has its albedo as factor. In a class of several, light that meets one of them goes on
// by the albedo that it has, the base, and the factor is how albedos have changed in the mean,
//
//     D = sum_i w_i d_i / sum_i w_i b_i,    w_i b_i: light that object i passes on at later hops
//
// by channel. So what is not edited comes out as it is; of an edit the light in the picture changes as
// it does without classes, to first order, but where it falls is where that of the whole class does.
#pragma once

#include "base/json.h"
#include "driver/edit_plan.h"

struct edit_classes {
    uint32_t count;
    uint32_t *of;                   // by object
    const char **names;             // by class; NULL: of one object
    double (*base)[CURVE_CHANNELS]; // by object: b_i; 1 where it is alone
    double (*share)[CURVE_CHANNELS]; // by object: w_i / sum w b; 1 where it is alone
    struct arena arena;
};

// texts: "NAME=OBJECT,OBJECT,..." or "N", which leaves N classes: the objects that `passed` says pass
// most light on alone, and all others together. albedos: of all objects; passed: light that each
// passes on at later hops.
// false after an error message.
bool edit_classes_init(struct edit_classes *c, const struct edit_plan *plan,
                       double *const (*albedos)[FORM_TERMS],
                       const double (*passed)[CURVE_CHANNELS], const char *const *texts, size_t count);
void edit_classes_finish(struct edit_classes *c);

// Adds what the factor of a class is: "object", or "members" with weights.
void edit_classes_describe(const struct edit_classes *c, const struct edit_plan *plan, uint32_t index,
                           struct json *factor);
