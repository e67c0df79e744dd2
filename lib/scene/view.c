// SPDX-License-Identifier: Apache-2.0
// Sensors with their film, filter and sampler, and the integrator.
#include <limits.h>
#include <string.h>

#include "scene/language.h"
#include "scene/reader.h"

// ---- film -----------------------------------------------------------------------------------

struct film_data {
    int width, height, crop_offset_x, crop_offset_y, crop_width, crop_height;
    int pixel_format;
};

// As versions 3 and 0.5/0.6 have them.
static const char *const pixel_formats[] = {"rgb", "luminance", "xyz", "spectrum", "rgba",
                                            "luminance_alpha", "xyza", "spectrum_alpha",
                                            "luminanceAlpha", "spectrumAlpha", NULL};
enum { FIRST_WITH_ALPHA = 4 };

#define FIELD(name) offsetof(struct film_data, name)
#define SIZE .min = 1, .max = 65536, .unit = "pixels"

static const struct param film_params[] = {
    {"width", PARAM_INT, FIELD(width), .def = "768", SIZE, .help = "of the whole picture"},
    {"height", PARAM_INT, FIELD(height), .def = "576", SIZE, .help = "of the whole picture"},
    {"crop_offset_x", PARAM_INT, FIELD(crop_offset_x), .def = "0", .min = 0, .max = 65535,
     .help = "left edge of what is rendered"},
    {"crop_offset_y", PARAM_INT, FIELD(crop_offset_y), .def = "0", .min = 0, .max = 65535,
     .help = "upper edge of what is rendered"},
    {"crop_width", PARAM_INT, FIELD(crop_width), SIZE, .optional = true,
     .help = "width of what is rendered; absent: to the right edge"},
    {"crop_height", PARAM_INT, FIELD(crop_height), SIZE, .optional = true,
     .help = "height of what is rendered; absent: to the lower edge"},
    {"pixel_format", PARAM_CHOICE, FIELD(pixel_format), .def = "rgb", .choices = pixel_formats,
     .help = "with alpha or without; colours are R, G and B in either case"},
    // of the file that Mitsuba would write
    {"file_format", PARAM_IGNORED}, {"component_format", PARAM_IGNORED},
    {"filename", PARAM_IGNORED}, {"gamma", PARAM_IGNORED}, {"banner", PARAM_IGNORED},
    {"high_quality_edges", PARAM_IGNORED}, {"sample_border", PARAM_IGNORED},
    {"compensate", PARAM_IGNORED}, {"attach_log", PARAM_IGNORED}, {"exposure", PARAM_IGNORED},
    {"key", PARAM_IGNORED}, {"burn", PARAM_IGNORED}, {"tonemap_method", PARAM_IGNORED},
    {"has_variance", PARAM_IGNORED}, {"variance", PARAM_IGNORED}, {"digits", PARAM_IGNORED},
    {"variable", PARAM_IGNORED}, {"channel_names", PARAM_IGNORED}, {"label", PARAM_IGNORED},
    PARAM_END,
};

static const char *const film_aliases[] = {"ldrfilm", "tiledhdrfilm", "mfilm", "exrfilm",
                                           "pngfilm", NULL};
static const struct entry film_entry = {"hdrfilm", "size and crop of the picture", film_aliases,
                                        film_params, sizeof(struct film_data)};
static const struct entry *const film_entries[] = {&film_entry, NULL};
const struct registry scene_films = {"film", film_entries};

// The sensor being read: the first one's film and sampler become the scene's.
struct sensor_parts {
    bool first, film, sampler, medium;
};

static bool wrong_child(const struct xml_node *child, const struct xml_node *target,
                        const char *owner) {
    log_error_at(child->at, "a <%s> cannot stand in a %s", target->tag, owner);
    return false;
}

static bool film_child(struct reader *r, struct xml_node *child, struct xml_node *target,
                       struct id_entry *entry, void *ctx) {
    struct object **filter = ctx;
    (void)entry;
    if (strcmp(target->tag, "rfilter") != 0)
        return wrong_child(child, target, "film");
    *filter = object_make(r, r->options->registries.filters, target, NULL, NULL);
    return *filter != NULL;
}

