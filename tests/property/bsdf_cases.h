// SPDX-License-Identifier: Apache-2.0
// Parameter sets with which every material of the registry is tested, and the directions.
#pragma once

#include "make_object.h"

struct bsdf_case {
    const char *name;
    const char *overrides;
    const char *children[2]; // "NAME OVERRIDES"; NULL: none
    float eta;               // index inside over outside where light crosses; 0: 1
    float tolerance;         // relative, of pdf and weight between sample and eval; 0: 2e-3
};

// A half vector found from two directions in single precision is wrong by about 1e-7 / cos: this
// decides the tolerances of nearly smooth materials.
static const struct bsdf_case bsdf_cases[] = {
    {"diffuse", ""},
    {"diffuse", "reflectance=1,0.5,0"},
    {"conductor", ""},
    {"conductor", "eta=0.2,0.9,1.1 k=3.9,2.4,2.1"},
    {"roughconductor", "alpha=0.001 distribution=ggx", .tolerance = 0.2f},
    {"roughconductor", "alpha=0.0002 distribution=beckmann", .tolerance = 1},
    {"roughconductor", "alpha=0.00009"},
    {"roughconductor", "alpha=0.02 distribution=beckmann", .tolerance = 0.02f},
    {"roughconductor", "alpha=0.1 distribution=ggx eta=0.2,0.9,1.1 k=3.9,2.4,2.1"},
    {"roughconductor", "alpha=0.1 distribution=beckmann"},
    {"roughconductor", "alpha=0.5 distribution=ggx"},
    {"roughconductor", "alpha=0.5 distribution=beckmann"},
    {"roughconductor", "alpha=1 distribution=ggx specular_reflectance=0.9,0.5,0.1"},
    {"roughconductor", "alpha=1 distribution=beckmann"},
    {"roughconductor", "alpha_u=0.05 alpha_v=0.4 distribution=ggx"},
    {"roughconductor", "alpha_u=0.3 alpha_v=0.05 distribution=beckmann"},
    {"roughconductor", "alpha_u=0.03 alpha_v=0.8 distribution=ggx", .tolerance = 0.02f},
    {"dielectric", "", .eta = 1.5046f / 1.000277f},
    {"dielectric", "int_ior=1 ext_ior=1"},
    {"dielectric", "int_ior=1 ext_ior=1.8", .eta = 1 / 1.8f},
    {"thindielectric", ""},
    {"thindielectric", "int_ior=1 ext_ior=1"},
    {"roughdielectric", "alpha=0.02", .eta = 1.5046f / 1.000277f, .tolerance = 0.02f},
    {"roughdielectric", "alpha=0.1 distribution=ggx", .eta = 1.5046f / 1.000277f,
     .tolerance = 0.02f},
    {"roughdielectric", "alpha=0.5", .eta = 1.5046f / 1.000277f, .tolerance = 0.02f},
    {"roughdielectric", "alpha=1 distribution=ggx", .eta = 1.5046f / 1.000277f, .tolerance = 0.02f},
    {"roughdielectric", "alpha_u=0.4 alpha_v=0.1 distribution=ggx int_ior=1 ext_ior=1.5",
     .eta = 1 / 1.5f, .tolerance = 0.02f},
    {"roughdielectric", "alpha=0.3 distribution=ggx int_ior=2.4 ext_ior=1", .eta = 2.4f,
     .tolerance = 0.02f},
    {"roughdielectric", "alpha=0.2 distribution=ggx int_ior=1.05 ext_ior=1", .eta = 1.05f,
     .tolerance = 0.02f},
    {"roughdielectric", "alpha=0.2 int_ior=1.3 ext_ior=1.3"},
    {"plastic", ""},
    {"plastic", "diffuse_reflectance=0.9,0.5,0.1 nonlinear=true int_ior=1.9"},
    {"plastic", "diffuse_reflectance=1"},
    {"plastic", "diffuse_reflectance=0"},
    {"roughplastic", "alpha=0.01 distribution=ggx", .tolerance = 0.02f},
    {"roughplastic", "alpha=0.1"},
    {"roughplastic", "alpha=0.3 distribution=ggx diffuse_reflectance=0.9,0.5,0.1 nonlinear=true"},
    {"roughplastic", "alpha=1 distribution=ggx"},
    {"roughplastic", "alpha=0.00005"},
    {"twosided", "", {"diffuse reflectance=0.8"}},
    {"twosided", "", {"roughconductor alpha=0.2", "plastic"}},
    {"mask", "opacity=0.3", {"diffuse"}},
    {"mask", "opacity=0.6", {"roughdielectric alpha=0.3"}, .eta = 1.5046f / 1.000277f},
    {"mask", "opacity=0", {"diffuse"}},
    {"mask", "opacity=1", {"plastic"}},
    {"blendbsdf", "weight=0.3", {"diffuse", "roughconductor alpha=0.1"}},
    {"blendbsdf", "weight=0.7", {"plastic", "dielectric"}, .eta = 1.5046f / 1.000277f},
    {"blendbsdf", "weight=0.5", {"roughplastic alpha=0.2", "null"}},
    {"bumpmap", "texture=0", {"diffuse"}},
    {"normalmap", "normalmap=0.7,0.4,0.9", {"roughconductor alpha=0.3 distribution=ggx"}},
    {"normalmap", "normalmap=0.9,0.5,0.6", {"diffuse"}},
    {"normalmap", "normalmap=0.6,0.6,0.9 use_shadowing_function=false",
     {"roughdielectric alpha=0.3"}, .eta = 1.5046f / 1.000277f},
    {"null", ""},
};

enum { BSDF_CASES = sizeof bsdf_cases / sizeof *bsdf_cases, BSDF_DIRECTIONS = 20 };

static inline struct object *bsdf_case_child(struct arena *arena, const char *text) {
    char name[64];
    size_t n = 0;
    while (text[n] && text[n] != ' ' && n + 1 < sizeof name)
        n++;
    for (size_t i = 0; i < n; i++)
        name[i] = text[i];
    name[n] = '\0';
    return make_bsdf(arena, name, text + n, NULL);
}

static inline struct object *bsdf_case_make(struct arena *arena, const struct bsdf_case *c) {
    const struct object *children[3] = {NULL, NULL, NULL};
    for (int i = 0; i < 2 && c->children[i]; i++)
        children[i] = bsdf_case_child(arena, c->children[i]);
    return make_bsdf(arena, c->name, c->overrides, children);
}

// Ten angles from 1 to 89 degrees on either side of the surface, in various azimuths.
static inline vec3 bsdf_direction(int i) {
    static const float degrees[10] = {1, 12, 27, 40, 52, 63, 72, 80, 86, 89};
    const float theta = degrees[i % 10] * (PI / 180), phi = 2.4f * (float)i;
    return v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi),
              i < 10 ? cosf(theta) : -cosf(theta));
}

static inline struct bsdf_point bsdf_case_point(void) {
    struct bsdf_point p = {.at = {.uv = {0.3f, 0.6f}}};
    p.frame = (struct frame){v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)};
    p.dpdu = v3(1, 0, 0);
    p.dpdv = v3(0, 1, 0);
    return p;
}
