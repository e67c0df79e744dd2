// SPDX-License-Identifier: Apache-2.0
#include "world/world.h"

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "phase/phase.h"
#include "world/texture_check.h"
#include "world/unseen.h"

// Measured with tests/bench/packets: bounces of 16 lanes as a packet against single rays.
enum { MOST_FOR_PACKETS = 2000 };

static void init_shapes(struct world *w, const struct scene *s) {
    uint64_t primitives = 0;
    w->shapes = mem_array(s->shape_count, sizeof *w->shapes);
    for (uint32_t i = 0; i < s->shape_count; i++) {
        const struct shape *from = &s->shapes[i];
        const struct mesh *m = &from->mesh;
        w->shapes[i] = (struct world_shape){
            .indices = (const void *)m->indices, .positions = (const void *)m->positions,
            .normals = mesh_is_flat(m) ? NULL : (const void *)m->normals, .uvs = (const void *)m->uvs, .mesh = m,
            .bsdf = from->bsdf, .light = from->light, .kind = (uint8_t)from->kind,
            .flip_normals = from->flip_normals, .hidden = from->hidden};
        w->hides |= from->hidden;
        const uint32_t count = from->kind == SHAPE_MESH ? m->triangle_count : 1;
        const uint32_t lobes = count ? bsdf_lobes(from->bsdf) : 0;
        w->shapes[i].smooth = (lobes & LOBE_SMOOTH) != 0;
        w->shapes[i].glossy = (lobes & LOBE_GLOSSY) != 0;
        w->shadow_rays_may_pass |= (lobes & LOBE_NULL) != 0;
        w->tangents_matter |= (lobes & LOBE_ANISOTROPIC) != 0;
        primitives += count;
    }
    for (uint32_t i = 0; i < s->instance_count; i++)
        w->hides |= s->instances[i].hidden;
    w->packets_pay = primitives <= MOST_FOR_PACKETS && s->instance_count == 0;
}

static bool prepare_textures(struct scene *s) {
    for (uint32_t i = 0; i < s->texture_count; i++) {
        const struct texture_type *type = texture_type_of(s->textures[i]);
        if (type->prepare && !type->prepare(s->textures[i], &s->arena))
            return false;
    }
    return true;
}

static bool prepare_bsdfs(struct scene *s) {
    for (uint32_t i = 0; i < s->bsdf_count; i++) {
        const struct bsdf_type *type = bsdf_type_of(s->bsdfs[i]);
        if (type->prepare && !type->prepare(s->bsdfs[i], &s->arena))
            return false;
    }
    return true;
}

// 0: there are too many kinds already.
static uint32_t index_of_kind(struct world *w, const struct wide_bsdf *kind) {
    uint32_t k = 1;
    while (k < w->wide_kind_count && w->wide_kinds[k] != kind)
        k++;
    if (k == WORLD_MOST_WIDE_KINDS)
        return 0;
    w->wide_kinds[k] = kind;
    w->wide_kind_count = k < w->wide_kind_count ? w->wide_kind_count : k + 1;
    return k;
}

void world_shade_wide(struct world *w, uint32_t index, const struct object *bsdf) {
    struct world_shape *shape = &w->shapes[index];
    struct wide_material m;
    if (w->tangents_matter || shape->kind != SHAPE_MESH ||
        w->scene->shapes[index].group != SCENE_NONE || !bsdf_wide(bsdf, &m))
        return;
    shape->wide_kind = (uint8_t)index_of_kind(w, m.kind);
    shape->wide_data = m.data;
    shape->two_sided = m.two_sided;
    shape->textured = m.textured;
}

static void find_wide_materials(struct world *w, const struct scene *s) {
    w->wide_kind_count = 1;
    for (uint32_t i = 0; i < s->shape_count; i++)
        world_shade_wide(w, i, w->shapes[i].bsdf);
}

