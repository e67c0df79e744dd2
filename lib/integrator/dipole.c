// SPDX-License-Identifier: Apache-2.0
// Path tracing with subsurface scattering by a diffusion dipole (math/dipole.h) in place of a walk
// through the medium: an approximation, to be measured against volpath.
//
// A surface is subsurface where a homogeneous medium that scatters lies inside it and its material
// refracts. What the material would refract into the medium is taken out of it at another point of
// the same shape, which rays along the normal and the tangents find, at distances by the profile
// (King, Kulla, Conty, Fajardo 2013, BSSRDF Importance Sampling), and which gathers what falls on it:
//     S(x_o, w_o, x_i, w_i) = F_t(w_o) R_d(|x_o - x_i|) F_t(w_i) / (pi T),
// F_t(w_o) by the material itself, F_t(w_i) by Fresnel's formula of a smooth boundary. T is the share
// of diffuse light that passes the boundary: R_d counts what leaves, and with T that is what is seen
// (Jensen et al. 2001 leave it out; normalized = false).
//
// What is neglected: single scattering is part of the profile, as light that enters is taken to be
// diffuse from the first event (another term would create energy where nothing is absorbed); light
// is as in a half space, whatever the shape, and passes through gaps of it. The media's own emission,
// media outside, and light or eyes within media are not seen. One event stands for all that happens
// below the surface, also in max_depth. tests/README.md has the errors as measured: jensen is the
// nearer one, as d'Eon's leaves out what scatters once.
#include "integrator/vertex.h"
#include "math/dipole.h"
#include "math/fresnel.h"
#include "math/warp.h"
#include "phase/phase.h"

struct dipole_path {
    int max_depth, rr_depth;
    bool hide_emitters, normalized;
    int light_choice, model;
};

static const char *const models[] = {"jensen", "better", NULL};

static const struct param params[] = {
    {"model", PARAM_CHOICE, offsetof(struct dipole_path, model), .def = "jensen", .unit = "",
     .help = "jensen: of Jensen et al. 2001; better: of d'Eon 2012", .choices = models},
    {"normalized", PARAM_BOOL, offsetof(struct dipole_path, normalized), .def = "true",
     .unit = "", .help = "what leaves the medium is what is seen; false: literally Jensen's"},
    {"max_depth", PARAM_INT, offsetof(struct dipole_path, max_depth), .def = "-1", .min = -1,
     .max = 1e6, .unit = "",
     .help = "most edges of a path: 1 sees emitters, 2 adds direct light; -1: no limit"},
    {"rr_depth", PARAM_INT, offsetof(struct dipole_path, rr_depth), .def = "3", .min = 1, .max = 1e6,
     .unit = "", .help = "edges after which Russian roulette may end a path"},
    {"hide_emitters", PARAM_BOOL, offsetof(struct dipole_path, hide_emitters), .def = "false",
     .unit = "", .help = "do not show lights that are seen directly"},
    INTEGRATOR_LIGHT_CHOICE(struct dipole_path, light_choice),
    INTEGRATOR_IGNORED,
    PARAM_END,
};

// Of random numbers: the camera's, then so many for each event, as in path.c.
enum {
    CAMERA_DIMENSIONS = 4,
    EVENT_DIMENSIONS = 11,
    DRAW_LIGHT_POINT = 0,
    DRAW_DIRECTION = 2,
    DRAW_LIGHT = 4,
    DRAW_LOBE = 5,
    DRAW_ROULETTE = 6,
    DRAW_PROBE = 7, // distance and angle
    DRAW_AXIS = 9,
    DRAW_FOUND = 10,
};

struct walker {
    const struct dipole_path *p;
    struct trace_context *ctx;
    int index; // of the sink's lane
    struct ray ray;
    spectrum beta;
    float eta2; // product of the squared relative indices crossed: refraction's radiance scaling
    struct path_origin from;
    struct sampler sampler;
    uint32_t events;
    bool alive, first_done;
};

static struct sampler *draw(struct walker *w, uint32_t purpose) {
    w->sampler.dimension = CAMERA_DIMENSIONS + EVENT_DIMENSIONS * w->events + purpose;
    return &w->sampler;
}

static bool may_scatter(const struct walker *w, uint32_t depth) {
    return w->p->max_depth < 0 || depth < (uint32_t)w->p->max_depth;
}

