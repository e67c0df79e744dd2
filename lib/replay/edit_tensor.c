// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_tensor.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "curve/form_json.h"
#include "curve/parameters.h"

static bool fail(const struct edit_tensor *e, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static bool fail(const struct edit_tensor *e, const char *format, ...) {
    char text[400];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    log_error("%s: %s", e->path, text);
    return false;
}

static bool read_index(const struct json *j, uint32_t below, uint32_t *out) {
    int64_t v;
    if (!json_read_integer(j, &v) || v < 0 || v >= below)
        return false;
    *out = (uint32_t)v;
    return true;
}

// Finite numbers of at least 0.
static bool read_numbers(const struct json *j, size_t n, double *out) {
    bool sound = json_is_array(j) && json_count(j) == n;
    for (size_t i = 0; i < n && sound; i++)
        sound = json_read_number(json_at(j, i), &out[i]) && out[i] >= 0 && out[i] <= 1e300;
    return sound;
}

enum form_slot_name edit_axis_slot(const struct edit_tensor *e, uint32_t block, uint32_t axis) {
    const struct edited_block *b = &e->blocks[block];
    const struct form_term *t = &e->objects[b->object].form.term[b->term];
    return axis == 0 && edit_has_slot(t, SLOT_A) ? SLOT_A : SLOT_B;
}

uint32_t edit_axis_curve(const struct edit_tensor *e, uint32_t block, uint32_t axis) {
    const struct edited_block *b = &e->blocks[block];
    return e->objects[b->object].form.term[b->term].slots[edit_axis_slot(e, block, axis)].curve;
}

// ---- objects ------------------------------------------------------------------------------------

// A table of three channels in place of a curve, so that every channel can be edited.
static struct curve *own_table(struct edit_tensor *e, struct form_curve *c) {
    const struct curve *from = c->f[0].table;
    struct curve *own = arena_alloc(&e->arena, sizeof *own);
    *own = curve_make(&e->arena, &from->basis, CURVE_CHANNELS);
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++) {
        memcpy(own->values + (size_t)k * from->basis.count, curve_values(from, k),
               sizeof *own->values * from->basis.count);
        c->f[k] = (struct curve_function){.kind = FUNCTION_TABLE, .table = own, .channel = k};
    }
    return own;
}

static bool own_tables(struct edit_tensor *e, struct edited_object *o) {
    for (uint32_t c = 0; c < o->form.curves; c++) {
        if (o->form.curve[c].f[0].kind != FUNCTION_TABLE)
            return fail(e, "object %s: the curve %s is not tabulated", o->name,
                        o->form.curve[c].name);
        o->curve[c] = own_table(e, &o->form.curve[c]);
    }
    return true;
}

static uint32_t bins_of(const struct edited_object *o, const struct form_term *t,
                        enum form_slot_name slot) {
    return edit_has_slot(t, slot) ? o->curve[t->slots[slot].curve]->basis.count : 1;
}

static bool read_terms(struct edit_tensor *e, struct edited_object *o, const struct json *terms) {
    for (uint32_t t = 0; t < o->form.terms; t++) {
        const struct json *j = json_at(terms, t);
        const struct json *share = json_get(j, "share"), *albedo = json_get(j, "albedo");
        const struct form_term *term = &o->form.term[t];
        for (int k = 0; k < CURVE_CHANNELS; k++)
            o->share[t][k] = 1;
        if (share && !read_numbers(share, CURVE_CHANNELS, o->share[t]))
            return fail(e, "%s.%s: its share is not three numbers", o->name, term->name);
        if (!albedo)
            continue;
        const size_t n = (size_t)bins_of(o, term, SLOT_A) * bins_of(o, term, SLOT_B) * CURVE_CHANNELS;
        if (!json_is_array(albedo) || json_count(albedo) != n)
            return fail(e, "%s.%s: expected %zu numbers of its albedo", o->name, term->name, n);
        double *values = arena_alloc(&e->arena, n * sizeof *values);
        if (!read_numbers(albedo, n, values))
            return fail(e, "%s.%s: its albedo holds what is no number of at least 0", o->name,
                        term->name);
        o->albedo[t] = values;
    }
    return true;
}

static bool read_object(struct edit_tensor *e, const struct json *j, struct edited_object *o) {
    const char *name = json_text(json_get(j, "name")), *model = json_text(json_get(j, "model"));
    const struct json *form = json_get(j, "form");
    char at[300];
    if (!name || !*name || !model)
        return fail(e, "an object has no name or no model");
    o->name = name;
    snprintf(at, sizeof at, "%s: object %s", e->path, name);
    for (const struct edited_object *other = e->objects; other < o; other++)
        if (strcmp(other->name, name) == 0)
            return fail(e, "two objects are called %s", name);
    o->model = model_find(model);
    if (*model && !o->model)
        return fail(e, "object %s: there is no model \"%s\"", name, model);
    return parameters_from_json(&o->parameters, json_get(j, "parameters"), at) &&
           form_from_json(&o->form, form, &e->arena, at) && own_tables(e, o) &&
           read_terms(e, o, json_get(form, "terms"));
}

