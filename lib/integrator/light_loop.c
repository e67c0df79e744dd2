// SPDX-License-Identifier: Apache-2.0
#include "integrator/light_loop_data.h"

#include <string.h>

#include "base/mem.h"

// What a triangle's shares may be off by, where nothing else is asked for: what is off, times how far,
// is the same for large and small ones. 4e-4 of a triangle of 400 even ones, 1e-2 of one of 4000.
static double default_tolerance(double solid_angle) {
    const double t = 2.2e-6 / (solid_angle * sqrt(solid_angle));
    return t < 1e-4 ? 1e-4 : t > 1e-2 ? 1e-2 : t;
}

enum { MOST_SURFACES = 64 }; // straight through, before the rest counts as opaque

// ---- scene --------------------------------------------------------------------------------------

static void fill_rows(struct light_rows *r, const struct overlap_triangle *t, vec3 centre,
                      double tolerance) {
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < OVERLAP_NODES; i++)
            r->row[i][k] = (float)t->node[i][k];
        r->row[LIGHT_CENTRE][k] = centre[k];
    }
    r->row[LIGHT_CENTRE][3] = (float)tolerance;
    for (int k = 0; k < 4; k++)
        r->row[LIGHT_PARTS][k] = (float)t->part[k];
}

static void init_triangles(struct light_loop_scene *s) {
    const struct light_triangles *sky = s->options.lights;
    const double asked = s->options.tolerance;
    s->triangles = mem_array(sky->count, sizeof *s->triangles);
    s->rows = mem_array(sky->count, sizeof *s->rows);
    s->centres = mem_array(sky->count, sizeof *s->centres);
    for (uint32_t i = 0; i < sky->count; i++) {
        const struct light_triangle *l = &sky->items[i];
        double corner[OVERLAP_CORNERS][3];
        for (int k = 0; k < OVERLAP_CORNERS; k++) {
            corner[k][0] = l->corner[k].x;
            corner[k][1] = l->corner[k].y;
            corner[k][2] = l->corner[k].z;
        }
        overlap_triangle_make(&s->triangles[i], corner);
        s->centres[i] = direction_round(l->centre);
        fill_rows(&s->rows[i], &s->triangles[i], s->centres[i],
                  asked > 0 ? asked : default_tolerance(l->solid_angle));
    }
}

static void init_positions(struct light_loop_scene *s) {
    const struct light_loop_options *o = &s->options;
    uint32_t n = 0;
    s->seen = mem_array(o->lights->count, sizeof *s->seen);
    s->first = mem_array((size_t)o->positions + 1, sizeof *s->first);
    for (uint32_t p = 0; p < o->positions; p++) {
        for (uint32_t i = 0; i < o->lights->count; i++)
            if (light_loop_position(&o->lights->items[i], o->positions) == p)
                s->seen[n++] = i;
        s->first[p + 1] = n;
    }
}

static void init_others(struct light_loop_scene *s) {
    const struct world *w = s->options.world;
    s->others = mem_array(w->light_count, sizeof *s->others);
    for (uint32_t i = 0; i < w->light_count; i++) {
        const struct light_type *type = w->lights[i].type;
        if ((!type->infinite || type->delta) && type->power(w->lights[i].data) > 0)
            s->others[s->other_count++] =
                (struct world_light){.type = type, .data = w->lights[i].data};
    }
    if (s->other_count > 0)
        light_choice_init(&s->choice, LIGHT_CHOICE_AUTO, s->others, s->other_count);
}

static uint32_t coefficients_of(const struct form *f, const struct form_term *t) {
    uint32_t n = 1;
    for (int s = SLOT_A; s < SLOTS; s++)
        if (t->slots[s].gamma.kind != GAMMA_NONE)
            n *= f->curve[t->slots[s].curve].f[0].table->basis.count;
    return n;
}

struct light_loop_scene *light_loop_scene_create(const struct light_loop_options *options) {
    struct light_loop_scene *s = mem_array(1, sizeof *s);
    s->options = *options;
    init_triangles(s);
    init_positions(s);
    if (!options->refines)
        init_others(s);
    s->coefficients = mem_array(options->object_count, sizeof *s->coefficients);
    for (uint32_t i = 0; i < options->object_count; i++) {
        const struct form *f = options->objects[i].form;
        for (uint32_t t = 0; t < f->terms; t++)
            s->coefficients[i] += coefficients_of(f, &f->term[t]);
    }
    return s;
}