static void survive_roulette(struct walker *w) {
    if (w->from.depth < (uint32_t)w->p->rr_depth)
        return;
    const float q = roulette_chance(w->beta, w->eta2, 0.95f);
    if (sampler_1d(draw(w, DRAW_ROULETTE)) < q)
        w->beta /= q;
    else
        w->alive = false;
}

// Next event estimation. inside: light from below the surface counts as well.
static void sample_light(struct walker *w, const struct surface *s, const struct closure *closure,
                         vec3 side, bool inside) {
    struct shadow_test test;
    const float choice = w->ctx->world->choice.draws ? sampler_1d(draw(w, DRAW_LIGHT)) : 0;
    const struct vec2 point = sampler_2d(draw(w, DRAW_LIGHT_POINT));
    vertex_sample_light(w->ctx, s, closure, side, choice, point, 1, &test);
    if (!test.pending || (!inside && dot(test.contribution.wi, s->ng) < 0))
        return;
    test.contribution.weight *= w->beta;
    test.contribution.depth = w->from.depth + 1;
    test.contribution.lobe = w->from.depth ? w->from.lobe : closure->lobes;
    vertex_finish_light(w->ctx, w->index, &test);
}

// Leaves a vertex along a sampled direction.
static void scatter(struct walker *w, const struct surface *s, vec3 side,
                    const struct bsdf_sample *b) {
    const vec3 wi = to_world(&s->point.frame, b->wi);
    const uint32_t first_lobe = w->from.depth == 0 ? b->lobe : w->from.lobe;
    w->beta *= b->weight;
    w->eta2 *= b->eta * b->eta;
    w->from = (struct path_origin){s->p, b->pdf_sa, (b->lobe & LOBE_DELTA) != 0, w->from.depth + 1,
                                   first_lobe, side, s->shape + 1};
    w->ray = (struct ray){surface_offset(s, wi), wi, 0, INFINITY};
    w->alive = !spectrum_is_black(w->beta);
    if (w->alive)
        survive_roulette(w);
}

// ---- where light enters -------------------------------------------------------------------------

// What falls on a subsurface point and passes its boundary, diffusely: cos F_t / pi.
struct entry_closure {
    struct closure head;
    float eta; // of the inside over the outside
};

static float entry_transmittance(const struct entry_closure *c, vec3 wi) {
    float cos_t;
    return 1 - fresnel_dielectric(cos_theta(wi), c->eta, &cos_t);
}

static spectrum entry_eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    *pdf_sa = maxf(cos_theta(wi), 0) * INV_PI;
    return *pdf_sa > 0 ? spectrum_grey(*pdf_sa * entry_transmittance((const void *)closure, wi))
                       : spectrum_grey(0);
}

static bool entry_sample(const struct closure *closure, float u1, struct vec2 u2,
                         struct bsdf_sample *s) {
    (void)u1;
    const vec3 wi = warp_cosine_hemisphere(u2);
    const spectrum weight = spectrum_grey(entry_transmittance((const void *)closure, wi));
    *s = (struct bsdf_sample){wi, weight, cos_theta(wi) * INV_PI, 1,
                              LOBE_DIFFUSE | LOBE_REFLECTION};
    return s->pdf_sa > 0;
}

static const struct bsdf_type entry_type = {.eval = entry_eval, .sample = entry_sample};

static void enter(struct walker *w, const struct surface *s, float eta) {
    const struct entry_closure closure = {{&entry_type, LOBE_DIFFUSE | LOBE_REFLECTION}, eta};
    const vec3 side = s->point.frame.n;
    struct bsdf_sample b;
    sample_light(w, s, &closure.head, side, true);
    w->alive = entry_sample(&closure.head, 0, sampler_2d(draw(w, DRAW_DIRECTION)), &b);
    if (w->alive)
        scatter(w, s, side, &b);
}

// ---- from exit to entry -------------------------------------------------------------------------

// Axes of the probe rays, with the probability of each: half along the normal.
struct probe {
    const struct dipole *profile;
    const struct surface *from;
    vec3 axis[3];
    float share[3];
};

// Density per area of the points found, over all axes.
static float probe_pdf_area(const struct probe *p, vec3 to, vec3 ng) {
    float pdf = 0;
    for (int i = 0; i < 3; i++) {
        const float slant = fabsf(dot(p->axis[i], ng));
        if (slant > 0)
            pdf += p->share[i] * slant * dipole_pdf_area(p->profile, length(cross(to, p->axis[i])));
    }
    return pdf;
}

