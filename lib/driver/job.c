// SPDX-License-Identifier: Apache-2.0
#include "driver/job.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/thread.h"
#include "driver/cryptomatte.h"
#include "driver/pilot.h"
#include "driver/ranks.h"
#include "phase/phase.h"

enum { DEFAULT_SPP = 64, MOST_SAMPLES = 1 << 30 };

struct scene_registries job_registries(void) {
    return (struct scene_registries){&textures, &bsdfs, &lights, &sensors, &samplers, &filters,
                                     &integrators, &volumes, &phases, &media};
}

struct scene_define *defines_parse(const struct option_list *texts, struct arena *arena) {
    struct scene_define *d = arena_alloc(arena, (texts->count + 1) * sizeof *d);
    for (size_t i = 0; i < texts->count; i++) {
        const char *text = texts->items[i], *equals = strchr(text, '=');
        if (!equals || equals == text) {
            log_error("-D %s: expected NAME=VALUE", text);
            return NULL;
        }
        d[i].name = arena_printf(arena, "%.*s", (int)(equals - text), text);
        d[i].value = equals + 1;
        for (size_t k = 0; k < i; k++)
            if (strcmp(d[k].name, d[i].name) == 0) {
                log_error("-D %s: \"%s\" is given twice, as %s before", text, d[k].name, d[k].value);
                return NULL;
            }
    }
    return d;
}

bool samples_parse(const char *text, uint64_t samples[2]) {
    char rest;
    samples[0] = samples[1] = 0;
    if (!text || (sscanf(text, "%" SCNu64 ":%" SCNu64 "%c", &samples[0], &samples[1], &rest) == 2 &&
                  samples[1] > samples[0] && !strchr(text, '-')))
        return true;
    log_error("--samples %s: expected A:B, the first sample and the one after the last", text);
    return false;
}

static bool choose_crop(const struct job_options *o, const struct film_settings *s,
                        struct film_options *film) {
    const int *c = o->crop;
    const bool given = c[0] || c[1] || c[2] || c[3];
    film->x0 = given ? c[0] : s->crop_x0;
    film->y0 = given ? c[1] : s->crop_y0;
    film->x1 = given ? c[2] : s->crop_x1;
    film->y1 = given ? c[3] : s->crop_y1;
    if (film->x0 >= 0 && film->y0 >= 0 && film->x0 < film->x1 && film->y0 < film->y1 &&
        film->x1 <= s->width && film->y1 <= s->height)
        return true;
    log_error("--crop %d,%d,%d,%d is not inside the picture of %dx%d; expected X0,Y0,X1,Y1 with "
              "X1 and Y1 just past the last pixel", film->x0, film->y0, film->x1, film->y1,
              s->width, s->height);
    return false;
}

// Overrides a number of the integrator (or of the one it wraps) by its parameter table.
static void override_int(struct object *o, const char *name, int value) {
    for (const struct param *p = o->type->params; p && p->name; p++) {
        char *field = (char *)o->data + p->offset;
        if (p->type == PARAM_INT && strcmp(p->name, name) == 0)
            memcpy(field, &value, sizeof value);
        if (p->type == PARAM_INTEGRATOR) {
            struct object *nested;
            memcpy(&nested, field, sizeof nested);
            if (nested)
                override_int(nested, name, value);
        }
    }
}

static bool prepare_integrator(const struct job_options *o, struct scene *s, struct world *w,
                               struct method *method, struct film_options *film) {
    struct integrator_wants wants = {0};
    if (o->max_depth)
        override_int(s->integrator, "max_depth", o->max_depth);
    method_choose(s, w, method);
    const struct integrator_type *type = integrator_type_of(s->integrator);
    if (type->prepare && !type->prepare(s->integrator, &wants))
        return false;
    if (!integrator_enter(s->integrator, w, &s->arena))
        return false;
    world_choose_lights(w, wants.light_choice);
    film->moments = wants.moments;
    film->aovs |= wants.aovs;
    return true;
}

// The nearest legal boundary of a range of samples.
static uint64_t nearest_boundary(uint64_t sample) {
    return (sample + FILM_BLOCK / 2) / FILM_BLOCK * FILM_BLOCK;
}

