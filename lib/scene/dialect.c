// SPDX-License-Identifier: Apache-2.0
// The elements of Mitsuba's scene language, what versions before 2 called them, and what those
// versions take where a file says nothing.
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "scene/reader.h"

static const struct tag {
    const char *name;
    enum tag_kind kind;
    const char *attributes; // allowed ones, each followed by a blank; '!' before required ones
    const char *was;        // its name in old versions
} tags[] = {
    {"scene", TAG_OBJECT, "type id "},
    {"bsdf", TAG_OBJECT, "!type id name "},
    {"emitter", TAG_OBJECT, "!type id name ", "luminaire"},
    {"shape", TAG_OBJECT, "!type id name "},
    {"texture", TAG_OBJECT, "!type id name "},
    {"sensor", TAG_OBJECT, "!type id name ", "camera"},
    {"film", TAG_OBJECT, "!type id name "},
    {"sampler", TAG_OBJECT, "!type id name "},
    {"rfilter", TAG_OBJECT, "!type id name "},
    {"integrator", TAG_OBJECT, "!type id name "},
    {"medium", TAG_OBJECT, "!type id name "},
    {"phase", TAG_OBJECT, "!type id name "},
    {"volume", TAG_OBJECT, "!type id name "},
    {"subsurface", TAG_OBJECT, "!type id name "},
    {"boolean", TAG_VALUE, "!name !value "},
    {"integer", TAG_VALUE, "!name !value "},
    {"float", TAG_VALUE, "!name !value "},
    {"string", TAG_VALUE, "!name !value "},
    {"point", TAG_VALUE, "!name value x y z "},
    {"vector", TAG_VALUE, "!name value x y z "},
    {"rgb", TAG_VALUE, "!name !value intent "},
    {"srgb", TAG_VALUE, "!name !value intent "},
    {"spectrum", TAG_VALUE, "name value filename type id intent "},
    {"blackbody", TAG_VALUE, "!name !temperature scale "},
    {"transform", TAG_VALUE, "!name "},
    {"translate", TAG_VALUE, "value x y z "},
    {"rotate", TAG_VALUE, "value x y z !angle "},
    {"scale", TAG_VALUE, "value x y z "},
    {"lookat", TAG_VALUE, "!origin !target up ", "lookAt"},
    {"matrix", TAG_VALUE, "!value "},
    {"ref", TAG_REF, "!id name "},
    {"include", TAG_STRUCTURE, "!filename name "},
    {"default", TAG_STRUCTURE, "!name !value "},
    {"path", TAG_STRUCTURE, "!value "},
    {"alias", TAG_STRUCTURE, "!id !as "},
    {"mode", TAG_SKIPPED, "type "},
    {"hide", TAG_SKIPPED, NULL},
};

enum { TAGS = sizeof tags / sizeof *tags };

static const struct tag *find(const char *name) {
    for (int i = 0; i < TAGS; i++)
        if (strcmp(tags[i].name, name) == 0)
            return &tags[i];
    return NULL;
}

enum tag_kind tag_kind(const struct xml_node *node) {
    const struct tag *t = find(node->tag);
    if (t && t->kind == TAG_VALUE && strcmp(node->tag, "spectrum") == 0 && xml_get(node, "type"))
        return TAG_OBJECT;
    return t ? t->kind : TAG_UNKNOWN;
}

const char *tag_nearest(const char *tag) {
    const char *nearest = NULL;
    int best = 1 << 20;
    for (int i = 0; i < TAGS; i++) {
        const int d = edit_distance(tag, tags[i].name);
        if (d < best && 3 * d <= (int)strlen(tags[i].name) + 2) {
            best = d;
            nearest = tags[i].name;
        }
    }
    return nearest;
}

// "intIOR" -> "int_ior", "toWorld" -> "to_world": as Mitsuba 3 upgrades old files.
static const char *snake_case(const char *name, struct arena *arena) {
    const size_t n = strlen(name);
    if (n == 1) // B and C of mitchell
        return name;
    char *out = arena_alloc(arena, 2 * n + 1);
    size_t k = 0;
    for (size_t i = 0; i < n; i++) {
        const bool upper = isupper((unsigned char)name[i]);
        if (upper && i > 0 && islower((unsigned char)name[i - 1]))
            out[k++] = '_';
        out[k++] = (char)tolower((unsigned char)name[i]);
    }
    out[k] = '\0';
    return out;
}

