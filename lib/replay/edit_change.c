// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_change.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "curve/form_json.h"
#include "curve/operators.h"
#include "curve/parameters.h"

enum { MOST_NAME = 256, MOST_OPERATORS = 64 };

static bool fail(const char *at, const char *what, const char *name) {
    log_error("%s: %s \"%s\"", at, what, name);
    return false;
}

// ---- places -------------------------------------------------------------------------------------

// The object whose name begins the text; *rest is behind its point (or at the end of the text).
// Names may hold points: the longest fits.
static bool find_object(const struct edit_tensor *e, const char *text, size_t length,
                        uint32_t *object, const char **rest) {
    size_t best = 0;
    for (uint32_t i = 0; i < e->object_count; i++) {
        const size_t n = strlen(e->objects[i].name);
        if (n <= best || n > length || strncmp(e->objects[i].name, text, n) != 0 ||
            (n < length && text[n] != '.'))
            continue;
        best = n;
        *object = i;
        *rest = text + n + (n < length);
    }
    return best > 0;
}

// "NAME" or "NAME#2".
static bool find_term(const struct form *f, const char *name, size_t length, uint32_t *term) {
    const char *hash = memchr(name, '#', length);
    const size_t n = hash ? (size_t)(hash - name) : length;
    long left = hash ? strtol(hash + 1, NULL, 10) : 1;
    for (uint32_t t = 0; t < f->terms; t++)
        if (strlen(f->term[t].name) == n && strncmp(f->term[t].name, name, n) == 0 && --left == 0) {
            *term = t;
            return true;
        }
    return false;
}

static bool no_object(const struct edit_tensor *e, const char *text, const char *at) {
    char known[300] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < e->object_count && used < sizeof known; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, " %s", e->objects[i].name);
    log_error("%s: \"%s\" names no object; there are:%s", at, text, known);
    return false;
}

static bool no_term(const struct edited_object *o, const char *name, const char *at) {
    char known[300] = "";
    size_t used = 0;
    for (uint32_t t = 0; t < o->form.terms && used < sizeof known; t++)
        used += (size_t)snprintf(known + used, sizeof known - used, " %s", o->form.term[t].name);
    log_error("%s: \"%s\" names no term of %s; there are:%s", at, name, o->name, known);
    return false;
}

struct place {
    struct edited_object *object;
    uint32_t object_index, curve;
    unsigned channels;
};

// "f_A" or "f_A.rg"
static bool find_slot(const struct form_term *t, const char *name, const char *at, struct place *p) {
    static const char letters[] = "rgb";
    const size_t n = strcspn(name, ".");
    p->channels = name[n] ? 0 : (1u << CURVE_CHANNELS) - 1;
    for (const char *c = name + n + (name[n] == '.'); *c; c++) {
        const char *letter = strchr(letters, *c);
        if (!letter)
            return fail(at, "expected channels among r, g and b, found", name);
        p->channels |= 1u << (letter - letters);
    }
    for (int s = 0; s < SLOTS; s++)
        if (strlen(slot_names[s]) == n && strncmp(slot_names[s], name, n) == 0 &&
            edit_has_slot(t, (enum form_slot_name)s)) {
            p->curve = t->slots[s].curve;
            return p->channels != 0 || fail(at, "there are no channels in", name);
        }
    log_error("%s: the term %s has no curve \"%s\"; it has%s%s%s", at, t->name, name,
              edit_has_slot(t, SLOT_O) ? " f_o" : "", edit_has_slot(t, SLOT_A) ? " f_A" : "",
              edit_has_slot(t, SLOT_B) ? " f_B" : "");
    return false;
}

// The curve that "OBJECT.TERM.f_A" names, up to `end`.
static bool find_place(struct edit_tensor *e, const char *text, const char *end, const char *at,
                       struct place *p) {
    char place[MOST_NAME];
    const char *rest;
    uint32_t term;
    if (!end || (size_t)(end - text) >= sizeof place)
        return fail(at, "expected OBJECT.TERM.f_A and what becomes of it, found", text);
    snprintf(place, sizeof place, "%.*s", (int)(end - text), text);
    if (!find_object(e, place, strlen(place), &p->object_index, &rest))
        return no_object(e, place, at);
    p->object = &e->objects[p->object_index];
    const char *slot = strstr(rest, ".f_");
    if (!slot || !find_term(&p->object->form, rest, (size_t)(slot - rest), &term))
        return no_term(p->object, rest, at);
    return find_slot(&p->object->form.term[term], slot + 1, at, p);
}

// ---- curves -------------------------------------------------------------------------------------

// Two curves of the largest values multiply to what single precision holds.
static const double LARGEST = 1e15;

static bool is_moderate(const struct curve *c, const char *at) {
    for (size_t i = 0; i < (size_t)c->channels * c->basis.count; i++)
        if (!(c->values[i] <= LARGEST)) {
            log_error("%s: the curve would reach %g, expected at most %g", at, c->values[i], LARGEST);
            return false;
        }
    return true;
}

