// SPDX-License-Identifier: Apache-2.0
// The world: a scene made ready for tracing. Constant while rendering.
#pragma once

#include "accel/accel.h"
#include "bsdf/bsdf_wide.h"
#include "math/wide_maps.h"
#include "medium/medium.h"
#include "scene/scene.h"
#include "world/light_choice.h"

// Transforms of an instance or a quadric as surfaces need them.
struct world_transform {
    struct transform to_world, to_object;
    struct affine forward, inverse; // the same in single precision
    vec3 error; // rounding of positions that grows with the size of a quadric
};

// What surfaces need of a shape at every hit, in one cache line: hits jump about in memory.
struct world_shape {
    const uint32_t (*indices)[3];
    const float (*positions)[3];
    const float (*normals)[3];  // NULL: none, or those of the triangles themselves
    const float (*uvs)[2];      // NULL: none
    const struct mesh *mesh;
    const struct object *bsdf;
    uint32_t light;             // or SCENE_NONE
    uint8_t kind;               // enum shape_kind
    uint8_t wide_kind;          // index of world.wide_kinds; 0: its points are shaded one by one
    bool flip_normals : 1, hidden : 1; // from the rays of the sensor
    bool two_sided : 1, textured : 1; // of the wide material
    bool smooth : 1;            // its material may scatter light that was sampled
    bool glossy : 1;            // and by a rough specular lobe
    const void *wide_data;
};

enum { WORLD_MOST_WIDE_KINDS = 16 };

// The media of both sides of a shape, SCENE_NONE for a vacuum.
struct world_boundary {
    bool parts; // it has media; else a ray that passes stays in the medium it is in
    uint32_t interior, exterior;
};

struct world {
    const struct scene *scene;
    struct world_shape *shapes;        // by shape
    const struct wide_bsdf *wide_kinds[WORLD_MOST_WIDE_KINDS]; // 0 is none
    uint32_t wide_kind_count;
    struct accel *accel;
    struct world_light *lights; // index: as in the scene
    uint32_t light_count;
    struct light_choice choice; // of lights, for next event estimation
    uint32_t *infinite;         // lights that rays leaving the scene find
    uint32_t infinite_count;
    struct world_transform *quadrics;  // by shape; NULL: the scene has none
    struct world_transform *instances; // by instance
    bool shadow_rays_may_pass;  // some material lets rays straight through
    bool hides;                 // something is hidden from the rays of the sensor
    bool links;                 // some light does not light all shapes
    bool packets_pay;           // so few primitives that packets win whichever way the rays run
    bool tangents_matter;       // some material is anisotropic or perturbs its normal
    struct medium *media;       // index: as in the scene; NULL: the scene has none
    struct world_boundary *boundaries; // by shape; NULL: the scene has no media
    vec3 centre;                // bounding sphere of all shapes
    float radius;
    double accel_seconds;       // building it took
};

// Prepares every texture, material and light of the scene and builds the acceleration structure.
// The scene must outlive the world. NULL after an error message.
struct world *world_create(struct scene *scene, int threads);
void world_destroy(struct world *w);

// Finds the facets that shadow rays are best tried against first, with paths that `start` begins at
// two random numbers.
void world_learn_blockers(struct world *w, void (*start)(const void *, struct vec2, struct ray *),
                          const void *context);

// Has a shape's points shaded together by this material, where they can be: its own, or that of a
// response which answers so (integrator/response.h).
void world_shade_wide(struct world *w, uint32_t shape, const struct object *bsdf);

// Chooses lights in another way than world_create did (LIGHT_CHOICE_AUTO).
void world_choose_lights(struct world *w, enum light_choice_mode mode);

// Puts another light in the place of one, and chooses lights anew (LIGHT_CHOICE_AUTO).
void world_replace_light(struct world *w, uint32_t light, const struct light_type *type,
                         const void *data);

// A point on one light as seen from a place, for next event estimation; s->pdf_sa includes the
// choice of the light. false: nothing was sampled. u1 is not used unless w->choice.draws.
static inline bool world_sample_light(const struct world *w, const struct light_place *at,
                                      float u1, struct vec2 u2, uint32_t *light,
                                      struct light_sample *s) {
    return light_choice_sample(&w->choice, w->lights, w->light_count, at, u1, u2, light, s);
}

