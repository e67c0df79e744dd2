// SPDX-License-Identifier: Apache-2.0
#include "driver/film_head.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"

enum { VERSION = 1, TEXT_SIZE = 1024 };

static const char *const flags[] = {"alpha", "variance", "moments", "paths"};

static bool *flag_of(struct film_options *o, size_t i) {
    bool *const members[] = {&o->alpha, &o->variance, &o->moments, &o->paths};
    return members[i];
}

// ---- writing ------------------------------------------------------------------------------------

// "path(max_depth=65, rr_depth=5)": the parameters that are numbers, and nested integrators.
static size_t describe(const struct object *o, char *text, size_t size) {
    size_t n = (size_t)snprintf(text, size, "%s(", o->type->name);
    for (const struct param *p = o->type->params; p && p->name; p++) {
        const char *field = (const char *)o->data + p->offset;
        char *out = n < size ? text + n : text;
        const size_t left = n < size ? size - n : 0;
        if (p->type == PARAM_INT || p->type == PARAM_CHOICE)
            n += (size_t)snprintf(out, left, "%s=%d ", p->name, *(const int *)(const void *)field);
        else if (p->type == PARAM_BOOL)
            n += (size_t)snprintf(out, left, "%s=%d ", p->name, *(const bool *)field);
        else if (p->type == PARAM_FLOAT)
            n += (size_t)snprintf(out, left, "%s=%.9g ", p->name,
                                  (double)*(const float *)(const void *)field);
        else if (p->type == PARAM_INTEGRATOR && *(struct object *const *)(const void *)field)
            n += describe(*(struct object *const *)(const void *)field, out, left);
    }
    return n + (size_t)snprintf(n < size ? text + n : text, n < size ? size - n : 0, ")");
}

static void add_made_of(struct json *made_of, const struct job *job) {
    const struct scene *s = job->scene;
    char text[TEXT_SIZE];
    snprintf(text, sizeof text, "%016" PRIx64, s->hash);
    json_add_text(made_of, "scene hash", text);
    snprintf(text, sizeof text, "%016" PRIx64, job->defines_hash);
    json_add_text(made_of, "-D values", text);
    snprintf(text, sizeof text, "%dx%d", s->film.width, s->film.height);
    json_add_text(made_of, "size", text);
    describe(s->integrator, text, sizeof text);
    json_add_text(made_of, "integrator", text);
    describe(s->filter, text, sizeof text);
    json_add_text(made_of, "filter", text);
    // Points that are laid out for a number of samples are others for another number.
    snprintf(text, sizeof text, "%s %u", s->sampler->type->name,
             job->render.tracer.sampler->counted ? job->render.tracer.spp : 0);
    json_add_text(made_of, "sampler", text);
    json_add_count(made_of, "replicates", job->render.tracer.replicates);
    const struct sample_map *map = job->film.map;
    const size_t packets = map ? (size_t)map->width * (size_t)map->height : 0;
    snprintf(text, sizeof text, map ? "%016" PRIx64 : "none",
             map ? file_hash(map->quarters, packets, 0) : 0);
    json_add_text(made_of, "sample map", text);
}

void film_head_set_crop(struct json *head, const struct film *film, const struct film_options *o) {
    struct json *crop = json_add_array(head, "crop");
    const int corners[4] = {o->x0, o->y0, o->x1, o->y1};
    for (int i = 0; i < 4; i++)
        json_append_number(crop, corners[i]);
    json_add_count(head, "values", (int64_t)film_values(film));
}

static void add_film(struct json *film, const struct film_options *o) {
    struct film_options copy = *o;
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        json_add_bool(film, flags[i], *flag_of(&copy, i));
    json_add_count(film, "aovs", o->aovs);
    if (o->clamp > 0)
        json_add_number(film, "clamp", (double)o->clamp);
    struct json *groups = json_add_array(film, "light groups");
    for (uint32_t i = 0; i < o->group_count; i++)
        json_append_text(groups, o->group_names[i]);
}

static void add_map(struct json *head, const struct sample_map *map) {
    struct arena arena = {0};
    json_add_text(head, "map", sample_map_text(map, &arena));
    arena_finish(&arena);
}

struct json *film_head_create(const struct job *job, const struct film *film, const char *command,
                              const char *version) {
    struct json *head = json_new_object();
    json_add_count(head, "version", VERSION);
    add_made_of(json_add_object(head, "made of"), job);
    add_film(json_add_object(head, "film"), &job->film);
    film_head_set_crop(head, film, &job->film);
    json_add_count(head, "width", job->scene->film.width);
    json_add_count(head, "height", job->scene->film.height);
    json_add_text(head, "command", command);
    json_add_text(head, "program", version);
    if (job->film.map)
        add_map(head, job->film.map);
    return head;
}

// ---- reading ------------------------------------------------------------------------------------

// The same text for two values that print the same; NULL: absent.
static bool same(const struct json *a, const struct json *b) {
    if (!a || !b)
        return a == b;
    char *text_a = json_to_text(a), *text_b = json_to_text(b);
    const bool equal = strcmp(text_a, text_b) == 0;
    mem_free(text_a);
    mem_free(text_b);
    return equal;
}