static bool choose_range(const uint64_t range[2], struct render_options *r, uint64_t *first) {
    *first = range[0];
    if (range[1] == 0)
        return true;
    if (range[0] % FILM_BLOCK == 0 && range[1] % FILM_BLOCK == 0 && range[1] <= MOST_SAMPLES) {
        r->end = range[1];
        return true;
    }
    if (range[1] > MOST_SAMPLES) {
        log_error("--samples %" PRIu64 ":%" PRIu64 " goes beyond the %d samples that a pixel may have",
                  range[0], range[1], MOST_SAMPLES);
        return false;
    }
    const uint64_t a = nearest_boundary(range[0]), b = nearest_boundary(range[1]);
    log_error("--samples %" PRIu64 ":%" PRIu64 " does not lie on multiples of %d; the nearest range "
              "is %" PRIu64 ":%" PRIu64, range[0], range[1], FILM_BLOCK, a,
              b > a ? b : a + FILM_BLOCK);
    return false;
}

static bool set_render_options(struct job *job, const struct job_options *o) {
    const struct scene *s = job->scene;
    const struct sampler_type *sampler = (const struct sampler_type *)s->sampler->type;
    const int spp = o->spp ? o->spp : s->sample_count ? s->sample_count : DEFAULT_SPP;
    const bool open_ended = !o->spp && (o->seconds > 0 || o->noise > 0) && !sampler->counted;
    if (sampler->counted && !o->spp && (o->seconds > 0 || o->noise > 0))
        log_warn("sampler %s lays out %d points, the scene's number of samples, and ends there; "
                 "--spp asks for more, and --sampler sobol can always go on",
                 s->sampler->type->name, spp);
    job->render = (struct render_options){
        .tracer = {.world = job->world, .sensor = s->sensors[0], .integrator = s->integrator,
                   .filter = &job->filter, .sampler = sampler, .spp = (uint32_t)spp,
                   .seed = o->seed, .replicates = job->film.variance ? FILM_REPLICATES : 1,
                   .threads = o->threads, .stop = o->stop},
        .end = open_ended ? MOST_SAMPLES : (uint64_t)spp, .seconds = o->seconds, .noise = o->noise,
        .progress = o->progress, .user = o->user};
    job->film.seed = o->seed;
    return choose_range(o->samples, &job->render, &job->film.first);
}

// The first sensor, and the filter of its pixels.
static bool prepare_sensor(struct job *job) {
    struct scene *s = job->scene;
    const struct object *sensor = s->sensors[0];
    const struct sensor_type *type = sensor_type_of(sensor);
    const struct sensor_scene scene = {
        .width = s->film.width, .height = s->film.height,
        .centre = {s->centre[0], s->centre[1], s->centre[2]}, .arena = &s->arena,
        .shape = s->sensor_shape == SCENE_NONE ? NULL : &s->shapes[s->sensor_shape]};
    if (type->place && !integrator_meters(s->integrator)) {
        log_error_at(sensor->at, "integrator \"%s\" cannot serve sensor \"%s\"; path and volpath can",
                     s->integrator->type->name, sensor->type->name);
        return false;
    }
    if (!type->prepare(s->sensors[0], &scene))
        return false;
    if (type->own_area)
        job->filter = filter_sampler_box;
    return type->own_area || filter_sampler_init(&job->filter, s->filter);
}

// Where the sensor's path of two random numbers begins.
static void start_path(const void *scene, struct vec2 u, struct ray *ray) {
    const struct scene *s = scene;
    const struct sensor_type *sensor = sensor_type_of(s->sensors[0]);
    const float x = u.x * (float)s->film.width, y = u.y * (float)s->film.height;
    struct sensor_place place;
    if (!sensor->place) {
        sensor->ray(s->sensors[0]->data, x, y, (struct vec2){0.5f, 0.5f}, ray);
        return;
    }
    sensor->place(s->sensors[0]->data, x, y, &place);
    *ray = (struct ray){place.p + place.n, -place.n, 0, INFINITY};
}

