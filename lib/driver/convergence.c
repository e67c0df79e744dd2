// SPDX-License-Identifier: Apache-2.0
#include "driver/convergence.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "driver/convergence_probe.h"
#include "math/warp.h"

enum { SIDE = 16, LIGHT_SAMPLES = CONVERGENCE_LIGHT_SAMPLES };
_Static_assert(2 * SIDE * SIDE == CONVERGENCE_MOST_POINTS, "seen, and seen from there");

static const double SHARE = 0.05;

// A sequence that fills the square evenly (Roberts 2018, R2).
static struct vec2 draw(struct probe *b) {
    const double i = (double)b->drawn++;
    return (struct vec2){(float)fmod(0.5 + i * 0.7548776662466927, 1),
                         (float)fmod(0.5 + i * 0.5698402909980532, 1)};
}

static bool is_glass(uint32_t lobes) {
    return !(lobes & (LOBE_SMOOTH | LOBE_NULL)) && lobes & LOBE_TRANSMISSION;
}

static bool is_passed(uint32_t lobes) {
    return is_glass(lobes) || lobes & LOBE_NULL;
}

// The first surface along a ray that scatters, straight through glass and off mirrors.
static bool find_point(const struct world *w, struct ray ray, struct probe_point *point) {
    for (int i = 0; i < CONVERGENCE_MOST_EVENTS; i++) {
        struct accel_hit hit;
        struct surface s;
        if (!accel_intersect(w->accel, &ray, &hit))
            return false;
        world_surface(w, &ray, &hit, &s);
        const uint32_t lobes = bsdf_lobes(s.bsdf);
        const vec3 n = dot(ray.d, s.ng) > 0 ? -s.ng : s.ng;
        if (lobes & LOBE_SMOOTH) {
            *point = (struct probe_point){s.p, s.p_error, n};
            return true;
        }
        if (!is_passed(lobes))
            ray.d -= 2 * dot(ray.d, n) * n;
        ray = (struct ray){surface_offset(&s, ray.d), ray.d, 0, INFINITY};
    }
    return false;
}

static void look(struct probe *b, const struct job *job) {
    const struct object *sensor = job->render.tracer.sensor;
    const struct sensor_type *type = sensor_type_of(sensor);
    const struct film_options *f = &job->film;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const float x = (float)f->x0 + ((float)(i % SIDE) + 0.5f) / SIDE * (float)(f->x1 - f->x0);
        const float y = (float)f->y0 + ((float)(i / SIDE) + 0.5f) / SIDE * (float)(f->y1 - f->y0);
        struct sensor_place place;
        struct ray ray;
        if (type->place) {
            type->place(sensor->data, x, y, &place);
            b->points[b->count++] = (struct probe_point){place.p, place.p_error, place.n};
            continue;
        }
        type->ray(sensor->data, x, y, draw(b), &ray);
        b->count += find_point(b->world, ray, &b->points[b->count]);
    }
}

static void bounce(struct probe *b) {
    for (uint32_t i = 0, n = b->count; i < n; i++) {
        const struct probe_point *from = &b->points[i];
        const struct frame frame = frame_from_normal(from->n);
        const vec3 d = to_world(&frame, warp_cosine_hemisphere(draw(b)));
        const struct ray ray = {offset_point(from->p, from->p_error, from->n, d), d, 0, INFINITY};
        b->count += find_point(b->world, ray, &b->points[b->count]);
    }
}

bool probe_reaches(const struct world *w, struct ray ray, uint32_t light, int *glass) {
    *glass = 0;
    for (int i = 0; i < CONVERGENCE_MOST_EVENTS; i++) {
        struct accel_hit hit;
        struct surface s;
        ray = ray_ordinary(ray);
        if (!accel_intersect(w->accel, &ray, &hit))
            return true;
        world_surface(w, &ray, &hit, &s);
        const uint32_t lobes = bsdf_lobes(s.bsdf);
        if (s.light == light)
            return true;
        if (!is_passed(lobes))
            return false;
        *glass += is_glass(lobes);
        const vec3 end = ray.o + ray.tmax * ray.d;
        ray.o = surface_offset(&s, ray.d);
        if (ray.tmax < INFINITY) {
            ray.d = end - ray.o;
            ray.tmax = 1;
        }
    }
    return false;
}

bool probe_sample_light(const struct probe *b, vec3 p, uint32_t light, struct vec2 u,
                        struct light_sample *s, double *energy) {
    const struct world_light *l = &b->world->lights[light];
    if (!(l->type->aim ? l->type->aim(l->data, u, s) : l->type->sample(l->data, p, u, s)))
        return false;
    const spectrum emission = l->type->aim ? light_late_emission(l, s->wi) : s->emission;
    *energy = (double)(spectrum_luminance(emission) / s->pdf_sa);
    return *energy > 0;
}