// Sends for the memory that world_light_pdf_sa will need for so many lights (at most one a lane), without
// waiting for it; triangles: where each was found.
static inline void world_prefetch_lights(const struct world *w, const uint32_t *found,
                                         const uint32_t *triangles, int count) {
    light_choice_prefetch(&w->choice, w->lights, found, triangles, count);
}

// The density with which world_sample_light finds the point of a light that a ray found.
static inline float world_light_pdf_sa(const struct world *w, uint32_t light,
                                       const struct light_place *at, const struct light_hit *hit) {
    return light_choice_pdf_sa(&w->choice, &w->lights[light], at, hit);
}

// Whether a light lights a shape; SCENE_NONE, which a meter or a point in a medium is: always.
static inline bool world_links(const struct world *w, uint32_t light, uint32_t shape) {
    const uint8_t *dark = w->lights[light].dark;
    return !dark || shape == SCENE_NONE || !dark[shape];
}

// Sends for what the surface of a hit will need of memory: first its triangle's indices, then, once they
// have arrived, its corners, but texture coordinates only where many lanes look textures up.
static inline void world_prefetch_indices(const struct world *w, const struct accel_hit *hit) {
    if (hit->shape == SCENE_NONE || w->shapes[hit->shape].kind != SHAPE_MESH)
        return;
    __builtin_prefetch(w->shapes[hit->shape].indices[hit->primitive]);
}

static inline void world_prefetch_corners(const struct world *w, const struct accel_hit *hit) {
    const struct world_shape *s = &w->shapes[hit->shape];
    for (int k = 0; s->kind == SHAPE_MESH && k < 3; k++) {
        const uint32_t i = s->indices[hit->primitive][k];
        __builtin_prefetch(s->positions[i]);
        if (s->normals)
            __builtin_prefetch(s->normals[i]);
        if (s->textured && s->uvs)
            __builtin_prefetch(s->uvs[i]);
    }
}

// Takes the hit of a ray of the sensor on to the first surface that is not hidden from it. Distances
// stay those from the ray's origin. Only where w->hides.
void world_see(const struct world *w, const struct ray *ray, struct accel_hit *hit);

// What a ray found, ready for shading.
struct surface {
    vec3 p, p_error;         // world space; absolute error bound per axis
    vec3 ng;                 // unit, on the outer side of the shape whatever the ray's side
    float t;
    struct bsdf_point point; // shading frame, texture coordinates
    const struct object *bsdf;
    uint32_t light;          // that shines from here, or SCENE_NONE
    uint32_t shape, primitive, instance;
};

// One a lane, of triangles that are not instanced, without what only textures need. Lanes that are
// not wanted have the hit of one that is.
struct surfaces {
    struct wide3 p, p_error, ng;
    struct wide_frame frame;
};

void world_surfaces(const struct world *w, const struct accel_hit *const hits[WIDE_LANES],
                    struct surfaces *s);
// The texture coordinates at a hit of a mesh.
struct texture_point world_texture_point(const struct world_shape *m, const struct accel_hit *hit);

void world_surface(const struct world *w, const struct ray *ray, const struct accel_hit *hit,
                   struct surface *s);

static inline struct wide3 surfaces_offset(const struct surfaces *s, struct wide3 w) {
    return wide_offset_point(s->p, s->p_error, s->ng, w);
}

// Origin of a ray that leaves the surface on the side w points to.
static inline vec3 surface_offset(const struct surface *s, vec3 w) {
    return offset_point(s->p, s->p_error, s->ng, w);
}

// The shadow ray from a surface to a sampled point of a light: t in (0, 1), or to infinity.
struct ray world_shadow_ray(const struct surface *s, const struct light_sample *l);

// The same from a point in space.
struct ray world_ray_to_light(vec3 o, const struct light_sample *l);

// Radiance that arrives along -d from infinitely far, of all lights that are there; world is a struct
// world, for functions of a direction that take a context.
spectrum world_environment(const void *world, vec3 d);

// Share of light that comes through along a shadow ray: 0 where anything opaque is in the way, or
// more than `most` surfaces that let light straight through (negative: no limit).
spectrum world_transmittance(const struct world *w, struct ray ray, int most,
                             struct wavelengths wavelengths);