static bool use_film(struct reader *r, const struct film_data *d, struct where at) {
    struct film_settings *f = &r->scene->film;
    const struct scene_options *o = r->options;
    const bool resized = o->width > 0 && o->height > 0 &&
                         (o->width != d->width || o->height != d->height);
    f->width = resized ? o->width : d->width;
    f->height = resized ? o->height : d->height;
    f->alpha = d->pixel_format >= FIRST_WITH_ALPHA;
    if (d->pixel_format != 0 && d->pixel_format != FIRST_WITH_ALPHA)
        log_warn_at(at, "pixel_format %s is written as %s", pixel_formats[d->pixel_format],
                    pixel_formats[f->alpha ? FIRST_WITH_ALPHA : 0]);
    f->crop_x0 = d->crop_offset_x;
    f->crop_y0 = d->crop_offset_y;
    f->crop_x1 = d->crop_width ? f->crop_x0 + d->crop_width : d->width;
    f->crop_y1 = d->crop_height ? f->crop_y0 + d->crop_height : d->height;
    if (f->crop_x1 > d->width || f->crop_y1 > d->height || f->crop_x0 >= f->crop_x1 ||
        f->crop_y0 >= f->crop_y1) {
        log_error_at(at, "the crop %d,%d,%d,%d does not lie in the picture of %dx%d", f->crop_x0,
                     f->crop_y0, f->crop_x1, f->crop_y1, d->width, d->height);
        return false;
    }
    const bool cropped = f->crop_x1 - f->crop_x0 < d->width || f->crop_y1 - f->crop_y0 < d->height;
    if (resized && cropped)
        log_warn_at(at, "the crop is dropped, since the picture gets another size");
    if (resized) {
        f->crop_x0 = f->crop_y0 = 0;
        f->crop_x1 = f->width;
        f->crop_y1 = f->height;
    }
    return true;
}

static bool film_read(struct reader *r, const struct xml_node *node, bool use) {
    const struct entry *e = object_entry(&scene_films, node);
    struct film_data d = {0};
    struct object *filter = NULL;
    if (!e || !object_fill(r, node, e, &d, false, film_child, &filter))
        return false;
    if (!use)
        return true;
    r->scene->filter = filter;
    return use_film(r, &d, node->at);
}

// ---- sampler --------------------------------------------------------------------------------

// Parameters of Mitsuba's samplers and integrators that mean nothing here, unless the entry's own
// table says otherwise.
static void take_ignored(struct reader *r, struct xml_node *node, const struct entry *e) {
    static const char *const names[] = {"seed", "dimension", "scramble", "jitter", "sample_num",
                                        "delta", "samples_per_pass", "block_size", "timeout"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!param_find(e, names[i]) && node_take_value(r, node, names[i]))
            ignore_name(r, names[i], node->at);
}

void sampler_report(const char *asked, const char *taken, struct where at) {
    if (strcmp(asked, taken) != 0)
        log_info("%s:%d: sampler \"%s\" is read as \"%s\"", at.file, at.line, asked, taken);
}

static bool sampler_read(struct reader *r, struct xml_node *node, bool use) {
    const struct registry *samplers = r->options->registries.samplers;
    const char *count = node_take_value(r, node, "sample_count");
    double spp = 0;
    if (count && (value_numbers(count, &spp, 1) != 1 || !(spp >= 1 && spp <= INT_MAX))) {
        log_error_at(node->at, "sample_count is \"%s\", expected 1 to %d", count, INT_MAX);
        return false;
    }
    bool replaced = false;
    if (r->options->sampler) {
        replaced = strcmp(r->options->sampler, xml_get(node, "type")) != 0;
        xml_set(node, "type", r->options->sampler, r->arena);
    }
    const struct entry *e = object_entry(samplers, node);
    if (!e)
        return false;
    take_ignored(r, node, e);
    struct object *o = object_make_as(r, e, node, replaced, NULL, NULL);
    if (!o)
        return false;
    if (use) {
        sampler_report(xml_get(node, "type"), e->name, node->at);
        r->scene->sampler = o;
        r->scene->sample_count = (int)spp;
    }
    return true;
}

// ---- sensor ---------------------------------------------------------------------------------

static bool sensor_medium(struct reader *r, struct xml_node *target, struct id_entry *entry,
                          bool use) {
    const uint32_t medium = medium_read(r, target, entry);
    if (use)
        r->scene->sensor_medium = medium;
    return medium != SCENE_NONE;
}

static bool sensor_child(struct reader *r, struct xml_node *child, struct xml_node *target,
                         struct id_entry *entry, void *ctx) {
    struct sensor_parts *parts = ctx;
    const bool is_film = strcmp(target->tag, "film") == 0;
    const bool is_medium = strcmp(target->tag, "medium") == 0;
    if (!is_film && !is_medium && strcmp(target->tag, "sampler") != 0)
        return wrong_child(child, target, "sensor");
    bool *have = is_film ? &parts->film : is_medium ? &parts->medium : &parts->sampler;
    if (*have) {
        log_error_at(child->at, "a second %s in one sensor", target->tag);
        return false;
    }
    *have = true;
    if (is_medium)
        return sensor_medium(r, target, entry, parts->first);
    return is_film ? film_read(r, target, parts->first) : sampler_read(r, target, parts->first);
}

bool sensor_read(struct reader *r, struct xml_node *node, uint32_t shape) {
    struct sensor_parts parts = {.first = r->sensors.count == 0};
    if (parts.first)
        r->scene->sensor_shape = shape;
    struct object *o =
        object_make(r, r->options->registries.sensors, node, sensor_child, &parts);
    if (!o)
        return false;
    *LIST_ADD(&r->sensors, struct object *) = o;
    return true;
}

// ---- integrator -----------------------------------------------------------------------------

