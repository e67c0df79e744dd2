// SPDX-License-Identifier: Apache-2.0
// Media without a scene, for tests: homogeneous ones from text, and grids from arrays by way of a
// .vol file.
#pragma once

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "make_object.h"
#include "medium/medium.h"

static inline struct medium test_medium(struct arena *arena, const char *type,
                                        const char *parameters) {
    struct medium m;
    if (!medium_prepare(make_object(arena, &media, type, parameters, NULL), arena, &m))
        exit(1);
    return m;
}

// Writes float values as a volume; box: lo and hi corners, or NULL for the unit cube.
static inline void test_write_vol(const char *path, const int size[3], int channels,
                                  const float *values, const float box[6]) {
    static const float unit[6] = {0, 0, 0, 1, 1, 1};
    const size_t n = (size_t)size[0] * (size_t)size[1] * (size_t)size[2] * (size_t)channels;
    const int32_t head[5] = {1, size[0], size[1], size[2], channels};
    unsigned char *bytes = mem_array(48 + 4 * n, 1);
    memcpy(bytes, "VOL\3", 4);
    memcpy(bytes + 4, head, sizeof head);
    memcpy(bytes + 24, box ? box : unit, 24);
    memcpy(bytes + 48, values, 4 * n);
    if (!file_write(path, bytes, 48 + 4 * n))
        exit(1);
    mem_free(bytes);
}

// A grid that fills the unit cube; volume_grid_finish when done.
static inline struct object *test_grid(struct arena *arena, const int size[3], int channels,
                                       const float *values, const char *parameters) {
    static const double origin[3];
    char path[64], text[256];
    snprintf(path, sizeof path, "/tmp/relume-grid-%d.vol", (int)getpid());
    test_write_vol(path, size, channels, values, NULL);
    snprintf(text, sizeof text, "filename=%s %s", path, parameters);
    struct object *o = make_object(arena, &volumes, "gridvolume", text, NULL);
    const bool good = volume_type_of(o)->prepare(o, origin, arena);
    unlink(path);
    if (!good)
        exit(1);
    return o;
}

// A heterogeneous medium of that density.
static inline struct medium test_grid_medium(struct arena *arena, const struct object *density,
                                             const char *parameters) {
    struct medium m;
    struct object *o = make_object(arena, &media, "heterogeneous", parameters, NULL);
    const struct param *p = param_find(o->type, "sigma_t");
    struct volume_ref *slot = (struct volume_ref *)((char *)o->data + p->offset);
    *slot = (struct volume_ref){.volume = density, .given = true};
    if (!medium_prepare(o, arena, &m))
        exit(1);
    return m;
}