// The ray along an axis past a point beside the exit, as long as the profile reaches.
static struct ray probe_ray(const struct walker *w, const struct probe *p, struct vec2 u, float pick) {
    const struct world *world = w->ctx->world;
    int i = 0;
    while (i < 2 && pick >= p->share[i])
        pick -= p->share[i++];
    const vec3 along = p->axis[i], s = p->axis[(i + 1) % 3], t = p->axis[(i + 2) % 3];
    const float r = dipole_sample(p->profile, minf(pick / p->share[i], 0x1.fffffep-1f), u.x);
    float sine, cosine;
    sincos_turn(u.y, &sine, &cosine);
    const vec3 middle = p->from->p + (r * cosine) * s + (r * sine) * t;
    const float half = minf(dipole_reach(p->profile),
                            length(p->from->p - world->centre) + world->radius);
    return (struct ray){middle - half * along, along, 0, r < 2 * world->radius ? 2 * half : -1};
}

// A point of entry on the exit's shape, with R_d over its density. All that the ray meets are
// candidates; one is taken by its share of them (weighted reservoir). false: there is none.
static bool probe_find(struct walker *w, const struct probe *p, struct ray ray,
                       struct surface *entry, spectrum *weight) {
    enum { MOST_SURFACES = 256 };
    const struct surface *from = p->from;
    float u = sampler_1d(draw(w, DRAW_FOUND)), sum = 0, taken = 0;
    for (int i = 0; i < MOST_SURFACES && ray.tmax > 0; i++) {
        struct accel_hit hit;
        struct surface s;
        w->ctx->rays++;
        if (!accel_intersect(w->ctx->world->accel, &ray, &hit))
            break;
        world_surface(w->ctx->world, &ray, &hit, &s);
        ray.tmax -= hit.t;
        ray.o = surface_offset(&s, ray.d);
        const float pdf = probe_pdf_area(p, s.p - from->p, s.ng);
        if (s.shape != from->shape || s.instance != from->instance || !(pdf > 0))
            continue;
        const spectrum found = dipole_Rd(p->profile, length(s.p - from->p)) / pdf;
        const float share = spectrum_max(found);
        if (!(share > 0))
            continue;
        sum += share;
        const float keep = share / sum; // probability that this one is the one
        if (u < keep) {
            *entry = s;
            *weight = found;
            taken = share;
            u /= keep;
        } else {
            u = (u - keep) / (1 - keep);
        }
    }
    *weight *= taken > 0 ? sum / taken : 0;
    return taken > 0;
}

// Light that refracts out of the medium at s, b its sample: it went in somewhere around.
static void subsurface(struct walker *w, const struct surface *s, const struct medium *m,
                       const struct bsdf_sample *b) {
    const struct medium_point *c = &m->constant;
    const float g = phase_type_of(m->phase)->mean_cosine(m->phase->data, s->p);
    const struct dipole profile = dipole_make(c->sigma_s * (1 - g), c->sigma_t - c->sigma_s, b->eta,
                                              (enum dipole_model)w->p->model);
    if (dipole_is_black(&profile))
        return;
    const struct frame f = frame_from_normal(s->ng);
    const struct probe probe = {&profile, s, {f.n, f.s, f.t}, {0.5f, 0.25f, 0.25f}};
    const struct vec2 place = sampler_2d(draw(w, DRAW_PROBE));
    const struct ray ray = probe_ray(w, &probe, place, sampler_1d(draw(w, DRAW_AXIS)));
    struct surface entry;
    spectrum weight = spectrum_grey(0);
    if (!probe_find(w, &probe, ray, &entry, &weight))
        return;
    const float T = w->p->normalized ? dipole_diffuse_transmittance(b->eta) : 1;
    w->beta *= b->weight * (b->eta * b->eta / T) * weight; // without refraction's radiance scaling
    if (w->from.depth == 0)
        w->from.lobe = b->lobe;
    w->events++;
    enter(w, &entry, b->eta);
}

// ---- paths --------------------------------------------------------------------------------------

// The medium that a ray along d would refract into, if the dipole stands for it.
static const struct medium *medium_below(const struct world *w, const struct surface *s, vec3 d) {
    const struct world_boundary *b = w->boundaries ? &w->boundaries[s->shape] : NULL;
    if (!b || !b->parts || b->interior == SCENE_NONE || dot(d, s->ng) > 0)
        return NULL;
    const struct medium *m = &w->media[b->interior];
    return m->homogeneous && m->scatters ? m : NULL;
}

