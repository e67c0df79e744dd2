// SPDX-License-Identifier: Apache-2.0
// Parameter sets with which every material of the registry is tested, and the directions.
//
// A family of materials has its rows in property/bsdf_cases_FAMILY.inc; 20 sets a material are
// required. A row with `draws` stands for that many sets drawn from the ranges in its text, its
// children's included: "a=0..1" is uniform, "a=1e-3~1" uniform in the logarithm, "a=*" any of a
// choice's or a switch's values; colours draw each channel.
#pragma once

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "make_object.h"
#include "math/hash.h"

#ifndef BSDF_FILES
#define BSDF_FILES "." // where the files of measured materials are
#endif

struct bsdf_case {
    const char *name;
    const char *overrides;
    const char *children[2]; // "NAME OVERRIDES"; NULL: none
    float eta;               // index inside over outside where light crosses; 0: not checked
    float tolerance;         // relative, of pdf and weight between sample and eval; 0: 2e-3
    float alpha;             // of a nearly smooth lobe, whose rounding counts besides; 0: none
    int draws;               // 0: the row is one set as it stands
    bool steps;              // densities of tables jump: cubature takes them less exactly
    uint32_t waived;         // claims that these parameters give up, as the material's help says
};

static const struct bsdf_case bsdf_rows[] = {
#include "property/bsdf_cases_classic.inc"
#include "property/bsdf_cases_standard.inc"
#include "property/bsdf_cases_editable.inc"
#include "property/bsdf_cases_measured.inc"
#include "property/bsdf_cases_principled.inc"
};

enum { BSDF_ROWS = sizeof bsdf_rows / sizeof *bsdf_rows, BSDF_DIRECTIONS = 20, BSDF_SETS = 20 };

static inline int bsdf_row_sets(int row) {
    return bsdf_rows[row].draws ? bsdf_rows[row].draws : 1;
}

// Number of sets of that material, of all materials for NULL.
static inline int bsdf_set_count(const char *name) {
    int n = 0;
    for (int i = 0; i < BSDF_ROWS; i++)
        if (!name || strcmp(bsdf_rows[i].name, name) == 0)
            n += bsdf_row_sets(i);
    return n;
}

// One number of a range "LOW..HIGH" or "LOW~HIGH"; anything else stands as it is.
static inline void bsdf_draw_number(struct rng *rng, const char *range, char *out, size_t size) {
    const char *dots = strstr(range, ".."), *wave = strchr(range, '~');
    if (!dots && !wave) {
        snprintf(out, size, "%s", range);
        return;
    }
    // not by strtod's end: it takes the first of two dots for a decimal point
    const double low = atof(range), high = atof(dots ? dots + 2 : wave + 1), u = rng_float(rng);
    snprintf(out, size, "%.5g", dots ? low + u * (high - low) : low * pow(high / low, u));
}

static inline void bsdf_draw_choice(struct rng *rng, const struct param *p, char *out,
                                    size_t size) {
    static const char *const switches[] = {"false", "true", NULL};
    const char *const *choices = p->type == PARAM_CHOICE ? p->choices : switches;
    uint32_t n = 0;
    while (choices[n])
        n++;
    snprintf(out, size, "%s", choices[rng_u32(rng) % n]);
}

static inline bool bsdf_param_has_channels(const struct param *p) {
    return p->type == PARAM_REFLECTANCE || p->type == PARAM_INDEX || p->type == PARAM_TEXTURE;
}

static inline void bsdf_draw_value(struct rng *rng, const struct param *p, const char *value,
                                   char *out, size_t size) {
    if (strcmp(value, "*") == 0) {
        bsdf_draw_choice(rng, p, out, size);
        return;
    }
    bsdf_draw_number(rng, value, out, size);
    for (int i = 1; i < 3 && strcmp(out, value) != 0 && bsdf_param_has_channels(p); i++) {
        const size_t n = strlen(out);
        out[n] = ',';
        bsdf_draw_number(rng, value, out + n + 1, size - n - 1);
    }
}

