// SPDX-License-Identifier: Apache-2.0
// Which light to sample at a place.
//
// Scenes of few lights take one from a table, half uniformly and half by power: the cheapest way.
// Where there are many, triangles of emitting meshes counted each, a light tree chooses among all
// parts that have a place (light/light_tree.h); lights without one (sky, sun) are chosen apart,
// with a fixed probability.
#pragma once

#include "light/light.h"
#include "math/distribution.h"

enum light_choice_mode {
    LIGHT_CHOICE_AUTO,    // the tree where there are many lights, else the table
    LIGHT_CHOICE_TREE,
    LIGHT_CHOICE_POWER,   // of each part
    LIGHT_CHOICE_UNIFORM, // all parts the same
};

extern const char *const light_choice_modes[]; // their names, NULL-terminated

// A light, with the functions and data it is called with at every vertex.
struct world_light {
    const struct light_type *type;
    const void *data;
    float pmf;           // probability of being chosen where that does not depend on the place
    uint32_t first_part; // of all parts of the scene; its parts follow one another
    const uint8_t *dark; // by shape: 1 where it gives no light; NULL: it lights all
    bool hidden;         // from the rays of the sensor
    uint32_t parts;      // sampled each on its own; 0: the light is sampled as a whole
};

struct light_choice {
    bool draws;          // it needs a random number
    bool by_part;        // chosen among parts, not among lights
    bool has_tree;
    struct alias_table table;   // of lights, of parts, or with a tree of lights without a place
    float table_share;          // with a tree: probability of taking from the table
    uint32_t *table_light;      // with a tree: light by entry of the table
    uint32_t *block_light;      // by part: the light of every 64th, and the last light
    struct light_tree tree;     // of all parts; those without a place are dark there
};

// all[].type and data are given; fills the rest of them.
void light_choice_init(struct light_choice *c, enum light_choice_mode mode,
                       struct world_light *all, uint32_t count);
void light_choice_finish(struct light_choice *c);
size_t light_choice_bytes(const struct light_choice *c);
const char *light_choice_name(const struct light_choice *c);

// A point on one light as seen from a place; s->pdf_sa includes the probability of the choice.
// false: nothing was sampled. u1 chooses; it is not used where choice->draws is false. The emission
// may be left for late (light_late_emission).
bool light_choice_sample(const struct light_choice *c, const struct world_light *all,
                         uint32_t count, const struct light_place *at, float u1, struct vec2 u2,
                         uint32_t *light, struct light_sample *s);
// Its two steps where lights are not chosen by part: a light, and a point on it (first_part).
uint32_t light_choice_of_all(const struct light_choice *c, uint32_t count, float u1, float *pmf);
// leaf: what the tree knows of the part, or NULL.
bool light_chosen_sample(const struct world_light *l, uint32_t part, const struct light_leaf *leaf,
                         vec3 p, struct vec2 u2, float pmf, struct light_sample *s);
// The first step for the lanes of `wanted`, where lights are chosen by part: those that found one,
// with the bits of one at a time.
struct light_parts {
    uint32_t part[WIDE_LANES], light[WIDE_LANES];
    const struct light_leaf *leaf[WIDE_LANES];
    float pmf[WIDE_LANES];
};
uint32_t light_choice_parts(const struct light_choice *c, const struct world_light *all,
                            uint32_t wanted, const struct light_place at[WIDE_LANES], wide u1,
                            const wide u2[2], struct light_parts *out);
static inline spectrum light_late_emission(const struct world_light *light, vec3 wi) {
    return light->type->emission(light->data, &(struct light_hit){.wi = wi, .distance = INFINITY});
}

// The density with which light_choice_sample finds the point of a light that a ray has found.
float light_choice_pdf_sa(const struct light_choice *c, const struct world_light *light,
                          const struct light_place *at, const struct light_hit *hit);
// Sends for the memory that this will need, without waiting for it: at most one light a lane, and the
// triangle of each that was found.
void light_choice_prefetch(const struct light_choice *c, const struct world_light *all,
                           const uint32_t *found, const uint32_t *triangles, int count);
