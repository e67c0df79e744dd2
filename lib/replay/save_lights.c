// SPDX-License-Identifier: Apache-2.0
#include "replay/save_lights.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "replay/scene_copy.h"

static bool is(const char *text, const char *other) {
    return text && strcmp(text, other) == 0;
}

// ---- factors ------------------------------------------------------------------------------------

// What the emission of each kind of emitter is called, and its value where the scene says nothing.
static const struct {
    const char *type, *name, *value;
} emissions[] = {
    {"area", "radiance", "1"},       {"constant", "radiance", "1"},
    {"point", "intensity", "1"},     {"spot", "intensity", "1"},
    {"ies", "intensity", "1"},       {"projector", "irradiance", "1"},
    {"directional", "irradiance", "1"}, {"envmap", "scale", "1"},
    {"sunsky", "sky_scale", "1"},    {"sunsky", "sun_scale", "1"},
    {NULL, NULL, NULL},
};

static struct xml_node *parameter(const struct xml_node *node, const char *name) {
    for (struct xml_node *n = node->first; n; n = n->next)
        if (is(xml_get(n, "name"), name))
            return n;
    return NULL;
}

static bool refuse(const struct xml_node *emitter, const char *why) {
    log_error_at(emitter->at, "emitter \"%s\": cannot be given a factor: %s", xml_get(emitter, "type"),
                 why);
    return false;
}

// One or three numbers of a text.
static int numbers_of(const char *text, double v[3]) {
    char rest;
    int n = sscanf(text, "%lf %lf %lf %c", &v[0], &v[1], &v[2], &rest);
    if (n == 1 && strchr(text, ','))
        n = sscanf(text, "%lf , %lf , %lf %c", &v[0], &v[1], &v[2], &rest);
    return n;
}

static bool multiply(struct scene_copy *c, struct xml_node *emitter, struct xml_node *value,
                     const double factor[3]) {
    double v[3];
    const bool grey = factor[0] == factor[1] && factor[1] == factor[2];
    const char *text = xml_get(value, "value");
    const int n = text ? numbers_of(text, v) : 0;
    if (n != 1 && n != 3)
        return refuse(emitter, "its emission is no number and no colour");
    if (n == 1)
        v[1] = v[2] = v[0];
    if (is(value->tag, "float") && !grey)
        return refuse(emitter, "its scale is one number, the factor a colour");
    if (is(value->tag, "float")) {
        xml_set(value, "value", arena_printf(&c->arena, "%.9g", v[0] * factor[0]), &c->arena);
        return true;
    }
    if (!is(value->tag, "rgb") && !is(value->tag, "spectrum"))
        return refuse(emitter, "its emission is no number and no colour");
    if (is(value->tag, "spectrum") && (n != 1 || !grey))
        return refuse(emitter, "its emission is a spectrum");
    xml_set(value, "value", is(value->tag, "spectrum")
                ? arena_printf(&c->arena, "%.9g", v[0] * factor[0])
                : arena_printf(&c->arena, "%.9g, %.9g, %.9g", v[0] * factor[0], v[1] * factor[1],
                               v[2] * factor[2]), &c->arena);
    return true;
}

static bool scale_emitter(struct scene_copy *c, struct xml_node *emitter, const double factor[3]) {
    bool known = false, good = true;
    for (int i = 0; emissions[i].type && good; i++) {
        if (!is(xml_get(emitter, "type"), emissions[i].type))
            continue;
        known = true;
        struct xml_node *value = parameter(emitter, emissions[i].name);
        if (!value) {
            const bool number = strstr(emissions[i].name, "scale") != NULL;
            scene_copy_add(c, emitter, number ? "float" : "rgb", emissions[i].name, emissions[i].value);
            value = emitter->last;
        }
        good = multiply(c, emitter, value, factor);
    }
    return known ? good : refuse(emitter, "it is not known how");
}

// Whether an emitter is of the name that the tensor knows it by.
static bool is_called(const struct xml_node *emitter, const struct xml_node *around, const char *name) {
    const struct xml_node *group = parameter(emitter, "group");
    return (group && is(xml_get(group, "value"), name)) || is(xml_get(emitter, "id"), name) ||
           (is(around->tag, "shape") && is(xml_get(around, "id"), name));
}

