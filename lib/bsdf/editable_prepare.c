// SPDX-License-Identifier: Apache-2.0
// Parameters of the editable material, and how they become a form with tables.
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "bsdf/editable.h"
#include "bsdf/editable_albedo.h"
#include "curve/form_json.h"
#include "curve/operators.h"

#define AT(member) offsetof(struct editable, member)

static const char *const model_names[] = {
#define X(name) #name,
#include "curve/list.h"
#undef X
    NULL,
};
static const char *const bases[] = {"box", "hat", NULL};
static const char *const spacings[] = {"uniform", "quadratic", NULL};
static const char *const weightings[] = {"light", "even", "points", NULL};
static const char *const variants[] = {"original", "duer", "bounded", NULL};

const struct param editable_params[] = {
    {"model", PARAM_CHOICE, AT(model), .def = "blinnphong", .unit = "",
     .help = "what the curves are generated from", .choices = model_names},
    {"specular_reflectance", PARAM_TEXTURE, AT(specular), .def = "1", .max = 1e6, .unit = "",
     .help = "factor on all terms but the diffuse one"},
    {"diffuse_reflectance", PARAM_TEXTURE, AT(diffuse), .def = "0", .max = 1, .unit = "",
     .help = "reflectance of an added Lambertian term"},
    {"exponent", PARAM_FLOAT, AT(exponent), .def = "30", .max = 1e8, .unit = "",
     .help = "sharpness of Phong, Blinn-Phong, Ashikhmin-Shirley and facets"},
    {"exponent_u", PARAM_FLOAT, AT(exponent_u), .def = "-1", .min = -1, .max = 1e8, .unit = "",
     .help = "sharpness along the tangent (-1: exponent)"},
    {"exponent_v", PARAM_FLOAT, AT(exponent_v), .def = "-1", .min = -1, .max = 1e8, .unit = "",
     .help = "sharpness across the tangent (-1: exponent)"},
    {"alpha", PARAM_FLOAT, AT(alpha), .def = "0.1", .max = 1000, .unit = "",
     .help = "roughness of Cook-Torrance, Ward, Schlick and Oren-Nayar; at least 1e-4 is taken"},
    {"alpha_u", PARAM_FLOAT, AT(alpha_u), .def = "-1", .min = -1, .max = 1000, .unit = "",
     .help = "roughness along the tangent (-1: alpha)"},
    {"alpha_v", PARAM_FLOAT, AT(alpha_v), .def = "-1", .min = -1, .max = 1000, .unit = "",
     .help = "roughness across the tangent (-1: alpha)"},
    CONDUCTOR_INDEX_PARAMS(struct editable, index),
    {"r0", PARAM_REFLECTANCE, AT(r0), .def = "0.04", .max = 1, .unit = "",
     .help = "Schlick's reflectance at normal incidence (Ashikhmin-Shirley, Schlick)"},
    {"isotropy", PARAM_FLOAT, AT(isotropy), .def = "1", .min = 1e-4, .max = 1, .unit = "",
     .help = "Schlick's p: towards 0 the highlight is stretched along the bitangent"},
    {"variant", PARAM_CHOICE, AT(variant), .def = "bounded", .unit = "",
     .help = "of Ward: as published, Duer's, or bounded", .choices = variants},
    {"literal", PARAM_BOOL, AT(literal), .def = "false", .unit = "",
     .help = "Phong and Cook-Torrance with the factors as printed, which reflect too much"},
    {"fixed_fresnel", PARAM_BOOL, AT(fixed_fresnel), .def = "false", .unit = "",
     .help = "keep the Fresnel factor out of the curves"},
    {"gamma_o", PARAM_CHOICE, AT(gamma[SLOT_O]), .def = "none", .unit = "",
     .help = "of freehand: what the curve outside the integral depends on",
     .choices = gamma_names},
    {"gamma_a", PARAM_CHOICE, AT(gamma[SLOT_A]), .def = "theta_h", .unit = "",
     .help = "of freehand: what the first curve depends on", .choices = gamma_names},
    {"gamma_b", PARAM_CHOICE, AT(gamma[SLOT_B]), .def = "none", .unit = "",
     .help = "of freehand: what the second curve depends on", .choices = gamma_names},
    {"quotient", PARAM_CHOICE, AT(quotient), .def = "one", .unit = "",
     .help = "of freehand: the fixed factor", .choices = quotient_names},
    {"curve_o", PARAM_FILE, AT(curve[MODEL_CURVE_O]), .unit = "", .optional = true,
     .help = "CSV file in place of the first term's f_o"},
    {"curve_a", PARAM_FILE, AT(curve[MODEL_CURVE_A]), .unit = "", .optional = true,
     .help = "CSV file in place of the first term's f_A"},
    {"curve_b", PARAM_FILE, AT(curve[MODEL_CURVE_B]), .unit = "", .optional = true,
     .help = "CSV file in place of the first term's f_B"},
    {"diffuse_curve_o", PARAM_FILE, AT(curve[MODEL_CURVE_DIFFUSE_O]), .unit = "",
     .optional = true, .help = "CSV file of the diffuse term over theta_o"},
    {"diffuse_curve_a", PARAM_FILE, AT(curve[MODEL_CURVE_DIFFUSE_A]), .unit = "",
     .optional = true, .help = "CSV file of the diffuse term over theta_i"},
    {"edit_o", PARAM_STRING, AT(edit[SLOT_O]), .unit = "", .optional = true,
     .help = "operators on the first term's f_o: \"amplify-y,a,b,c,d,m[,base];...\", degrees"},
    {"edit_a", PARAM_STRING, AT(edit[SLOT_A]), .unit = "", .optional = true,
     .help = "operators on the first term's f_A"},
    {"edit_b", PARAM_STRING, AT(edit[SLOT_B]), .unit = "", .optional = true,
     .help = "operators on the first term's f_B"},
    {"edited", PARAM_FILE, AT(edited), .unit = "", .optional = true,
     .help = "JSON file with edited curves and factors of all terms (edit --save-scene)"},
    {"bins", PARAM_INT, AT(bins), .def = "256", .min = 1, .max = 4096, .unit = "",
     .help = "coefficients of a curve that is generated; files keep their own bins"},
    {"bins_b", PARAM_INT, AT(bins_b), .def = "-1", .min = -1, .max = 4096, .unit = "",
     .help = "the same for f_B (-1: bins)"},
    {"bins_constant", PARAM_INT, AT(bins_constant), .def = "-1", .min = -1, .max = 4096, .unit = "",
     .help = "the same for curves that are constant (-1: bins)"},
    {"basis", PARAM_CHOICE, AT(basis), .def = "hat", .unit = "",
     .help = "steps, or lines between nodes", .choices = bases},
    {"spacing", PARAM_CHOICE, AT(spacing), .def = "uniform", .unit = "",
     .help = "even bins, or narrow ones near 0", .choices = spacings},
    {"weighting", PARAM_CHOICE, AT(weighting), .def = "light", .unit = "",
     .help = "a bin's value: mean as light sees it, even mean, value in the middle",
     .choices = weightings},
    {"term_1", PARAM_BSDF, AT(child[0]), .unit = "", .optional = true,
     .help = "more terms: an editable material"},
    {"term_2", PARAM_BSDF, AT(child[1]), .unit = "", .optional = true, .help = "more terms"},
    {"term_3", PARAM_BSDF, AT(child[2]), .unit = "", .optional = true, .help = "more terms"},
    PARAM_END,
};

