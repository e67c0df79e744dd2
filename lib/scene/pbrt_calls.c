// SPDX-License-Identifier: Apache-2.0
// Directives of pbrt that make something: a type in quotes, and parameters.
#include <string.h>

#include "scene/pbrt.h"

struct xml_node *pbrt_add(struct pbrt *p, struct xml_node *parent, const char *tag, const char *type,
                          const char *id, struct where at) {
    p->r->place = at;
    return id ? tree_add_named(p->r, parent, tag, type, id) : tree_add(p->r, parent, tag, type, NULL);
}

void pbrt_set_type(struct pbrt *p, struct xml_node *node, const char *type) {
    xml_set(node, "type", type, p->r->arena);
}

void pbrt_ref(struct pbrt *p, struct xml_node *parent, const char *name, const char *id) {
    struct xml_node *ref = tree_add(p->r, parent, "ref", NULL, id);
    if (name)
        xml_set(ref, "name", name, p->r->arena);
}

// "; did you mean ...", or the list of what there is.
static void report_unknown(const struct pbrt_row *table, const struct pbrt_call *c) {
    const char *nearest = NULL;
    int least = 1 + (int)strlen(c->type) / 3;
    for (const struct pbrt_row *row = table; row->type; row++) {
        const int d = row->make ? edit_distance(c->type, row->type) : least;
        if (d < least) {
            least = d;
            nearest = row->type;
        }
    }
    log_error_at(c->at, "%s \"%s\" is not known%s%s%s", c->directive, c->type,
                 nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
}

bool pbrt_make(struct pbrt *p, const struct pbrt_row *table, struct pbrt_call *c,
               struct xml_node *out) {
    const struct pbrt_row *row = table;
    while (row->type && strcmp(row->type, c->type) != 0)
        row++;
    if (!row->type) {
        report_unknown(table, c);
        return false;
    }
    if (!row->make) {
        log_error_at(c->at, "%s \"%s\" is not read (relume help format pbrt lists what is)",
                     c->directive, c->type);
        return false;
    }
    p->r->place = c->at;
    if (!row->make(p, c, out))
        return false;
    pbrt_report_unused(p, c);
    return true;
}

// ---- directives with parameters -----------------------------------------------------------------

static bool read_call(struct pbrt *p, struct pbrt_call *c, const char *directive, struct where at,
                      enum pbrt_target target) {
    *c = (struct pbrt_call){.directive = directive, .at = at, .given = p->state.given,
                            .target = target};
    c->type = pbrt_read_string(p, "a type in quotes");
    return c->type && pbrt_read_params(p, &c->params);
}

static bool make_view(struct pbrt *p, const char *directive, struct where at, const char *tag,
                      const struct pbrt_row *table, struct xml_node **slot) {
    struct pbrt_call c;
    bool good = read_call(p, &c, directive, at, PBRT_NO_TARGET);
    if (good && p->in_world) {
        log_error_at(at, "%s stands after WorldBegin", directive);
        good = false;
    }
    if (good) {
        *slot = pbrt_add(p, NULL, tag, NULL, NULL, at);
        good = pbrt_make(p, table, &c, *slot);
    }
    pbrt_free_params(&c.params);
    return good;
}

static bool do_camera(struct pbrt *p, struct where at) {
    p->camera = p->state.ctm;
    p->camera_medium = p->state.outside;
    if (p->camera_medium && !id_find(p->r, p->camera_medium)) {
        log_error_at(at, "there is no medium \"%s\" before this line", p->camera_medium + 7);
        return false;
    }
    return make_view(p, "Camera", at, "sensor", pbrt_cameras, &p->sensor);
}

static bool do_film(struct pbrt *p, struct where at) {
    return make_view(p, "Film", at, "film", pbrt_films, &p->film);
}

static bool do_filter(struct pbrt *p, struct where at) {
    return make_view(p, "PixelFilter", at, "rfilter", pbrt_filters, &p->filter);
}

static bool do_sampler(struct pbrt *p, struct where at) {
    return make_view(p, "Sampler", at, "sampler", pbrt_samplers, &p->sampler);
}

static bool do_integrator(struct pbrt *p, struct where at) {
    struct xml_node *node = NULL;
    if (!make_view(p, "Integrator", at, "integrator", pbrt_integrators, &node))
        return false;
    if (!p->has_integrator)
        xml_append(p->scene, node);
    p->has_integrator = true;
    return true;
}

// Read and forgotten.
static bool do_ignored(struct pbrt *p, struct where at) {
    struct pbrt_call c;
    const bool good = read_call(p, &c, "", at, PBRT_NO_TARGET);
    pbrt_free_params(&c.params);
    return good;
}

static bool do_option(struct pbrt *p, struct where at) {
    struct list params = {0};
    const bool good = pbrt_read_params(p, &params);
    pbrt_warn(p, at, "Option is not used");
    pbrt_free_params(&params);
    return good;
}

static bool do_colour_space(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "a colour space in quotes");
    if (name && strcmp(name, "srgb") != 0) {
        log_error_at(at, "the colour space \"%s\" is not read, expected \"srgb\"", name);
        return false;
    }
    return name != NULL;
}

