// SPDX-License-Identifier: Apache-2.0
#include "replay/save_scene.h"

#include <ctype.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "curve/form_json.h"
#include "replay/nearest.h"
#include "replay/save_lights.h"

struct saving {
    struct scene_copy copy; // first
    const struct edit_tensor *objects;
};

static bool is(const char *text, const char *other) {
    return text && strcmp(text, other) == 0;
}

// ---- finding ------------------------------------------------------------------------------------

// The material of a shape: inside it, or by reference.
static struct xml_node *material_of(struct saving *s, const struct xml_node *shape) {
    for (struct xml_node *n = shape->first; n; n = n->next) {
        if (is(n->tag, "bsdf"))
            return n;
        const char *id = is(n->tag, "ref") ? xml_get(n, "id") : NULL;
        struct xml_node *there = id ? scene_copy_find(s->copy.root, "bsdf", id) : NULL;
        if (there)
            return there;
    }
    return NULL;
}

// The material inside those that wrap it; NULL: there is not one alone.
static struct xml_node *inner(struct xml_node *node) {
    while (!is(xml_get(node, "type"), "editable")) {
        struct xml_node *child = xml_child(node, "bsdf");
        if (!child)
            return node;
        for (struct xml_node *n = child->next; n; n = n->next)
            if (is(n->tag, "bsdf"))
                return NULL;
        node = child;
    }
    return node;
}

static struct xml_node *find_material(struct saving *s, const char *name) {
    struct xml_node *node = scene_copy_find(s->copy.root, "bsdf", name);
    struct xml_node *shape = node ? NULL : scene_copy_find(s->copy.root, "shape", name);
    if (shape)
        node = material_of(s, shape);
    node = node ? inner(node) : NULL;
    if (!node)
        log_error("%s: has no single material or shape of the id %s in the file itself; give the "
                  "object an id to save it", s->copy.scene, name);
    return node;
}

// ---- changing -----------------------------------------------------------------------------------

static void add_number(struct saving *s, struct xml_node *node, const char *name, double v) {
    scene_copy_add(&s->copy, node, "float", name, arena_printf(&s->copy.arena, "%.9g", v));
}

static void add_colour(struct saving *s, struct xml_node *node, const char *name, const double *v) {
    scene_copy_add(&s->copy, node, "rgb", name, arena_printf(&s->copy.arena, "%.9g, %.9g, %.9g", v[0], v[1], v[2]));
}

static bool has_term(const struct edited_object *o, const char *name) {
    for (uint32_t t = 0; t < o->form.terms; t++)
        if (is(o->form.term[t].name, name))
            return true;
    return false;
}

// What a texture of a plain material is to the editable one; NULL: nothing.
static const char *texture_name(const struct edited_object *o, const char *name) {
    if (is(name, "specular_reflectance") || is(name, "diffuse_reflectance"))
        return name;
    if (is(name, "reflectance"))
        return "specular_reflectance";
    return is(name, "base_color") ? (has_term(o, "diffuse") ? "diffuse_reflectance"
                                                            : "specular_reflectance") : NULL;
}

// A plain material becomes the editable one that the tensor was made of; textures stay.
static void convert(struct saving *s, struct xml_node *node, const struct edited_object *o) {
    static const char *const variants[] = {"original", "duer", "bounded"};
    const struct model_parameters *p = &o->parameters;
    bool diffuse = false;
    struct xml_node *old = node->first;
    node->first = node->last = NULL;
    while (old) {
        struct xml_node *next = old->next;
        const char *name = texture_name(o, xml_get(old, "name"));
        if (name && (is(old->tag, "texture") || is(old->tag, "ref"))) {
            diffuse = diffuse || is(name, "diffuse_reflectance");
            xml_set(old, "name", name, &s->copy.arena);
            old->next = NULL;
            xml_append(node, old);
        }
        old = next;
    }
    xml_set(node, "type", "editable", &s->copy.arena);
    scene_copy_add(&s->copy, node, "string", "model", o->model->name);
    add_number(s, node, "exponent_u", p->exponent_u);
    add_number(s, node, "exponent_v", p->exponent_v);
    add_number(s, node, "alpha_u", p->alpha_u);
    add_number(s, node, "alpha_v", p->alpha_v);
    add_number(s, node, "isotropy", p->isotropy);
    add_colour(s, node, "eta", p->eta);
    add_colour(s, node, "k", p->k);
    add_colour(s, node, "r0", p->r0);
    scene_copy_add(&s->copy, node, "string", "variant", variants[p->variant]);
    scene_copy_add(&s->copy, node, "boolean", "literal", p->literal ? "true" : "false");
    scene_copy_add(&s->copy, node, "boolean", "fixed_fresnel", p->fixed_fresnel ? "true" : "false");
    if (has_term(o, "diffuse") && !diffuse)
        scene_copy_add(&s->copy, node, "rgb", "diffuse_reflectance", "1");
}