// ---- the form -------------------------------------------------------------------------------

static double given(float own, float common) {
    return (double)(own >= 0 ? own : common);
}

static void set_colour(double out[CURVE_CHANNELS], spectrum s) {
    for (int k = 0; k < CURVE_CHANNELS; k++)
        out[k] = (double)s[k];
}

// What of a reflectance is a number of the form, to be edited; a texture is a factor of its own.
static spectrum even_part(const struct texture_ref *r) {
    return r->texture ? spectrum_grey(1) : r->value;
}

static const struct texture_ref *textured_part(const struct texture_ref *r) {
    static const struct texture_ref one = {.value = {1, 1, 1}};
    return r->texture ? r : &one;
}

static void fill_parameters(const struct editable *e, struct model_parameters *p) {
    *p = model_defaults;
    p->exponent_u = given(e->exponent_u, e->exponent);
    p->exponent_v = given(e->exponent_v, e->exponent);
    p->alpha_u = fmax(given(e->alpha_u, e->alpha), 1e-4);
    p->alpha_v = fmax(given(e->alpha_v, e->alpha), 1e-4);
    set_colour(p->reflectance, even_part(&e->specular));
    set_colour(p->diffuse, even_part(&e->diffuse));
    set_colour(p->eta, e->index.eta);
    set_colour(p->k, e->index.k);
    set_colour(p->r0, e->r0);
    p->isotropy = (double)e->isotropy;
    p->variant = e->variant;
    p->literal = e->literal;
    p->fixed_fresnel = e->fixed_fresnel;
    p->quotient = (enum quotient_kind)e->quotient;
    for (int s = 0; s < SLOTS; s++)
        p->gamma[s] = (enum gamma_kind)e->gamma[s];
}

