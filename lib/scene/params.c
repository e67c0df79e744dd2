// SPDX-License-Identifier: Apache-2.0
// One parameter: from its element, or from the default its table gives, to its place in the data.
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "image/image.h"
#include "math/ior.h"
#include "scene/params.h"
#include "texture/texture.h"
#include "volume/volume.h"

static void *place(const struct param *p, void *data) {
    return (char *)data + p->offset;
}

static bool wrong_tag(const struct xml_node *node, const struct param *p, const char *expected) {
    log_error_at(node->at, "\"%s\" is given as <%s>, expected <%s>", p->name, node->tag, expected);
    return false;
}

static bool has_tag(const struct xml_node *node, const char *tag) {
    return strcmp(node->tag, tag) == 0;
}

static bool in_range(const struct xml_node *node, const struct param *p, double v) {
    if ((p->min == 0 && p->max == 0) || (v >= p->min && v <= p->max))
        return true;
    log_error_at(node->at, "\"%s\" is %g%s%s, expected %.7g to %.7g", p->name, v,
                 p->unit && *p->unit ? " " : "", p->unit ? p->unit : "", p->min, p->max);
    return false;
}

static bool read_bool(const struct xml_node *node, const struct param *p, void *out) {
    return has_tag(node, "boolean") ? value_boolean(node, out) : wrong_tag(node, p, "boolean");
}

static bool read_int(const struct xml_node *node, const struct param *p, void *out) {
    long long v;
    if (!has_tag(node, "integer"))
        return wrong_tag(node, p, "integer");
    if (!value_integer(node, &v) || !in_range(node, p, (double)v))
        return false;
    *(int *)out = (int)v;
    if (*(int *)out == v)
        return true;
    log_error_at(node->at, "\"%s\" is %lld, which exceeds the range of numbers", p->name, v);
    return false;
}

static bool read_float(const struct xml_node *node, const struct param *p, void *out) {
    double v;
    if (!has_tag(node, "float") && !has_tag(node, "integer"))
        return wrong_tag(node, p, "float");
    if (!value_number(node, &v) || !in_range(node, p, v))
        return false;
    *(float *)out = (float)v;
    if (isfinite(*(float *)out))
        return true;
    log_error_at(node->at, "\"%s\" is %g, which exceeds the range of numbers", p->name, v);
    return false;
}

static bool read_choice(const struct xml_node *node, const struct param *p, void *out) {
    if (!has_tag(node, "string"))
        return wrong_tag(node, p, "string");
    const char *text = xml_get(node, "value");
    char known[256] = "";
    size_t used = 0;
    for (int i = 0; p->choices[i]; i++) {
        if (strcmp(p->choices[i], text) == 0) {
            *(int *)out = i;
            return true;
        }
        const size_t n = strlen(p->choices[i]);
        if (used + n + 3 < sizeof known) {
            used += (size_t)snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "",
                                     p->choices[i]);
        }
    }
    log_error_at(node->at, "\"%s\" is \"%s\", expected one of %s", p->name, text, known);
    return false;
}

static bool read_string(struct reader *r, const struct xml_node *node, const struct param *p,
                        void *out) {
    if (!has_tag(node, "string"))
        return wrong_tag(node, p, "string");
    const char *text = xml_get(node, "value");
    if (p->type == PARAM_FILE && !arena_find(r->arena, IMAGE_EMBEDDED, text)) {
        text = load_find_file(r, text, node->at);
        if (!text || !load_hash_file(r, text))
            return false;
    }
    *(const char **)out = text;
    return true;
}

static bool read_vector(const struct xml_node *node, const struct param *p, void *out) {
    double v[3];
    if (!has_tag(node, "point") && !has_tag(node, "vector"))
        return wrong_tag(node, p, p->type == PARAM_POINT ? "point" : "vector");
    if (!value_vector(node, 0, v))
        return false;
    const vec3 read = *(vec3 *)out = v3((float)v[0], (float)v[1], (float)v[2]);
    if (!isfinite(length(read))) {
        log_error_at(node->at, "\"%s\" exceeds the range of numbers", p->name);
        return false;
    }
    if (!p->optional || length2(read) > 0) // zero stands for one that is not given
        return true;
    log_error_at(node->at, "\"%s\" is %g %g %g, expected a direction, which has a length", p->name, v[0],
                 v[1], v[2]);
    return false;
}