static bool scale_named(struct scene_copy *c, struct xml_node *node, const char *name,
                        const double factor[3], size_t *found) {
    bool good = true;
    for (struct xml_node *n = node->first; n && good; n = n->next) {
        if (is(n->tag, "emitter") && is_called(n, node, name)) {
            ++*found;
            good = scale_emitter(c, n, factor);
        }
        good = good && scale_named(c, n, name, factor, found);
    }
    return good;
}

bool save_light_factor(struct scene_copy *c, const char *name, const double factor[3]) {
    size_t found = 0;
    if (!scale_named(c, c->root, name, factor, &found))
        return false;
    if (found == 0)
        log_error("%s: has no emitter of the id or group %s in the file itself", c->scene, name);
    return found > 0;
}

// "NAME=R,G,B" or "NAME=X", which relight_weights has checked.
static bool scale_light(struct scene_copy *c, const char *text) {
    const char *equals = strchr(text, '=');
    double factor[3];
    if (sscanf(equals + 1, "%lf,%lf,%lf", &factor[0], &factor[1], &factor[2]) == 1)
        factor[1] = factor[2] = factor[0];
    return save_light_factor(c, arena_printf(&c->arena, "%.*s", (int)(equals - text), text), factor);
}

// ---- environments -------------------------------------------------------------------------------

static bool is_environment(const struct xml_node *node) {
    const char *type = xml_get(node, "type");
    return is(node->tag, "emitter") &&
           (is(type, "envmap") || is(type, "constant") || is(type, "sunsky"));
}

static void remove_environments(struct xml_node *root) {
    struct xml_node *old = root->first;
    root->first = root->last = NULL;
    while (old) {
        struct xml_node *next = old->next;
        old->next = NULL;
        if (!is_environment(old))
            xml_append(root, old);
        old = next;
    }
}

// Turns an emitter after all else that places it.
static void turn(struct scene_copy *c, struct xml_node *emitter, double degrees) {
    struct xml_node *place = parameter(emitter, "to_world");
    if (!place)
        place = parameter(emitter, "toWorld"); // version 0.5
    if (!place) {
        place = xml_new("transform", c->root->at, &c->arena);
        xml_set(place, "name", "to_world", &c->arena);
        xml_append(emitter, place);
    }
    struct xml_node *rotate = xml_new("rotate", c->root->at, &c->arena);
    xml_set(rotate, "y", "1", &c->arena);
    xml_set(rotate, "angle", arena_printf(&c->arena, "%.9g", degrees), &c->arena);
    xml_append(place, rotate);
}

static bool replace_environment(struct scene_copy *c, const struct relight_lighting *l) {
    char *whole = realpath(l->environment, NULL);
    if (!whole) {
        log_error("%s: cannot be found", l->environment);
        return false;
    }
    remove_environments(c->root);
    struct xml_node *emitter = xml_new("emitter", c->root->at, &c->arena);
    xml_set(emitter, "type", "envmap", &c->arena);
    scene_copy_add(c, emitter, "string", "filename", arena_strdup(&c->arena, whole));
    turn(c, emitter, l->rotate);
    xml_append(c->root, emitter);
    free(whole);
    return true;
}

static bool turn_environments(struct scene_copy *c, double degrees) {
    bool found = false;
    for (struct xml_node *n = c->root->first; n; n = n->next)
        if (is_environment(n)) {
            found = true;
            if (!is(xml_get(n, "type"), "constant"))
                turn(c, n, degrees);
        }
    if (!found)
        log_error("%s: has no environment in the file itself that could be turned", c->scene);
    return found;
}

bool save_lights(const struct relight_lighting *l, const struct json *meta, const char *scene,
                 const char *output) {
    struct scene_copy c;
    bool good = scene_copy_init(&c, scene, output, meta);
    if (good && l->environment)
        good = replace_environment(&c, l);
    else if (good && l->rotate != 0)
        good = turn_environments(&c, l->rotate);
    for (size_t i = 0; i < l->light_count && good; i++)
        good = scale_light(&c, l->lights[i]);
    good = good && scene_copy_write(&c);
    scene_copy_finish(&c);
    return good;
}