static bool read_objects(struct edit_tensor *e) {
    const struct json *objects = json_get(e->tensor->meta, "objects");
    const size_t n = json_count(objects);
    if (!json_is_array(objects) || n > EDITED_MOST_OBJECTS)
        return fail(e, "its objects are not described");
    e->object_count = (uint32_t)n;
    e->objects = arena_alloc(&e->arena, (n + 1) * sizeof *e->objects);
    for (uint32_t i = 0; i < e->object_count; i++)
        if (!read_object(e, json_at(objects, i), &e->objects[i]))
            return false;
    return true;
}

// ---- factors and groups -------------------------------------------------------------------------

bool edit_factor_has(const struct edited_factor *f, uint32_t object) {
    for (uint32_t i = 0; i < f->count; i++)
        if (f->members[i].object == object)
            return true;
    return false;
}

static bool read_coarse(struct edit_tensor *e, const struct json *j, struct edited_factor *f) {
    const struct edited_object *o = &e->objects[f->members[0].object];
    const struct json *knots = json_get(j, "knots");
    const size_t n = json_count(knots);
    bool sound = read_index(json_get(j, "term"), o->form.terms, &f->term) && n >= 2 &&
                 n <= BASIS_MOST && read_index(json_get(j, "bin"), (uint32_t)n - 1, &f->bin);
    double *values = arena_alloc(&e->arena, n * sizeof *values);
    sound = sound && read_numbers(knots, n, values);
    for (size_t i = 1; i < n && sound; i++)
        sound = values[i] > values[i - 1];
    f->knots = values;
    return sound;
}

// A factor's objects: one, with weight 1, or several.
static bool read_members(struct edit_tensor *e, const struct json *j, struct edited_factor *f) {
    const struct json *list = json_get(j, "members");
    const size_t n = list ? json_count(list) : 1;
    bool sound = !list || (json_is_array(list) && n >= 1 && n <= e->object_count);
    struct edited_member *m = arena_alloc(&e->arena, (sound ? n : 1) * sizeof *m);
    for (size_t i = 0; i < n && sound; i++) {
        const struct json *own = list ? json_at(list, i) : j;
        for (int k = 0; k < CURVE_CHANNELS; k++)
            m[i].weight[k] = 1;
        sound = read_index(json_get(own, "object"), e->object_count, &m[i].object) &&
                (!list || read_numbers(json_get(own, "weight"), CURVE_CHANNELS, m[i].weight));
    }
    f->count = sound ? (uint32_t)n : 0;
    f->members = m;
    return sound;
}

// The members' terms must tell their albedos.
static bool tell_albedos(const struct edit_tensor *e, uint32_t factor) {
    const struct edited_factor *f = &e->factors[factor];
    for (uint32_t i = 0; i < f->count && f->term == EDIT_NOTHING; i++) {
        const struct edited_object *o = &e->objects[f->members[i].object];
        for (uint32_t t = 0; t < o->form.terms; t++)
            if (!o->albedo[t])
                return fail(e, "factor %u is the albedo of %s, whose terms tell none", factor, o->name);
    }
    return true;
}

static bool read_factors(struct edit_tensor *e) {
    const struct json *factors = json_get(e->tensor->meta, "factors");
    const size_t n = json_count(factors);
    if ((factors && !json_is_array(factors)) || n > EDITED_MOST_FACTORS)
        return fail(e, "its factors are not described");
    e->factor_count = (uint32_t)n;
    e->factors = arena_alloc(&e->arena, (n + 1) * sizeof *e->factors);
    for (uint32_t i = 0; i < e->factor_count; i++) {
        const struct json *j = json_at(factors, i);
        struct edited_factor *f = &e->factors[i];
        f->term = EDIT_NOTHING;
        if (!read_members(e, j, f) || (json_get(j, "term") && !read_coarse(e, j, f)))
            return fail(e, "factor %u is not described", i);
        if (!tell_albedos(e, i))
            return false;
    }
    return true;
}

static bool read_group(struct edit_tensor *e, const struct json *j, struct edited_group *g) {
    const size_t n = json_count(j);
    if (!json_is_array(j) || n > EDITED_MOST_POWER)
        return false;
    uint32_t *factors = arena_alloc(&e->arena, (n + 1) * sizeof *factors);
    for (size_t i = 0; i < n; i++)
        if (!read_index(json_at(j, i), e->factor_count, &factors[i]))
            return false;
    *g = (struct edited_group){(uint32_t)n, factors};
    return true;
}

