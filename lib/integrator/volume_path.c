// SPDX-License-Identifier: Apache-2.0
// Veach and Guibas 1995 (MIS of next event and directions), in media as medium/tracking.h says. The
// two techniques are weighted by their densities of direction alone: transmittance is the same
// random factor for both.
#include "integrator/volume_path.h"

#include "medium/tracking.h"
#include "phase/phase.h"

// Of random numbers: the camera's, then so many for each event, as in path.c.
enum {
    CAMERA_DIMENSIONS = 4,
    CAMERA_LANE = 3,
    EVENT_DIMENSIONS = 8,
    DRAW_LIGHT_POINT = 0,
    DRAW_DIRECTION = 2,
    DRAW_LIGHT = 4,
    DRAW_LOBE = 5,
    DRAW_ROULETTE = 6,
    DRAW_DISTANCE = 7,
};

// A walk in a medium that neither absorbs nor lets go is cut here, and counted: dense media (optical
// depth 1e4) take 1e8 steps for a few of their paths.
enum { MOST_SCATTERINGS = 1 << 27 };

struct walker {
    const struct volume_path *p;
    struct trace_context *ctx;
    int index; // of the sink's lane
    struct ray ray;
    uint32_t medium; // around ray.o, or SCENE_NONE
    struct flight flight; // beta and what else tracking changes
    struct rng rng;  // behind each event's own numbers
    float eta2;      // product of the squared relative indices crossed: refraction's radiance scaling
    struct path_origin from;
    struct sampler sampler;
    uint32_t events, surfaces;
    bool alive, first_done;
    float passed;    // length of the way from the sensor to ray.o, while nothing has scattered
};

static struct sampler *draw(struct walker *w, uint32_t purpose) {
    w->sampler.dimension = CAMERA_DIMENSIONS + EVENT_DIMENSIONS * w->events + purpose;
    return &w->sampler;
}

static bool may_scatter(const struct walker *w, uint32_t depth) {
    return w->p->max_depth < 0 || depth < (uint32_t)w->p->max_depth;
}

static const struct medium *medium_of(const struct walker *w, uint32_t index) {
    return index == SCENE_NONE ? NULL : &w->ctx->world->media[index];
}

// What a contribution is weighted by.
static spectrum throughput(const struct walker *w) {
    return w->flight.beta / flight_ratio(w->flight.ratio);
}

// The medium behind a boundary that is left along d.
static uint32_t across(const struct world *world, const struct surface *s, vec3 d,
                       uint32_t medium) {
    const bool shape = world->boundaries && s->shape != SCENE_NONE;
    const struct world_boundary *b = shape ? &world->boundaries[s->shape] : NULL;
    if (!b || !b->parts)
        return medium;
    return dot(d, s->ng) > 0 ? b->exterior : b->interior;
}

// Share of light that comes along a shadow ray, through media and straight through surfaces.
static spectrum transmittance(struct walker *w, struct ray ray, uint32_t medium) {
    enum { MOST_SURFACES = 256 };
    const struct world *world = w->ctx->world;
    spectrum through = spectrum_grey(1);
    w->ctx->shadow_rays++;
    for (int i = 0; i < MOST_SURFACES; i++) {
        struct accel_hit hit;
        struct surface s;
        ray = ray_ordinary(ray); // as in world_transmittance
        const bool found = accel_intersect(world->accel, &ray, &hit);
        if (found) {
            world_surface(world, &ray, &hit, &s);
            through *= bsdf_null_transmittance(s.bsdf, &s.point,
                                               to_local(&s.point.frame, -normalize(ray.d)));
        }
        const struct medium *m = medium_of(w, medium);
        if (m && !spectrum_is_black(through))
            through *= medium_transmittance(m, ray.o, ray.d, found ? hit.t : ray.tmax, &w->rng);
        if (!found || spectrum_is_black(through))
            return through;
        const vec3 end = ray.o + ray.tmax * ray.d;
        ray.o = surface_offset(&s, ray.d);
        medium = across(world, &s, ray.d, medium);
        if (ray.tmax < INFINITY) {
            ray.d = end - ray.o;
            ray.tmax = 1;
        }
    }
    return spectrum_grey(0);
}

