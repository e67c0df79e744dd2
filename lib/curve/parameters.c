// SPDX-License-Identifier: Apache-2.0
#include "curve/parameters.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"

static const char *const variants[] = {"original", "duer", "bounded", NULL};
static const char *const truth[] = {"false", "true", NULL};

struct field {
    const char *name;
    size_t offset;
    int numbers;              // doubles that follow each other; 0: an int, by name
    const char *const *names; // of the int's values
    bool boolean;             // a bool, not an int
};

#define AT(member) offsetof(struct model_parameters, member)
static const struct field fields[] = {
    {"reflectance", AT(reflectance), CURVE_CHANNELS, NULL, false},
    {"diffuse", AT(diffuse), CURVE_CHANNELS, NULL, false},
    {"exponent_u", AT(exponent_u), 1, NULL, false},
    {"exponent_v", AT(exponent_v), 1, NULL, false},
    {"alpha_u", AT(alpha_u), 1, NULL, false},
    {"alpha_v", AT(alpha_v), 1, NULL, false},
    {"eta", AT(eta), CURVE_CHANNELS, NULL, false},
    {"k", AT(k), CURVE_CHANNELS, NULL, false},
    {"r0", AT(r0), CURVE_CHANNELS, NULL, false},
    {"isotropy", AT(isotropy), 1, NULL, false},
    {"variant", AT(variant), 0, variants, false},
    {"literal", AT(literal), 0, truth, true},
    {"fixed_fresnel", AT(fixed_fresnel), 0, truth, true},
};
enum { FIELDS = sizeof fields / sizeof *fields };

const char *parameters_names(void) {
    return "reflectance diffuse exponent exponent_u exponent_v alpha alpha_u alpha_v eta k r0 "
           "isotropy variant literal fixed_fresnel";
}

static double *numbers_of(struct model_parameters *p, const struct field *f) {
    return (double *)(void *)((char *)p + f->offset);
}

static int get_choice(const struct model_parameters *p, const struct field *f) {
    const void *at = (const char *)p + f->offset;
    return f->boolean ? *(const bool *)at : *(const int *)at;
}

static void set_choice(struct model_parameters *p, const struct field *f, int value) {
    void *at = (char *)p + f->offset;
    if (f->boolean)
        *(bool *)at = value != 0;
    else
        *(int *)at = value;
}

static bool find_name(const char *text, const char *const *names, int *out) {
    for (int i = 0; text && names[i]; i++)
        if (strcmp(text, names[i]) == 0) {
            *out = i;
            return true;
        }
    return false;
}

// ---- JSON -----------------------------------------------------------------------------------

void parameters_to_json(const struct model_parameters *p, struct json *object) {
    struct model_parameters copy = *p;
    for (int i = 0; i < FIELDS; i++) {
        const struct field *f = &fields[i];
        if (f->numbers == 0) {
            json_add_text(object, f->name, f->names[get_choice(p, f)]);
        } else if (f->numbers == 1) {
            json_add_number(object, f->name, *numbers_of(&copy, f));
        } else {
            struct json *list = json_add_array(object, f->name);
            for (int k = 0; k < f->numbers; k++)
                json_append_number(list, numbers_of(&copy, f)[k]);
        }
    }
    struct json *gammas = json_add_array(object, "gamma");
    for (int s = 0; s < SLOTS; s++)
        json_append_text(gammas, gamma_names[p->gamma[s]]);
    json_add_text(object, "quotient", quotient_names[p->quotient]);
}

static bool read_field(struct model_parameters *p, const struct field *f, const struct json *j) {
    double *v = numbers_of(p, f);
    int choice = 0;
    if (f->numbers == 0) {
        if (!find_name(json_text(j), f->names, &choice))
            return false;
        set_choice(p, f, choice);
        return true;
    }
    if (f->numbers == 1)
        return json_read_number(j, v) && isfinite(*v);
    bool sound = json_is_array(j) && json_count(j) == (size_t)f->numbers;
    for (int k = 0; k < f->numbers && sound; k++)
        sound = json_read_number(json_at(j, (size_t)k), &v[k]) && isfinite(v[k]);
    return sound;
}

static bool read_shape(struct model_parameters *p, const struct json *object) {
    const struct json *gammas = json_get(object, "gamma"), *quotient = json_get(object, "quotient");
    int choice = 0;
    bool sound = !gammas || json_count(gammas) == SLOTS;
    for (size_t s = 0; s < SLOTS && gammas && sound; s++) {
        sound = find_name(json_text(json_at(gammas, s)), gamma_names, &choice);
        p->gamma[s] = (enum gamma_kind)choice;
    }
    choice = 0;
    sound = sound && (!quotient || find_name(json_text(quotient), quotient_names, &choice));
    p->quotient = (enum quotient_kind)choice;
    return sound;
}

bool parameters_from_json(struct model_parameters *p, const struct json *object, const char *at) {
    *p = model_defaults;
    for (int i = 0; i < FIELDS; i++) {
        const struct json *j = json_get(object, fields[i].name);
        if (j && !read_field(p, &fields[i], j)) {
            log_error("%s: the parameter \"%s\" of a model has no value of its kind", at,
                      fields[i].name);
            return false;
        }
    }
    if (read_shape(p, object))
        return true;
    log_error("%s: the parameters \"gamma\" or \"quotient\" of a model are not known names", at);
    return false;
}

// ---- by a person ----------------------------------------------------------------------------

// "X" or as many numbers as there are, with commas.
static bool parse_numbers(const char *text, int n, double *out) {
    char *end;
    for (int k = 0; k < n; k++) {
        out[k] = strtod(text, &end);
        if (end == text || !isfinite(out[k]))
            return false;
        if (k == 0 && *end == '\0') {
            for (int i = 1; i < n; i++)
                out[i] = out[0];
            return true;
        }
        if (*end != (k + 1 < n ? ',' : '\0'))
            return false;
        text = end + 1;
    }
    return true;
}

static bool refuse(const char *name, const char *text, const char *expected, const char *at) {
    log_error("%s: %s = %s, expected %s", at, name, text, expected);
    return false;
}

static bool set_field(struct model_parameters *p, const struct field *f, const char *text,
                      const char *at) {
    double v[CURVE_CHANNELS];
    int choice = 0;
    if (f->numbers == 0) {
        if (!find_name(text, f->names, &choice))
            return refuse(f->name, text, f->boolean ? "true or false"
                                                    : "original, duer or bounded", at);
        set_choice(p, f, choice);
        return true;
    }
    if (!parse_numbers(text, f->numbers, v))
        return refuse(f->name, text, f->numbers > 1 ? "a number or R,G,B" : "a number", at);
    memcpy(numbers_of(p, f), v, sizeof *v * (size_t)f->numbers);
    return true;
}

bool parameters_set(struct model_parameters *p, const char *name, const char *text,
                    const char *at) {
    bool found = false;
    for (int i = 0; i < FIELDS; i++) {
        const size_t n = strlen(fields[i].name);
        const bool both = n > 2 && n - 2 == strlen(name) && fields[i].name[n - 2] == '_' &&
                          strncmp(fields[i].name, name, n - 2) == 0;
        if (!both && strcmp(fields[i].name, name) != 0)
            continue;
        found = true;
        if (!set_field(p, &fields[i], text, at))
            return false;
    }
    if (!found)
        log_error("%s: there is no parameter \"%s\", expected one of: %s", at, name,
                  parameters_names());
    return found;
}
