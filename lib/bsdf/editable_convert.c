// SPDX-License-Identifier: Apache-2.0
// A row of `rules` names a material, the model it becomes, and which parameter goes where. What a
// model's formula has in other units is computed after that.
#include "bsdf/editable_convert.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf/editable_data.h"
#include "math/fresnel.h"

enum { RULE_PARAMS = 8 };

struct rule {
    const char *from, *model;
    const char *params[RULE_PARAMS][2]; // name there, name here
    const char *note;                   // what is not the same; or NULL
};

#define METAL {"material", "material"}, {"eta", "eta"}, {"k", "k"}, {"ext_eta", "ext_eta"}
#define SPECULAR {"specular_reflectance", "specular_reflectance"}
#define DIFFUSE {"diffuse_reflectance", "diffuse_reflectance"}

static const char COAT[] = "its base is dimmed as at the normal, not at all where it is textured";
static const char MIRROR[] = "a mirror becomes a highlight of alpha 0.01";

static const struct rule rules[] = {
    {"diffuse", "lightview", {{"reflectance", "specular_reflectance"}}, NULL},
    {"orennayar", "orennayar", {{"reflectance", "specular_reflectance"}, {"alpha", "alpha"}},
     "without light that is reflected twice"},
    {"eon", "orennayar", {{"reflectance", "specular_reflectance"}},
     "without light that is reflected twice"},
    {"phong", "phong", {SPECULAR, DIFFUSE, {"exponent", "exponent"}}, NULL},
    {"blinnphong", "blinnphong", {SPECULAR, DIFFUSE, {"exponent", "exponent"}}, NULL},
    {"cooktorrance", "cooktorrance", {SPECULAR, DIFFUSE, {"alpha", "alpha"}, METAL}, NULL},
    {"ashikhminshirley", "ashikhminshirley",
     {{"specular_reflectance", "r0"}, DIFFUSE, {"exponent_u", "exponent_u"},
      {"exponent_v", "exponent_v"}}, COAT},
    {"ward", "ward", {SPECULAR, DIFFUSE, {"alpha_u", "alpha_u"}, {"alpha_v", "alpha_v"},
                      {"variant", "variant"}}, NULL},
    {"schlick", "schlick", {{"specular_reflectance", "r0"}, DIFFUSE, {"isotropy", "isotropy"}}, COAT},
    {"conductor", "cooktorrance", {SPECULAR, METAL}, MIRROR},
    {"roughconductor", "cooktorrance", {SPECULAR, {"alpha", "alpha"}, METAL}, NULL},
    {"plastic", "cooktorrance", {SPECULAR, DIFFUSE}, COAT},
    {"roughplastic", "cooktorrance", {SPECULAR, DIFFUSE, {"alpha", "alpha"}}, COAT},
    {"principled", "schlick", {{"base_color", "diffuse_reflectance"}},
     "of its lobes the main one and the base are kept"},
};

// ---- parameters -----------------------------------------------------------------------------

static const void *value_of(const struct object *o, const char *name, const struct param **p) {
    *p = param_find(o->type, name);
    return *p ? (const char *)o->data + (*p)->offset : NULL;
}

// A number of the old material, or `otherwise` where it has none or a texture in its place.
static float number_of(const struct object *o, const char *name, float otherwise) {
    const struct param *p;
    const void *v = value_of(o, name, &p);
    if (!v)
        return otherwise;
    if (p->type != PARAM_TEXTURE_SCALAR && p->type != PARAM_TEXTURE)
        return *(const float *)v;
    const struct texture_ref *r = v;
    if (!r->texture)
        return r->value[0];
    log_warn_at(o->at, "%s: the editable form takes no texture for %s; it becomes %g",
                o->type->name, name, (double)otherwise);
    return otherwise;
}

static void copy_param(const struct object *from, const char *name, struct object *to,
                       const char *new_name) {
    const struct param *p, *q;
    const void *v = value_of(from, name, &p);
    void *out = (void *)(uintptr_t)value_of(to, new_name, &q);
    if (!v || !out)
        return;
    switch (q->type) {
    case PARAM_TEXTURE: *(struct texture_ref *)out = *(const struct texture_ref *)v; break;
    case PARAM_FLOAT:
    case PARAM_IOR: *(float *)out = number_of(from, name, *(float *)out); break;
    case PARAM_CHOICE: *(int *)out = *(const int *)v; break;
    case PARAM_STRING: *(const char **)out = *(const char *const *)v; break;
    case PARAM_REFLECTANCE:
        *(spectrum *)out = p->type == PARAM_TEXTURE ? ((const struct texture_ref *)v)->value
                                                    : *(const spectrum *)v;
        break;
    case PARAM_INDEX: *(spectrum *)out = *(const spectrum *)v; break;
    default: break;
    }
}

static void set_default(const struct param *p, void *out) {
    char *end;
    const float number = strtof(p->def, &end);
    switch (p->type) {
    case PARAM_TEXTURE: ((struct texture_ref *)out)->value = spectrum_grey(number); break;
    case PARAM_REFLECTANCE:
    case PARAM_INDEX: *(spectrum *)out = spectrum_grey(number); break;
    case PARAM_FLOAT:
    case PARAM_IOR: *(float *)out = number; break;
    case PARAM_INT: *(int *)out = (int)number; break;
    case PARAM_BOOL: *(bool *)out = strcmp(p->def, "true") == 0; break;
    case PARAM_CHOICE:
        for (int i = 0; p->choices[i]; i++)
            if (strcmp(p->choices[i], p->def) == 0)
                *(int *)out = i;
        break;
    default: break;
    }
}

// ---- what has other units -------------------------------------------------------------------

