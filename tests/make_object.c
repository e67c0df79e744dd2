// SPDX-License-Identifier: Apache-2.0
#include "make_object.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "math/ior.h"
#include "math/transform.h"
#include "volume/volume.h"

static void fail(const struct entry *e, const char *what, const char *detail) {
    printf("make_object: %s: %s \"%s\"\n", e ? e->name : "?", what, detail);
    exit(1);
}

static spectrum parse_colour(const struct entry *e, const char *text) {
    float v[3];
    const int n = sscanf(text, "%f,%f,%f", &v[0], &v[1], &v[2]);
    if (n != 1 && n != 3)
        fail(e, "not one or three numbers:", text);
    return n == 1 ? spectrum_grey(v[0]) : spectrum_rgb(v[0], v[1], v[2]);
}

static int parse_choice(const struct entry *e, const struct param *p, const char *text) {
    for (int i = 0; p->choices[i]; i++)
        if (strcmp(p->choices[i], text) == 0)
            return i;
    fail(e, "not a choice:", text);
    return 0;
}

static float parse_ior(const struct entry *e, const char *text) {
    char *end;
    float v = strtof(text, &end);
    if (*end && !ior_dielectric_find(text, &v))
        fail(e, "not a number or a dielectric:", text);
    return v;
}

static vec3 parse_vector(const struct entry *e, const char *text) {
    float v[3];
    if (sscanf(text, "%f,%f,%f", &v[0], &v[1], &v[2]) != 3)
        fail(e, "not three numbers:", text);
    return v3(v[0], v[1], v[2]);
}

static void set(struct arena *arena, const struct entry *e, const struct param *p, void *data,
                const char *text) {
    void *out = (char *)data + p->offset;
    switch (p->type) {
    case PARAM_BOOL: *(bool *)out = strcmp(text, "true") == 0; break;
    case PARAM_INT: *(int *)out = atoi(text); break;
    case PARAM_FLOAT: *(float *)out = strtof(text, NULL); break;
    case PARAM_CHOICE: *(int *)out = parse_choice(e, p, text); break;
    case PARAM_STRING:
    case PARAM_FILE: *(const char **)out = arena_strdup(arena, text); break;
    case PARAM_POINT:
    case PARAM_VECTOR: *(vec3 *)out = parse_vector(e, text); break;
    case PARAM_TRANSFORM: *(struct transform *)out = transform_identity; break;
    case PARAM_REFLECTANCE:
    case PARAM_EMISSION:
    case PARAM_INDEX: *(spectrum *)out = parse_colour(e, text); break;
    case PARAM_VOLUME:
        *(struct volume_ref *)out = (struct volume_ref){parse_colour(e, text), NULL, true};
        break;
    case PARAM_TEXTURE:
    case PARAM_TEXTURE_EMISSION:
    case PARAM_TEXTURE_SCALAR: ((struct texture_ref *)out)->value = parse_colour(e, text); break;
    case PARAM_IOR: *(float *)out = parse_ior(e, text); break;
    case PARAM_BSDF:
    case PARAM_INTEGRATOR:
    case PARAM_PHASE:
    case PARAM_IGNORED: break;
    }
}

static bool is_in(const struct registry *r, const struct entry *e) {
    for (const struct entry *const *i = r->entries; *i; i++)
        if (*i == e)
            return true;
    return false;
}

// Puts a child into the first free slot that takes it.
static void adopt(const struct entry *e, void *data, const struct object *child) {
    const bool texture = is_in(&textures, child->type);
    for (const struct param *p = e->params; p && p->name; p++) {
        void *out = (char *)data + p->offset;
        const bool takes_texture = p->type == PARAM_TEXTURE || p->type == PARAM_TEXTURE_SCALAR ||
                                   p->type == PARAM_TEXTURE_EMISSION;
        const bool takes_other = p->type == PARAM_BSDF || p->type == PARAM_INTEGRATOR ||
                                 p->type == PARAM_PHASE;
        const struct object **slot = texture ? &((struct texture_ref *)out)->texture : out;
        if ((texture ? takes_texture : takes_other) && !*slot) {
            *slot = child;
            return;
        }
    }
    fail(e, "no place for a", child->type->name);
}

static void override(struct arena *arena, const struct entry *e, void *data, const char *text) {
    char *words = arena_strdup(arena, text), *state;
    for (char *w = strtok_r(words, " ", &state); w; w = strtok_r(NULL, " ", &state)) {
        char *value = strchr(w, '=');
        if (!value)
            fail(e, "no value in", w);
        *value++ = '\0';
        const struct param *p = param_find(e, w);
        if (!p)
            fail(e, "no parameter", w);
        else
            set(arena, e, p, data, value);
    }
}

struct object *make_object(struct arena *arena, const struct registry *registry, const char *name,
                           const char *overrides, const struct object *const *children) {
    const struct entry *e = registry_find(registry, name);
    if (!e)
        fail(e, "no such entry:", name);
    struct object *o = arena_alloc(arena, sizeof *o);
    o->type = e;
    o->data = arena_alloc(arena, e->size ? e->size : 1);
    for (const struct param *p = e->params; p && p->name; p++)
        if (p->def)
            set(arena, e, p, o->data, p->def);
    if (overrides)
        override(arena, e, o->data, overrides);
    for (; children && *children; children++)
        adopt(e, o->data, *children);
    return o;
}

struct object *make_bsdf(struct arena *arena, const char *name, const char *overrides,
                         const struct object *const *children) {
    struct object *o = make_object(arena, &bsdfs, name, overrides, children);
    const struct bsdf_type *type = bsdf_type_of(o);
    if (type->prepare && !type->prepare(o, arena))
        fail(o->type, "was not prepared with", overrides ? overrides : "");
    return o;
}

struct object *make_texture(struct arena *arena, const char *name, const char *overrides,
                            const struct object *const *children) {
    struct object *o = make_object(arena, &textures, name, overrides, children);
    const struct texture_type *type = texture_type_of(o);
    if (type->prepare && !type->prepare(o, arena))
        fail(o->type, "was not prepared with", overrides ? overrides : "");
    return o;
}
