// SPDX-License-Identifier: Apache-2.0
#include "curve/form_json.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"

static const char *const basis_names[] = {"box", "hat", NULL};

// Those of enum function_kind that are formulas.
static const char *const function_names[] = {"constant", "cos_power", "beckmann", "gaussian",
                                             "fresnel", "schlick_f", "schlick_z", NULL};

// ---- writing --------------------------------------------------------------------------------

static void add_numbers(struct json *object, const char *key, const double *v, size_t n) {
    struct json *array = json_add_array(object, key);
    for (size_t i = 0; i < n; i++)
        json_append_number(array, v[i]);
}

static void add_functions(struct json *object, const char *key,
                          const struct curve_function f[CURVE_CHANNELS]) {
    struct json *array = json_add_array(object, key);
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        struct json *one = json_append_object(array);
        assert(f[k].kind != FUNCTION_TABLE);
        json_add_text(one, "kind", function_names[f[k].kind]);
        add_numbers(one, "p", f[k].p, 2);
    }
}

static void write_quotient(const struct quotient *q, struct json *j) {
    json_add_text(j, "kind", quotient_names[q->kind]);
    json_add_number(j, "n", q->n);
    json_add_number(j, "roughness", q->roughness);
    json_add_number(j, "isotropy", q->isotropy);
    if (q->g)
        add_numbers(j, "facets", q->g->c[0], PROFILE_PANELS * PROFILE_ORDER);
    if (q->has_fresnel)
        add_functions(j, "fresnel", q->fresnel);
}

static void write_term(const struct form_term *t, struct json *j) {
    json_add_text(j, "name", t->name);
    add_numbers(j, "scale", t->scale, CURVE_CHANNELS);
    write_quotient(&t->quotient, json_add_object(j, "quotient"));
    for (int s = 0; s < SLOTS; s++) {
        const struct form_slot *slot = &t->slots[s];
        if (slot->gamma.kind == GAMMA_NONE)
            continue;
        struct json *one = json_add_object(j, slot_names[s]);
        json_add_text(one, "gamma", gamma_names[slot->gamma.kind]);
        json_add_number(one, "n", slot->gamma.n);
        json_add_count(one, "curve", slot->curve);
    }
}

static void write_curve(const struct form_curve *c, struct json *j) {
    json_add_text(j, "name", c->name);
    if (c->f[0].kind != FUNCTION_TABLE) {
        add_functions(j, "functions", c->f);
        return;
    }
    const struct curve *t = c->f[0].table;
    json_add_text(j, "basis", basis_names[t->basis.kind]);
    add_numbers(j, "knots", t->basis.knots, basis_knots(&t->basis));
    struct json *values = json_add_array(j, "values");
    for (uint32_t k = 0; k < t->channels; k++) {
        struct json *channel = json_append_array(values);
        for (uint32_t i = 0; i < t->basis.count; i++)
            json_append_number(channel, curve_values(t, k)[i]);
    }
}

void form_to_json(const struct form *f, struct json *object, struct json *terms[FORM_TERMS]) {
    struct json *list = json_add_array(object, "terms");
    for (uint32_t t = 0; t < f->terms; t++) {
        struct json *one = json_append_object(list);
        write_term(&f->term[t], one);
        if (terms)
            terms[t] = one;
    }
    struct json *curves = json_add_array(object, "curves");
    for (uint32_t c = 0; c < f->curves; c++)
        write_curve(&f->curve[c], json_append_object(curves));
}

// ---- reading --------------------------------------------------------------------------------