bool probe_add_hard(struct hard_light *h, const struct light_sample *s, double cosine,
                    double energy) {
    static const double HARD = 1.0 / 200;
    const double chance = s->delta ? 0 : cosine * (double)INV_PI / (double)s->pdf_sa;
    if (chance >= HARD)
        return false;
    h->energy += energy;
    h->chance += chance;
    h->samples++;
    return true;
}

static void add_sample(struct probe *b, const struct probe_point *at, uint32_t light,
                       struct tally *t) {
    struct light_sample s;
    double energy;
    int glass;
    if (!probe_sample_light(b, at->p, light, draw(b), &s, &energy))
        return;
    const double cosine = (double)dot(at->n, s.wi);
    const vec3 o = offset_point(at->p, at->p_error, at->n, s.wi);
    if (!(cosine > 0) || !probe_reaches(b->world, world_ray_to_light(o, &s), light, &glass))
        return;
    energy *= cosine;
    if (glass == 0)
        t->open += energy;
    else if (!probe_add_hard(&t->through, &s, cosine, energy))
        t->easy += energy;
}

static void tell(const struct job *job, uint32_t light, const char *by, double share, double chance,
                 struct json *out) {
    const struct scene_light *l = &job->scene->lights[light];
    const bool mirrored = strcmp(by, "reflection") == 0;
    const char *way = mirrored ? "by smooth reflection" : "through smooth glass";
    const char *remedy = mirrored ? "rougher surfaces" : "thindielectric or rough glass";
    struct json *j = json_append_object(out);
    json_add_text(j, "light", l->name);
    json_add_text(j, "by", by);
    json_add_number(j, "share", share);
    json_add_number(j, "chance", chance);
    if (share == 0)
        log_warn_at(l->object->at, "path tracing will not find the light of \"%s\": none of it reaches "
                    "what the camera sees but by mirrors or smooth glass", l->name);
    else if (chance == 0)
        log_warn_at(l->object->at, "path tracing will not find the light of \"%s\" that comes %s, "
                    "%.0f %% of all light on what the camera sees: it is a point to every ray; an area "
                    "light or %s can be found", l->name, way, 100 * share, remedy);
    else
        log_warn_at(l->object->at, "path tracing will converge slowly: %.0f %% of all light on what "
                    "the camera sees comes from \"%s\" %s, and is found by one path in %.0f; a larger "
                    "light or %s would help", 100 * share, l->name, way, 1 / chance, remedy);
}

static void tell_hard(const struct job *job, uint32_t light, const char *by,
                      const struct hard_light *h, double all, struct json *out) {
    if (h->energy > SHARE * all)
        tell(job, light, by, h->energy / all, h->chance / h->samples, out);
}

static uint32_t specular_lobes(const struct scene *s) {
    uint32_t lobes = 0;
    for (uint32_t i = 0; i < s->shape_count; i++)
        lobes |= bsdf_lobes(s->shapes[i].bsdf);
    return lobes & LOBE_SPECULAR;
}

uint32_t probe_light(const struct probe *b, uint32_t k) {
    return (uint32_t)((uint64_t)k * b->world->light_count / b->lights);
}

static double sum_of(const struct tally *t) {
    return t->open + t->easy + t->through.energy + t->mirrored.energy;
}

static double count_light(struct probe *b, struct tally *tallies) {
    double all = 0;
    for (uint32_t k = 0; k < b->lights; k++)
        for (uint32_t i = 0; i < b->count * LIGHT_SAMPLES; i++)
            add_sample(b, &b->points[i / LIGHT_SAMPLES], probe_light(b, k), &tallies[k]);
    probe_mirrors(b, tallies);
    for (uint32_t k = 0; k < b->lights; k++)
        all += sum_of(&tallies[k]);
    return all;
}

void convergence_add(const struct job *job, struct json *out) {
    enum { MOST_LIGHTS = 64 };
    const struct world *w = job->world;
    struct json *list = json_add_array(out, "will_not_converge");
    if (!specular_lobes(job->scene))
        return;
    struct probe *b = mem_array(1, sizeof *b);
    struct tally tallies[MOST_LIGHTS] = {{0}};
    b->world = w;
    b->lights = w->light_count < MOST_LIGHTS ? w->light_count : MOST_LIGHTS;
    look(b, job);
    bounce(b);
    const double all = count_light(b, tallies);
    for (uint32_t k = 0; k < b->lights; k++) {
        const struct tally *t = &tallies[k];
        const uint32_t light = probe_light(b, k);
        tell_hard(job, light, "glass", &t->through, all, list);
        tell_hard(job, light, "reflection", &t->mirrored, all, list);
        if (w->lights[light].type->delta && sum_of(t) == 0)
            tell(job, light, "nothing", 0, 0, list);
    }
    mem_free(b);
}
