// SPDX-License-Identifier: Apache-2.0
// Forms and parameters as JSON: the same bits come back, and what is wrong is refused.
#include "curve/form_json.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "capture.h"
#include "check.h"
#include "curve/parameters.h"
#include "math/hash.h"

static double between(struct rng *r, double lo, double hi) {
    return lo + (hi - lo) * (double)rng_float(r);
}

static struct model_parameters random_parameters(struct rng *r) {
    struct model_parameters p = model_defaults;
    p.exponent_u = between(r, 0.1, 1000);
    p.exponent_v = between(r, 0.1, 1000);
    p.alpha_u = between(r, 0.01, 1);
    p.alpha_v = between(r, 0.01, 1);
    p.isotropy = between(r, 0.1, 1);
    p.gamma[SLOT_O] = GAMMA_THETA_O;
    p.gamma[SLOT_A] = GAMMA_RATIO;
    p.quotient = QUOTIENT_WARD;
    p.variant = 1;
    p.literal = between(r, 0, 1) < 0.5;
    p.fixed_fresnel = between(r, 0, 1) < 0.5;
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        p.reflectance[k] = between(r, 0, 1);
        p.diffuse[k] = between(r, 0, 1);
        p.eta[k] = between(r, 0.1, 4);
        p.k[k] = between(r, 0, 5);
        p.r0[k] = between(r, 0, 1);
    }
    return p;
}

static struct json *through_text(const struct json *j) {
    char *text = json_to_text(j);
    struct json *back = json_parse(text, strlen(text), "test");
    mem_free(text);
    return back;
}

static bool same_curve(const struct form_curve *a, const struct form_curve *b) {
    bool same = strcmp(a->name, b->name) == 0;
    for (int k = 0; k < CURVE_CHANNELS && same; k++) {
        const struct curve_function *x = &a->f[k], *y = &b->f[k];
        same = x->kind == y->kind && memcmp(x->p, y->p, sizeof x->p) == 0;
        if (same && x->kind == FUNCTION_TABLE)
            same = basis_equal(&x->table->basis, &y->table->basis) &&
                   x->table->basis.spacing == y->table->basis.spacing &&
                   x->table->channels == y->table->channels &&
                   memcmp(x->table->values, y->table->values, sizeof(double) *
                          x->table->channels * x->table->basis.count) == 0;
    }
    return same;
}

static bool same_form(const struct form *a, const struct form *b) {
    bool same = form_same_shape(a, b);
    for (uint32_t t = 0; t < a->terms && same; t++)
        same = strcmp(a->term[t].name, b->term[t].name) == 0 &&
               memcmp(a->term[t].scale, b->term[t].scale, sizeof a->term[t].scale) == 0;
    for (uint32_t c = 0; c < a->curves && same; c++)
        same = same_curve(&a->curve[c], &b->curve[c]);
    return same;
}

static void tabulate_some(struct form *f, struct rng *r, struct arena *arena) {
    for (uint32_t c = 0; c < f->curves; c++) {
        if (between(r, 0, 1) < 0.3)
            continue; // stays a formula
        const struct basis b = basis_make(arena, (enum basis_kind)(c % 2), 2 + c * 9,
                                          (enum basis_spacing)(between(r, 0, 1) < 0.5));
        form_tabulate(f, c, &b, form_filter(f, c), arena);
    }
}

// A sum of the model and, now and then, of another one.
static bool make_sum(const struct model *m, bool two, const struct model_parameters *p,
                     struct arena *arena, struct form *f) {
    struct form more;
    return model_make(m, p, arena, f, "test") &&
           (!two || (model_make(model_find("lightview"), p, arena, &more, "test") &&
                     form_append(f, &more)));
}

static void forms_come_back(void) {
    struct rng rng = {1};
    for (const struct model *const *m = models; *m; m++)
        for (int i = 0; i < 10; i++) {
            struct arena arena = {0};
            struct form form, back;
            const struct model_parameters p = random_parameters(&rng);
            struct json *terms[FORM_TERMS], *j = json_new_object();
            CHECK(make_sum(*m, i % 2 == 1, &p, &arena, &form));
            tabulate_some(&form, &rng, &arena);
            form_to_json(&form, j, terms);
            json_add_number(terms[form.terms - 1], "more", 1); // does no harm
            struct json *read = through_text(j);
            CHECK(form_from_json(&back, read, &arena, "test") && same_form(&form, &back));
            json_destroy(read);
            json_destroy(j);
            arena_finish(&arena);
        }
}