static bool load_curve(struct edit_tensor *e, const char *text, const char *at,
                       struct edit_touch *touch) {
    const char *equals = strchr(text, '=');
    struct arena arena = {0};
    struct curve file;
    struct place p;
    if (!find_place(e, text, equals, at, &p))
        return false;
    const bool good = curve_read(&file, &arena, equals + 1) && is_moderate(&file, at);
    if (good) {
        struct curve *own = p.object->curve[p.curve];
        struct curve fitted = curve_make(&arena, &own->basis, CURVE_CHANNELS);
        const enum curve_filter filter = form_filter(&p.object->form, p.curve);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++) {
            const struct curve_function f = {.kind = FUNCTION_TABLE, .table = &file, .channel = k};
            function_project(&fitted, k, &f, filter);
            if (p.channels >> k & 1)
                memcpy(own->values + (size_t)k * own->basis.count, curve_values(&fitted, k),
                       sizeof *own->values * own->basis.count);
        }
        *touch = (struct edit_touch){p.object_index, p.curve, false};
    }
    arena_finish(&arena);
    return good;
}

static bool operate(struct edit_tensor *e, const char *text, const char *at,
                    struct edit_touch *touch) {
    const char *colon = strchr(text, ':');
    struct curve_operator operators[MOST_OPERATORS];
    uint32_t count;
    struct place p;
    if (!find_place(e, text, colon, at, &p) ||
        !operators_parse(colon + 1, operators, MOST_OPERATORS, &count, at))
        return false;
    if (count == 0)
        return fail(at, "expected operators behind the colon, found", text);
    struct curve *own = p.object->curve[p.curve];
    const size_t bytes = (size_t)own->channels * own->basis.count * sizeof *own->values;
    double *before = mem_array(bytes, 1);
    memcpy(before, own->values, bytes);
    curve_edit(own, p.channels, operators, count);
    const bool good = is_moderate(own, at);
    if (!good)
        memcpy(own->values, before, bytes);
    mem_free(before);
    *touch = (struct edit_touch){p.object_index, p.curve, false};
    return good;
}

// ---- numbers ------------------------------------------------------------------------------------

static const double none[CURVE_CHANNELS];

// The model's form. A diffuse term that is there stays when its reflectance becomes 0.
static bool make_form(const struct edited_object *o, const struct model_parameters *p,
                      struct arena *arena, struct form *f, const char *at) {
    uint32_t term;
    struct model_parameters q = *p;
    const bool black = memcmp(p->diffuse, none, sizeof none) == 0 &&
                       find_term(&o->form, "diffuse", strlen("diffuse"), &term);
    if (black)
        q.diffuse[0] = q.diffuse[1] = q.diffuse[2] = 1;
    if (!model_make(o->model, &q, arena, f, at))
        return false;
    if (black && find_term(f, "diffuse", strlen("diffuse"), &term))
        memcpy(f->term[term].scale, none, sizeof none);
    return true;
}

// Whether the object's first terms are the model's.
static bool begins_with(const struct form *f, const struct form *model) {
    bool same = f->terms >= model->terms && f->curves >= model->curves;
    for (uint32_t t = 0; t < model->terms && same; t++)
        for (int s = 0; s < SLOTS && same; s++) {
            const struct form_slot *x = &f->term[t].slots[s], *y = &model->term[t].slots[s];
            same = x->gamma.kind == y->gamma.kind &&
                   (x->gamma.kind == GAMMA_NONE || x->curve == y->curve);
        }
    return same;
}

static bool same_formula(const struct form_curve *a, const struct form_curve *b) {
    bool same = true;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        same = same && a->f[k].kind == b->f[k].kind && a->f[k].p[0] == b->f[k].p[0] &&
               a->f[k].p[1] == b->f[k].p[1];
    return same;
}

// What the eye would take for the material is then the bins' doing.
static void warn_of_sharp(struct edited_object *o, const struct form *f, uint32_t curve, const char *at) {
    static const double rounding = 1e-6;
    const struct basis *b = &o->curve[curve]->basis;
    const double most = basis_exponent(b);
    double asked = 0;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        asked = fmax(asked, function_exponent(&f->curve[curve].f[k]));
    if (o->told_sharp || asked <= most * (1 + rounding))
        return;
    o->told_sharp = true;
    log_warn("%s: %s: a lobe as sharp as cos^%.3g comes out too wide: the %u bins of its curve carry cos^%.3g "
             "at most. `relume verify` tells the error; a tensor of more bins follows", at, o->name, asked,
             b->count, most);
}

// What differs between two makes of the model goes into the object.
static void take_over(struct edited_object *o, const struct form *before, const struct form *after,
                      const char *at, struct edit_touch *touch) {
    for (uint32_t t = 0; t < after->terms; t++)
        for (int k = 0; k < CURVE_CHANNELS; k++)
            if (after->term[t].scale[k] != before->term[t].scale[k])
                o->form.term[t].scale[k] = after->term[t].scale[k];
    for (uint32_t c = 0; c < after->curves; c++) {
        if (same_formula(&before->curve[c], &after->curve[c]))
            continue;
        warn_of_sharp(o, after, c, at);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            function_project(o->curve[c], k, &after->curve[c].f[k], form_filter(&o->form, c));
        touch->several = touch->curve != EDIT_NOTHING;
        touch->curve = c;
    }
}

