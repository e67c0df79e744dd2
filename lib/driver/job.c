// SPDX-License-Identifier: Apache-2.0
#include "driver/job.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "driver/light_groups.h"

enum { DEFAULT_SPP = 64 };

struct scene_registries job_registries(void) {
    return (struct scene_registries){&textures, &bsdfs, &lights, &sensors, &samplers, &filters,
                                     &integrators};
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

static bool prepare_integrator(const struct job_options *o, struct scene *s,
                               struct film_options *film) {
    struct integrator_wants wants = {0};
    if (o->max_depth)
        override_int(s->integrator, "max_depth", atoi(o->max_depth));
    const struct integrator_type *type = integrator_type_of(s->integrator);
    if (type->prepare && !type->prepare(s->integrator, &wants))
        return false;
    film->moments = wants.moments;
    film->aovs |= wants.aovs;
    return true;
}

static uint64_t count_triangles(const struct scene *s) {
    uint64_t n = 0;
    for (uint32_t i = 0; i < s->shape_count; i++)
        n += s->shapes[i].mesh.triangle_count;
    return n;
}

static bool run(const struct job_options *o, struct scene *s, struct world *w,
                struct light_groups *groups, struct job_result *r) {
    struct film_options film_options = {.alpha = s->film.alpha, .variance = o->variance,
                                        .paths = o->paths};
    struct filter_sampler filter;
    const struct sensor_type *sensor = sensor_type_of(s->sensors[0]);
    if ((o->aovs && !film_aovs_parse(o->aovs, &film_options.aovs)) ||
        !choose_crop(o, &s->film, &film_options) || !prepare_integrator(o, s, &film_options) ||
        !sensor->prepare(s->sensors[0], s->film.width, s->film.height, s->centre) ||
        !filter_sampler_init(&filter, s->filter))
        return false;
    if (groups) {
        film_options.group_count = groups->count;
        film_options.group_names = groups->names;
        film_options.group_of_light = groups->of_light;
    }
    const struct render_options options = {
        .sampler = (const struct sampler_type *)s->sampler->type,
        .spp = (uint32_t)(o->spp ? o->spp : s->sample_count ? s->sample_count : DEFAULT_SPP),
        .seed = o->seed, .replicates = o->variance ? FILM_REPLICATES : 1, .threads = o->threads,
        .stop = o->stop, .progress = o->progress, .user = o->user};
    struct film *film = film_create(&film_options);
    render(w, s->sensors[0], s->integrator, &filter, film, &options, &r->render);
    r->rejected = film_rejected(film);
    r->noise = film_noise(film);
    bool done = r->render.samples > 0;
    if (done)
        done = film_image(film, &r->image);
    else
        log_error("stopped before every pixel had its first sample: there is no picture to write");
    film_destroy(film);
    filter_sampler_finish(&filter);
    return done;
}

bool job_run(const struct job_options *o, struct job_result *r) {
    *r = (struct job_result){0};
    struct scene_options reading = o->reading;
    reading.registries = job_registries();
    reading.threads = o->threads;
    const double start = time_seconds();
    struct scene *s = scene_read(o->scene, &reading);
    struct world *w = s ? world_create(s, o->threads) : NULL;
    struct light_groups groups = {0};
    bool done = w && (!o->light_groups || light_groups_init(&groups, s));
    r->load_seconds = time_seconds() - start;
    if (done) {
        r->triangles = count_triangles(s);
        r->accel_bytes = accel_bytes(w->accel);
        r->accel_seconds = w->accel_seconds;
        r->scene_hash = s->hash;
        done = run(o, s, w, o->light_groups ? &groups : NULL, r);
    }
    light_groups_finish(&groups);
    world_destroy(w);
    scene_destroy(s);
    return done;
}
