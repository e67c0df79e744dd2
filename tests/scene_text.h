// SPDX-License-Identifier: Apache-2.0
// Scenes from text, for tests: files in a folder of their own, read with the real registries.
#pragma once

#include <stdarg.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "bsdf/bsdf.h"
#include "capture.h"
#include "check.h"
#include "filter/filter.h"
#include "integrator/integrator.h"
#include "light/light.h"
#include "medium/medium.h"
#include "phase/phase.h"
#include "sampler/sampler.h"
#include "scene/scene.h"
#include "sensor/sensor.h"
#include "texture/texture.h"

static char scene_folder[64];

static inline struct scene_options scene_real_options(void) {
    return (struct scene_options){.registries = {&textures, &bsdfs, &lights, &sensors, &samplers,
                                                 &filters, &integrators, &volumes, &phases,
                                                 &media}, .threads = 1};
}

static inline void scene_folder_open(void) {
    snprintf(scene_folder, sizeof scene_folder, "/tmp/relume-scene-XXXXXX");
    if (!mkdtemp(scene_folder))
        exit(1);
}

static inline void scene_folder_close(void) {
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", scene_folder);
    if (system(command) != 0)
        exit(1);
}

static inline const char *scene_path(const char *name) {
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", scene_folder, name);
    return path;
}

static inline void scene_write(const char *name, const char *text) {
    if (!file_write(scene_path(name), text, strlen(text)))
        exit(1);
}

// Reads text as a whole scene file; what it says is captured.
static inline struct scene *scene_parse_with(const struct scene_options *options,
                                             const char *text) {
    scene_write("scene.xml", text);
    capture_begin();
    struct scene *s = scene_read(scene_path("scene.xml"), options);
    capture_end();
    return s;
}

#define SCENE_HEAD "<scene version='3.0.0'><sensor type='perspective'/>\n"
#define SCENE_TAIL "\n</scene>"

// The body of a version 3 scene with a sensor; it begins in line 2.
static inline struct scene *scene_parse(const char *body) {
    const struct scene_options options = scene_real_options();
    char text[16384];
    snprintf(text, sizeof text, SCENE_HEAD "%s" SCENE_TAIL, body);
    return scene_parse_with(&options, text);
}

// A parameter of an object, as the type says.
#define PARAM(type, object, name) (*(type const *)param_place((object), (name)))

static inline const void *param_place(const struct object *o, const char *name) {
    const struct param *p = param_find(o->type, name);
    if (!p) {
        printf("no parameter %s in %s\n", name, o->type->name);
        exit(1);
    }
    return (const char *)o->data + p->offset;
}

static inline void check_colour(spectrum c, double r, double g, double b, double tolerance) {
    CHECK_NEAR(c[0], r, tolerance);
    CHECK_NEAR(c[1], g, tolerance);
    CHECK_NEAR(c[2], b, tolerance);
}