static void first_event(struct walker *w, const struct surface *s, const struct closure *closure) {
    w->first_done = true;
    w->ctx->sink->type->covered(w->ctx->sink, w->index);
    if (w->ctx->sink->wants_surface)
        vertex_add_first(w->ctx, w->index, s, closure);
}

// Where a direction was sampled at a surface.
static void go_on(struct walker *w, const struct surface *s, vec3 side, const struct medium *below,
                  const struct bsdf_sample *b) {
    if (b->lobe & LOBE_NULL) {
        w->beta *= b->weight;
        w->ray = (struct ray){surface_offset(s, w->ray.d), w->ray.d, 0, INFINITY};
        w->alive = !spectrum_is_black(w->beta);
    } else if (may_scatter(w, w->from.depth + 1)) {
        if (below && b->lobe & LOBE_TRANSMISSION)
            subsurface(w, s, below, b);
        else
            scatter(w, s, side, b);
    }
}

static void shade(struct walker *w, const struct accel_hit *hit) {
    struct surface s;
    struct bsdf_sample b = {.lobe = 0};
    world_surface(w->ctx->world, &w->ray, hit, &s);
    if (w->from.depth > 0 || !w->p->hide_emitters)
        vertex_add_emission(w->ctx, w->index, &s, w->ray.d, w->beta, &w->from);
    const vec3 wo = to_local(&s.point.frame, -w->ray.d);
    const struct closure *closure = response_resolve(w->ctx, w->index, w->from.depth, &s, wo);
    const bool goes_on = closure && may_scatter(w, w->from.depth);
    const struct medium *below = medium_below(w->ctx->world, &s, w->ray.d);
    const vec3 side = goes_on ? vertex_light_side(&s, closure, wo) : v3(0, 0, 0);
    if (goes_on && closure->lobes & LOBE_SMOOTH && may_scatter(w, w->from.depth + 1))
        sample_light(w, &s, closure, side, !below);
    bool sampled = false;
    if (goes_on) {
        const float lobe = sampler_1d(draw(w, DRAW_LOBE));
        sampled = closure_sample(closure, lobe, sampler_2d(draw(w, DRAW_DIRECTION)), &b);
    }
    if (!w->first_done && !(b.lobe & LOBE_NULL))
        first_event(w, &s, closure);
    w->alive = false;
    if (sampled)
        go_on(w, &s, side, below, &b);
}

static void step(struct walker *w) {
    struct accel_hit hit;
    w->ctx->rays++;
    accel_intersect(w->ctx->world->accel, &w->ray, &hit);
    if (w->ctx->world->hides && w->from.depth == 0)
        world_see(w->ctx->world, &w->ray, &hit);
    if (hit.shape != SCENE_NONE) {
        shade(w, &hit);
        return;
    }
    w->alive = false;
    if (w->from.depth > 0 || !w->p->hide_emitters)
        vertex_add_infinite(w->ctx, w->index, w->ray.d, w->beta, &w->from);
}

static void trace(const void *data, struct trace_context *ctx,
                  const struct path_start starts[SINK_LANES]) {
    for (int i = 0; i < SINK_LANES; i++) {
        struct walker w = {.p = data, .ctx = ctx, .index = i, .ray = starts[i].ray,
                           .beta = spectrum_grey(1), .eta2 = 1,
                           .from = {.p = starts[i].ray.o, .delta = true},
                           .sampler = starts[i].sampler};
        ctx->paths++;
        w.alive = may_scatter(&w, 0);
        for (; w.alive; w.events++) {
            step(&w);
            if (w.alive && w.events >= INTEGRATOR_MOST_EVENTS) {
                w.alive = false;
                ctx->truncated++;
            }
        }
    }
}

static bool prepare(struct object *self, struct integrator_wants *wants) {
    wants->light_choice = (enum light_choice_mode)((const struct dipole_path *)self->data)->light_choice;
    return true;
}

const struct integrator_type integrator_dipole = {
    .entry = {.name = "dipole",
              .help = "path tracing with subsurface scattering by diffusion (Jensen et al. 2001)",
              .params = params, .size = sizeof(struct dipole_path)},
    .prepare = prepare, .trace = trace, .sees_media = true,
};