static bool read_ior(const struct xml_node *node, const struct param *p, void *out) {
    if (!has_tag(node, "string"))
        return read_float(node, p, out);
    const char *name = xml_get(node, "value");
    if (ior_dielectric_find(name, out))
        return true;
    const char *nearest = "", *known;
    int best = 1 << 20;
    for (size_t i = 0; (known = ior_dielectric_name(i)); i++)
        if (edit_distance(name, known) < best) {
            best = edit_distance(name, known);
            nearest = known;
        }
    log_error_at(node->at, "\"%s\" is \"%s\", expected a number or a material such as \"%s\"",
                 p->name, name, nearest);
    return false;
}

static enum param_type colour_use(enum param_type type) {
    switch (type) {
    case PARAM_TEXTURE: return PARAM_REFLECTANCE;
    case PARAM_TEXTURE_EMISSION: return PARAM_EMISSION;
    case PARAM_TEXTURE_SCALAR:
    case PARAM_VOLUME: return PARAM_INDEX;
    default: return type;
    }
}

// A number that has come through single precision: the limits have not.
static bool in_range_single(const struct xml_node *node, const struct param *p, float v) {
    return v == (float)p->min || v == (float)p->max || in_range(node, p, (double)v);
}

static bool read_colour(struct reader *r, const struct xml_node *node, const struct param *p,
                        spectrum *out) {
    if (!spectrum_read(r, node, colour_use(p->type), out))
        return false;
    if (p->type == PARAM_TEXTURE_SCALAR)
        *out = spectrum_grey((*out)[0]);
    const float lo = spectrum_min(*out), hi = spectrum_max(*out);
    if (p->min != 0 || p->max != 0)
        return in_range_single(node, p, lo) && in_range_single(node, p, hi);
    if (lo >= 0 || p->type == PARAM_TEXTURE_SCALAR || p->type == PARAM_INDEX)
        return true;
    log_error_at(node->at, "\"%s\" is %g in one channel, expected no negative values", p->name, (double)lo);
    return false;
}

bool param_is_colour(enum param_type type) {
    return type == PARAM_REFLECTANCE || type == PARAM_EMISSION || type == PARAM_INDEX ||
           type == PARAM_VOLUME || param_is_texture(type);
}

bool param_is_texture(enum param_type type) {
    return type == PARAM_TEXTURE || type == PARAM_TEXTURE_EMISSION || type == PARAM_TEXTURE_SCALAR;
}

static bool read_volume(struct reader *r, const struct xml_node *node, const struct param *p,
                        struct volume_ref *out) {
    out->given = true;
    return read_colour(r, node, p, &out->value);
}

bool param_read_value(struct reader *r, const struct xml_node *node, const struct param *p,
                      void *data) {
    void *out = place(p, data);
    switch (p->type) {
    case PARAM_BOOL: return read_bool(node, p, out);
    case PARAM_INT: return read_int(node, p, out);
    case PARAM_FLOAT: return read_float(node, p, out);
    case PARAM_CHOICE: return read_choice(node, p, out);
    case PARAM_STRING:
    case PARAM_FILE: return read_string(r, node, p, out);
    case PARAM_POINT:
    case PARAM_VECTOR: return read_vector(node, p, out);
    case PARAM_TRANSFORM:
        return has_tag(node, "transform") ? value_transform(node, out)
                                          : wrong_tag(node, p, "transform");
    case PARAM_IOR: return read_ior(node, p, out);
    case PARAM_REFLECTANCE:
    case PARAM_EMISSION:
    case PARAM_INDEX: return read_colour(r, node, p, out);
    case PARAM_TEXTURE:
    case PARAM_TEXTURE_EMISSION:
    case PARAM_TEXTURE_SCALAR: return read_colour(r, node, p, &((struct texture_ref *)out)->value);
    case PARAM_VOLUME: return read_volume(r, node, p, out);
    case PARAM_BSDF: return wrong_tag(node, p, "bsdf");
    case PARAM_PHASE: return wrong_tag(node, p, "phase");
    case PARAM_INTEGRATOR: return wrong_tag(node, p, "integrator");
    case PARAM_IGNORED: ignore_name(r, p->name, node->at); return true;
    }
    return false;
}