// Hands out what a light sample brings: f, the density of its direction by the vertex, its ray.
static void add_light(struct walker *w, const struct light_sample *l, uint32_t light, spectrum f,
                      float pdf_vertex, uint32_t lobe, const struct ray *ray, uint32_t medium) {
    if (spectrum_is_black(f) || (!l->late && spectrum_is_black(l->emission)))
        return;
    const spectrum through = transmittance(w, *ray, medium);
    if (spectrum_is_black(through))
        return;
    const spectrum emission =
        l->late ? light_late_emission(&w->ctx->world->lights[light], l->wi) : l->emission;
    const float share = l->delta ? 1 : mis_weight(l->pdf_sa, pdf_vertex);
    sink_add(w->ctx->sink, w->index,
             &(struct contribution){throughput(w) * f * through * (share / l->pdf_sa), emission,
                                    light, w->from.depth + 1, w->from.depth ? w->from.lobe : lobe, true,
                                    l->wi});
}

static bool sample_light(struct walker *w, const struct light_place *place, uint32_t *light,
                         struct light_sample *l) {
    const struct world *world = w->ctx->world;
    const float choice = world->choice.draws ? sampler_1d(draw(w, DRAW_LIGHT)) : 0;
    return world_sample_light(world, place, choice, sampler_2d(draw(w, DRAW_LIGHT_POINT)), light, l);
}

// At a boundary of media, and inside, walks are long and no step is lost to a cap below 1.
static void survive_roulette(struct walker *w, bool in_media) {
    if (w->from.depth < (uint32_t)w->p->rr_depth)
        return;
    const float q = roulette_chance(throughput(w), w->eta2, in_media ? 1 : 0.95f);
    if (q < 1 && !(sampler_1d(draw(w, DRAW_ROULETTE)) < q))
        w->alive = false;
    else
        w->flight.beta /= q;
}

// First event of the path that is not straight through: coverage.
static void first_event(struct walker *w, const struct surface *s, const struct closure *closure) {
    w->first_done = true;
    w->ctx->sink->type->covered(w->ctx->sink, w->index);
    if (!s || !w->ctx->sink->wants_surface)
        return;
    struct surface seen = *s;
    seen.t += w->passed;
    vertex_add_first(w->ctx, w->index, &seen, closure);
}

// ---- in a medium --------------------------------------------------------------------------------

static void sample_light_from_medium(struct walker *w, const struct medium *m, vec3 p, vec3 wo) {
    const struct light_place place = {.p = p};
    struct light_sample l;
    uint32_t light;
    if (!sample_light(w, &place, &light, &l))
        return;
    const float f = phase_pdf_sa(m->phase, p, wo, l.wi);
    const struct ray ray = world_ray_to_light(p, &l);
    add_light(w, &l, light, spectrum_grey(f), f, LOBE_DIFFUSE, &ray, w->medium);
}

static void scatter_in_medium(struct walker *w, const struct medium *m, vec3 p) {
    const vec3 wo = -w->ray.d;
    if (!w->first_done)
        first_event(w, NULL, NULL);
    w->alive = may_scatter(w, w->from.depth + 1);
    if (!w->alive)
        return;
    if (m->sample_emitters)
        sample_light_from_medium(w, m, p, wo);
    float pdf_sa;
    const float part = sampler_1d(draw(w, DRAW_LOBE));
    const vec3 wi = phase_sample(m->phase, p, wo, part, sampler_2d(draw(w, DRAW_DIRECTION)), &pdf_sa);
    const uint32_t first_lobe = w->from.depth == 0 ? LOBE_DIFFUSE : w->from.lobe;
    w->from = (struct path_origin){.p = p, .pdf_sa = pdf_sa, .delta = !m->sample_emitters,
                                   .depth = w->from.depth + 1, .lobe = first_lobe};
    w->ray = (struct ray){p, wi, 0, INFINITY};
    survive_roulette(w, true);
}

// Emission gained along the way; its source follows those of the lights.
static void add_glow(struct walker *w) {
    if (spectrum_is_black(w->flight.emitted) || (w->from.depth == 0 && w->p->hide_emitters))
        return;
    sink_add(w->ctx->sink, w->index,
             &(struct contribution){w->flight.emitted, spectrum_grey(1),
                                    w->ctx->world->light_count + w->medium, w->from.depth,
                                    w->from.lobe, false, w->ray.d});
}

