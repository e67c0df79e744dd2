// SPDX-License-Identifier: Apache-2.0
#include "math/ior.h"

#include <string.h>
#include <strings.h>

#include "base/registry.h"
#include "math/ior_table.h"

enum {
    CONDUCTORS = sizeof conductors / sizeof *conductors,
    DIELECTRICS = sizeof dielectrics / sizeof *dielectrics,
};

bool ior_conductor_find(const char *name, spectrum *eta, spectrum *k) {
    if (strcmp(name, "none") == 0) {
        *eta = spectrum_grey(0);
        *k = spectrum_grey(1);
        return true;
    }
    for (int i = 0; i < CONDUCTORS; i++)
        if (strcmp(conductors[i].name, name) == 0) {
            const float *e = conductors[i].eta, *c = conductors[i].k;
            *eta = spectrum_rgb(e[0], e[1], e[2]);
            *k = spectrum_rgb(c[0], c[1], c[2]);
            return true;
        }
    return false;
}

const char *ior_conductor_name(size_t i) {
    return i < CONDUCTORS ? conductors[i].name : NULL;
}

const char *ior_conductor_nearest(const char *name) {
    const char *nearest = NULL;
    int best = 1 << 20;
    for (int i = 0; i < CONDUCTORS; i++) {
        if (strcasecmp(conductors[i].name, name) == 0)
            return conductors[i].name;
        name_consider(conductors[i].name, conductors[i].name, name, &best, &nearest);
    }
    return nearest;
}

bool ior_dielectric_find(const char *name, float *ior) {
    for (int i = 0; i < DIELECTRICS; i++)
        if (strcmp(dielectrics[i].name, name) == 0) {
            *ior = dielectrics[i].ior;
            return true;
        }
    return false;
}

const char *ior_dielectric_name(size_t i) {
    return i < DIELECTRICS ? dielectrics[i].name : NULL;
}