// The nearest material without curves, for a person to put there.
static const char *nearest(struct saving *s, const struct edited_object *o) {
    struct nearest n;
    if (!o->model)
        return " curves without a model ";
    nearest_find(o, &n);
    const struct model_parameters *p = &n.parameters;
    const double *f = o->form.term[0].scale, *by = n.factor;
    return arena_printf(&s->copy.arena, " nearest without curves: %s, exponent_u %.4g, exponent_v %.4g, "
                        "alpha_u %.4g, alpha_v %.4g; factor of its first term %.4g %.4g %.4g; it misses "
                        "%.2g %% of the curves ", is(o->model->name, "lightview") ? "diffuse" : o->model->name,
                        p->exponent_u, p->exponent_v, p->alpha_u, p->alpha_v, f[0] * by[0], f[1] * by[1],
                        f[2] * by[2], 100 * n.missing);
}

// "OUT-OBJECT.json", with letters, digits, '-' and '_' of the name.
static const char *form_path(struct saving *s, const char *name) {
    const char *point = strrchr(s->copy.output, '.');
    const int stem = point && !strchr(point, '/') ? (int)(point - s->copy.output) : (int)strlen(s->copy.output);
    char *path = arena_printf(&s->copy.arena, "%.*s-%s.json", stem, s->copy.output, name);
    for (char *c = path + stem; *c && c < path + strlen(path) - strlen(".json"); c++)
        if (!isalnum((unsigned char)*c) && *c != '-')
            *c = '_';
    return path;
}

static bool save_object(struct saving *s, const struct edited_object *o) {
    struct xml_node *node = find_material(s, o->name);
    if (!node)
        return false;
    if (!is(xml_get(node, "type"), "editable")) {
        if (!o->model) {
            log_error("%s: the object %s has no model to write it as", s->objects->path, o->name);
            return false;
        }
        convert(s, node, o);
    }
    const char *path = form_path(s, o->name), *slash = strrchr(path, '/');
    struct json *form = json_new_object();
    form_to_json(&o->form, form, NULL);
    char *text = json_to_text(form);
    const bool written = file_write(path, text, strlen(text));
    mem_free(text);
    json_destroy(form);
    scene_copy_add(&s->copy, node, "string", "edited", slash ? slash + 1 : path);
    node->text = nearest(s, o);
    return written;
}

static bool save_light(struct saving *s, const struct edit_light *l) {
    const double factor[] = {l->factor[0], l->factor[1], l->factor[2]};
    return (factor[0] == 1 && factor[1] == 1 && factor[2] == 1) ||
           save_light_factor(&s->copy, l->name, factor);
}

bool save_scene(const struct edit_tensor *e, const struct edit_light *lights, uint32_t light_count,
                const char *scene, const char *output) {
    struct saving s = {.objects = e};
    bool good = scene_copy_init(&s.copy, scene, output, e->tensor->meta);
    for (uint32_t i = 0; i < e->object_count && good; i++)
        good = save_object(&s, &e->objects[i]);
    for (uint32_t i = 0; i < light_count && good; i++)
        good = save_light(&s, &lights[i]);
    good = good && scene_copy_write(&s.copy);
    scene_copy_finish(&s.copy);
    return good;
}
