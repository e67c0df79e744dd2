// SPDX-License-Identifier: Apache-2.0
#include "driver/edit_classes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"

enum { NO_CLASS = UINT32_MAX };

// Of darker objects it is not known what they would pass on.
static const double least_albedo = 1e-3;

// ---- membership -----------------------------------------------------------------------------

static bool take(struct edit_classes *c, const struct edit_plan *p, const char *name, size_t length,
                 const char *text) {
    for (uint32_t i = 0; i < p->count; i++) {
        if (strncmp(p->objects[i].name, name, length) != 0 || p->objects[i].name[length])
            continue;
        if (c->of[i] == NO_CLASS) {
            c->of[i] = c->count;
            return true;
        }
        log_error("--group %s: %s is in a group already", text, p->objects[i].name);
        return false;
    }
    const char *known = "";
    for (uint32_t i = 0; i < p->count; i++)
        known = arena_printf(&c->arena, "%s %s", known, p->objects[i].name);
    log_error("--group %s: no object %.*s; there are:%s", text, (int)length, name, known);
    return false;
}

// "NAME=OBJECT,OBJECT,..."
static bool add_named(struct edit_classes *c, const struct edit_plan *p, const char *text) {
    const char *at = strchr(text, '=');
    if (!at || at == text || !at[1]) {
        log_error("--group %s: expected NAME=OBJECT,OBJECT,... or a number of groups", text);
        return false;
    }
    c->names[c->count] = arena_printf(&c->arena, "%.*s", (int)(at - text), text);
    while (*at) {
        const size_t length = strcspn(++at, ",");
        if (!take(c, p, at, length, text))
            return false;
        at += length;
    }
    c->count++;
    return true;
}

struct rank {
    uint32_t object;
    double passed;
};

static int by_light(const void *a, const void *b) {
    const struct rank *x = a, *y = b;
    if (x->passed != y->passed)
        return x->passed > y->passed ? -1 : 1;
    return x->object < y->object ? -1 : 1;
}

// All but the classes - 1 that pass most light on are together.
static void add_rest(struct edit_classes *c, const struct edit_plan *p,
                     const double (*passed)[CURVE_CHANNELS], uint32_t classes) {
    struct rank *ranks = mem_array(p->count, sizeof *ranks);
    for (uint32_t i = 0; i < p->count; i++)
        ranks[i] = (struct rank){i, passed[i][0] + passed[i][1] + passed[i][2]};
    qsort(ranks, p->count, sizeof *ranks, by_light);
    for (uint32_t i = classes - 1; i < p->count; i++)
        c->of[ranks[i].object] = c->count;
    c->names[c->count++] = "rest";
    mem_free(ranks);
}

static bool find_members(struct edit_classes *c, const struct edit_plan *p,
                         const double (*passed)[CURVE_CHANNELS], const char *const *texts,
                         size_t count) {
    for (size_t i = 0; i < count; i++) {
        char *end;
        const long n = strtol(texts[i], &end, 10);
        if (*end || end == texts[i]) {
            if (!add_named(c, p, texts[i]))
                return false;
            continue;
        }
        if (count > 1 || n < 1) {
            log_error("--group %s: expected a number of at least 1, and no other --group", texts[i]);
            return false;
        }
        if (n < (long)p->count)
            add_rest(c, p, passed, (uint32_t)n);
    }
    for (uint32_t i = 0; i < p->count; i++)
        if (c->of[i] == NO_CLASS)
            c->of[i] = c->count++;
    return true;
}

// ---- shares ---------------------------------------------------------------------------------

// Light that a member would pass on with albedo 1; dark ones count like the others in the mean, and
// all alike where none has passed any.
static void weigh(struct edit_classes *c, const struct edit_plan *p,
                  const double (*passed)[CURVE_CHANNELS], uint32_t class, int k) {
    double sum = 0, known = 0, all = 0;
    for (uint32_t i = 0; i < p->count; i++)
        if (c->of[i] == class && c->base[i][k] > least_albedo) {
            sum += passed[i][k] / c->base[i][k];
            known++;
        }
    const double mean = sum > 0 ? sum / known : 1;
    for (uint32_t i = 0; i < p->count; i++)
        if (c->of[i] == class) {
            const bool lit = sum > 0 && c->base[i][k] > least_albedo;
            c->base[i][k] = fmax(c->base[i][k], least_albedo);
            c->share[i][k] = lit ? passed[i][k] / c->base[i][k] : mean;
            all += c->share[i][k] * c->base[i][k];
        }
    for (uint32_t i = 0; i < p->count; i++)
        if (c->of[i] == class)
            c->share[i][k] /= all;
}

bool edit_classes_init(struct edit_classes *c, const struct edit_plan *p,
                       double *const (*albedos)[FORM_TERMS],
                       const double (*passed)[CURVE_CHANNELS], const char *const *texts, size_t count) {
    *c = (struct edit_classes){.count = 0};
    c->of = arena_alloc(&c->arena, p->count * sizeof *c->of);
    c->names = arena_alloc(&c->arena, (p->count + count + 1) * sizeof *c->names);
    c->base = arena_alloc(&c->arena, p->count * sizeof *c->base);
    c->share = arena_alloc(&c->arena, p->count * sizeof *c->share);
    for (uint32_t i = 0; i < p->count; i++) {
        c->of[i] = NO_CLASS;
        for (int k = 0; k < CURVE_CHANNELS; k++)
            c->base[i][k] = c->share[i][k] = 1;
    }
    if (!find_members(c, p, passed, texts, count)) {
        edit_classes_finish(c);
        return false;
    }
    for (uint32_t i = 0; i < p->count; i++)
        if (c->names[c->of[i]])
            edit_plan_albedo(p, i, albedos[i], c->base[i]);
    for (uint32_t g = 0; g < c->count; g++)
        for (int k = 0; k < CURVE_CHANNELS && c->names[g]; k++)
            weigh(c, p, passed, g, k);
    return true;
}

void edit_classes_finish(struct edit_classes *c) {
    arena_finish(&c->arena);
    *c = (struct edit_classes){.count = 0};
}

void edit_classes_describe(const struct edit_classes *c, const struct edit_plan *p, uint32_t index,
                           struct json *factor) {
    struct json *members = NULL;
    if (c->names[index]) {
        json_add_text(factor, "name", c->names[index]);
        members = json_add_array(factor, "members");
    }
    for (uint32_t i = 0; i < p->count; i++) {
        if (c->of[i] != index)
            continue;
        struct json *j = members ? json_append_object(members) : factor;
        json_add_count(j, "object", i);
        struct json *weight = members ? json_add_array(j, "weight") : NULL;
        for (int k = 0; weight && k < CURVE_CHANNELS; k++)
            json_append_number(weight, c->share[i][k]);
    }
}
