// SPDX-License-Identifier: Apache-2.0
#include "replay/save_scene.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/xml.h"
#include "curve/form_json.h"

struct saving {
    const struct edit_tensor *objects;
    const char *scene, *output;
    struct xml_node *root;
    struct arena arena;
};

static bool is(const char *text, const char *other) {
    return text && strcmp(text, other) == 0;
}

// ---- finding ------------------------------------------------------------------------------------

static struct xml_node *find_id(struct xml_node *node, const char *tag, const char *id) {
    for (struct xml_node *n = node->first; n; n = n->next) {
        if (is(n->tag, tag) && is(xml_get(n, "id"), id))
            return n;
        struct xml_node *inside = find_id(n, tag, id);
        if (inside)
            return inside;
    }
    return NULL;
}

// The material of a shape: inside it, or by reference.
static struct xml_node *material_of(struct saving *s, const struct xml_node *shape) {
    for (struct xml_node *n = shape->first; n; n = n->next) {
        if (is(n->tag, "bsdf"))
            return n;
        const char *id = is(n->tag, "ref") ? xml_get(n, "id") : NULL;
        struct xml_node *there = id ? find_id(s->root, "bsdf", id) : NULL;
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
    struct xml_node *node = find_id(s->root, "bsdf", name);
    struct xml_node *shape = node ? NULL : find_id(s->root, "shape", name);
    if (shape)
        node = material_of(s, shape);
    node = node ? inner(node) : NULL;
    if (!node)
        log_error("%s: has no single material or shape of the id %s in the file itself; give the "
                  "object an id to save it", s->scene, name);
    return node;
}

// ---- changing -----------------------------------------------------------------------------------

static void add(struct saving *s, struct xml_node *node, const char *tag, const char *name,
                const char *value) {
    struct xml_node *child = xml_new(tag, node->at, &s->arena);
    xml_set(child, "name", name, &s->arena);
    xml_set(child, "value", value, &s->arena);
    xml_append(node, child);
}

static void add_number(struct saving *s, struct xml_node *node, const char *name, double v) {
    add(s, node, "float", name, arena_printf(&s->arena, "%.9g", v));
}

static void add_colour(struct saving *s, struct xml_node *node, const char *name, const double *v) {
    add(s, node, "rgb", name, arena_printf(&s->arena, "%.9g, %.9g, %.9g", v[0], v[1], v[2]));
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
            xml_set(old, "name", name, &s->arena);
            old->next = NULL;
            xml_append(node, old);
        }
        old = next;
    }
    xml_set(node, "type", "editable", &s->arena);
    add(s, node, "string", "model", o->model->name);
    add_number(s, node, "exponent_u", p->exponent_u);
    add_number(s, node, "exponent_v", p->exponent_v);
    add_number(s, node, "alpha_u", p->alpha_u);
    add_number(s, node, "alpha_v", p->alpha_v);
    add_number(s, node, "isotropy", p->isotropy);
    add_colour(s, node, "eta", p->eta);
    add_colour(s, node, "k", p->k);
    add_colour(s, node, "r0", p->r0);
    add(s, node, "string", "variant", variants[p->variant]);
    add(s, node, "boolean", "literal", p->literal ? "true" : "false");
    add(s, node, "boolean", "fixed_fresnel", p->fixed_fresnel ? "true" : "false");
    if (has_term(o, "diffuse") && !diffuse)
        add(s, node, "rgb", "diffuse_reflectance", "1");
}

// The nearest material without curves, for a person to put there.
static const char *nearest(struct saving *s, const struct edited_object *o) {
    const struct model_parameters *p = &o->parameters;
    const char *name = o->model ? o->model->name : "none";
    const double *f = o->form.term[0].scale;
    return arena_printf(&s->arena, " nearest without curves: %s, exponent_u %.4g, exponent_v %.4g, "
                        "alpha_u %.4g, alpha_v %.4g; factor of its first term %.4g %.4g %.4g ",
                        is(name, "lightview") ? "diffuse" : name, p->exponent_u, p->exponent_v,
                        p->alpha_u, p->alpha_v, f[0], f[1], f[2]);
}

// "OUT-OBJECT.json", with letters, digits, '-' and '_' of the name.
static const char *form_path(struct saving *s, const char *name) {
    const char *point = strrchr(s->output, '.');
    const int stem = point && !strchr(point, '/') ? (int)(point - s->output) : (int)strlen(s->output);
    char *path = arena_printf(&s->arena, "%.*s-%s.json", stem, s->output, name);
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
    add(s, node, "string", "edited", slash ? slash + 1 : path);
    node->text = nearest(s, o);
    return written;
}

// ---- writing ------------------------------------------------------------------------------------

static void write_text(FILE *f, const char *text) {
    for (; *text; text++)
        switch (*text) {
        case '&': fputs("&amp;", f); break;
        case '<': fputs("&lt;", f); break;
        case '>': fputs("&gt;", f); break;
        case '"': fputs("&quot;", f); break;
        default: fputc(*text, f);
        }
}

static void write_node(FILE *f, const struct xml_node *node, int indent) {
    if (node->text)
        fprintf(f, "%*s<!--%s-->\n", indent, "", node->text);
    fprintf(f, "%*s<%s", indent, "", node->tag);
    for (int i = 0; i < node->attribute_count; i++) {
        fprintf(f, " %s=\"", node->attributes[i].name);
        write_text(f, node->attributes[i].value);
        fputc('"', f);
    }
    fputs(node->first ? ">\n" : "/>\n", f);
    for (const struct xml_node *n = node->first; n; n = n->next)
        write_node(f, n, indent + 4);
    if (node->first)
        fprintf(f, "%*s</%s>\n", indent, "", node->tag);
}

// The folder where the scene's files are looked for, in front of all else.
static bool add_folder(struct saving *s) {
    char folder[4096];
    file_directory(s->scene, folder, sizeof folder);
    char *whole = realpath(folder, NULL);
    if (!whole) {
        log_error("%s: its folder cannot be found", s->scene);
        return false;
    }
    struct xml_node *path = xml_new("path", s->root->at, &s->arena);
    xml_set(path, "value", arena_strdup(&s->arena, whole), &s->arena);
    path->next = s->root->first;
    s->root->first = path;
    free(whole);
    return true;
}

static bool write_scene(struct saving *s) {
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    if (!f) {
        log_error("%s: no memory to write a scene", s->output);
        return false;
    }
    write_node(f, s->root, 0);
    const bool good = fclose(f) == 0 && file_write(s->output, text, size);
    free(text);
    return good;
}

bool save_scene(const struct edit_tensor *e, const char *scene, const char *output) {
    struct saving s = {.objects = e, .scene = scene, .output = output};
    size_t size, nodes = 0;
    char *text = file_read(scene, XML_MOST_BYTES, &size);
    s.root = text ? xml_parse(text, size, scene, XML_TEXT_REPORTED, &s.arena, &nodes) : NULL;
    mem_free(text);
    bool good = s.root != NULL;
    for (uint32_t i = 0; i < e->object_count && good; i++)
        good = save_object(&s, &e->objects[i]);
    good = good && add_folder(&s) && write_scene(&s);
    arena_finish(&s.arena);
    return good;
}
