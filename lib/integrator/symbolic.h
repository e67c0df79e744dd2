// SPDX-License-Identifier: Apache-2.0
// The symbolic response: surfaces whose material is to be edited answer with marks (sink/chain.h).
//
// What is seen first answers with the basis of its curves: for each term and each pair of functions
// that are not zero, quotient times cosine (and texture), and where among the object's coefficients
// that belongs. Every later editable surface is Lambertian with an albedo that is left open, so its
// answer is the cosine over pi and a step from one group to the next; or it keeps its material, over
// the albedo, so that edits change how much it reflects and not where to; or each of its terms does so
// for itself; or, where the second hop has curves of its own, the first of them answers with a basis
// again. After `bounces` scattering events
// all surfaces answer with their materials as they are, and so do those that are never edited.
//
// The weight that an integrator sees is the density it draws with: its paths, and its roulette,
// depend on nothing that can be edited, and f over the density stands in the marks.
#pragma once

#include "bsdf/bin_sampler.h"
#include "integrator/integrator.h"

struct symbolic_object {
    const struct form *form; // its curves, over the basis of the eye's hop
    const struct texture_ref *texture[FORM_TERMS];
    uint32_t first[FORM_TERMS]; // place of a term's first coefficient
    bool knows_view;            // some term has a curve over theta_o
    bool wide;                  // where it is seen first it can be shaded together (wide_basis.h)
    struct bin_sampler sampler;
    struct bin_sampler coarse; // where `second` is: of the bins that it tells apart
    const uint32_t *second; // by place: the group it leads to from group 0; NULL: `next` is taken
    bool keeps;             // its material later, too; else it is Lambertian
    bool splits;            // each of its terms keeps its shape, with a factor of its own
    bool lacks;             // one of them has none to keep: it is as its quotient is
    spectrum part[FORM_TERMS]; // over the value of its factor as it is; black: there is none to keep
    uint32_t factor;        // its albedo, or that of its class, or the first of its terms'
    spectrum scale;         // what is left of a later answer when that factor is taken out
};

struct symbolic {
    struct response response; // first
    const struct symbolic_object *objects;
    const int *object_of_shape; // CHAIN_FIXED: none
    const bool *two_sided;      // by shape
    uint32_t bounces, factors; // factors: that later hops step by
    const uint32_t *next; // [group][factor]: the group that one leads to
    bool survey; // only finds out what is seen first
};

// Functions of a term's axis: 1 where there is no curve.
static inline uint32_t symbolic_bins(const struct form *f, uint32_t term, enum form_slot_name slot) {
    const struct form_slot *s = &f->term[term].slots[slot];
    return s->gamma.kind == GAMMA_NONE ? 1 : f->curve[s->curve].f[0].table->basis.count;
}

// Coefficients of a term.
static inline uint32_t symbolic_places(const struct form *f, uint32_t term) {
    return symbolic_bins(f, term, SLOT_A) * symbolic_bins(f, term, SLOT_B);
}

// Fills form, first, knows_view and sampler; memory from the arena. The form must outlive it.
void symbolic_object_init(struct symbolic_object *o, const struct form *form, struct arena *arena);
// Fills wide, when the textures are known.
void symbolic_object_ready(struct symbolic_object *o);

// Finds what is seen first, for the survey: `data` of the integrator is the struct symbolic, which
// must be the response, too.
extern const struct integrator_type integrator_survey;

// Fills s->response; the rest is the caller's.
void symbolic_init(struct symbolic *s);
