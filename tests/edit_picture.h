// SPDX-License-Identifier: Apache-2.0
// Pictures from edit tensors and by other ways, for tests of precomputing materials.
#pragma once

#include "driver/precompute_edit.h"

struct edit_picture {
    int width, height;
    double *rgb; // [height][width][3]
};

struct edit_picture edit_picture_make(int width, int height);
void edit_picture_free(struct edit_picture *p);

// Precomputes a scene given as a text and multiplies out with the weights of the scene as it is; f_o
// too. The tensor stays in the scene folder as t.safetensors. fixed: whether what no edit changes
// is added. false after an error message.
bool edit_picture_by_tensor(const char *scene, const struct edit_options *options, bool fixed,
                            struct edit_picture *out, struct edit_report *report);

// The picture of a tensor file.
bool edit_picture_replay(const char *path, bool fixed, struct edit_picture *out);

// The sum over the same triangles, surface by surface and light by light, each triangle's curves
// averaged over 4^depth points of it (depth 0: its centre); visibility, quotient and cosine are
// those of the centre. exact: the whole material is averaged over the points.
void edit_picture_by_loop(const char *scene, const struct edit_options *options, int depth, bool exact,
                          struct edit_picture *out);
// The same over other lights; and the triangles of the options.
void edit_picture_by_lights(const char *scene, const struct edit_options *options,
                            const struct light_triangles *sky, int depth, bool exact,
                            struct edit_picture *out);
void edit_picture_lights(const char *scene, const struct edit_options *options,
                         struct light_triangles *out);

// mean of (a - b)^2 / (b^2 + 1e-3 mean(b)^2)
double edit_picture_relmse(const struct edit_picture *a, const struct edit_picture *b);
// Largest difference, relative to the brightest value of b.
double edit_picture_largest(const struct edit_picture *a, const struct edit_picture *b);
double edit_picture_mean(const struct edit_picture *p);

// Writes an environment: what its texels' channels are.
typedef double edit_picture_radiance(int x, int y, int channel, const void *ctx);
void edit_picture_write_sky(const char *path, int width, int height, edit_picture_radiance *of,
                            const void *ctx);
// One that is even above and below the horizon, with one texel brighter by `radiance`; below_only:
// black above.
void edit_picture_write_sun(const char *path, double radiance, bool below_only);
