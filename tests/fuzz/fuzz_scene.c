// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "bsdf/bsdf.h"
#include "filter/filter.h"
#include "fuzz.h"
#include "integrator/integrator.h"
#include "light/light.h"
#include "medium/medium.h"
#include "phase/phase.h"
#include "sampler/sampler.h"
#include "scene/scene.h"
#include "sensor/sensor.h"
#include "texture/texture.h"
#include "world/world.h"

// What a scene promises once it has been read.
static const char *scene_fault(const struct scene *s) {
    if (!s->sensor_count || !s->sampler || !s->filter || !s->integrator)
        return "lacks a sensor, sampler, filter or integrator";
    if (s->film.width < 1 || s->film.height < 1 || s->film.crop_x0 >= s->film.crop_x1 ||
        s->film.crop_y0 >= s->film.crop_y1 || s->film.crop_x1 > s->film.width ||
        s->film.crop_y1 > s->film.height)
        return "has an impossible film";
    for (uint32_t i = 0; i < s->shape_count; i++) {
        const struct shape *shape = &s->shapes[i];
        if (!shape->bsdf || (shape->light != SCENE_NONE && shape->light >= s->light_count) ||
            (shape->group != SCENE_NONE && shape->group >= s->group_count))
            return "has a shape that points nowhere";
        for (uint32_t k = 0; k < shape->mesh.vertex_count; k++)
            if (!isfinite(length2(v3_load(shape->mesh.positions[k]))))
                return "has a vertex that is not finite";
    }
    for (uint32_t i = 0; i < s->instance_count; i++)
        if (s->instances[i].group >= s->group_count)
            return "has an instance that points nowhere";
    return NULL;
}

// Reads the scene and prepares all that stands in it.
static bool read_scene(const char *path) {
    const struct scene_options options = {
        .registries = {&textures, &bsdfs, &lights, &sensors, &samplers, &filters, &integrators, &volumes, &phases,
                       &media},
        .threads = 1};
    struct scene *s = scene_read(path, &options);
    if (!s)
        return false;
    const char *fault = scene_fault(s);
    if (fault) {
        fprintf(stderr, "%s: was read, but %s\n", path, fault);
        abort();
    }
    struct world *w = world_create(s, 1);
    world_destroy(w);
    scene_destroy(s);
    return w != NULL;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-scene", read_scene);
}