static bool prepare(struct job *job, const struct job_options *o) {
    struct scene *s = job->scene;
    job->film = (struct film_options){.alpha = s->film.alpha, .paths = o->paths,
                                      .clamp = (float)o->clamp,
                                      .variance = o->variance || o->noise > 0};
    if ((o->aovs && !film_aovs_parse(o->aovs, &job->film.aovs)) ||
        (o->cryptomatte && !cryptomatte_parse(o->cryptomatte, &job->cryptomatte)) ||
        !choose_crop(o, &s->film, &job->film) ||
        !prepare_integrator(o, s, job->world, &job->method, &job->film) ||
        !prepare_sensor(job) ||
        (o->light_groups &&
         (!light_groups_init(&job->groups, s) || !light_groups_check(&job->groups, s))))
        return false;
    world_learn_blockers(job->world, start_path, s);
    job->film.group_count = job->groups.count;
    job->film.group_names = job->groups.names;
    job->film.group_of_light = job->groups.of_light;
    for (size_t i = 0; i < o->reading.define_count; i++) {
        const struct scene_define *d = &o->reading.defines[i];
        job->defines_hash = file_hash(d->name, strlen(d->name) + 1, job->defines_hash);
        job->defines_hash = file_hash(d->value, strlen(d->value) + 1, job->defines_hash);
    }
    for (const char *c = o->receiver.texels ? o->receiver.texels : o->receiver.vertices; c && *c; c++)
        job->defines_hash = file_hash(c, 1, job->defines_hash + (o->receiver.texels != NULL));
    if (o->light)
        job->defines_hash = file_hash(o->light, strlen(o->light) + 1, ~job->defines_hash);
    return set_render_options(job, o);
}

// The time of the pilot counts.
static bool use_pilot(struct job *job) {
    const double least = 1e-3, start = time_seconds();
    if (!pilot_run(job, &job->scene->arena, &job->map))
        return false;
    if (job->render.seconds > 0)
        job->render.seconds = fmax(job->render.seconds - (time_seconds() - start), least);
    job->film.map = job->render.tracer.map = &job->map;
    return true;
}

bool job_open(struct job *job, const struct job_options *o) {
    *job = (struct job){0};
    struct scene_options reading = o->reading;
    reading.registries = job_registries();
    reading.threads = o->threads;
    const double start = time_seconds();
    job->scene = scene_read(o->scene, &reading);
    if (job->scene && o->may_leak)
        job->scene->may_leak = true;
    if (job->scene && o->light && !light_groups_keep(job->scene, o->light)) {
        job_close(job);
        return false;
    }
    if (job->scene && o->edit_scene)
        o->edit_scene(job->scene, o->edit_user);
    if (job->scene && receiver_place(&o->receiver, &reading, job->scene))
        job->world = world_create(job->scene, o->threads);
    if (!job->world || !prepare(job, o)) {
        job_close(job);
        return false;
    }
    job->load_seconds = time_seconds() - start;
    if (o->adaptive && !use_pilot(job)) {
        job_close(job);
        return false;
    }
    for (uint32_t i = 0; i < job->scene->shape_count; i++)
        job->triangles += job->scene->shapes[i].mesh.triangle_count;
    return true;
}

void job_close(struct job *job) {
    filter_sampler_finish(&job->filter);
    light_groups_finish(&job->groups);
    world_destroy(job->world);
    scene_destroy(job->scene);
    *job = (struct job){0};
}

struct film *job_film(const struct job *job) {
    return film_create(&job->film);
}

void job_trace(struct job *job, struct film *film, struct render_result *result) {
    ranks_render(film, &job->render, result);
}

struct film *job_render(struct job *job, struct render_result *result) {
    struct film *film = job_film(job);
    job_trace(job, film, result);
    return film;
}

bool job_image_head(const struct job *job, const struct film *film,
                    const struct render_result *result, struct image *im) {
    if (film_samples(film) == 0) {
        log_error("stopped before every pixel had its first sample: there is no picture to write");
        return false;
    }
    if (!film_image_head(film, im))
        return false;
    image_set_number(im, "relume.seed", job->render.tracer.seed);
    image_set_number(im, "relume.seconds", result->seconds);
    return true;
}

bool job_image(const struct job *job, const struct film *film, const struct render_result *result,
               struct image *im) {
    if (!job_image_head(job, film, result, im))
        return false;
    film_image_pixels(film, im);
    return cryptomatte_add(job, job->cryptomatte, film_samples(film), im);
}
