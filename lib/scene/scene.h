// SPDX-License-Identifier: Apache-2.0
// A scene as plain arrays, exactly as a file gives it: nothing here is specific to an algorithm.
//
// Materials, textures, lights, sensors, ... are struct objects of registries that the program hands
// to the reader, so the reader knows no module of a higher row. Objects stand in the arrays
// children first. Everything lives in the arena except mesh arrays, which the scene owns too.
#pragma once

#include "base/mem.h"
#include "base/registry.h"
#include "math/transform.h"
#include "mesh/mesh.h"

#define SCENE_NONE UINT32_MAX

enum shape_kind {
    SHAPE_MESH,
    SHAPE_SPHERE,   // unit sphere in object space
    SHAPE_DISK,     // unit disk at z = 0, normal +z
    SHAPE_CYLINDER, // radius 1 about z, z from 0 to 1, open ends, normal outwards
};

struct shape {
    enum shape_kind kind;
    const char *name;            // id, or "" ; for layers and messages
    const char *type;            // "obj", "sphere", ... as in the file
    struct where at;
    struct mesh mesh;            // SHAPE_MESH: in world space (or in the group's space)
    struct transform to_world;   // quadrics only: includes radius, centre, length
    bool flip_normals;
    const struct object *bsdf;   // never NULL after reading
    uint32_t light;              // index into lights, or SCENE_NONE
    const char *set;             // that it belongs to, for the lists of lights, or NULL
    bool hidden;                 // from the rays of the sensor
    uint32_t group;              // shapegroup it belongs to, or SCENE_NONE: directly in the world
    uint32_t interior, exterior; // media behind and before it (normal outwards), or SCENE_NONE
};

struct instance {
    uint32_t group;
    const char *name;
    struct transform to_world;
    bool hidden; // from the rays of the sensor
};

// A light as it stands in the file. `shape` ties an area light to its shape.
struct scene_light {
    struct object *object;
    uint32_t shape; // or SCENE_NONE
    const char *name;  // id, else the shape's id, else "TYPE.N"
    const char *group; // light group it is summed under, or NULL: by itself
    const char *include, *exclude; // shapes that it lights, or does not, as a list; or NULL
    const uint8_t *dark; // by shape: 1 where it gives no light; NULL: it lights all
    bool hidden;       // from the rays of the sensor; of infinite lights
};

struct film_settings {
    int width, height;                     // of the whole picture
    int crop_x0, crop_y0, crop_x1, crop_y1; // pixels to render, half-open
    bool alpha;                            // pixel_format with alpha
};

struct scene {
    struct arena arena;
    const char *path;
    uint64_t hash; // of all files read that decide the picture

    struct shape *shapes;
    uint32_t shape_count;
    struct instance *instances;
    uint32_t instance_count;
    uint32_t group_count;

    struct object **textures; // children first
    uint32_t texture_count;
    struct object **bsdfs;
    uint32_t bsdf_count;
    struct scene_light *lights;
    uint32_t light_count;

    struct object **volumes; // children first
    uint32_t volume_count;
    struct object **phases; // children first
    uint32_t phase_count;
    struct object **media;
    uint32_t medium_count;

    struct object **sensors; // the first is rendered unless the user names another
    uint32_t sensor_count;
    struct film_settings film;    // of the sensor that is rendered
    uint32_t sensor_medium;       // index of the medium that sensor stands in, or SCENE_NONE
    uint32_t sensor_shape;        // index of the shape that sensor stands in, or SCENE_NONE
    struct object *filter;        // of that sensor's film
    struct object *sampler;       // of that sensor
    int sample_count;             // spp asked by the file; 0: none
    struct object *integrator;

    bool may_leak; // rays may slip through between triangles that share an edge, and take less time

    double centre[3];  // every position is stored relative to this point of the file's world
    vec3 bounds_min, bounds_max; // of all shapes and instances, relative to centre
};

// The registries a reader may instantiate from.
struct scene_registries {
    const struct registry *textures, *bsdfs, *lights, *sensors, *samplers, *filters, *integrators;
    const struct registry *volumes, *phases, *media;
};

struct scene_define {
    const char *name, *value; // -D NAME=VALUE
};

struct scene_options {
    const char *text;       // the scene itself, read instead of the file of that name; or NULL
    struct scene_registries registries;
    const struct scene_define *defines;
    size_t define_count;
    const char *integrator; // replaces the file's, before names are resolved; or NULL
    const char *sampler;    // replaces the file's; or NULL
    int width, height;      // replaces the file's; 0: keep
    int threads;            // 0: default
    bool sensorless;        // a file without a sensor gets one, in place of an error
    bool lenient;           // unknown parameters warn instead of failing
};

// Whether the extension is one that scene_read knows.
bool scene_is_format(const char *path);
// Reads by the file's extension (.xml, .gltf, .glb, .obj, .pbrt). NULL after an error message.
struct scene *scene_read(const char *path, const struct scene_options *options);
void scene_destroy(struct scene *s);