static bool read_colour_object(struct reader *r, struct where at, struct xml_node *target,
                               struct id_entry *entry, const struct param *p, void *data) {
    const struct registry *registry = r->options->registries.textures;
    const char *type = xml_get(target, "type");
    const bool is_spectrum = has_tag(target, "spectrum") ||
                             (!registry_find(registry, type) && spectrum_is_type(type));
    if (!is_spectrum && param_is_texture(p->type)) {
        struct texture_ref *out = place(p, data);
        out->texture = object_shared(r, registry, &r->textures, target, entry);
        return out->texture != NULL;
    }
    if (!is_spectrum) {
        log_error_at(at, "\"%s\" is the same everywhere and takes no texture", p->name);
        return false;
    }
    if (!object_enter(r, target, entry))
        return false;
    const bool ok = param_read_value(r, target, p, data);
    object_leave(r, entry);
    return ok;
}

static bool read_volume_object(struct reader *r, struct xml_node *target, struct id_entry *entry,
                               const struct param *p, void *data) {
    struct volume_ref *out = place(p, data);
    out->given = true;
    out->volume = object_shared(r, r->options->registries.volumes, &r->volumes, target, entry);
    return out->volume != NULL;
}

bool param_read_object(struct reader *r, struct where at, struct xml_node *target,
                       struct id_entry *entry, const struct param *p, void *data) {
    if (p->type == PARAM_VOLUME && has_tag(target, "volume"))
        return read_volume_object(r, target, entry, p, data);
    if (p->type == PARAM_PHASE) {
        const struct object *o =
            object_shared(r, r->options->registries.phases, &r->phases, target, entry);
        *(const struct object **)place(p, data) = o;
        return o != NULL;
    }
    if (p->type == PARAM_BSDF) {
        const struct object *o =
            object_shared(r, r->options->registries.bsdfs, &r->bsdfs, target, entry);
        *(const struct object **)place(p, data) = o;
        return o != NULL;
    }
    if (p->type == PARAM_INTEGRATOR) {
        const struct object *o = integrator_make(r, target);
        *(const struct object **)place(p, data) = o;
        return o != NULL;
    }
    return read_colour_object(r, at, target, entry, p, data);
}

bool param_accepts(const struct param *p, const struct xml_node *target) {
    if (has_tag(target, "bsdf"))
        return p->type == PARAM_BSDF;
    if (has_tag(target, "integrator"))
        return p->type == PARAM_INTEGRATOR;
    if (has_tag(target, "volume"))
        return p->type == PARAM_VOLUME;
    if (has_tag(target, "phase"))
        return p->type == PARAM_PHASE;
    return (has_tag(target, "texture") || has_tag(target, "spectrum")) && param_is_colour(p->type);
}

const char *param_tag(const struct param *p, const char *value) {
    const bool word = isalpha((unsigned char)value[0]);
    switch (p->type) {
    case PARAM_BOOL: return "boolean";
    case PARAM_INT: return "integer";
    case PARAM_FLOAT: return "float";
    case PARAM_IOR: return word ? "string" : "float";
    case PARAM_POINT: return "point";
    case PARAM_VECTOR: return "vector";
    case PARAM_TRANSFORM: return "transform"; // the identity: it has no steps
    case PARAM_BSDF: return "bsdf";
    case PARAM_INTEGRATOR: return "integrator";
    case PARAM_PHASE: return "phase";
    case PARAM_CHOICE:
    case PARAM_STRING:
    case PARAM_FILE: return "string";
    default: return word ? "spectrum" : "rgb";
    }
}

bool param_read_default(struct reader *r, const struct xml_node *owner, const struct param *p,
                        void *data) {
    if (p->type == PARAM_IGNORED || (!p->def && p->optional))
        return true;
    if (!p->def) {
        log_error_at(owner->at, "%s \"%s\" lacks the parameter \"%s\" (%s)", owner->tag,
                     xml_get(owner, "type"), p->name, p->help ? p->help : "");
        return false;
    }
    struct xml_node *node = xml_new(param_tag(p, p->def), owner->at, r->arena);
    const bool object = p->type == PARAM_BSDF || p->type == PARAM_INTEGRATOR ||
                        p->type == PARAM_PHASE ||
                        (param_is_colour(p->type) && has_tag(node, "spectrum"));
    xml_set(node, object ? "type" : "value", p->def, r->arena);
    return object ? param_read_object(r, owner->at, node, NULL, p, data)
                  : param_read_value(r, node, p, data);
}
