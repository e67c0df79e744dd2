// SPDX-License-Identifier: Apache-2.0
// What of a scene can be edited: objects with their forms, and the blocks of a tensor for them.
//
// An object is an editable material, whatever shapes use it, also behind a twosided, a mask or a
// bumpmap. Its name is the material's id, else that of the one around it, else the shape's, else
// "object N". Objects stand in the order in which the scene's shapes meet them.
#pragma once

#include "base/json.h"
#include "bsdf/editable.h"
#include "scene/scene.h"
#include "transport/tensor.h"

enum { EDIT_NONE = UINT32_MAX };

struct edit_object {
    const char *name;
    const struct object *material;
    const struct form *form;                  // all curves are tables
    double share[FORM_TERMS][CURVE_CHANNELS]; // mean of a term's texture
};

struct edit_plan {
    struct edit_object *objects;
    uint32_t count;
    struct arena arena;
};

// Turns the materials of `names` (ids of materials or shapes) into editable ones; before the world
// is built. Those that become so get `bins_b` bins for a second curve; 0: as many as for the first.
// false after an error message.
bool edit_convert(struct scene *s, const char *const *names, size_t count, int bins_b);

// The objects of a scene whose materials are prepared. false after an error message: there is none.
bool edit_plan_init(struct edit_plan *p, const struct scene *s);
void edit_plan_finish(struct edit_plan *p);

// The object whose material has that data (editable_owner); EDIT_NONE: none.
uint32_t edit_plan_find(const struct edit_plan *p, const void *owner);

// Whether a term has a curve in this slot.
static inline bool edit_term_has(const struct form_term *t, enum form_slot_name slot) {
    return t->slots[slot].gamma.kind != GAMMA_NONE;
}

// The basis of the curve in a slot.
static inline const struct basis *edit_basis(const struct form *f, const struct form_slot *s) {
    return &f->curve[s->curve].f[0].table->basis;
}

// Names, axes and number of coefficients of a term's block with one group; axes are f_A, then f_B,
// where there are curves. Pixels, view and storage are left to the caller. Refers to the plan.
void edit_plan_block(const struct edit_plan *p, uint32_t object, uint32_t term,
                     struct tensor_block *b);

// An object's albedo as its factor is at run time (replay/edit_weights.h), by channel, from those of its
// terms' coefficients (bsdf/equivalent_albedo.h).
void edit_plan_albedo(const struct edit_plan *p, uint32_t object, double *const e[FORM_TERMS],
                      double albedo[CURVE_CHANNELS]);

// The weights of the form as it is, coefficient by coefficient and channel: f_q c_A c_B.
void edit_plan_weights(const struct edit_plan *p, uint32_t object, uint32_t term, float *weights);

// Adds "objects" to the metadata. terms: by object and term, the JSON object of each term, for more
// to be added; or NULL.
void edit_plan_describe(const struct edit_plan *p, struct json *meta,
                        struct json *(*terms)[FORM_TERMS]);
