// SPDX-License-Identifier: Apache-2.0
// What convergence.c and convergence_mirror.c share: the points that light is looked for at, and what
// of each light was found there. Energies are luminances of irradiance, summed over points and
// CONVERGENCE_LIGHT_SAMPLES samples of a light at each.
#pragma once

#include "world/world.h"

enum {
    CONVERGENCE_MOST_POINTS = 512,
    CONVERGENCE_LIGHT_SAMPLES = 4,
    CONVERGENCE_MOST_EVENTS = 32, // along a line or path
};

struct probe_point {
    vec3 p, p_error, n; // n: turned to the side that is looked at
};

// Light that few paths find.
struct hard_light {
    double energy, chance, samples; // chance: sum over the samples
};

struct tally {
    double open, easy;                   // arrives straight; by glass or mirrors, but is found
    struct hard_light through, mirrored; // glass on a straight line; at least one mirror
};

struct probe {
    const struct world *world;
    struct probe_point points[CONVERGENCE_MOST_POINTS];
    uint32_t count, lights;
    uint64_t drawn;
};

// Index of the k-th of b->lights lights that are looked at: of many, every so many.
uint32_t probe_light(const struct probe *b, uint32_t k);
// A sample of a light at p; *energy: luminance of radiance over density. false: none.
bool probe_sample_light(const struct probe *b, vec3 p, uint32_t light, struct vec2 u,
                        struct light_sample *s, double *energy);
// Whether a light is reached along a ray, and how much smooth glass there is before it.
bool probe_reaches(const struct world *w, struct ray ray, uint32_t light, int *glass);
// Counts a sample that only a ray of the material can find, if it is hard; false: it is not.
bool probe_add_hard(struct hard_light *h, const struct light_sample *s, double cosine,
                    double energy);

// What mirrors send on (convergence_mirror.c).
void probe_mirrors(const struct probe *b, struct tally *tallies);