// A point that rounding can put onto the other side of a surface at that distance counts as having
// reached it.
static float slack(const struct walker *w, float distance) {
    return 0x1p-21f * (largest(w->ray.o) + (distance < INFINITY ? distance : 0));
}

// Flies to the next surface, if a scattering event does not come first: then it is handled. t: the
// free path in a plain medium.
static bool fly(struct walker *w, const struct medium *m, float distance, float t) {
    const vec3 o = w->ray.o;
    const float end = maxf(distance - slack(w, distance), 0);
    bool scatters = t < end;
    if (!m->plain)
        scatters = medium_fly(m, o, w->ray.d, end, sampler_1d(draw(w, DRAW_DISTANCE)), &w->flight, &t);
    else if (scatters)
        medium_scatter(m, &w->flight);
    if (m->emits)
        add_glow(w);
    w->alive = !spectrum_is_black(w->flight.beta);
    if (!scatters || !w->alive)
        return false;
    scatter_in_medium(w, m, o + t * w->ray.d);
    return true;
}

// ---- at a surface -------------------------------------------------------------------------------

// Whether shading and geometric normal agree on which side d (local wl) is.
static bool same_side(const struct surface *s, vec3 d, vec3 wl) {
    return dot(d, s->ng) * cos_theta(wl) > 0;
}

static void sample_light_from_surface(struct walker *w, const struct surface *s, vec3 side,
                                      const struct closure *closure) {
    const struct light_place place = {s->p, side};
    struct light_sample l;
    uint32_t light;
    float pdf;
    if (!sample_light(w, &place, &light, &l) || !world_links(w->ctx->world, light, s->shape))
        return;
    const vec3 wi = to_local(&s->point.frame, l.wi);
    if (w->p->strict_normals && !same_side(s, l.wi, wi))
        return;
    const spectrum f = closure_eval(closure, wi, &pdf);
    const struct ray ray = world_shadow_ray(s, &l);
    add_light(w, &l, light, f, pdf, closure->lobes, &ray,
              across(w->ctx->world, s, l.wi, w->medium));
}

static void leave_surface(struct walker *w, const struct surface *s, vec3 wi) {
    w->medium = across(w->ctx->world, s, wi, w->medium);
    w->ray = (struct ray){surface_offset(s, wi), wi, 0, INFINITY};
    w->alive = !spectrum_is_black(w->flight.beta);
}

static void scatter_at_surface(struct walker *w, const struct surface *s, vec3 side,
                               const struct bsdf_sample *b) {
    const vec3 wi = to_world(&s->point.frame, b->wi);
    if (w->p->strict_normals && !same_side(s, wi, b->wi))
        return;
    w->flight.beta *= b->weight;
    w->eta2 *= b->eta * b->eta;
    const uint32_t first_lobe = w->from.depth == 0 ? b->lobe : w->from.lobe;
    w->from = (struct path_origin){s->p, b->pdf_sa, (b->lobe & LOBE_DELTA) != 0, w->from.depth + 1,
                                   first_lobe, side, s->shape + 1};
    leave_surface(w, s, wi);
    const struct world_boundary *boundaries = s->shape == SCENE_NONE ? NULL : w->ctx->world->boundaries;
    if (w->alive)
        survive_roulette(w, boundaries && boundaries[s->shape].parts);
}

static void shade_surface(struct walker *w, const struct surface *s) {
    struct bsdf_sample b = {.lobe = 0};
    if (w->from.depth > 0 || !w->p->hide_emitters)
        vertex_add_emission(w->ctx, w->index, s, w->ray.d, throughput(w), &w->from);
    const vec3 wo = to_local(&s->point.frame, -w->ray.d);
    const struct closure *closure = response_resolve(w->ctx, w->index, w->from.depth, s, wo);
    const bool goes_on = closure && may_scatter(w, w->from.depth) &&
                         (!w->p->strict_normals || same_side(s, -w->ray.d, wo));
    const vec3 side = goes_on ? vertex_light_side(s, closure, wo) : v3(0, 0, 0);
    if (goes_on && closure->lobes & LOBE_SMOOTH && may_scatter(w, w->from.depth + 1))
        sample_light_from_surface(w, s, side, closure);
    bool sampled = false;
    if (goes_on) {
        const float lobe = sampler_1d(draw(w, DRAW_LOBE));
        sampled = closure_sample(closure, lobe, sampler_2d(draw(w, DRAW_DIRECTION)), &b);
    }
    if (!w->first_done && !(b.lobe & LOBE_NULL))
        first_event(w, s, closure);
    w->alive = false;
    if (sampled && b.lobe & LOBE_NULL) {
        w->flight.beta *= b.weight;
        w->passed += s->t;
        leave_surface(w, s, w->ray.d);
    } else if (sampled && may_scatter(w, w->from.depth + 1)) {
        scatter_at_surface(w, s, side, &b);
    }
    w->surfaces++;
}