void light_loop_scene_destroy(struct light_loop_scene *s) {
    if (!s)
        return;
    if (s->other_count > 0)
        light_choice_finish(&s->choice);
    mem_free(s->others);
    mem_free(s->triangles);
    mem_free(s->rows);
    mem_free(s->centres);
    mem_free(s->seen);
    mem_free(s->first);
    mem_free(s->coefficients);
    mem_free(s);
}

bool light_loop_has_noise(const struct light_loop_scene *s) {
    return s->other_count > 0;
}

void light_loop_set_packets(struct light_loop_scene *s, enum light_packets packets) {
    s->options.packets = packets;
}

uint32_t light_loop_coefficients(const struct light_loop_scene *s, uint32_t object) {
    return s->coefficients[object];
}

// ---- worker -------------------------------------------------------------------------------------

static void init_overlaps(struct light_loop *l, uint32_t object) {
    const struct light_loop_options *o = &l->scene->options;
    const struct form *f = o->objects[object].form;
    l->overlaps[object] = arena_alloc(&l->arena, f->terms * sizeof **l->overlaps);
    l->quotients[object] = arena_alloc(&l->arena, f->terms * sizeof **l->quotients);
    for (uint32_t t = 0; t < f->terms; t++) {
        const struct gamma *gamma[OVERLAP_AXES] = {NULL};
        const struct basis *basis[OVERLAP_AXES] = {NULL};
        uint32_t axes = 0;
        for (int s = SLOT_A; s < SLOTS; s++) {
            const struct form_slot *slot = &f->term[t].slots[s];
            if (slot->gamma.kind == GAMMA_NONE)
                continue;
            gamma[axes] = &slot->gamma;
            basis[axes++] = &f->curve[slot->curve].f[0].table->basis;
        }
        wide_quotient_init(&l->quotients[object][t], &f->term[t].quotient, &l->arena);
        wide_overlap_init(&l->overlaps[object][t], gamma, basis, axes, &l->arena);
    }
}

struct light_loop *light_loop_create(const struct light_loop_scene *s) {
    struct light_loop *l = mem_array(1, sizeof *l);
    l->scene = s;
    for (uint32_t p = 0; p < s->options.positions; p++)
        if (s->first[p + 1] - s->first[p] > l->most)
            l->most = s->first[p + 1] - s->first[p];
    l->overlaps = arena_alloc(&l->arena, (s->options.object_count + 1) * sizeof *l->overlaps);
    l->quotients = arena_alloc(&l->arena, (s->options.object_count + 1) * sizeof *l->quotients);
    for (uint32_t i = 0; i < s->options.object_count; i++)
        init_overlaps(l, i);
    return l;
}

void light_loop_destroy(struct light_loop *l) {
    if (!l)
        return;
    mem_free(l->visits);
    mem_free(l->arrivals);
    arena_finish(&l->arena);
    mem_free(l);
}

// ---- what the camera sees -----------------------------------------------------------------------

static uint32_t find_object(const struct light_loop *l, const struct closure *inner) {
    const struct light_loop_options *o = &l->scene->options;
    const void *owner = editable_owner(inner);
    for (uint32_t i = 0; i < o->object_count; i++)
        if (o->objects[i].owner == owner)
            return i;
    return SCENE_NONE;
}

const struct closure *visit_resolve(const struct visit *v, struct closure_stack *stack,
                                    const struct closure **outer, vec3 rows[3]) {
    const struct surface *s = &v->surface;
    const struct closure *inner = NULL;
    vec3 image[3]; // of the frame's axes
    stack->used = 0;
    *outer = bsdf_resolve(s->bsdf, &s->point, to_local(&s->point.frame, v->wo), stack);
    for (int i = 0; i < 3 && *outer; i++) {
        float factor = 1;
        image[i] = v3(i == 0, i == 1, i == 2);
        inner = editable_inside(*outer, &image[i], &factor);
    }
    for (int i = 0; i < 3 && inner; i++)
        rows[i] = image[0][i] * s->point.frame.s + image[1][i] * s->point.frame.t +
                  image[2][i] * s->point.frame.n;
    return inner;
}