static void append_text(struct reader *r, struct xml_node *node, const char *tag,
                        const char *name, const char *value) {
    struct xml_node *child = xml_new(tag, node->at, r->arena);
    xml_set(child, "name", name, r->arena);
    xml_set(child, "value", value, r->arena);
    xml_append(node, child);
}

// Version 3 has one light for the sky, whose zenith is z, and the sun.
static void upgrade_sky(struct reader *r, struct xml_node *node) {
    const char *type = xml_get(node, "type");
    const bool sky = type && strcmp(type, "sky") == 0, sun = type && strcmp(type, "sun") == 0;
    if (!sky && !sun && !(type && strcmp(type, "sunsky") == 0))
        return;
    append_text(r, node, "string", "up", "y");
    if (sky)
        append_text(r, node, "float", "sun_scale", "0");
    if (sun)
        append_text(r, node, "float", "sky_scale", "0");
    xml_set(node, "type", "sunsky", r->arena);
}

static void upgrade(struct reader *r, struct xml_node *node) {
    for (int i = 0; i < TAGS; i++)
        if (tags[i].was && strcmp(tags[i].was, node->tag) == 0)
            node->tag = tags[i].name;
    if (strcmp(node->tag, "emitter") == 0)
        upgrade_sky(r, node);
    const char *type = xml_get(node, "type");
    if (strcmp(node->tag, "volume") == 0 && type && strcmp(type, "gridvolume") == 0)
        append_text(r, node, "boolean", "use_grid_bbox", "true"); // version 3 ignores the file's
    const char *name = xml_get(node, "name");
    if (name && strcmp(node->tag, "default") != 0) {
        node->old_name = name;
        xml_set(node, "name", snake_case(name, r->arena), r->arena);
    }
}

const char *dialect_spelling(const struct xml_node *node, const char *name, struct arena *arena) {
    if (!node->old)
        return name;
    char *out = arena_alloc(arena, strlen(name) + 1), *end = out;
    for (const char *c = name; *c; c++)
        *end++ = c[0] == '_' && islower((unsigned char)c[1]) ? (char)toupper((unsigned char)*++c) : *c;
    *end = '\0';
    return out;
}

// Whether `name` is in a list of blank-separated words, a '!' before it disregarded.
static bool listed(const char *list, const char *name) {
    const size_t n = strlen(name);
    for (const char *word = list; *word; word = strchr(word, ' ') + 1) {
        const char *start = *word == '!' ? word + 1 : word;
        if (strncmp(start, name, n) == 0 && start[n] == ' ')
            return true;
    }
    return false;
}

static bool check_required(const struct xml_node *node, const char *list) {
    for (const char *word = list; *word; word = strchr(word, ' ') + 1) {
        char name[16];
        const size_t n = (size_t)(strchr(word, ' ') - word) - 1;
        if (*word != '!')
            continue;
        memcpy(name, word + 1, n);
        name[n] = '\0';
        if (!xml_get(node, name)) {
            log_error_at(node->at, "<%s> lacks the attribute \"%s\"", node->tag, name);
            return false;
        }
    }
    return true;
}

// ---- what old objects mean ------------------------------------------------------------------

// The first child with one of these names, or NULL.
static struct xml_node *find_named(const struct xml_node *node, const char *names) {
    for (struct xml_node *c = node->first; c; c = c->next) {
        const char *name = xml_get(c, "name");
        if (name && listed(names, name))
            return c;
    }
    return NULL;
}

#define METAL "conductor roughconductor "
#define SKY "sunsky "
#define MEDIUM "homogeneous "

// Parameters that version 0.6 gives another value than version 3 where a file does not; in order,
// since one that is added counts as given.
static const struct old_default {
    const char *types, *name, *tag, *value;
    const char *unless; // one of these is given
} old_defaults[] = {
    {METAL, "eta", "rgb", "0.2010055 0.9237495 1.102215", "eta material "}, // copper
    {METAL, "k", "rgb", "3.913262 2.453045 2.14209", "k material "},
    {METAL, "ext_eta", "string", "air", "ext_eta "},
    {MEDIUM, "sigma_s", "rgb", "74 88 101", "sigma_s sigma_t albedo material "}, // skin
    {MEDIUM, "sigma_a", "rgb", "3.2 17 48", "sigma_a sigma_t albedo material "},
    {MEDIUM, "sigma_t", "rgb", "77.2 105 149", "sigma_t sigma_s material "},
    {MEDIUM, "albedo", "rgb", "0.958549 0.838095 0.677852", "albedo sigma_s material "},
    {SKY, "albedo", "rgb", "0.2", "albedo "},
};