static void shade(struct walker *w, const struct accel_hit *hit) {
    struct surface s;
    world_surface(w->ctx->world, &w->ray, hit, &s);
    shade_surface(w, &s);
}

// ---- paths --------------------------------------------------------------------------------------

static void begin_event(struct walker *w) {
    w->rng.state = hash_u64(((uint64_t)w->sampler.seed << 32 | w->sampler.index) ^
                            hash_u64(w->events));
}

static void step(struct walker *w) {
    const struct medium *m = medium_of(w, w->medium);
    struct accel_hit hit;
    const float clip = w->ray.tmax; // of the sensor
    float t = INFINITY;
    w->ctx->rays++;
    begin_event(w);
    if (m && m->plain) {
        t = medium_free_path(m, sampler_1d(draw(w, DRAW_DISTANCE)), &w->rng);
        w->ray.tmax = minf(clip, t + 2 * slack(w, t));
    }
    accel_intersect(w->ctx->world->accel, &w->ray, &hit);
    if (w->ctx->world->hides && w->from.depth == 0)
        world_see(w->ctx->world, &w->ray, &hit);
    const bool found = hit.shape != SCENE_NONE;
    if (m && fly(w, m, found ? hit.t : clip, t))
        return;
    if (!w->alive)
        return;
    if (found) {
        shade(w, &hit);
        return;
    }
    w->alive = false;
    if (w->from.depth > 0 || !w->p->hide_emitters)
        vertex_add_infinite(w->ctx, w->index, w->ray.d, throughput(w), &w->from);
}

static void start(struct walker *w, const struct path_start *from) {
    w->ray = from->ray;
    w->medium = w->ctx->world->scene->sensor_medium;
    w->sampler = from->sampler;
    w->flight = (struct flight){.beta = spectrum_grey(1), .ratio = spectrum_grey(1), .lane = -1,
                                .rng = &w->rng};
    if (w->p->spectral) {
        w->sampler.dimension = CAMERA_LANE;
        w->flight.lane = (int)(sampler_1d(&w->sampler) * SPECTRUM_LANES);
    }
    w->passed = 0;
    if (w->medium != SCENE_NONE) { // it begins at the near plane (as Mitsuba has it)
        w->passed = w->ray.tmin;
        w->ray.o += w->ray.tmin * w->ray.d;
        w->ray.tmax -= w->ray.tmin;
        w->ray.tmin = 0;
    }
    w->eta2 = 1;
    w->from = (struct path_origin){.p = from->ray.o, .delta = true};
    w->events = w->surfaces = 0;
    w->alive = may_scatter(w, 0);
    w->first_done = false;
    w->ctx->paths++;
}

bool volume_path_prepare(struct object *self, struct integrator_wants *wants) {
    const struct volume_path *p = self->data;
    wants->light_choice = (enum light_choice_mode)p->light_choice;
    return true;
}

void volume_path_trace(const void *data, struct trace_context *ctx,
                       const struct path_start starts[SINK_LANES]) {
    for (int i = 0; i < SINK_LANES; i++) {
        struct walker w = {.p = data, .ctx = ctx, .index = i};
        start(&w, &starts[i]);
        if (w.alive && starts[i].surface) {
            begin_event(&w);
            shade_surface(&w, starts[i].surface);
            w.events++;
        }
        for (; w.alive; w.events++) {
            step(&w);
            if (w.alive && (w.surfaces >= INTEGRATOR_MOST_EVENTS || w.events >= MOST_SCATTERINGS)) {
                w.alive = false;
                ctx->truncated++;
            }
        }
    }
}
