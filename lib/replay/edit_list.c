// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_list.h"

#include <stdio.h>
#include <string.h>

#include "curve/parameters.h"

// "specular", or "specular#2" for the second of that name.
static void term_name(const struct form *f, uint32_t term, char *out, size_t n) {
    int same = 1;
    for (uint32_t t = 0; t < term; t++)
        same += strcmp(f->term[t].name, f->term[term].name) == 0;
    if (same > 1)
        snprintf(out, n, "%s#%d", f->term[term].name, same);
    else
        snprintf(out, n, "%s", f->term[term].name);
}

static uint64_t pixels_of(const struct edit_tensor *e, uint32_t object, uint32_t term) {
    uint64_t pixels = 0;
    for (uint32_t i = 0; i < e->tensor->block_count; i++)
        if (e->blocks[i].object == object && e->blocks[i].term == term)
            pixels += e->tensor->blocks[i].pixel_count;
    return pixels;
}

static void list_curve(const struct edited_object *o, const struct form_slot *slot, struct json *out) {
    const struct basis *b = &o->curve[slot->curve]->basis;
    json_add_text(out, "curve", o->form.curve[slot->curve].name);
    json_add_text(out, "of", gamma_names[slot->gamma.kind]);
    json_add_text(out, "basis", b->kind == BASIS_HAT ? "hat" : "box");
    json_add_count(out, "coefficients", b->count);
}

static void list_term(const struct edit_tensor *e, uint32_t object, uint32_t term,
                      struct json *out) {
    const struct edited_object *o = &e->objects[object];
    const struct form_term *t = &o->form.term[term];
    char name[256];
    term_name(&o->form, term, name, sizeof name);
    json_add_text(out, "name", name);
    json_add_count(out, "pixels", (int64_t)pixels_of(e, object, term));
    struct json *scale = json_add_array(out, "scale");
    for (int k = 0; k < CURVE_CHANNELS; k++)
        json_append_number(scale, t->scale[k]);
    for (int s = 0; s < SLOTS; s++)
        if (edit_has_slot(t, (enum form_slot_name)s))
            list_curve(o, &t->slots[s], json_add_object(out, slot_names[s]));
}

void edit_list(const struct edit_tensor *e, struct json *out) {
    struct json *objects = json_add_array(out, "objects");
    for (uint32_t i = 0; i < e->object_count; i++) {
        const struct edited_object *o = &e->objects[i];
        struct json *j = json_append_object(objects);
        json_add_text(j, "name", o->name);
        json_add_text(j, "model", o->model ? o->model->name : "");
        if (o->model)
            parameters_to_json(&o->parameters, json_add_object(j, "parameters"));
        struct json *terms = json_add_array(j, "terms");
        for (uint32_t t = 0; t < o->form.terms; t++)
            list_term(e, i, t, json_append_object(terms));
    }
}

// ---- for people ---------------------------------------------------------------------------------

static void print_parameters(const struct edited_object *o) {
    struct json *j = json_new_object();
    parameters_to_json(&o->parameters, j);
    printf(" ");
    for (size_t i = 0; i < json_count(j); i++) {
        const struct json *value = json_get(j, json_key(j, i));
        double number;
        printf(" %s=", json_key(j, i));
        if (json_is_array(value))
            for (size_t k = 0; k < json_count(value); k++)
                if (json_read_number(json_at(value, k), &number))
                    printf("%s%.6g", k ? "," : "", number);
                else
                    printf("%s%s", k ? "," : "", json_text(json_at(value, k)));
        else if (json_read_number(value, &number))
            printf("%.6g", number);
        else
            printf("%s", json_text(value));
    }
    putchar('\n');
    json_destroy(j);
}

static void print_term(const struct edit_tensor *e, uint32_t object, uint32_t term) {
    const struct edited_object *o = &e->objects[object];
    const struct form_term *t = &o->form.term[term];
    char name[256];
    term_name(&o->form, term, name, sizeof name);
    printf("  %s.%s  scale=%.6g,%.6g,%.6g  %llu pixels\n", o->name, name, t->scale[0], t->scale[1],
           t->scale[2], (unsigned long long)pixels_of(e, object, term));
    for (int s = 0; s < SLOTS; s++) {
        if (!edit_has_slot(t, (enum form_slot_name)s))
            continue;
        const struct form_slot *slot = &t->slots[s];
        const struct basis *b = &o->curve[slot->curve]->basis;
        printf("    %s.%s.%s  \"%s\" of %s, %u %s\n", o->name, name, slot_names[s],
               o->form.curve[slot->curve].name, gamma_names[slot->gamma.kind], b->count,
               b->kind == BASIS_HAT ? "nodes" : "boxes");
    }
}

void edit_list_print(const struct edit_tensor *e) {
    for (uint32_t i = 0; i < e->object_count; i++) {
        const struct edited_object *o = &e->objects[i];
        printf("%s: %s\n", o->name, o->model ? o->model->name : "curves without a model");
        if (o->model)
            print_parameters(o);
        for (uint32_t t = 0; t < o->form.terms; t++)
            print_term(e, i, t);
    }
}
