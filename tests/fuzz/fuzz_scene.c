// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "driver/job.h"
#include "fuzz.h"

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

// Reads the scene, prepares all that stands in it and traces some paths.
static bool read_scene(const char *path) {
    const struct job_options options = {
        .scene = path, .spp = 1, .threads = 1, .max_depth = 6, .reading = {.width = 8, .height = 8}};
    struct job job;
    struct render_result result;
    if (!job_open(&job, &options))
        return false;
    const char *fault = scene_fault(job.scene);
    if (fault) {
        fprintf(stderr, "%s: was read, but %s\n", path, fault);
        abort();
    }
    film_destroy(job_render(&job, &result));
    job_close(&job);
    return true;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-scene", read_scene);
}