static bool do_shape(struct pbrt *p, struct where at) {
    struct pbrt_call c;
    const bool good = read_call(p, &c, "Shape", at, PBRT_SHAPE) && pbrt_add_shape(p, &c);
    pbrt_free_params(&c.params);
    return good;
}

static bool do_material(struct pbrt *p, struct where at) {
    struct pbrt_call c;
    const char *id = arena_printf(p->r->arena, "material at line %d, %d", at.line, p->anonymous++);
    const bool good = read_call(p, &c, "Material", at, PBRT_MATERIAL) && pbrt_add_material(p, &c, id);
    pbrt_free_params(&c.params);
    p->state.material = id;
    return good;
}

// The type of what MakeNamed... makes is a parameter.
static bool read_named(struct pbrt *p, struct pbrt_call *c, const char *directive, struct where at,
                       enum pbrt_target target, const char **name) {
    bool good = read_call(p, c, directive, at, target);
    *name = c->type;
    c->type = "";
    const char *type = good ? pbrt_string(c, "type", NULL, &good) : NULL;
    if (good && !type) {
        log_error_at(at, "%s \"%s\": \"string type\" is missing", directive, *name);
        return false;
    }
    c->type = type ? type : "";
    return good;
}

static bool do_named_material(struct pbrt *p, struct where at) {
    struct pbrt_call c;
    const char *name;
    const bool good =
        read_named(p, &c, "MakeNamedMaterial", at, PBRT_MATERIAL, &name) &&
        pbrt_add_material(p, &c, arena_printf(p->r->arena, "material %s", name));
    pbrt_free_params(&c.params);
    return good;
}

static bool do_use_material(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of a material in quotes");
    if (!name)
        return false;
    p->state.material = arena_printf(p->r->arena, "material %s", name);
    if (id_find(p->r, p->state.material))
        return true;
    log_error_at(at, "there is no material \"%s\" before this line", name);
    return false;
}

static bool do_medium(struct pbrt *p, struct where at) {
    struct pbrt_call c;
    const char *name;
    bool good = read_named(p, &c, "MakeNamedMedium", at, PBRT_MEDIUM, &name);
    if (good) {
        const char *id = arena_printf(p->r->arena, "medium %s", name);
        struct xml_node *out = pbrt_add(p, p->scene, "medium", NULL, id, at);
        good = out && pbrt_make(p, pbrt_media, &c, out);
        p->has_media = true;
    }
    pbrt_free_params(&c.params);
    return good;
}