// The text of overrides with every range replaced by a number of it; memory is the arena's.
static inline const char *bsdf_draw_text(struct arena *arena, struct rng *rng, const char *name,
                                         const char *text) {
    char out[1000] = "", *words = arena_strdup(arena, text), *state;
    for (char *w = strtok_r(words, " ", &state); w; w = strtok_r(NULL, " ", &state)) {
        char number[200], *value = strchr(w, '=');
        const size_t n = strlen(out);
        *value++ = '\0';
        const struct param *p = param_find(registry_find(&bsdfs, name), w);
        if (!p) {
            printf("%s has no parameter \"%s\"\n", name, w);
            exit(1);
        }
        bsdf_draw_value(rng, p, value, number, sizeof number);
        snprintf(out + n, sizeof out - n, "%s%s=%s", n ? " " : "", w, number);
    }
    return arena_strdup(arena, out);
}

static inline void bsdf_first_word(const char *text, char *word, size_t size) {
    size_t n = 0;
    while (text[n] && text[n] != ' ' && n + 1 < size) {
        word[n] = text[n];
        n++;
    }
    word[n] = '\0';
}

// The set of that number of a row, its ranges drawn; each row has its own random numbers, so that
// it stays the same whatever rows are added elsewhere.
static inline struct bsdf_case bsdf_case_at(struct arena *arena, int row, int set) {
    struct bsdf_case c = bsdf_rows[row];
    struct rng rng = {(uint64_t)set};
    if (!c.draws)
        return c;
    for (const char *s = c.overrides; *s; s++)
        rng.state = hash_u64(rng.state + (unsigned char)*s);
    c.overrides = bsdf_draw_text(arena, &rng, c.name, c.overrides);
    for (int i = 0; i < 2 && c.children[i]; i++) {
        char name[64];
        bsdf_first_word(c.children[i], name, sizeof name);
        c.children[i] = arena_printf(
            arena, "%s %s", name,
            bsdf_draw_text(arena, &rng, name, c.children[i] + strlen(name)));
    }
    return c;
}

static inline struct object *bsdf_case_make(struct arena *arena, const struct bsdf_case *c) {
    const struct object *children[3] = {NULL, NULL, NULL};
    for (int i = 0; i < 2 && c->children[i]; i++) {
        char name[64];
        bsdf_first_word(c->children[i], name, sizeof name);
        children[i] = make_bsdf(arena, name, c->children[i] + strlen(name), NULL);
    }
    return make_bsdf(arena, c->name, c->overrides, children);
}

static inline void bsdf_case_print(const struct bsdf_case *c) {
    printf("%s %s", c->name, c->overrides);
    for (int i = 0; i < 2 && c->children[i]; i++)
        printf(" (%s)", c->children[i]);
}

// Whether a material is meant by the program's arguments: all are when there are none.
static inline bool bsdf_is_asked(int argc, char **argv, const char *name) {
    bool asked = argc < 2;
    for (int i = 1; i < argc; i++)
        asked = asked || strcmp(argv[i], name) == 0;
    return asked;
}

// Ten angles from 1 to 89 degrees on either side of the surface, in various azimuths.
static inline vec3 bsdf_direction(int i) {
    static const float degrees[10] = {1, 12, 27, 40, 52, 63, 72, 80, 86, 89};
    const float theta = degrees[i % 10] * (PI / 180), phi = 2.4f * (float)i;
    return v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi),
              i < 10 ? cosf(theta) : -cosf(theta));
}

static inline struct bsdf_point bsdf_case_point(void) {
    struct bsdf_point p = {.at = {.uv = {0.3f, 0.6f}}};
    p.frame = (struct frame){v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)};
    p.dpdu = v3(1, 0, 0);
    p.dpdv = v3(0, 1, 0);
    return p;
}
