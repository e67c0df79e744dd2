// SPDX-License-Identifier: Apache-2.0
// OpenVDB, through the library that reads pictures (image/oiio.h), in a child process: the grid is
// made dense. Voxels have their middles at whole indices.
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "image/decode.h"
#include "image/oiio.h"
#include "volume/grid.h"

static const char *text_of(const struct image *im, const char *name) {
    const struct image_attribute *a = image_find_attribute(im, name);
    return a && a->text ? a->text : "";
}

// From the unit cube that the voxels fill to the file's world.
static bool read_place(const struct image *im, const char *path, struct grid *g) {
    int origin[3];
    struct transform index = {0};
    const char *matrix = text_of(im, "indexToWorld");
    int used = 0;
    bool good = sscanf(text_of(im, "origin"), "%d %d %d", &origin[0], &origin[1], &origin[2]) == 3;
    for (int i = 0; i < 16 && good; i++, matrix += used)
        good = sscanf(matrix, "%lf%n", &index.m[i / 4][i % 4], &used) == 1;
    const bool affine = index.m[3][0] == 0 && index.m[3][1] == 0 && index.m[3][2] == 0;
    if (!good || !affine || !transform_is_finite(&index)) {
        log_error("%s: does not say where its grid stands; expected an affine transform", path);
        return false;
    }
    const struct transform size = transform_scale(g->size[0], g->size[1], g->size[2]);
    const struct transform move =
        transform_translate(origin[0] - 0.5, origin[1] - 0.5, origin[2] - 0.5);
    const struct transform unit = transform_multiply(&move, &size);
    g->to_file = transform_multiply(&index, &unit);
    g->placed = true;
    return true;
}

static bool take(const struct image *im, const char *path, struct grid *g) {
    int depth = 0;
    if (sscanf(text_of(im, "depth"), "%d", &depth) != 1 || depth < 1 || im->height % depth != 0) {
        log_error("%s: has no sound number of layers", path);
        return false;
    }
    g->size[0] = im->width;
    g->size[1] = im->height / depth;
    g->size[2] = depth;
    g->channels = im->channels;
    if (!grid_init(g, path) || !read_place(im, path, g))
        return false;
    memcpy(g->values, im->pixels, grid_values(g) * sizeof *g->values);
    return true;
}

bool grid_read_vdb(const char *path, const char *name, struct grid *g) {
    struct image im = {0};
    if (!oiio_load() || !image_decode_part_in_child(path, name, oiio_decode_voxels, &im))
        return false;
    const bool good = take(&im, path, g);
    image_finish(&im);
    return good;
}