static void parameters_come_back(void) {
    struct rng rng = {2};
    for (int i = 0; i < 100; i++) {
        struct model_parameters back, p = random_parameters(&rng);
        struct json *j = json_new_object();
        parameters_to_json(&p, j);
        struct json *read = through_text(j);
        CHECK(parameters_from_json(&back, read, "test") && memcmp(&back, &p, sizeof p) == 0);
        json_destroy(read);
        json_destroy(j);
    }
}

// ---- what is wrong --------------------------------------------------------------------------

static const char good[] =
    "{\"terms\": [{\"name\": \"t\", \"scale\": [1, 1, 1], \"quotient\": {\"kind\": \"one\","
    " \"n\": 0, \"roughness\": 0, \"isotropy\": 0}, \"f_A\": {\"gamma\": \"theta_h\", \"n\": 0,"
    " \"curve\": 0}}], \"curves\": [{\"name\": \"c\", \"basis\": \"hat\", \"knots\": [0, 0.5,"
    " 1.5707963267948966], \"values\": [[1, 2, 3]]}]}";

// Whether the good text with `from` put in place of `to` is read.
static bool reads_with(const char *from, const char *to) {
    struct arena arena = {0};
    struct form form;
    char text[1000];
    const char *at = strstr(good, from);
    CHECK(at != NULL);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, to, at + strlen(from));
    struct json *j = json_parse(text, strlen(text), "test");
    capture_begin();
    const bool read = form_from_json(&form, j, &arena, "a place");
    CHECK(capture_end() && (read || captured_has("a place")));
    json_destroy(j);
    arena_finish(&arena);
    return read;
}

static void wrong_forms_are_refused(void) {
    static const char *const wrong[][2] = {
        {"\"curve\": 0", "\"curve\": 1"},       {"\"curve\": 0", "\"curve\": -1"},
        {"\"curve\": 0", "\"curve\": 0.5"},     {"theta_h", "theta_x"},
        {"theta_h", "none"},                    {"\"one\"", "\"facets\""},
        {"\"one\"", "\"schlick\""},             {"[1, 1, 1]", "[1, 1]"},
        {"[1, 1, 1]", "[1, -1, 1]"},            {"[1, 1, 1]", "[1, 1e301, 1]"},
        {"\"hat\"", "\"bat\""},                 {"\"hat\"", "\"box\""},
        {"0.5", "0"},                           {"0.5", "1.6"},
        {"1.5707963267948966", "1.5"},          {"[1, 2, 3]", "[1, 2]"},
        {"[1, 2, 3]", "[1, 2, -3]"},            {"[1, 2, 3]", "[1, 2, null]"},
        {"[[1, 2, 3]]", "[[1, 2, 3], [1, 2, 3]]"}, {"\"name\": \"c\"", "\"name\": 3"},
        {"\"terms\": [", "\"terms\": [[], "},   {"\"terms\"", "\"turns\""},
        {"\"scale\"", "\"scales\""},            {"\"roughness\": 0", "\"roughness\": \"0\""},
    };
    CHECK(reads_with("\"c\"", "\"d\"")); // the test can pass
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const bool read = reads_with(wrong[i][0], wrong[i][1]);
        if (read)
            printf("%s was read\n", wrong[i][1]);
        CHECK(!read);
    }
}

static bool set(struct model_parameters *p, const char *name, const char *text) {
    capture_begin();
    const bool done = parameters_set(p, name, text, "a place");
    CHECK(capture_end() && (done || captured_has("a place")));
    return done;
}

static void a_person_sets_numbers(void) {
    struct model_parameters p = model_defaults;
    CHECK(set(&p, "exponent", "12.5") && p.exponent_u == 12.5 && p.exponent_v == 12.5);
    CHECK(set(&p, "alpha_v", "0.3") && p.alpha_v == 0.3 && p.alpha_u == model_defaults.alpha_u);
    CHECK(set(&p, "r0", "0.1,0.2,0.3") && p.r0[1] == 0.2);
    CHECK(set(&p, "eta", "1.5") && p.eta[2] == 1.5);
    CHECK(set(&p, "variant", "duer") && p.variant == 1);
    CHECK(set(&p, "literal", "true") && p.literal);
    CHECK(!set(&p, "exponents", "1") && !set(&p, "r0", "1,2") && !set(&p, "r0", "1,2,3,4"));
    CHECK(!set(&p, "alpha", "wide") && !set(&p, "alpha", "1 ") && !set(&p, "alpha", "nan"));
    CHECK(!set(&p, "variant", "3") && !set(&p, "literal", "1") && !set(&p, "", "1"));
}

int main(void) {
    forms_come_back();
    parameters_come_back();
    wrong_forms_are_refused();
    a_person_sets_numbers();
    return check_result();
}
