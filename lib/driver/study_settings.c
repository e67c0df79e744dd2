// SPDX-License-Identifier: Apache-2.0
#include "driver/study_settings.h"

#include <string.h>

#include "base/param_text.h"

// ---- settings of a run ------------------------------------------------------------------------

enum { SPP, TIME, CLAMP, ADAPTIVE };

static const struct param run_settings[] = {
    [SPP] = {"spp", PARAM_INT, 0, .min = 1, .max = 1 << 30, .help = "samples per pixel"},
    [TIME] = {"time", PARAM_FLOAT, 0, .min = 1e-3, .max = 1e9, .help = "seconds to render for"},
    [CLAMP] = {"clamp", PARAM_FLOAT, 0, .min = 0, .max = 1e30, .help = "limit of indirect light; 0: none"},
    [ADAPTIVE] = {"adaptive", PARAM_BOOL, 0, .help = "samples go where a pilot finds noise"},
    PARAM_END,
};

static const struct param *find(const struct param *p, const char *name) {
    for (; p && p->name; p++)
        if (strcmp(p->name, name) == 0 && param_takes_text(p))
            return p;
    return NULL;
}

// ---- --vary -----------------------------------------------------------------------------------

static bool split_values(const char *text, struct arena *arena, struct study_factor *f) {
    size_t most = 1;
    for (const char *c = text; *c; c++)
        most += *c == ',';
    f->values = arena_alloc(arena, most * sizeof *f->values);
    for (char *word = arena_strdup(arena, text), *comma; word; word = comma) {
        comma = strchr(word, ',');
        if (comma)
            *comma++ = '\0';
        for (size_t i = 0; i < f->count; i++)
            if (strcmp(f->values[i], word) == 0) {
                log_error("--vary %s: %s stands there twice", f->name, word);
                return false;
            }
        f->values[f->count++] = word;
    }
    return true;
}

static bool parse_factor(const char *text, struct arena *arena, struct study_factors *all) {
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1]) {
        log_error("--vary %s: expected NAME=VALUE,VALUE,...", text);
        return false;
    }
    if (all->count == STUDY_MOST_FACTORS) {
        log_error("--vary %s: a study varies at most %d settings", text, STUDY_MOST_FACTORS);
        return false;
    }
    struct study_factor *f = &all->items[all->count];
    char *name = arena_printf(arena, "%.*s", (int)(equals - text), text);
    for (char *c = name; *c; c++)
        *c = *c == '-' ? '_' : *c;
    *f = (struct study_factor){.name = name};
    for (size_t i = 0; i < all->count; i++)
        if (strcmp(all->items[i].name, name) == 0) {
            log_error("--vary %s is given twice", name);
            return false;
        }
    all->count++;
    return split_values(equals + 1, arena, f);
}

static bool known_names(const struct study_factor *f, const struct registry *r) {
    for (size_t i = 0; strcmp(f->name, r->kind) == 0 && i < f->count; i++)
        if (!registry_find(r, f->values[i])) {
            const char *nearest = registry_nearest(r, f->values[i]);
            log_error("--vary %s: found '%s'%s%s%s (see relume help %s)", r->kind, f->values[i],
                      nearest ? "; the nearest is '" : "", nearest ? nearest : "",
                      nearest ? "'" : "", r->kind);
            return false;
        }
    return true;
}

bool study_factors_parse(const struct option_list *texts, struct arena *arena,
                         struct study_factors *factors) {
    *factors = (struct study_factors){.count = 0};
    for (size_t i = 0; i < texts->count; i++)
        if (!parse_factor(texts->items[i], arena, factors))
            return false;
    for (size_t i = 0; i < factors->count; i++)
        if (!known_names(&factors->items[i], &integrators) ||
            !known_names(&factors->items[i], &samplers))
            return false;
    return true;
}

// ---- combinations -----------------------------------------------------------------------------

static bool names_type(const char *factor) {
    return strcmp(factor, integrators.kind) == 0 || strcmp(factor, samplers.kind) == 0;
}

// The parameter of an object or of what it wraps, and the object that has it.
static const struct param *find_inside(const struct object *o, const char *name,
                                       const struct object **owner) {
    const struct param *found = find(o->type->params, name);
    *owner = o;
    for (const struct param *p = o->type->params; !found && p && p->name; p++) {
        const struct object *inner = NULL;
        if (p->type == PARAM_INTEGRATOR)
            memcpy(&inner, (const char *)o->data + p->offset, sizeof inner);
        found = inner ? find_inside(inner, name, owner) : NULL;
    }
    return found;
}

static const struct param *find_in_method(const struct registry *r, const char *named,
                                          const struct object *of_scene, const char *name) {
    const struct object *owner;
    return named ? find(registry_find(r, named)->params, name) : find_inside(of_scene, name, &owner);
}

static const char *value_of(const struct study_factors *f, const struct study_combination *c,
                            const char *name) {
    for (size_t i = 0; i < f->count; i++)
        if (strcmp(f->items[i].name, name) == 0)
            return c->values[i];
    return NULL;
}

