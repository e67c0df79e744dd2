// SPDX-License-Identifier: Apache-2.0
#include "help_materials.h"

#include <stdio.h>
#include <string.h>

#include "base/registry.h"
#include "math/ior.h"
#include "medium/named.h"

static void print_conductor(const char *name) {
    spectrum eta, k;
    ior_conductor_find(name, &eta, &k);
    printf("  %-18s%8.4f %8.4f %8.4f   %8.4f %8.4f %8.4f\n", name, (double)eta[0], (double)eta[1],
           (double)eta[2], (double)k[0], (double)k[1], (double)k[2]);
}

static void print_dielectric(const char *name) {
    float ior;
    ior_dielectric_find(name, &ior);
    printf("  %-28s%.6g\n", name, (double)ior);
}

static void print_medium(const char *name) {
    struct medium_point c;
    float g;
    named_medium_find(name, (struct where){0}, &c, &g);
    const spectrum a = c.sigma_t - c.sigma_s;
    printf("  %-28s%9.5g %9.5g %9.5g  %9.5g %9.5g %9.5g  %5.3f\n", name, (double)c.sigma_s[0],
           (double)c.sigma_s[1], (double)c.sigma_s[2], (double)a[0], (double)a[1], (double)a[2],
           (double)g);
}

void help_list_materials(void) {
    printf("Values of int_ior and ext_ior (dielectrics):\n\n");
    for (size_t i = 0; ior_dielectric_name(i); i++)
        print_dielectric(ior_dielectric_name(i));
    printf("\nValues of material (metals), eta and k in linear Rec.709; none reflects all:\n\n");
    for (size_t i = 0; ior_conductor_name(i); i++)
        print_conductor(ior_conductor_name(i));
    printf("\nValues of material (homogeneous media), sigma_s and sigma_a in 1/mm, mean cosine:\n\n");
    for (size_t i = 0; named_medium_name(i); i++)
        print_medium(named_medium_name(i));
}

bool help_material(const char *name) {
    spectrum eta, k;
    float ior;
    const bool metal = ior_conductor_find(name, &eta, &k), glass = ior_dielectric_find(name, &ior);
    if (metal)
        printf("material=\"%s\", a metal: eta and k in linear Rec.709\n\n", name);
    if (metal)
        print_conductor(name);
    if (glass)
        printf("int_ior or ext_ior=\"%s\"\n\n", name);
    if (glass)
        print_dielectric(name);
    return metal || glass;
}

const char *help_nearest_material(const char *name) {
    const char *nearest = NULL;
    int best = 1 + (int)strlen(name) / 3; // as near as that, else it is another word
    for (int metals = 0; metals < 2; metals++) {
        const char *(*at)(size_t) = metals ? ior_conductor_name : ior_dielectric_name;
        for (size_t i = 0; at(i); i++)
            if (edit_distance(name, at(i)) <= best) {
                best = edit_distance(name, at(i)) - 1;
                nearest = at(i);
            }
    }
    return nearest;
}
