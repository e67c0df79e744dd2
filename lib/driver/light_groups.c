// SPDX-License-Identifier: Apache-2.0
#include "driver/light_groups.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "driver/cryptomatte.h"
#include "sink/film.h"

static bool any_named(const struct scene *s) {
    for (uint32_t i = 0; i < s->light_count; i++)
        if (s->lights[i].group)
            return true;
    return false;
}

static uint32_t find_or_add(struct light_groups *g, const char *name) {
    for (uint32_t i = 0; i < g->count; i++)
        if (strcmp(g->names[i], name) == 0)
            return i;
    g->names[g->count] = name;
    return g->count++;
}

// Names of the groups, and which each light belongs to; the rest: UINT32_MAX.
static void gather(struct light_groups *g, const struct scene *s) {
    const bool named = any_named(s);
    g->names = mem_array(s->light_count + 1, sizeof *g->names);
    // Media that glow follow the lights as sources.
    const uint32_t sources = s->light_count + s->medium_count;
    g->of_light = mem_array(sources, sizeof *g->of_light);
    for (uint32_t i = 0; i < s->light_count; i++) {
        const char *name = named ? s->lights[i].group : s->lights[i].name;
        g->of_light[i] = name ? find_or_add(g, name) : UINT32_MAX;
    }
}

bool light_groups_init(struct light_groups *g, const struct scene *s) {
    gather(g, s);
    const uint32_t rest = g->count, sources = s->light_count + s->medium_count;
    if (find_or_add(g, "rest") != rest) {
        log_error("%s: --light-groups writes what has no group as \"rest\"; expected another name of "
                  "the light or group that is called so", s->path);
        return false;
    }
    for (uint32_t i = 0; i < sources; i++)
        if (i >= s->light_count || g->of_light[i] == UINT32_MAX)
            g->of_light[i] = rest;
    if (rest <= FILM_MOST_GROUPS)
        return true;
    const struct film_options film = {.x1 = s->film.width, .y1 = s->film.height,
                                      .group_count = g->count};
    log_error("%s: --light-groups would take %u layers (%.1f GiB while rendering); at most %d are "
              "written: give the lights `group` names", s->path, rest,
              (double)film_bytes(&film, FILM_BLOCK) / 0x1p30, FILM_MOST_GROUPS);
    return false;
}

bool light_groups_check(const struct light_groups *g, const struct scene *s) {
    enum { MOST = IMAGE_NAME_SIZE - 1 - 2 }; // beside ".R"
    for (uint32_t i = 0; i < s->light_count; i++) {
        const char *name = g->names[g->of_light[i]];
        const size_t n = strlen(name);
        const bool taken = film_is_layer(name) || cryptomatte_is_layer(name);
        if (n >= 1 && n <= MOST && !taken)
            continue;
        char found[80];
        snprintf(found, sizeof found, taken ? "the name of another layer" : "a name of %zu bytes", n);
        log_error_at(s->lights[i].object->at,
                     "--light-groups: \"%s\" is %s; expected another id of the light, or a `group`, "
                     "of 1 to %d bytes", name, found, MOST);
        return false;
    }
    return true;
}

void light_groups_finish(struct light_groups *g) {
    mem_free(g->names);
    mem_free(g->of_light);
    *g = (struct light_groups){0};
}

static bool no_group(const struct light_groups *g, const char *path, const char *group) {
    char known[400] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < g->count && used < sizeof known; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, " %s", g->names[i]);
    log_error("--light %s: %s has no light or group of that name; there are:%s", group, path, known);
    return false;
}

// Of the group, or UINT32_MAX: those without. How many stay.
static uint32_t keep(struct scene *s, const uint32_t *of_light, uint32_t group) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->light_count; i++) {
        const bool stays = of_light[i] == group;
        if (s->lights[i].shape != SCENE_NONE)
            s->shapes[s->lights[i].shape].light = stays ? kept : SCENE_NONE;
        if (stays)
            s->lights[kept++] = s->lights[i];
    }
    return kept;
}

bool light_groups_keep(struct scene *s, const char *group) {
    struct light_groups g = {0};
    uint32_t wanted = 0, kept = 0;
    gather(&g, s);
    while (wanted < g.count && strcmp(g.names[wanted], group) != 0)
        wanted++;
    if (wanted < g.count || strcmp(group, "rest") == 0)
        kept = keep(s, g.of_light, wanted < g.count ? wanted : UINT32_MAX);
    const bool known = kept || no_group(&g, s->path, group);
    s->light_count = kept;
    light_groups_finish(&g);
    return known;
}