static void add_defaults(struct reader *r, struct xml_node *node, const char *type) {
    for (size_t i = 0; i < sizeof old_defaults / sizeof *old_defaults; i++) {
        const struct old_default *d = &old_defaults[i];
        if (listed(d->types, type) && !find_named(node, d->unless))
            append_text(r, node, d->tag, d->name, d->value);
    }
}

// In old versions sunScale and skyScale stand in place of scale, in version 3 beside it.
static void upgrade_sky_scale(struct reader *r, struct xml_node *node) {
    struct xml_node *scale = find_named(node, "scale ");
    const bool sun = find_named(node, "sun_scale "), sky = find_named(node, "sky_scale ");
    if (!scale || (!sun && !sky))
        return;
    if (!sun || !sky) {
        xml_set(scale, "name", sun ? "sky_scale" : "sun_scale", r->arena);
        return;
    }
    ignore_name(r, "scale", scale->at);
    xml_set(scale, "value", "1", r->arena);
}

// The four parameters by which old versions placed textures, as the transform they mean.
static bool upgrade_uv(struct reader *r, struct xml_node *node) {
    const char *const names[4] = {"uoffset", "voffset", "uscale", "vscale"};
    double v[4] = {0, 0, 1, 1};
    bool found = false;
    struct xml_node **link = &node->first, *last = NULL;
    while (*link) {
        struct xml_node *child = *link;
        const char *name = xml_get(child, "name");
        int k = 0;
        while (k < 4 && !(name && strcmp(name, names[k]) == 0))
            k++;
        if (k == 4) {
            last = child;
            link = &child->next;
            continue;
        }
        if (!value_number(child, &v[k]))
            return false;
        found = true;
        *link = child->next;
    }
    node->last = last;
    if (!found)
        return true;
    struct xml_node *transform = xml_new("transform", node->at, r->arena);
    struct xml_node *matrix = xml_new("matrix", node->at, r->arena);
    xml_set(transform, "name", "to_uv", r->arena);
    xml_set(matrix, "value", // scale * translate, as Mitsuba 3 upgrades it
            arena_printf(r->arena, "%.17g 0 0 %.17g 0 %.17g 0 %.17g 0 0 1 0 0 0 0 1", v[2],
                         v[2] * v[0], v[3], v[3] * v[1]), r->arena);
    xml_append(transform, matrix);
    xml_append(node, transform);
    return true;
}

bool dialect_upgrade_object(struct reader *r, struct xml_node *node) {
    const char *type = xml_get(node, "type");
    if (type)
        add_defaults(r, node, type);
    if (type && listed(SKY, type))
        upgrade_sky_scale(r, node);
    return upgrade_uv(r, node);
}

static void complain_attribute(const struct xml_node *node, const char *list, const char *name) {
    char known[64], hint[96];
    const char *nearest = NULL;
    size_t n = 0;
    int best = 1 << 20;
    for (const char *c = list; *c; c++)
        if (*c != '!' && n + 1 < sizeof known)
            known[n++] = *c;
    known[n - 1] = '\0'; // the blank behind the last
    snprintf(hint, sizeof hint, "it may have: %s", known);
    for (char *rest, *word = strtok_r(known, " ", &rest); word; word = strtok_r(NULL, " ", &rest))
        name_consider(word, word, name, &best, &nearest);
    if (nearest)
        snprintf(hint, sizeof hint, "did you mean \"%s\"?", nearest);
    log_error_at(node->at, "<%s> has no attribute \"%s\"; %s", node->tag, name, hint);
}

bool dialect_check(struct reader *r, struct xml_node *node) {
    if (node->old)
        upgrade(r, node);
    const struct tag *t = find(node->tag);
    if (!t) {
        const char *nearest = tag_nearest(node->tag);
        log_error_at(node->at, "<%s> is not an element of a scene%s%s%s", node->tag,
                     nearest ? "; did you mean <" : "", nearest ? nearest : "", nearest ? ">?" : "");
        return false;
    }
    if (!t->attributes)
        return true;
    for (int i = 0; i < node->attribute_count; i++)
        if (!listed("version ", node->attributes[i].name) && // outermost elements have it
            !listed(t->attributes, node->attributes[i].name)) {
            complain_attribute(node, t->attributes, node->attributes[i].name);
            return false;
        }
    return check_required(node, t->attributes);
}