static void add_visit(struct light_loop *l, const struct visit *seen) {
    const struct closure *outer;
    vec3 rows[3];
    struct visit v = *seen;
    const struct closure *inner = visit_resolve(&v, &l->stack, &outer, rows);
    v.object = inner ? find_object(l, inner) : SCENE_NONE;
    if (v.object == SCENE_NONE)
        return;
    const struct direction wo = editable_wo(inner);
    v.theta_o = atan2(hypot(wo.x, wo.y), wo.z);
    v.pole = rows[2];
    mem_grow(&l->visits, &l->visit_capacity, l->visit_count + 1, sizeof *l->visits);
    l->visits[l->visit_count++] = v;
}

// Follows a ray through whatever lets it pass straight.
static void follow(struct light_loop *l, struct visit v, struct ray ray, const struct accel_hit *first) {
    const struct world *w = l->scene->options.world;
    struct accel_hit hit = *first;
    v.wo = -ray.d;
    for (int i = 0; i < MOST_SURFACES && hit.shape != SCENE_NONE; i++) {
        if (w->hides)
            world_see(w, &ray, &hit);
        if (hit.shape == SCENE_NONE)
            return;
        world_surface(w, &ray, &hit, &v.surface);
        add_visit(l, &v);
        const struct surface *s = &v.surface;
        v.weight *= bsdf_null_transmittance(s->bsdf, &s->point, to_local(&s->point.frame, v.wo));
        if (spectrum_is_black(v.weight))
            return;
        ray.o = surface_offset(s, ray.d);
        ray.tmin = 0;
        if (!accel_intersect(w->accel, &ray, &hit))
            return;
    }
}

void light_loop_see(struct light_loop *l, int x, int y) {
    const struct light_loop_options *o = &l->scene->options;
    const struct sensor_type *sensor = sensor_type_of(o->sensor);
    l->x = x;
    l->y = y;
    l->visit_count = 0;
    for (uint32_t p = 0; p < o->positions; p++) {
        struct ray rays[ACCEL_PACKET];
        struct accel_hit hits[ACCEL_PACKET];
        float weights[ACCEL_PACKET];
        for (int i = 0; i < ACCEL_PACKET; i++) {
            const int px = x + i % LIGHT_LOOP_SIDE, py = y + i / LIGHT_LOOP_SIDE;
            struct sampler s = sampler_start(o->sampler, (uint32_t)px, (uint32_t)py, p, o->positions,
                                             1, o->seed);
            const struct vec2 d = filter_sample(o->filter, sampler_2d(&s), &weights[i]);
            sensor->ray(o->sensor->data, (float)px + 0.5f + d.x, (float)py + 0.5f + d.y,
                        sampler_2d(&s), &rays[i]);
            hits[i].shape = SCENE_NONE;
        }
        accel_intersect16(o->world->accel, rays, 0xffff, true, hits);
        for (uint32_t i = 0; i < ACCEL_PACKET; i++)
            follow(l, (struct visit){.weight = spectrum_grey(weights[i]), .pixel = i, .position = p},
                   rays[i], &hits[i]);
    }
}

bool light_loop_shows(const struct light_loop *l, uint32_t pixel, uint32_t object) {
    for (size_t i = 0; i < l->visit_count; i++)
        if (l->visits[i].pixel == pixel && l->visits[i].object == object)
            return true;
    return false;
}

float light_loop_view(const struct light_loop *l, uint32_t pixel, uint32_t object) {
    double sum = 0, weight = 0;
    for (size_t i = 0; i < l->visit_count; i++) {
        const struct visit *v = &l->visits[i];
        const double w = v->pixel == pixel && v->object == object
                             ? fabs((double)spectrum_mean(v->weight)) : 0;
        sum += w * v->theta_o;
        weight += w;
    }
    return weight > 0 ? (float)(sum / weight) : 0;
}