static bool refuse(const char *at, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool refuse(const char *at, const char *format, ...) {
    char text[300];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    log_error("%s: %s", at, text);
    return false;
}

// A finite number in a range.
static bool read_number(const struct json *j, double least, double most, double *out) {
    return json_read_number(j, out) && *out >= least && *out <= most;
}

static bool read_numbers(const struct json *j, size_t n, double least, double *out) {
    bool sound = json_is_array(j) && json_count(j) == n;
    for (size_t i = 0; i < n && sound; i++)
        sound = read_number(json_at(j, i), least, 1e300, &out[i]);
    return sound;
}

// The index of a text in a list of names.
static bool read_name(const struct json *j, const char *const *names, int *out) {
    const char *text = json_text(j);
    for (int i = 0; text && names[i]; i++)
        if (strcmp(text, names[i]) == 0) {
            *out = i;
            return true;
        }
    return false;
}

static bool read_label(const struct json *j, struct arena *arena, const char **out, const char *at) {
    const char *text = json_text(json_get(j, "name"));
    if (!text || !*text)
        return refuse(at, "a term or curve has no name");
    *out = arena_strdup(arena, text);
    return true;
}

static bool read_functions(const struct json *j, struct curve_function f[CURVE_CHANNELS]) {
    bool sound = json_is_array(j) && json_count(j) == CURVE_CHANNELS;
    for (size_t k = 0; k < CURVE_CHANNELS && sound; k++) {
        int kind = 0;
        sound = read_name(json_get(json_at(j, k), "kind"), function_names, &kind) &&
                read_numbers(json_get(json_at(j, k), "p"), 2, 0, f[k].p);
        f[k].kind = (enum function_kind)kind;
    }
    return sound;
}

static bool read_quotient(struct quotient *q, const struct json *j, struct arena *arena,
                          const char *at) {
    const struct json *facets = json_get(j, "facets"), *fresnel = json_get(j, "fresnel");
    int kind = 0;
    if (!read_name(json_get(j, "kind"), quotient_names, &kind) ||
        !read_number(json_get(j, "n"), 0, 1e8, &q->n) ||
        !read_number(json_get(j, "roughness"), 0, 1e6, &q->roughness) ||
        !read_number(json_get(j, "isotropy"), 0, 1, &q->isotropy))
        return refuse(at, "a quotient is not described (kind, n, roughness, isotropy)");
    q->kind = (enum quotient_kind)kind;
    if ((q->kind == QUOTIENT_FACETS) != (facets != NULL) ||
        (q->kind == QUOTIENT_SCHLICK && !(q->isotropy > 0)))
        return refuse(at, "a quotient does not fit its kind \"%s\"", quotient_names[kind]);
    if (facets) {
        struct profile *g = arena_alloc(arena, sizeof *g);
        if (!read_numbers(facets, PROFILE_PANELS * PROFILE_ORDER, -1e300, g->c[0]))
            return refuse(at, "the facets of a quotient are not %d numbers",
                          PROFILE_PANELS * PROFILE_ORDER);
        q->g = g;
    }
    q->has_fresnel = fresnel != NULL;
    return !fresnel || read_functions(fresnel, q->fresnel) ||
           refuse(at, "the Fresnel factor of a quotient is not described");
}

static bool read_slot(struct form_slot *slot, const struct json *j, uint32_t curves,
                      const char *at) {
    int gamma = GAMMA_NONE;
    int64_t curve = -1;
    if (!read_name(json_get(j, "gamma"), gamma_names, &gamma) || gamma == GAMMA_NONE ||
        !read_number(json_get(j, "n"), 0, 1e8, &slot->gamma.n) ||
        !json_read_integer(json_get(j, "curve"), &curve) || curve < 0 || curve >= curves)
        return refuse(at, "a slot is not described (gamma, n, curve below %u)", curves);
    slot->gamma.kind = (enum gamma_kind)gamma;
    slot->curve = (uint32_t)curve;
    return true;
}

static bool read_term(struct form_term *t, const struct json *j, uint32_t curves,
                      struct arena *arena, const char *at) {
    if (!read_label(j, arena, &t->name, at))
        return false;
    if (!read_numbers(json_get(j, "scale"), CURVE_CHANNELS, 0, t->scale))
        return refuse(at, "term %s: its scale is not three numbers of at least 0", t->name);
    if (!read_quotient(&t->quotient, json_get(j, "quotient"), arena, at))
        return false;
    for (int s = 0; s < SLOTS; s++) {
        const struct json *slot = json_get(j, slot_names[s]);
        if (slot && !read_slot(&t->slots[s], slot, curves, at))
            return false;
    }
    return true;
}

// The knots as they are, with the spacing that finds them fastest.
static bool read_basis(struct basis *b, const struct json *j, struct arena *arena, const char *at) {
    const struct json *list = json_get(j, "knots");
    const size_t n = json_count(list);
    int kind = 0;
    if (!read_name(json_get(j, "basis"), basis_names, &kind) || !json_is_array(list) || n < 2 ||
        n > BASIS_MOST)
        return refuse(at, "a curve has no basis (box or hat) or no knots (2 to %d)", BASIS_MOST);
    double *knots = arena_alloc(arena, sizeof *knots * n);
    bool sound = read_numbers(list, n, 0, knots) && knots[0] == 0 && knots[n - 1] == CURVE_END;
    for (size_t i = 1; i < n && sound; i++)
        sound = knots[i] - knots[i - 1] >= 1e-12;
    if (!sound)
        return refuse(at, "the knots of a curve do not ascend from 0 to pi/2");
    const uint32_t count = (uint32_t)n - (kind == BASIS_BOX);
    *b = (struct basis){(enum basis_kind)kind, SPACING_ANY, count, knots};
    for (int s = SPACING_UNIFORM; s <= SPACING_QUADRATIC; s++) {
        const struct basis even = basis_make(arena, b->kind, count, (enum basis_spacing)s);
        if (basis_equal(&even, b))
            b->spacing = (enum basis_spacing)s;
    }
    return true;
}

static bool read_table(struct form_curve *c, const struct json *j, struct arena *arena,
                       const char *at) {
    const struct json *values = json_get(j, "values");
    const size_t channels = json_count(values);
    struct basis basis;
    if (!read_basis(&basis, j, arena, at))
        return false;
    if (!json_is_array(values) || (channels != 1 && channels != CURVE_CHANNELS))
        return refuse(at, "curve %s: expected 1 or %d lists of values", c->name, CURVE_CHANNELS);
    struct curve *t = arena_alloc(arena, sizeof *t);
    *t = curve_make(arena, &basis, (uint32_t)channels);
    for (size_t k = 0; k < channels; k++)
        if (!read_numbers(json_at(values, k), basis.count, 0, t->values + k * basis.count))
            return refuse(at, "curve %s: expected %u values of at least 0 a channel", c->name,
                          basis.count);
    for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
        c->f[k] = (struct curve_function){.kind = FUNCTION_TABLE, .table = t, .channel = k};
    return true;
}

static bool read_curve(struct form_curve *c, const struct json *j, struct arena *arena,
                       const char *at) {
    const struct json *functions = json_get(j, "functions");
    if (!read_label(j, arena, &c->name, at))
        return false;
    if (!functions)
        return read_table(c, j, arena, at);
    return read_functions(functions, c->f) ||
           refuse(at, "curve %s: its functions are not described", c->name);
}

bool form_from_json(struct form *f, const struct json *object, struct arena *arena,
                    const char *at) {
    const struct json *terms = json_get(object, "terms"), *curves = json_get(object, "curves");
    memset(f, 0, sizeof *f);
    if (!json_is_array(terms) || !json_is_array(curves) || json_count(terms) < 1 ||
        json_count(terms) > FORM_TERMS || json_count(curves) > FORM_CURVES)
        return refuse(at, "a form has 1 to %d terms and up to %d curves", FORM_TERMS, FORM_CURVES);
    f->terms = (uint32_t)json_count(terms);
    f->curves = (uint32_t)json_count(curves);
    for (uint32_t c = 0; c < f->curves; c++)
        if (!read_curve(&f->curve[c], json_at(curves, c), arena, at))
            return false;
    for (uint32_t t = 0; t < f->terms; t++)
        if (!read_term(&f->term[t], json_at(terms, t), f->curves, arena, at))
            return false;
    return true;
}