// What a factor means to the method of a combination; NULL: nothing.
static const struct param *meaning(const struct study_factors *f, const struct study_combination *c,
                                   const char *name, const struct scene *s) {
    const struct param *p = find(run_settings, name);
    if (!p)
        p = find_in_method(&integrators, value_of(f, c, integrators.kind), s->integrator, name);
    if (!p)
        p = find_in_method(&samplers, value_of(f, c, samplers.kind), s->sampler, name);
    return p;
}

static void combination_at(const struct study_factors *f, size_t index,
                           struct study_combination *c) {
    *c = (struct study_combination){{NULL}};
    for (size_t i = f->count; i-- > 0; index /= f->items[i].count)
        c->values[i] = f->items[i].values[index % f->items[i].count];
}

enum outcome { KEEP, DROP, BAD };

// Blanks what means nothing to the method; such a setting is tried once only.
static enum outcome check_combination(const struct study_factors *f, const struct scene *s,
                                      struct study_combination *c, bool *used) {
    char value[PARAM_VALUE_BYTES];
    enum outcome outcome = KEEP;
    for (size_t i = 0; i < f->count; i++) {
        if (names_type(f->items[i].name)) {
            used[i] = true;
            continue;
        }
        const struct param *p = meaning(f, c, f->items[i].name, s);
        if (p && !param_parse(p, c->values[i], value))
            return BAD;
        used[i] |= p != NULL;
        if (!p && c->values[i] != f->items[i].values[0])
            outcome = DROP;
        c->values[i] = p ? c->values[i] : NULL;
    }
    return outcome;
}

static void nearest_in(const struct param *p, const char *name, const char **best, int *distance) {
    for (; p && p->name; p++)
        if (param_takes_text(p) && edit_distance(name, p->name) < *distance) {
            *distance = edit_distance(name, p->name);
            *best = p->name;
        }
}

static bool nobody_has(const char *name) {
    const char *best = "";
    int distance = 1 << 20;
    nearest_in(run_settings, name, &best, &distance);
    for (size_t i = 0; integrators.entries[i]; i++)
        nearest_in(integrators.entries[i]->params, name, &best, &distance);
    for (size_t i = 0; samplers.entries[i]; i++)
        nearest_in(samplers.entries[i]->params, name, &best, &distance);
    log_error("--vary %s: no integrator or sampler of this study has a parameter of that name; the "
              "nearest that any has is \"%s\"", name, best);
    return false;
}

struct study_combination *study_combine(const struct study_factors *f, const struct scene *scene,
                                        struct arena *arena, size_t *count) {
    size_t all = 1;
    bool used[STUDY_MOST_FACTORS] = {false};
    for (size_t i = 0; i < f->count; i++)
        if ((all *= f->items[i].count) > STUDY_MOST_COMBINATIONS) {
            log_error("--vary: more than %d combinations", STUDY_MOST_COMBINATIONS);
            return NULL;
        }
    struct study_combination *out = arena_alloc(arena, all * sizeof *out);
    *count = 0;
    for (size_t i = 0; i < all; i++) {
        combination_at(f, i, &out[*count]);
        const enum outcome o = check_combination(f, scene, &out[*count], used);
        if (o == BAD)
            return NULL;
        *count += o == KEEP;
    }
    for (size_t i = 0; i < f->count; i++)
        if (!used[i] && !nobody_has(f->items[i].name))
            return NULL;
    return out;
}

// ---- into a job -------------------------------------------------------------------------------

static void set_parameter(struct object *method, const char *name, const char *text) {
    const struct object *owner;
    const struct param *p = find_inside(method, name, &owner);
    char value[PARAM_VALUE_BYTES];
    if (p && param_parse(p, text, value))
        memcpy((char *)owner->data + p->offset, value, param_text_size(p));
}

static void edit_scene(struct scene *scene, void *user) {
    const struct study_setting *s = user;
    for (size_t i = 0; i < s->factors->count; i++) {
        const char *name = s->factors->items[i].name, *text = s->combination->values[i];
        const struct object *owner;
        if (!text || names_type(name) || find(run_settings, name))
            continue;
        set_parameter(find_inside(scene->integrator, name, &owner) ? scene->integrator
                                                                   : scene->sampler, name, text);
    }
}

void study_apply(const struct study_setting *s, struct job_options *job) {
    const char *spp = value_of(s->factors, s->combination, "spp");
    const char *seconds = value_of(s->factors, s->combination, "time");
    const char *integrator = value_of(s->factors, s->combination, integrators.kind);
    const char *sampler = value_of(s->factors, s->combination, samplers.kind);
    const char *clamp = value_of(s->factors, s->combination, "clamp");
    const char *adaptive = value_of(s->factors, s->combination, "adaptive");
    float limit = 0, most = 0;
    if (spp)
        param_parse(&run_settings[SPP], spp, &job->spp);
    if (seconds && param_parse(&run_settings[TIME], seconds, &limit))
        job->seconds = (double)limit;
    if (clamp && param_parse(&run_settings[CLAMP], clamp, &most))
        job->clamp = (double)most;
    if (adaptive)
        param_parse(&run_settings[ADAPTIVE], adaptive, &job->adaptive);
    job->reading.integrator = integrator ? integrator : job->reading.integrator;
    job->reading.sampler = sampler ? sampler : job->reading.sampler;
    job->edit_scene = edit_scene;
    job->edit_user = (void *)s;
}