static bool do_interface(struct pbrt *p, struct where at) {
    const char *inside = pbrt_read_string(p, "the name of a medium in quotes"), *outside = inside;
    struct pbrt_token t;
    (void)at;
    if (!inside || !pbrt_next(p, &t))
        return false;
    pbrt_put_back(p, &t);
    if (t.kind == PBRT_STRING)
        outside = pbrt_read_string(p, "the name of a medium");
    if (!outside)
        return false;
    p->state.inside = *inside ? arena_printf(p->r->arena, "medium %s", inside) : NULL;
    p->state.outside = *outside ? arena_printf(p->r->arena, "medium %s", outside) : NULL;
    return true;
}

static bool do_light(struct pbrt *p, struct where at) {
    struct pbrt_call c;
    bool good = read_call(p, &c, "LightSource", at, PBRT_LIGHT);
    if (good) {
        const char *id = tree_free_id(p->r, NULL, c.type);
        struct xml_node *out = pbrt_add(p, p->scene, "emitter", NULL, id, at);
        good = out && pbrt_make(p, pbrt_lights, &c, out);
    }
    pbrt_free_params(&c.params);
    return good;
}

static bool do_area_light(struct pbrt *p, struct where at) {
    struct pbrt_call *c = mem_array(1, sizeof *c);
    *LIST_ADD(&p->area_lights, struct pbrt_call *) = c;
    p->state.area_light = c;
    return read_call(p, c, "AreaLightSource", at, PBRT_LIGHT);
}

static bool do_texture(struct pbrt *p, struct where at) {
    const char *name = pbrt_read_string(p, "the name of the texture in quotes");
    const char *kind = name ? pbrt_read_string(p, "\"float\" or \"spectrum\"") : NULL;
    struct pbrt_call c;
    if (!kind)
        return false;
    const bool scalar = strcmp(kind, "float") == 0;
    if (!scalar && strcmp(kind, "spectrum") != 0) {
        log_error_at(at, "found the texture kind \"%s\", expected \"float\" or \"spectrum\"", kind);
        return false;
    }
    bool good = read_call(p, &c, "Texture", at, PBRT_TEXTURE);
    if (good) {
        const char *id =
            arena_printf(p->r->arena, "%s texture %s", scalar ? "float" : "spectrum", name);
        struct xml_node *out = pbrt_add(p, p->scene, "texture", NULL, id, at);
        good = out && pbrt_make(p, pbrt_textures, &c, out);
    }
    pbrt_free_params(&c.params);
    return good;
}

static bool do_attribute(struct pbrt *p, struct where at) {
    static const char *const targets[] = {"shape", "light", "material", "medium", "texture"};
    const char *target = pbrt_read_string(p, "shape, light, material, medium or texture in quotes");
    if (!target)
        return false;
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        if (strcmp(targets[i], target) == 0) {
            struct pbrt_given *g = mem_array(1, sizeof *g);
            *g = (struct pbrt_given){(enum pbrt_target)i, {0}, p->state.given, p->all_given};
            p->all_given = p->state.given = g;
            return pbrt_read_params(p, &g->params);
        }
    log_error_at(at, "Attribute \"%s\": expected shape, light, material, medium or texture", target);
    return false;
}

const struct pbrt_directive pbrt_calls[] = {
    {"Shape", do_shape},
    {"Material", do_material},
    {"MakeNamedMaterial", do_named_material},
    {"NamedMaterial", do_use_material},
    {"Texture", do_texture},
    {"Attribute", do_attribute},
    {"MakeNamedMedium", do_medium},
    {"MediumInterface", do_interface},
    {"LightSource", do_light},
    {"AreaLightSource", do_area_light},
    {"Camera", do_camera},
    {"Film", do_film},
    {"PixelFilter", do_filter},
    {"Sampler", do_sampler},
    {"Integrator", do_integrator},
    {"Accelerator", do_ignored},
    {"ColorSpace", do_colour_space},
    {"Option", do_option},
    {0},
};