static bool regenerate(struct edited_object *o, const struct model_parameters *p, const char *name,
                       const char *at, struct edit_touch *touch) {
    struct arena arena = {0};
    struct form before, after;
    bool good = make_form(o, &o->parameters, &arena, &before, at) &&
                make_form(o, p, &arena, &after, at);
    if (good && (!begins_with(&o->form, &before) || !form_same_shape(&before, &after))) {
        log_error("%s: %s of %s is fixed: it stands in what was precomputed, not in a curve", at,
                  name, o->name);
        good = false;
    }
    if (good) {
        take_over(o, &before, &after, at, touch);
        o->parameters = *p;
    }
    arena_finish(&arena);
    return good;
}

static bool set_scale(struct form_term *t, const char *text, const char *at) {
    double v[CURVE_CHANNELS];
    char rest;
    const int n = sscanf(text, "%lf,%lf,%lf%c", &v[0], &v[1], &v[2], &rest);
    if (n == 1 && !strchr(text, ','))
        v[1] = v[2] = v[0];
    else if (n != 3)
        return fail(at, "scale: expected a number or R,G,B, found", text);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        if (!(v[k] >= 0 && v[k] <= 1e6))
            return fail(at, "scale: expected numbers from 0 to 1e6, found", text);
    memcpy(t->scale, v, sizeof v);
    return true;
}

// Of "TERM.PARAM" or "PARAM": the parameter, and the term if there is one (else EDIT_NOTHING).
static const char *split_term(const struct edited_object *o, const char *text, uint32_t *term) {
    const char *point = strrchr(text, '.');
    *term = EDIT_NOTHING;
    if (!point)
        return text;
    return find_term(&o->form, text, (size_t)(point - text), term) ? point + 1 : NULL;
}

static bool set(struct edit_tensor *e, const char *text, const char *at, struct edit_touch *touch) {
    char place[MOST_NAME];
    const char *equals = strchr(text, '='), *rest;
    uint32_t term;
    *touch = (struct edit_touch){.curve = EDIT_NOTHING};
    if (!equals || (size_t)(equals - text) >= sizeof place)
        return fail(at, "expected OBJECT.TERM.PARAM=VALUE, found", text);
    snprintf(place, sizeof place, "%.*s", (int)(equals - text), text);
    if (!find_object(e, place, strlen(place), &touch->object, &rest) || !*rest)
        return no_object(e, place, at);
    struct edited_object *o = &e->objects[touch->object];
    const char *name = split_term(o, rest, &term);
    if (!name)
        return no_term(o, rest, at);
    if (strcmp(name, "scale") == 0 && term != EDIT_NOTHING)
        return set_scale(&o->form.term[term], equals + 1, at);
    if (!o->model)
        return fail(at, "there is no model whose numbers could be set behind", o->name);
    struct model_parameters p = o->parameters;
    return parameters_set(&p, name, equals + 1, at) && regenerate(o, &p, name, at, touch);
}

static bool reset(struct edit_tensor *e, const char *object, const char *at,
                  struct edit_touch *touch) {
    const char *rest;
    *touch = (struct edit_touch){.curve = EDIT_NOTHING, .several = true};
    if (!find_object(e, object, strlen(object), &touch->object, &rest) || *rest)
        return no_object(e, object, at);
    struct arena arena = {0};
    struct form f;
    struct edited_object *o = &e->objects[touch->object];
    const struct json *j = json_at(json_get(e->tensor->meta, "objects"), touch->object);
    const bool good = parameters_from_json(&o->parameters, json_get(j, "parameters"), at) &&
                      form_from_json(&f, json_get(j, "form"), &arena, at);
    for (uint32_t t = 0; t < o->form.terms && good; t++)
        memcpy(o->form.term[t].scale, f.term[t].scale, sizeof f.term[t].scale);
    for (uint32_t c = 0; c < o->form.curves && good; c++)
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            function_project(o->curve[c], k, &f.curve[c].f[k], FILTER_MEAN);
    arena_finish(&arena);
    return good;
}

bool edit_apply(struct edit_tensor *e, enum edit_kind kind, const char *text, const char *at,
                struct edit_touch *touch) {
    switch (kind) {
    case EDIT_SET: return set(e, text, at, touch);
    case EDIT_CURVE: return load_curve(e, text, at, touch);
    case EDIT_OPERATE: return operate(e, text, at, touch);
    case EDIT_RESET: return reset(e, text, at, touch);
    case EDIT_LIGHT: break;
    }
    *touch = (struct edit_touch){EDIT_NOTHING, EDIT_NOTHING, false};
    return true;
}