static bool is_wrapper(const struct entry *e) {
    for (const struct param *p = e ? e->params : NULL; p && p->name; p++)
        if (p->type == PARAM_INTEGRATOR)
            return true;
    return false;
}

struct object *integrator_make(struct reader *r, struct xml_node *node) {
    const struct registry *integrators = r->options->registries.integrators;
    const struct entry *e = registry_find(integrators, xml_get(node, "type"));
    bool drop = xml_get(node, "replaced") != NULL;
    if (!e) {
        log_warn_at(node->at, "integrator \"%s\" is not known: \"path\" takes its place, with its "
                    "depth", xml_get(node, "type"));
        e = registry_find(integrators, "path");
        drop = true;
    }
    if (!e) {
        log_error_at(node->at, "there is no integrator \"path\"");
        return NULL;
    }
    if (!object_enter(r, node, NULL))
        return NULL;
    if (!drop)
        take_ignored(r, node, e);
    struct object *o = object_make_as(r, e, node, drop, NULL, NULL);
    object_leave(r, NULL);
    return o;
}

static struct xml_node *find_inner(struct xml_node *node) {
    for (struct xml_node *c = node->first; c; c = c->next)
        if (strcmp(c->tag, "integrator") == 0)
            return c;
    return NULL;
}

// moment measures another integrator; aov may, but by itself it is the quick way to the layers.
static bool needs_inner(const struct entry *e) {
    for (const struct param *p = e ? e->params : NULL; p && p->name; p++)
        if (p->type == PARAM_INTEGRATOR && !p->optional)
            return true;
    return false;
}

// Puts the integrator that the user asks for into the place of the file's: inside the file's
// wrapper, or around its integrator when it needs one inside. NULL after an error message.
static struct xml_node *replace_integrator(struct reader *r, struct xml_node *node) {
    const char *wanted = r->options->integrator;
    const struct registry *integrators = r->options->registries.integrators;
    const struct entry *e = registry_find(integrators, wanted);
    if (!e) {
        const char *nearest = registry_nearest(integrators, wanted);
        log_error("integrator \"%s\" is not known%s%s%s", wanted,
                  nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                  nearest ? "\"?" : "");
        return NULL;
    }
    const struct entry *present = registry_find(integrators, xml_get(node, "type"));
    if (needs_inner(e) && !is_wrapper(present)) {
        struct xml_node *outer = xml_new("integrator", node->at, r->arena);
        // A copy goes inside: the original stays the scene's child, followed by its siblings.
        struct xml_node *inner = arena_alloc(r->arena, sizeof *inner);
        *inner = *node;
        inner->next = NULL;
        xml_set(outer, "type", wanted, r->arena);
        xml_append(outer, inner);
        return outer;
    }
    struct xml_node *place = node;
    while (!is_wrapper(e) && is_wrapper(registry_find(integrators, xml_get(place, "type")))) {
        struct xml_node *inner = find_inner(place);
        if (!inner)
            break;
        place = inner;
    }
    if (registry_find(integrators, xml_get(place, "type")) == e)
        return node;
    xml_set(place, "type", wanted, r->arena);
    xml_set(place, "replaced", "", r->arena);
    return node;
}

bool integrator_read(struct reader *r, struct xml_node *node) {
    if (r->scene->integrator) {
        log_error_at(node->at, "a second integrator; the first stands at %s:%d",
                     r->scene->integrator->at.file, r->scene->integrator->at.line);
        return false;
    }
    if (r->options->integrator)
        node = replace_integrator(r, node);
    r->scene->integrator = node ? integrator_make(r, node) : NULL;
    return r->scene->integrator != NULL;
}

// ---- what the file leaves out ---------------------------------------------------------------

static struct xml_node *default_node(struct reader *r, const char *tag, const char *type) {
    struct xml_node *node = xml_new(tag, (struct where){r->scene->path, 0}, r->arena);
    xml_set(node, "type", type, r->arena);
    return node;
}

bool view_defaults(struct reader *r) {
    struct scene *s = r->scene;
    if (r->sensors.count == 0 && r->options->sensorless &&
        !sensor_read(r, default_node(r, "sensor", "perspective"), SCENE_NONE))
        return false;
    if (r->sensors.count == 0) {
        log_error("%s: the scene has no sensor", s->path);
        return false;
    }
    if (r->sensors.count > 1)
        log_info("%s: the first of %zu sensors is used", s->path, r->sensors.count);
    if (s->film.width == 0 && !film_read(r, default_node(r, "film", "hdrfilm"), true))
        return false;
    if (!s->sampler && !sampler_read(r, default_node(r, "sampler", "sobol"), true))
        return false;
    if (!s->integrator && !integrator_read(r, default_node(r, "integrator", "path")))
        return false;
    if (!s->filter)
        s->filter = object_make(r, r->options->registries.filters,
                                default_node(r, "rfilter", "gaussian"), NULL, NULL);
    return s->filter != NULL;
}