// Reflectance at the normal as an index of refraction.
static void set_index(struct editable *e, float eta) {
    e->index.eta = spectrum_grey(eta);
    e->index.k = spectrum_grey(0);
}

static float index_of_reflectance(float r0) {
    const float r = sqrtf(r0);
    return (1 + r) / maxf(1 - r, 1e-4f);
}

// What a highlight takes from the base, as at normal incidence.
static void dim_base(struct editable *e, spectrum r0) {
    if (!e->diffuse.texture)
        e->diffuse.value *= spectrum_grey(1) - r0;
}

static spectrum normal_reflectance(const struct editable *e) {
    return fresnel_conductor(1, e->index.eta, e->index.k);
}

// GGX is Schlick's Z of roughness alpha^2; his model has a reflectance at the normal for an index.
static void use_ggx(const struct object *from, struct editable *e, int schlick) {
    const struct param *p;
    const int *distribution = value_of(from, "distribution", &p);
    if (!distribution || strcmp(p->choices[*distribution], "ggx") != 0)
        return;
    e->model = schlick;
    e->r0 = normal_reflectance(e);
}

static void convert_roughness(const struct object *from, struct editable *e, int ward) {
    const float u = number_of(from, "alpha_u", -1), v = number_of(from, "alpha_v", -1);
    if (!(u >= 0))
        return;
    e->alpha = e->alpha_u = u;
    e->alpha_v = v;
    if (u == v)
        return;
    e->model = ward; // which has no Fresnel factor
    e->specular.value *= normal_reflectance(e);
}

static void convert_principled(const struct object *from, struct editable *e) {
    const float metallic = number_of(from, "metallic", 0), specular = number_of(from, "specular", -1);
    const float eta = number_of(from, "eta", -1), rough = number_of(from, "roughness", 0.5f);
    const float r = eta > 0 ? (eta - 1) / (eta + 1) : 0;
    const float r0 = eta > 0 ? r * r : 0.08f * (specular >= 0 ? specular : 0.5f);
    e->alpha = maxf(rough * rough, 1e-3f);
    e->r0 = spectrum_grey(r0);
    if (metallic < 0.5f) {
        dim_base(e, e->r0);
        return;
    }
    e->specular = e->diffuse; // a metal has the base colour as its reflectance
    e->diffuse = (struct texture_ref){.value = spectrum_grey(0)};
    e->r0 = spectrum_grey(1);
}

static int model_index(const char *name) {
    int i = 0;
    while (strcmp(models[i]->name, name) != 0)
        i++;
    return i;
}

static bool finish(const struct object *from, struct editable *e) {
    const char *type = from->type->name;
    if (strcmp(type, "conductor") == 0 || strcmp(type, "plastic") == 0)
        e->alpha = 0.01f;
    if (strcmp(type, "blinnphong") == 0 && number_of(from, "r0", 1) < 1)
        set_index(e, index_of_reflectance(number_of(from, "r0", 1)));
    if (strcmp(type, "schlick") == 0)
        e->alpha = sqrtf(number_of(from, "roughness", 0.1f));
    if (strcmp(type, "eon") == 0)
        e->alpha = number_of(from, "roughness", 0.5f) * sqrtf(2);
    if (strcmp(type, "principled") == 0)
        convert_principled(from, e);
    if (strstr(type, "plastic")) {
        set_index(e, number_of(from, "int_ior", 1.5f) / number_of(from, "ext_ior", 1));
        dim_base(e, normal_reflectance(e));
    }
    if (strcmp(type, "schlick") == 0 || strcmp(type, "ashikhminshirley") == 0)
        dim_base(e, e->r0);
    if (strcmp(type, "roughconductor") == 0) {
        struct conductor_index index = e->index;
        if (!conductor_index_prepare(&index, from))
            return false;
        e->index = index;
        e->index.material = NULL;
        e->index.ext_eta = 1;
        use_ggx(from, e, model_index("schlick"));
        convert_roughness(from, e, model_index("ward"));
    }
    if (strcmp(type, "roughplastic") == 0)
        use_ggx(from, e, model_index("schlick"));
    return true;
}

// ---- conversion -----------------------------------------------------------------------------

static const struct rule *find_rule(const char *type) {
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (strcmp(rules[i].from, type) == 0)
            return &rules[i];
    return NULL;
}

static bool refuse(const struct object *o) {
    char known[400] = "";
    size_t used = 0;
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        used += (size_t)snprintf(known + used, sizeof known - used, " %s", rules[i].from);
    log_error_at(o->at, "%s has no editable form; expected one of:%s", o->type->name, known);
    return false;
}

bool editable_converts(const struct object *material) {
    return material->type == &bsdf_editable.entry || find_rule(material->type->name);
}

bool editable_convert(struct object *material, struct arena *arena) {
    if (material->type == &bsdf_editable.entry)
        return true;
    const struct rule *rule = find_rule(material->type->name);
    if (!rule)
        return refuse(material);
    struct editable *e = arena_alloc(arena, sizeof *e);
    struct object now = {&bsdf_editable.entry, e, material->id, material->at};
    for (const struct param *p = editable_params; p->name; p++)
        if (p->def)
            set_default(p, (char *)e + p->offset);
    e->model = model_index(rule->model);
    for (int i = 0; i < RULE_PARAMS && rule->params[i][0]; i++)
        copy_param(material, rule->params[i][0], &now, rule->params[i][1]);
    if (!finish(material, e))
        return false;
    log_info("%s:%d: %s becomes editable as %s%s%s", material->at.file ? material->at.file : "",
             material->at.line, material->type->name, models[e->model]->name, rule->note ? "; " : "",
             rule->note ? rule->note : "");
    *material = now;
    return true;
}