const char *editable_model(const struct object *material, struct model_parameters *p) {
    const struct editable *e = material->data;
    fill_parameters(e, p);
    return model_names[e->model];
}

static bool read_curves(const struct editable *e, struct model_parameters *p,
                        struct arena *arena) {
    for (int i = 0; i < MODEL_CURVES; i++) {
        if (!e->curve[i])
            continue;
        struct curve *c = arena_alloc(arena, sizeof *c);
        if (!curve_read(c, arena, e->curve[i]))
            return false;
        p->curve[i] = c;
    }
    return true;
}

// Whether a curve stands in slot f_B of some term, and in no slot f_A.
static bool is_second_curve(const struct form *f, uint32_t curve) {
    bool b = false;
    for (uint32_t t = 0; t < f->terms; t++) {
        const struct form_slot *s = f->term[t].slots;
        if (s[SLOT_A].gamma.kind != GAMMA_NONE && s[SLOT_A].curve == curve)
            return false;
        b = b || (s[SLOT_B].gamma.kind != GAMMA_NONE && s[SLOT_B].curve == curve);
    }
    return b;
}

// Whether a generated curve is the same everywhere: a constant, or the Fresnel factor of what reflects
// everything.
static bool is_constant(const struct form_curve *c) {
    for (int k = 0; k < CURVE_CHANNELS; k++)
        if (c->f[k].kind != FUNCTION_CONSTANT &&
            !(c->f[k].kind == FUNCTION_FRESNEL && !(c->f[k].p[0] > 0)))
            return false;
    return true;
}

// Coefficients of a curve that no file gives; hats have at least two.
static uint32_t bins_of(const struct editable *e, uint32_t curve) {
    int bins = e->bins;
    if (e->bins_constant > 1 && is_constant(&e->form.curve[curve]))
        bins = e->bins_constant;
    else if (e->bins_b > 1 && is_second_curve(&e->form, curve))
        bins = e->bins_b;
    return (uint32_t)(bins < 2 && e->basis == BASIS_HAT ? 2 : bins);
}

static void tabulate(struct editable *e, struct curve *tables[FORM_CURVES], struct arena *arena) {
    for (uint32_t c = 0; c < e->form.curves; c++) {
        const struct basis *own = e->form.curve[c].f[0].kind == FUNCTION_TABLE
                                      ? &e->form.curve[c].f[0].table->basis : NULL;
        const struct basis even =
            own ? *own : basis_make(arena, (enum basis_kind)e->basis, bins_of(e, c),
                                    (enum basis_spacing)e->spacing);
        const enum curve_filter filter = e->weighting == 0   ? form_filter(&e->form, c)
                                         : e->weighting == 1 ? FILTER_MEAN : FILTER_POINT;
        tables[c] = form_tabulate(&e->form, c, &even, filter, arena);
    }
}

static bool edit_curves(const struct editable *e, struct curve *const tables[FORM_CURVES],
                        const char *at) {
    for (int s = 0; s < SLOTS; s++) {
        enum { MOST = 64 };
        struct curve_operator operators[MOST];
        uint32_t count;
        const struct form_slot *slot = &e->form.term[0].slots[s];
        if (!e->edit[s])
            continue;
        if (slot->gamma.kind == GAMMA_NONE) {
            log_error("%s: there is no curve %s to edit", at, slot_names[s]);
            return false;
        }
        if (!operators_parse(e->edit[s], operators, MOST, &count, at))
            return false;
        curve_edit(tables[slot->curve], (1u << CURVE_CHANNELS) - 1, operators, count);
    }
    return true;
}

static bool make_own_terms(struct editable *e, const char *at, struct arena *arena) {
    struct model_parameters p;
    struct curve *tables[FORM_CURVES];
    fill_parameters(e, &p);
    if (!read_curves(e, &p, arena) ||
        !model_make(model_find(model_names[e->model]), &p, arena, &e->form, at))
        return false;
    for (uint32_t t = 0; t < e->form.terms; t++)
        e->texture[t] = textured_part(strcmp(e->form.term[t].name, "diffuse") == 0 ? &e->diffuse
                                                                                   : &e->specular);
    tabulate(e, tables, arena);
    return edit_curves(e, tables, at);
}