static bool read_groups(struct edit_tensor *e) {
    const struct json *groups = json_get(e->tensor->meta, "groups");
    const size_t n = groups ? json_count(groups) : 1;
    if (groups && (!json_is_array(groups) || n < 1 || n > EDITED_MOST_GROUPS))
        return fail(e, "its groups are not described");
    e->group_count = (uint32_t)n;
    e->groups = arena_alloc(&e->arena, n * sizeof *e->groups);
    for (uint32_t i = 0; i < e->group_count && groups; i++)
        if (!read_group(e, json_at(groups, i), &e->groups[i]))
            return fail(e, "group %u is not a list of factors", i);
    return true;
}

// ---- blocks -------------------------------------------------------------------------------------

static bool find_object(const struct edit_tensor *e, const char *name, uint32_t *out) {
    for (uint32_t i = 0; i < e->object_count; i++)
        if (strcmp(e->objects[i].name, name) == 0) {
            *out = i;
            return true;
        }
    return false;
}

// The block of that object and term name that comes `before`-th belongs to the term that does.
static bool find_term(const struct edit_tensor *e, uint32_t block, struct edited_block *b) {
    const struct tensor_block *t = e->tensor->blocks;
    const struct form *f = &e->objects[b->object].form;
    uint32_t before = 0;
    for (uint32_t i = 0; i < block; i++)
        before += strcmp(t[i].object, t[block].object) == 0 && strcmp(t[i].term, t[block].term) == 0;
    for (uint32_t i = 0; i < f->terms; i++)
        if (strcmp(f->term[i].name, t[block].term) == 0 && before-- == 0) {
            b->term = i;
            return true;
        }
    return false;
}

static bool axes_fit(const struct edit_tensor *e, uint32_t block) {
    const struct edited_block *own = &e->blocks[block];
    const struct tensor_block *b = &e->tensor->blocks[block];
    const struct edited_object *o = &e->objects[own->object];
    const struct form_term *t = &o->form.term[own->term];
    const uint32_t axes = edit_has_slot(t, SLOT_A) + (uint32_t)edit_has_slot(t, SLOT_B);
    if (b->axis_count != axes)
        return fail(e, "block %u (%s.%s) has %u axes, expected %u", block, b->object, b->term,
                    b->axis_count, axes);
    for (uint32_t i = 0; i < axes; i++) {
        const struct curve *c = o->curve[edit_axis_curve(e, block, i)];
        const enum tensor_basis basis = c->basis.kind == BASIS_HAT ? TENSOR_HAT : TENSOR_BOX;
        if (b->axes[i].bins != c->basis.count || b->axes[i].basis != basis)
            return fail(e, "block %u (%s.%s): axis %u is not that of its curve", block, b->object,
                        b->term, i);
    }
    if (edit_has_slot(t, SLOT_O) && !b->view && b->pixel_count > 0)
        return fail(e, "block %u (%s.%s) has a curve f_o, but no view", block, b->object, b->term);
    return true;
}

static bool read_blocks(struct edit_tensor *e) {
    e->blocks = arena_alloc(&e->arena, (e->tensor->block_count + 1) * sizeof *e->blocks);
    for (uint32_t i = 0; i < e->tensor->block_count; i++) {
        const struct tensor_block *b = &e->tensor->blocks[i];
        e->blocks[i] = (struct edited_block){EDIT_NOTHING, EDIT_NOTHING};
        if (b->groups > e->group_count)
            return fail(e, "block %u has %u groups, the tensor %u", i, b->groups, e->group_count);
        if (!b->object[0] && b->axis_count == 0)
            continue;
        if (!find_object(e, b->object, &e->blocks[i].object) || !find_term(e, i, &e->blocks[i]))
            return fail(e, "block %u is of %s.%s, which is not among the objects", i, b->object,
                        b->term);
        if (!axes_fit(e, i))
            return false;
    }
    return true;
}

bool edit_tensor_init(struct edit_tensor *e, const struct tensor *t, const char *path) {
    const char *kind = json_text(json_get(t->meta, "kind"));
    *e = (struct edit_tensor){.tensor = t, .path = path};
    if (!kind || strcmp(kind, "edit") != 0)
        return fail(e, "is not a tensor of `relume precompute edit`");
    if (read_objects(e) && read_factors(e) && read_groups(e) && read_blocks(e))
        return true;
    edit_tensor_finish(e);
    return false;
}

void edit_tensor_finish(struct edit_tensor *e) {
    arena_finish(&e->arena);
    *e = (struct edit_tensor){0};
}
