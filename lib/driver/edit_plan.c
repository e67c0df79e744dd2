// SPDX-License-Identifier: Apache-2.0
#include "driver/edit_plan.h"

#include <string.h>

#include "base/log.h"
#include "bsdf/editable_convert.h"
#include "bsdf/editable_data.h"
#include "curve/form_albedo.h"
#include "curve/form_json.h"
#include "curve/parameters.h"

enum { MOST_LEAVES = 64 };

// Materials that wrap no others, found from one that may.
struct leaves {
    struct object *material[MOST_LEAVES];
    const char *name[MOST_LEAVES]; // id of it or of what is around it; or NULL
    uint32_t count;
};

static void find_leaves(struct object *o, const char *name, struct leaves *l) {
    bool wraps = false;
    name = o->id ? o->id : name;
    for (const struct param *p = o->type->params; p && p->name; p++) {
        struct object *child;
        if (p->type != PARAM_BSDF || o->type == &bsdf_editable.entry)
            continue;
        memcpy(&child, (const char *)o->data + p->offset, sizeof child);
        wraps = true;
        if (child)
            find_leaves(child, name, l);
    }
    if (!wraps && l->count < MOST_LEAVES) {
        l->material[l->count] = o;
        l->name[l->count++] = name;
    }
}

// ---- conversion ---------------------------------------------------------------------------------

// The material of that id, or of the shape of that id.
static struct object *find_material(const struct scene *s, const char *name) {
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        if (s->bsdfs[i]->id && strcmp(s->bsdfs[i]->id, name) == 0)
            return s->bsdfs[i];
    for (uint32_t i = 0; i < s->shape_count; i++)
        if (strcmp(s->shapes[i].name, name) == 0)
            for (uint32_t j = 0; j < s->bsdf_count; j++)
                if (s->bsdfs[j] == s->shapes[i].bsdf)
                    return s->bsdfs[j];
    return NULL;
}

static bool unknown(struct scene *s, const char *name) {
    const char *known = "";
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        if (s->bsdfs[i]->id)
            known = arena_printf(&s->arena, "%s %s", known, s->bsdfs[i]->id);
    for (uint32_t i = 0; i < s->shape_count; i++)
        if (s->shapes[i].name[0])
            known = arena_printf(&s->arena, "%s %s", known, s->shapes[i].name);
    log_error("--edit %s: no material or shape of that id; there %s%s", name,
              known[0] ? "are:" : "is none with an id", known);
    return false;
}

bool edit_convert(struct scene *s, const char *const *names, size_t count, int bins_b) {
    for (size_t i = 0; i < count; i++) {
        struct leaves l = {.count = 0};
        struct object *o = find_material(s, names[i]);
        if (!o)
            return unknown(s, names[i]);
        find_leaves(o, names[i], &l);
        for (uint32_t k = 0; k < l.count; k++) {
            if (!l.material[k]->id)
                l.material[k]->id = l.name[k]; // the object's name is the one that was asked for
            const bool plain = l.material[k]->type != &bsdf_editable.entry;
            if (!editable_convert(l.material[k], &s->arena))
                return false;
            if (plain && bins_b > 0)
                ((struct editable *)l.material[k]->data)->bins_b = bins_b;
        }
    }
    return true;
}

// ---- objects ------------------------------------------------------------------------------------

static void add_object(struct edit_plan *p, const struct object *material, const char *name,
                       size_t *capacity) {
    if (material->type != &bsdf_editable.entry || edit_plan_find(p, material->data) != EDIT_NONE)
        return;
    mem_grow(&p->objects, capacity, p->count + 1, sizeof *p->objects);
    struct edit_object *o = &p->objects[p->count];
    o->name = name ? name : arena_printf(&p->arena, "object %u", p->count);
    o->material = material;
    o->form = editable_form(material);
    for (uint32_t t = 0; t < o->form->terms; t++) {
        const spectrum mean = texture_mean(editable_texture(material, t));
        for (int k = 0; k < CURVE_CHANNELS; k++)
            o->share[t][k] = (double)mean[k];
    }
    p->count++;
}

bool edit_plan_init(struct edit_plan *p, const struct scene *s) {
    size_t capacity = 0;
    *p = (struct edit_plan){.count = 0};
    for (uint32_t i = 0; i < s->shape_count; i++) {
        struct leaves l = {.count = 0};
        const char *name = s->shapes[i].name[0] ? s->shapes[i].name : NULL;
        // The leaves are looked at only.
        find_leaves((struct object *)(uintptr_t)s->shapes[i].bsdf, NULL, &l);
        for (uint32_t k = 0; k < l.count; k++)
            add_object(p, l.material[k], l.name[k] ? l.name[k] : name, &capacity);
    }
    if (p->count > 0)
        return true;
    log_error("%s: nothing to edit; expected a shape with an editable material, or --edit NAME",
              s->path);
    edit_plan_finish(p);
    return false;
}