static bool add_children(struct editable *e, const struct object *self) {
    for (int i = 0; i < EDITABLE_CHILDREN; i++) {
        const struct object *child = e->child[i];
        const uint32_t terms = e->form.terms;
        if (!child)
            continue;
        if (child->type != &bsdf_editable.entry) {
            log_error_at(child->at, "editable: more terms are editable materials, found \"%s\"",
                         child->type->name);
            return false;
        }
        const struct editable *more = child->data;
        if (!form_append(&e->form, &more->form)) {
            log_error_at(self->at, "editable: more than %d terms or %d curves", FORM_TERMS,
                         FORM_CURVES);
            return false;
        }
        for (uint32_t t = 0; t < more->form.terms; t++)
            e->texture[terms + t] = more->texture[t];
    }
    return true;
}

// ---- what is rendered from ------------------------------------------------------------------

static const spectrum *curve_spectra(const struct curve *c, struct arena *arena) {
    spectrum *v = arena_alloc(arena, sizeof *v * c->basis.count);
    for (uint32_t j = 0; j < c->basis.count; j++)
        v[j] = spectrum_rgb((float)fmin(curve_values(c, 0)[j], 1e30),
                            (float)fmin(curve_values(c, 1)[j], 1e30),
                            (float)fmin(curve_values(c, 2)[j], 1e30));
    return v;
}

static uint32_t lobe_of(const struct form_term *t) {
    uint32_t lobe = LOBE_DIFFUSE;
    for (int s = SLOT_A; s < SLOTS; s++) {
        const enum gamma_kind g = t->slots[s].gamma.kind;
        if (gamma_is_half(g) || g == GAMMA_THETA_R)
            lobe = LOBE_GLOSSY;
    }
    return lobe | LOBE_REFLECTION;
}

static bool is_anisotropic(const struct form_term *t) {
    for (int s = SLOT_A; s < SLOTS; s++)
        if (t->slots[s].gamma.kind >= GAMMA_PHI_H)
            return true;
    return t->quotient.kind == QUOTIENT_SCHLICK && t->quotient.isotropy < 1;
}

static void finish(struct editable *e, struct arena *arena) {
    for (uint32_t c = 0; c < e->form.curves; c++)
        e->values[c] = curve_spectra(e->form.curve[c].f[0].table, arena);
    for (uint32_t t = 0; t < e->form.terms; t++) {
        curve_sampler_init(&e->sampler[t], &e->form, &e->form.term[t], arena);
        e->lobe[t] = lobe_of(&e->form.term[t]);
        e->lobes |= e->lobe[t] | (is_anisotropic(&e->form.term[t]) ? LOBE_ANISOTROPIC : 0);
    }
    editable_measure(e);
}

bool editable_set_form(struct object *material, const struct form *edited, struct arena *arena,
                       const char *at) {
    struct editable *e = material->data;
    if (!form_same_shape(&e->form, edited)) {
        log_error("%s: the edited form has other terms, angles or quotients than the material", at);
        return false;
    }
    for (uint32_t t = 0; t < edited->terms; t++)
        memcpy(e->form.term[t].scale, edited->term[t].scale, sizeof edited->term[t].scale);
    for (uint32_t c = 0; c < edited->curves; c++) {
        const struct curve_function *f = &edited->curve[c].f[0];
        const struct basis *own = f->kind == FUNCTION_TABLE ? &f->table->basis
                                                            : &e->form.curve[c].f[0].table->basis;
        struct curve *table = arena_alloc(arena, sizeof *table);
        *table = curve_make(arena, own, CURVE_CHANNELS);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            function_project(table, k, &edited->curve[c].f[k], form_filter(edited, c));
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            e->form.curve[c].f[k] =
                (struct curve_function){.kind = FUNCTION_TABLE, .table = table, .channel = k};
    }
    finish(e, arena);
    return true;
}

// What `relume edit --save-scene` wrote beside the scene.
static bool read_form(struct object *self, const char *path, struct arena *arena) {
    struct form f;
    size_t size;
    char *text = file_read(path, 256u << 20, &size);
    struct json *j = text ? json_parse(text, size, path) : NULL;
    const bool good = j && form_from_json(&f, j, arena, path) &&
                      editable_set_form(self, &f, arena, path);
    json_destroy(j);
    mem_free(text);
    return good;
}

bool editable_prepare(struct object *self, struct arena *arena) {
    struct editable *e = self->data;
    char at[300];
    snprintf(at, sizeof at, "%s:%d: editable", self->at.file ? self->at.file : "", self->at.line);
    if (!conductor_index_prepare(&e->index, self) || !make_own_terms(e, at, arena) ||
        !add_children(e, self) || !bsdf_check_nesting(self))
        return false;
    if (e->edited)
        return read_form(self, e->edited, arena);
    finish(e, arena);
    return true;
}
