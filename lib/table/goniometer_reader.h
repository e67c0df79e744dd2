// SPDX-License-Identifier: Apache-2.0
// What the readers of goniometer files share; for files of table/ only.
#pragma once

#include "table/goniometer.h"

// A sample as a file gives it, brought to incident azimuth 0 if the material is isotropic.
struct gonio_sample {
    float theta_i, phi_i;
    vec3 out; // above the surface
    float rgb[3];
};

struct gonio_samples {
    struct gonio_sample *items; // owned
    size_t count, capacity;
    size_t invalid;
};

// Adds a sample, or counts it as invalid (not finite, negative, beyond 1e12).
void gonio_add(struct gonio_samples *s, const struct gonio_sample *sample);

// Samples of an isotropic material as a table. false after an error message: too few samples, or
// more incident angles than a list of them has.
bool gonio_resample(const char *path, const struct gonio_samples *s, struct goniometer_table *t,
                    struct arena *arena);

bool cornell_read(const char *path, char *text, struct goniometer_table *t, struct arena *arena);
bool alta_read(const char *path, char *text, struct goniometer_table *t, struct arena *arena);
bool transfer_read(const char *path, char *text, struct goniometer_table *t, struct arena *arena);

// Room for one side of the table.
float (*gonio_alloc(const struct goniometer_table *t, struct arena *arena))[3];

// Fills nodes that are negative from their neighbours in the grid of outgoing directions.
void gonio_fill(struct goniometer_table *t);