void edit_plan_finish(struct edit_plan *p) {
    mem_free(p->objects);
    arena_finish(&p->arena);
    *p = (struct edit_plan){.count = 0};
}

uint32_t edit_plan_find(const struct edit_plan *p, const void *owner) {
    for (uint32_t i = 0; i < p->count; i++)
        if (p->objects[i].material->data == owner)
            return i;
    return EDIT_NONE;
}

// ---- blocks -------------------------------------------------------------------------------------

void edit_plan_block(const struct edit_plan *p, uint32_t object, uint32_t term,
                     struct tensor_block *b) {
    const struct edit_object *o = &p->objects[object];
    const struct form_term *t = &o->form->term[term];
    *b = (struct tensor_block){.object = o->name, .term = t->name, .groups = 1, .coefficients = 1,
                               .channels = CURVE_CHANNELS};
    for (int s = SLOT_A; s < SLOTS; s++) {
        if (!edit_term_has(t, (enum form_slot_name)s))
            continue;
        const struct basis *basis = edit_basis(o->form, &t->slots[s]);
        b->axes[b->axis_count++] = (struct tensor_axis){
            .name = gamma_names[t->slots[s].gamma.kind], .bins = basis->count,
            .basis = basis->kind == BASIS_HAT ? TENSOR_HAT : TENSOR_BOX, .edges = basis->knots};
        b->coefficients *= basis->count;
    }
}

void edit_plan_weights(const struct edit_plan *p, uint32_t object, uint32_t term, float *weights) {
    const struct form *f = p->objects[object].form;
    const struct form_term *t = &f->term[term];
    const bool a = edit_term_has(t, SLOT_A), b = edit_term_has(t, SLOT_B);
    const uint32_t rows = a ? edit_basis(f, &t->slots[SLOT_A])->count : 1;
    const uint32_t columns = b ? edit_basis(f, &t->slots[SLOT_B])->count : 1;
    for (uint32_t j = 0; j < rows; j++)
        for (uint32_t k = 0; k < columns; k++)
            for (uint32_t c = 0; c < CURVE_CHANNELS; c++) {
                double w = t->scale[c];
                if (a)
                    w *= curve_values(f->curve[t->slots[SLOT_A].curve].f[c].table, c)[j];
                if (b)
                    w *= curve_values(f->curve[t->slots[SLOT_B].curve].f[c].table, c)[k];
                weights[(j * columns + k) * CURVE_CHANNELS + c] = (float)w;
            }
}

void edit_plan_albedo(const struct edit_plan *p, uint32_t object, double *const e[FORM_TERMS],
                      double albedo[CURVE_CHANNELS]) {
    const struct edit_object *o = &p->objects[object];
    for (int k = 0; k < CURVE_CHANNELS; k++)
        albedo[k] = 0;
    for (uint32_t t = 0; t < o->form->terms; t++) {
        double value[CURVE_CHANNELS];
        form_term_albedo(o->form, t, e[t], value);
        for (int k = 0; k < CURVE_CHANNELS; k++)
            albedo[k] += o->share[t][k] * value[k];
    }
}

// ---- metadata -----------------------------------------------------------------------------------

void edit_plan_describe(const struct edit_plan *p, struct json *meta,
                        struct json *(*terms)[FORM_TERMS]) {
    struct json *objects = json_add_array(meta, "objects");
    for (uint32_t i = 0; i < p->count; i++) {
        const struct edit_object *o = &p->objects[i];
        struct json *own[FORM_TERMS], **of_term = terms ? terms[i] : own;
        struct model_parameters parameters;
        struct json *j = json_append_object(objects);
        json_add_text(j, "name", o->name);
        json_add_text(j, "model", editable_model(o->material, &parameters));
        parameters_to_json(&parameters, json_add_object(j, "parameters"));
        form_to_json(o->form, json_add_object(j, "form"), of_term);
        for (uint32_t t = 0; t < o->form->terms; t++) {
            struct json *share = json_add_array(of_term[t], "share");
            for (int k = 0; k < CURVE_CHANNELS; k++)
                json_append_number(share, o->share[t][k]);
        }
    }
}