static bool prepare_lights(struct world *w, struct scene *s) {
    w->light_count = s->light_count;
    w->lights = mem_array(s->light_count, sizeof *w->lights);
    w->infinite = mem_array(s->light_count, sizeof *w->infinite);
    for (uint32_t i = 0; i < s->light_count; i++) {
        struct scene_light *l = &s->lights[i];
        const struct light_type *type = light_type_of(l->object);
        const struct light_scene info = {
            .centre = w->centre, .radius = w->radius, .origin = {s->centre[0], s->centre[1], s->centre[2]},
            .shape = l->shape == SCENE_NONE ? NULL : &s->shapes[l->shape]};
        if (info.shape && info.shape->group != SCENE_NONE) {
            log_error_at(l->object->at, "a shape inside a shapegroup cannot emit light");
            return false;
        }
        if (type->prepare && !type->prepare(l->object, &info, &s->arena))
            return false;
        w->lights[i] = (struct world_light){.type = type, .data = l->object->data, .dark = l->dark,
                                            .hidden = l->hidden};
        w->links |= l->dark != NULL;
        if (type->infinite && !type->delta)
            w->infinite[w->infinite_count++] = i;
    }
    light_choice_init(&w->choice, LIGHT_CHOICE_AUTO, w->lights, w->light_count);
    return true;
}

static bool prepare_media(struct world *w, struct scene *s) {
    if (s->medium_count == 0)
        return true;
    for (uint32_t i = 0; i < s->volume_count; i++) {
        const struct volume_type *type = volume_type_of(s->volumes[i]);
        if (type->prepare && !type->prepare(s->volumes[i], s->centre, &s->arena))
            return false;
    }
    for (uint32_t i = 0; i < s->phase_count; i++) {
        const struct phase_type *type = phase_type_of(s->phases[i]);
        if (type->prepare && !type->prepare(s->phases[i], &s->arena))
            return false;
    }
    w->media = mem_array(s->medium_count, sizeof *w->media);
    for (uint32_t i = 0; i < s->medium_count; i++)
        if (!medium_prepare(s->media[i], &s->arena, &w->media[i]))
            return false;
    w->boundaries = mem_array(s->shape_count, sizeof *w->boundaries);
    for (uint32_t i = 0; i < s->shape_count; i++) {
        const uint32_t in = s->shapes[i].interior, out = s->shapes[i].exterior;
        w->boundaries[i] = (struct world_boundary){in != SCENE_NONE || out != SCENE_NONE, in, out};
    }
    return true;
}

static bool init_transform(struct world_transform *t, const struct transform *to_world,
                           struct where at) {
    t->to_world = *to_world;
    if (!transform_invert(to_world, &t->to_object)) {
        log_error_at(at, "the to_world transform is singular");
        return false;
    }
    t->forward = affine_from(&t->to_world);
    t->inverse = affine_from(&t->to_object);
    t->error = 0x1p-23f * (absolute(t->forward.x) + absolute(t->forward.y) + absolute(t->forward.z));
    return true;
}

static bool init_transforms(struct world *w, const struct scene *s) {
    for (uint32_t i = 0; i < s->shape_count; i++) {
        if (s->shapes[i].kind == SHAPE_MESH)
            continue;
        if (!w->quadrics)
            w->quadrics = mem_array(s->shape_count, sizeof *w->quadrics);
        if (!init_transform(&w->quadrics[i], &s->shapes[i].to_world, s->shapes[i].at))
            return false;
    }
    w->instances = mem_array(s->instance_count, sizeof *w->instances);
    for (uint32_t i = 0; i < s->instance_count; i++)
        if (!init_transform(&w->instances[i], &s->instances[i].to_world,
                            (struct where){s->path, 0}))
            return false;
    return true;
}

struct world *world_create(struct scene *s, int threads) {
    struct world *w = mem_array(1, sizeof *w);
    w->scene = s;
    w->centre = 0.5f * (s->bounds_min + s->bounds_max);
    w->radius = length(s->bounds_max - w->centre);
    if (!(w->radius > 0))
        w->radius = 1; // nothing, or a single point: any positive size will do
    if (!prepare_textures(s) || !prepare_bsdfs(s) || !world_check_textures(s))
        goto fail;
    world_drop_unseen(s);
    init_shapes(w, s);
    if (!init_transforms(w, s) || !prepare_lights(w, s) || !prepare_media(w, s))
        goto fail;
    find_wide_materials(w, s);
    const double start = time_seconds();
    w->accel = accel_create(s, threads);
    w->accel_seconds = time_seconds() - start;
    if (w->accel)
        return w;
fail:
    world_destroy(w);
    return NULL;
}

