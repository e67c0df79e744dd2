// SPDX-License-Identifier: Apache-2.0
// The data of sun and sky, shared by their two ways of being sampled.
#pragma once

#include "light/light.h"
#include "light/preetham.h"
#include "light/sunsky_model.h"
#include "math/distribution.h"
#include "math/frame.h"

enum { SUNSKY_ROWS = 48, SUNSKY_COLUMNS = 128 }; // in the cosine from the zenith, and around it

struct sunsky {
    float turbidity;
    spectrum albedo;
    vec3 sun_direction;
    float latitude, longitude, timezone;
    int year, month, day;
    float hour, minute, second;
    float sun_scale, sky_scale, scale, sun_aperture, sun_radius_scale;
    int up, model;
    struct transform to_world;
    // made by prepare
    struct affine world, local; // rotations; local z is up
    struct sky_model sky;
    struct preetham_sky preetham;
    struct sun_model disk;
    struct frame sun;           // local, n towards the sun
    float half_aperture, sin_aperture;
    float cone_height;          // 1 - cos of half_aperture
    float sky_factor, sun_factor;
    float sky_share;            // of the samples
    bool dark;                  // the sun is below the horizon, or the scales are 0
    struct distribution rows, columns[SUNSKY_ROWS];
    float density[SUNSKY_ROWS][SUNSKY_COLUMNS]; // per solid angle, of these
    float mean;                 // luminance over the sphere
    float radius;               // of the scene
};

// light_type.sample_wide
wide_mask sunsky_aim_wide(const void *data, const struct wide3 *p, const wide u[2],
                          struct light_samples *s);