static bool report(const char *what, const struct json *a, const char *path_a, const struct json *b,
                   const char *path_b) {
    char *text_a = a ? json_to_text(a) : NULL, *text_b = b ? json_to_text(b) : NULL;
    log_error("%s: was made with another %s than %s: %s, expected %s", path_b, what, path_a,
              text_b ? text_b : "none", text_a ? text_a : "none");
    mem_free(text_a);
    mem_free(text_b);
    return false;
}

bool film_head_agrees(const struct json *a, const char *path_a, const struct json *b,
                      const char *path_b, bool crop) {
    const struct json *made_a = json_get(a, "made of"), *made_b = json_get(b, "made of");
    const char *const others[] = {"version", "film", "width", "height", crop ? "crop" : NULL};
    for (size_t i = 0; i < json_count(made_a); i++) {
        const char *key = json_key(made_a, i);
        if (!same(json_get(made_a, key), json_get(made_b, key)))
            return report(key, json_get(made_a, key), path_a, json_get(made_b, key), path_b);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others && others[i]; i++)
        if (!same(json_get(a, others[i]), json_get(b, others[i])))
            return report(others[i], json_get(a, others[i]), path_a, json_get(b, others[i]), path_b);
    return true;
}

static bool read_int(const struct json *value, int least, int most, int *out) {
    double number;
    if (!json_read_number(value, &number) || !(number >= least && number <= most))
        return false;
    *out = (int)number;
    return true;
}

static bool read_groups(const struct json *groups, struct film_options *o, struct arena *arena) {
    o->group_count = (uint32_t)json_count(groups);
    const char **names = arena_alloc(arena, (o->group_count + 1) * sizeof *names);
    for (uint32_t i = 0; i < o->group_count; i++)
        if (!(names[i] = json_text(json_at(groups, i))))
            return false;
    o->group_names = names;
    return o->group_count <= FILM_MOST_GROUPS;
}

// The map of adaptive sampling, where there was one.
static bool read_map(const struct json *head, int width, int height, struct film_options *o,
                     struct arena *arena) {
    const char *text = json_text(json_get(head, "map"));
    struct sample_map *map = arena_alloc(arena, sizeof *map);
    o->map = text ? map : NULL;
    return !text || sample_map_parse(map, text, sample_map_packets(width),
                                     sample_map_packets(height), arena);
}

bool film_head_options(const struct json *head, const char *path, struct film_options *o,
                       struct arena *arena) {
    const struct json *crop = json_get(head, "crop"), *film = json_get(head, "film");
    const int most = 65536;
    int version = 0, width = 0, height = 0, aovs = 0;
    *o = (struct film_options){0};
    bool sound = read_int(json_get(head, "version"), VERSION, VERSION, &version) &&
                 read_int(json_get(head, "width"), 1, most, &width) &&
                 read_int(json_get(head, "height"), 1, most, &height) &&
                 read_int(json_at(crop, 0), 0, width - 1, &o->x0) &&
                 read_int(json_at(crop, 1), 0, height - 1, &o->y0) &&
                 read_int(json_at(crop, 2), o->x0 + 1, width, &o->x1) &&
                 read_int(json_at(crop, 3), o->y0 + 1, height, &o->y1) &&
                 read_int(json_get(film, "aovs"), 0, 2 * AOV_INSTANCE - 1, &aovs) &&
                 read_groups(json_get(film, "light groups"), o, arena) &&
                 read_map(head, width, height, o, arena);
    for (size_t i = 0; i < sizeof flags / sizeof *flags && sound; i++)
        sound = json_read_bool(json_get(film, flags[i]), flag_of(o, i));
    double clamp = 0;
    if (sound && json_get(film, "clamp"))
        sound = json_read_number(json_get(film, "clamp"), &clamp) && clamp > 0 && clamp < 1e30;
    o->clamp = (float)clamp;
    o->aovs = (uint32_t)aovs;
    if (!sound)
        log_error("%s: the head does not describe a picture of version %d", path, VERSION);
    return sound;
}

// The place of a crop in the whole picture, for the windows of EXR.
static void place_crop(const struct json *head, struct image *im) {
    const struct json *crop = json_get(head, "crop");
    int width = 0, height = 0, x = 0, y = 0;
    read_int(json_get(head, "width"), 1, INT32_MAX, &width);
    read_int(json_get(head, "height"), 1, INT32_MAX, &height);
    read_int(json_at(crop, 0), 0, INT32_MAX, &x);
    read_int(json_at(crop, 1), 0, INT32_MAX, &y);
    if (width == im->width && height == im->height)
        return;
    im->full_width = width;
    im->full_height = height;
    im->crop_x = x;
    im->crop_y = y;
}

void film_head_label(const struct json *head, const struct film *film, double noise,
                     struct image *im) {
    double clamp = 0;
    place_crop(head, im);
    image_set_text(im, "relume.command", json_text(json_get(head, "command")));
    image_set_text(im, "relume.version", json_text(json_get(head, "program")));
    image_set_text(im, "relume.sceneHash",
                   json_text(json_get(json_get(head, "made of"), "scene hash")));
    image_set_text(im, "relume.colourSpace", "linear Rec.709");
    image_set_number(im, "relume.samples", (double)film_samples(film));
    if (noise >= 0)
        image_set_number(im, "relume.noise", noise);
    const double clamped = film_clamped(film);
    if (clamped >= 0) {
        json_read_number(json_get(json_get(head, "film"), "clamp"), &clamp);
        image_set_number(im, "relume.clamp", clamp);
        image_set_number(im, "relume.clampedShare", clamped);
    }
}