void world_choose_lights(struct world *w, enum light_choice_mode mode) {
    if (mode == LIGHT_CHOICE_AUTO)
        return;
    light_choice_finish(&w->choice);
    light_choice_init(&w->choice, mode, w->lights, w->light_count);
}

void world_replace_light(struct world *w, uint32_t light, const struct light_type *type,
                         const void *data) {
    w->lights[light].type = type;
    w->lights[light].data = data;
    light_choice_finish(&w->choice);
    light_choice_init(&w->choice, LIGHT_CHOICE_AUTO, w->lights, w->light_count);
}

void world_destroy(struct world *w) {
    if (!w)
        return;
    const struct scene *s = w->scene;
    for (uint32_t i = 0; i < s->texture_count; i++)
        if (texture_type_of(s->textures[i])->finish)
            texture_type_of(s->textures[i])->finish(s->textures[i]->data);
    for (uint32_t i = 0; i < s->light_count; i++)
        if (light_type_of(s->lights[i].object)->finish)
            light_type_of(s->lights[i].object)->finish(s->lights[i].object->data);
    for (uint32_t i = 0; i < s->volume_count; i++)
        if (volume_type_of(s->volumes[i])->finish)
            volume_type_of(s->volumes[i])->finish(s->volumes[i]->data);
    accel_destroy(w->accel);
    light_choice_finish(&w->choice);
    mem_free(w->shapes);
    mem_free(w->quadrics);
    mem_free(w->instances);
    mem_free(w->lights);
    mem_free(w->media);
    mem_free(w->boundaries);
    mem_free(w->infinite);
    mem_free(w);
}

struct ray world_shadow_ray(const struct surface *s, const struct light_sample *l) {
    return world_ray_to_light(surface_offset(s, l->wi), l);
}

struct ray world_ray_to_light(vec3 o, const struct light_sample *l) {
    if (!(l->distance < INFINITY))
        return (struct ray){o, l->wi, 0, INFINITY};
    if (!(length2(l->n) > 0))
        return (struct ray){o, l->p - o, 0, 1};
    // The ray tracer works with positions relative to the origin: its error grows with the distance.
    const float reach = 4 * 0x1p-24f * largest(l->p - o);
    const vec3 error = l->p_error + v3(reach, reach, reach);
    return (struct ray){o, offset_point(l->p, error, l->n, -l->wi) - o, 0, 1};
}

spectrum world_transmittance(const struct world *w, struct ray ray, int most,
                             struct wavelengths wavelengths) {
    enum { MOST_SURFACES = 256 }; // more than that straight through counts as opaque
    const int limit = most < 0 || most > MOST_SURFACES ? MOST_SURFACES : most;
    if (!w->shadow_rays_may_pass)
        return spectrum_grey(accel_occluded(w->accel, &ray) ? 0 : 1);
    spectrum through = spectrum_grey(1);
    for (int i = 0; i <= limit; i++) {
        struct accel_hit hit;
        struct surface s;
        ray = ray_ordinary(ray); // Embree loses (u, v) where edges x distance x |d| is below 1e-18
        if (!accel_intersect(w->accel, &ray, &hit))
            return through;
        if (i == limit)
            break;
        world_surface(w, &ray, &hit, &s);
        s.point.wavelengths = wavelengths;
        const struct object *bsdf = s.bsdf;
        const struct bsdf_type *type = bsdf_type_of(bsdf);
        if (!type->null_transmittance)
            return spectrum_grey(0);
        const vec3 wo = to_local(&s.point.frame, -normalize(ray.d));
        through *= type->null_transmittance(bsdf->data, &s.point, wo);
        if (spectrum_is_black(through))
            return through;
        const vec3 end = ray.o + ray.tmax * ray.d;
        ray.o = surface_offset(&s, ray.d);
        if (ray.tmax < INFINITY) {
            ray.d = end - ray.o;
            ray.tmax = 1;
        }
    }
    return spectrum_grey(0);
}

spectrum world_environment(const void *world, vec3 d) {
    const struct world *w = world;
    const struct light_hit hit = {.wi = d, .distance = INFINITY};
    spectrum sum = spectrum_grey(0);
    for (uint32_t i = 0; i < w->infinite_count; i++) {
        const struct world_light *l = &w->lights[w->infinite[i]];
        sum += l->type->emission(l->data, &hit);
    }
    return sum;
}
