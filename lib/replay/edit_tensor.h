// SPDX-License-Identifier: Apache-2.0
// What an edit tensor says of its coefficients: objects with editable forms, and how a pixel follows
// from them (channel by channel),
//
//     pixel = fixed + sum over blocks  f_q f_o(view) sum_{g,j,k} G_g cA_j cB_k T[g][j][k]
//
// A block belongs to a term of an object; its axes are those of f_A and f_B that have a curve. cA and
// cB are the curves' values, f_q the term's scale. Group g stands for the product G_g of factors: the
// equivalent albedos of objects that light meets before, or coefficients of their curves over coarse
// bins. Blocks without object hold what is not edited itself; then f_q f_o cA cB = 1.
//
// Metadata, all checked when read:
//
//     "kind"     "edit"
//     "objects"  [{"name", "model": generator or "", "parameters" (curve/parameters.h),
//                  "form" (curve/form_json.h)}, ...]; terms of the form may hold
//                  "share": [r, g, b], the mean of a term's texture (absent: 1),
//                  "albedo": e_j, [bin A][bin B][channel] in a row
//     "factors"  [{"object": i} | {"members": [{"object": i, "weight": [r, g, b]}, ...]} |
//                {"object": i, "term": t, "bin": k, "knots": [...]}, ...]: an albedo, a weighted sum of
//                several, or a coefficient of a coarse curve, the
//                coarse bins being over the first axis that has several
//     "groups"   [[indices of factors], ...]; absent: one group without factors
//
// Texts that name a place are "OBJECT.TERM.f_A"; where several terms of an object have the same name,
// "TERM#2" is the second.
#pragma once

#include "curve/model.h"
#include "transport/tensor.h"

#define EDIT_NOTHING UINT32_MAX

enum { EDITED_MOST_OBJECTS = 4096, EDITED_MOST_FACTORS = 1 << 16, EDITED_MOST_GROUPS = 1 << 20,
       EDITED_MOST_POWER = 64 }; // factors of a group

struct edited_object {
    const char *name;
    const struct model *model;          // generator of the first terms; NULL: none
    struct model_parameters parameters; // that it was last asked for
    struct form form;                   // as it is edited
    struct curve *curve[FORM_CURVES];   // its tables, of three channels
    double share[FORM_TERMS][CURVE_CHANNELS];
    const double *albedo[FORM_TERMS];   // NULL: not known
    bool told_sharp;                    // that lobes are too sharp for its bins is told once
};

struct edited_block {
    uint32_t object, term; // EDIT_NOTHING: of no object
};

struct edited_member {
    uint32_t object;
    double weight[CURVE_CHANNELS];
};

struct edited_factor {
    uint32_t count; // members: equivalent albedos that are summed; or, of a coarse curve, its object
    const struct edited_member *members;
    uint32_t term, bin;  // of a coarse curve; term EDIT_NOTHING: albedos
    const double *knots; // of the coarse curve
};

struct edited_group {
    uint32_t count;
    const uint32_t *factors;
};

struct edit_tensor {
    const struct tensor *tensor;
    const char *path;
    uint32_t object_count, factor_count, group_count;
    struct edited_object *objects;
    struct edited_block *blocks; // as many as the tensor has
    struct edited_factor *factors;
    struct edited_group *groups;
    struct arena arena;
};

// The tensor must outlive it; path is for messages. false after an error message.
bool edit_tensor_init(struct edit_tensor *e, const struct tensor *t, const char *path);
void edit_tensor_finish(struct edit_tensor *e);

static inline bool edit_has_slot(const struct form_term *t, enum form_slot_name slot) {
    return t->slots[slot].gamma.kind != GAMMA_NONE;
}

// Whether a factor depends on an object.
bool edit_factor_has(const struct edited_factor *f, uint32_t object);

// The slot of a block's axis.
enum form_slot_name edit_axis_slot(const struct edit_tensor *e, uint32_t block, uint32_t axis);
// The curve of a block's axis.
uint32_t edit_axis_curve(const struct edit_tensor *e, uint32_t block, uint32_t axis);
