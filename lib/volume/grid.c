// SPDX-License-Identifier: Apache-2.0
#include "volume/grid.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"

bool grid_init(struct grid *g, const char *path) {
    for (int k = 0; k < 3; k++)
        if (g->size[k] < 1 || g->size[k] > GRID_MOST_SIDE) {
            log_error("%s: has %d voxels along %c, expected 1 to %d", path, g->size[k], "xyz"[k],
                      GRID_MOST_SIDE);
            return false;
        }
    if (g->channels != 1 && g->channels != 3) {
        log_error("%s: has %d channels, expected 1 or 3", path, g->channels);
        return false;
    }
    const double count = (double)g->size[0] * g->size[1] * g->size[2] * g->channels;
    if (count > GRID_MOST_VOXELS) {
        log_error("%s: holds %g values, expected at most %d", path, count, GRID_MOST_VOXELS);
        return false;
    }
    g->values = mem_array(grid_values(g), sizeof *g->values);
    g->to_file = transform_identity;
    return true;
}

void grid_finish(struct grid *g) {
    mem_free(g->values);
    g->values = NULL;
}

// Values below zero are what resampling leaves of nothing: they become zero.
static bool check_values(const char *path, struct grid *g) {
    const size_t n = grid_values(g);
    size_t negative = 0;
    float least = 0;
    for (size_t i = 0; i < n; i++) {
        float *v = &g->values[i];
        if (!isfinite(*v)) {
            const size_t voxel = i / (size_t)g->channels;
            log_error("%s: voxel %zu is %g, expected finite values", path, voxel, (double)*v);
            return false;
        }
        if (*v < 0) {
            negative++;
            least = *v < least ? *v : least;
            *v = 0;
        }
    }
    if (negative)
        log_info("%s: %zu of %zu values are negative (the least %g) and taken for zero", path,
                 negative, n, (double)least);
    return true;
}

bool grid_read(const char *path, const char *name, struct grid *g) {
    char extension[8];
    memset(g, 0, sizeof *g);
    file_extension(path, extension, sizeof extension);
    bool good = false;
    if (strcmp(extension, "vol") == 0)
        good = grid_read_vol(path, g);
    else if (strcmp(extension, "vdb") == 0)
        good = grid_read_vdb(path, name, g);
    else
        log_error("%s: is not a volume format that is read (vol, vdb)", path);
    if (good && check_values(path, g))
        return true;
    grid_finish(g);
    return false;
}
