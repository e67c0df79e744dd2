// SPDX-License-Identifier: Apache-2.0
// Directional albedo errors: what materials make of uniform light of radiance 1 when all their
// colours are white, as tables (tests/README.md shows them). A material that neither loses nor
// creates energy returns 1 to every direction.
//
// Mean weights of 2^17 samples of a rank-1 lattice (Roberts 2018, The Unreasonable Effectiveness of
// Quasirandom Sequences), twice with different shifts; the difference is the accuracy and checked.
// Arguments are names of materials, all of which are shown without, those read from files excepted;
// "furnace" shows the second table, single against compensated.
#include <stdio.h>
#include <string.h>

#include "check.h"
#include "property/bsdf_cases.h"

struct white {
    const char *name, *overrides;
    const char *children[2];
    bool creates; // energy, with these parameters, although the material may claim not to
};

static const struct white whites[] = {
#include "property/bsdf_whites.inc"
};

enum { WHITES = sizeof whites / sizeof *whites, ANGLES = 6, ALPHAS = 5, SAMPLES = 1 << 17 };

static const float degrees[ANGLES] = {1, 30, 60, 75, 85, 89};

static float lattice(int i, int dimension, float shift) {
    static const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    const double x = shift + i * step[dimension];
    return minf((float)(x - floor(x)), 0x1.fffffep-1f);
}

static double mean_weight(const struct closure *c, float shift, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        struct bsdf_sample s;
        const struct vec2 u = {lattice(i, 0, shift), lattice(i, 1, shift)};
        if (closure_sample(c, lattice(i, 2, shift), u, &s))
            sum += (double)(spectrum_mean(s.weight) * sqr(s.eta));
    }
    return sum / n;
}

struct albedos {
    double value[ANGLES];    // from outside
    double low, high;        // of both sides, where anything is scattered
    double accuracy;
    double worst_estimate;   // of the material's own estimate, relative to 1
};

static void measure_direction(const struct object *o, int angle, bool inside, struct albedos *a) {
    static struct closure_stack stack;
    const struct bsdf_point point = bsdf_case_point();
    const float theta = degrees[angle] * (PI / 180), phi = 0.7f;
    stack.used = 0;
    const struct closure *c = bsdf_resolve(
        o, &point, v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi),
                      inside ? -cosf(theta) : cosf(theta)), &stack);
    if (!c)
        return;
    const double x = mean_weight(c, 0.1f, SAMPLES), y = mean_weight(c, 0.6f, SAMPLES);
    const double e = 0.5 * (x + y);
    if (!inside)
        a->value[angle] = e;
    a->low = fmin(a->low, e);
    a->high = fmax(a->high, e);
    a->accuracy = fmax(a->accuracy, fabs(x - y) / fmax(e, 1));
    const double estimate = (double)spectrum_mean(closure_albedo(c));
    if (fabs(estimate - e) > fabs(a->worst_estimate))
        a->worst_estimate = estimate - e;
}

static struct albedos measure(const struct object *o) {
    struct albedos a = {.low = 1e9};
    for (int i = 0; i < 2 * ANGLES; i++)
        measure_direction(o, i % ANGLES, i >= ANGLES, &a);
    return a;
}

static struct albedos measure_white(const struct white *w) {
    struct arena arena = {0};
    const struct bsdf_case c = {w->name, w->overrides, {w->children[0], w->children[1]}};
    const struct object *o = bsdf_case_make(&arena, &c);
    const struct albedos a = measure(o);
    CHECK(a.accuracy < 1e-2 * fmax(1, a.high));
    if (bsdf_type_of(o)->claims & CLAIM_ENERGY && !w->creates)
        CHECK(a.high <= 1 + 5e-4);
    arena_finish(&arena);
    return a;
}

static void print_row(const struct white *w, const struct albedos *a) {
    printf("| %s | %s%s%s |", w->name, w->overrides, w->children[0] ? " over " : "",
           w->children[0] ? w->children[0] : "");
    for (int i = 0; i < ANGLES; i++)
        printf(" %.4f |", a->value[i]);
    printf(" %+.4f | %+.4f | %+.3f |\n", a->low - 1, a->high - 1, a->worst_estimate);
}

static void print_whites(int argc, char **argv) {
    printf("| material | white parameters |");
    for (int i = 0; i < ANGLES; i++)
        printf(" %g° |", (double)degrees[i]);
    printf(" lowest - 1 | highest - 1 | estimate - albedo |\n|---|---|");
    for (int i = 0; i < ANGLES + 3; i++)
        printf("---:|");
    printf("\n");
    for (int i = 0; i < WHITES; i++) {
        if (!bsdf_is_asked(argc, argv, whites[i].name))
            continue;
        const struct albedos a = measure_white(&whites[i]);
        print_row(&whites[i], &a);
    }
}

static void every_entry_has_a_row(void) {
    for (const struct entry *const *e = bsdfs.entries; *e; e++) {
        bool found = false;
        for (int i = 0; i < WHITES; i++)
            found = found || strcmp(whites[i].name, (*e)->name) == 0;
        for (const struct param *p = (*e)->params; p && p->name; p++)
            found = found || (p->type == PARAM_FILE && !p->optional && !p->def);
        if (!found)
            printf("%s: no row in property/bsdf_whites.inc\n", (*e)->name);
        CHECK(found);
    }
}

// ---- single against compensated -------------------------------------------------------------

static const char *const rough[] = {
    "roughconductor",
    "roughdielectric int_ior=1.1 ext_ior=1", "roughdielectric int_ior=1.5 ext_ior=1",
    "roughdielectric int_ior=2.5 ext_ior=1",
    "roughplastic int_ior=1.5 ext_ior=1 diffuse_reflectance=1 nonlinear=true",
    "roughplastic int_ior=2.5 ext_ior=1 diffuse_reflectance=1 nonlinear=true",
};

static const struct object *make_rough(struct arena *arena, const char *text,
                                       const char *distribution, float alpha, const char *energy) {
    char name[64];
    bsdf_first_word(text, name, sizeof name);
    return make_bsdf(arena, name,
                     arena_printf(arena, "%s distribution=%s alpha=%g energy=%s",
                                  text + strlen(name), distribution, (double)alpha, energy),
                     NULL);
}

// Largest departure from 1 over all directions.
static double furnace(const char *text, const char *distribution, float alpha, const char *energy,
                      double *accuracy) {
    struct arena arena = {0};
    const struct albedos a = measure(make_rough(&arena, text, distribution, alpha, energy));
    arena_finish(&arena);
    *accuracy = fmax(*accuracy, a.accuracy);
    return fabs(a.low - 1) > fabs(a.high - 1) ? a.low - 1 : a.high - 1;
}

static void print_furnace(void) {
    static const float alphas[ALPHAS] = {0.05f, 0.1f, 0.2f, 0.5f, 1};
    double noise = 0;
    printf("| material | distribution |");
    for (int i = 0; i < ALPHAS; i++)
        printf(" %g |", (double)alphas[i]);
    printf("\n|---|---|---:|---:|---:|---:|---:|\n");
    for (int k = 0; k < 2 * (int)(sizeof rough / sizeof *rough); k++) {
        const char *const distribution = k % 2 ? "ggx" : "beckmann";
        printf("| %s | %s |", rough[k / 2], distribution);
        for (int i = 0; i < ALPHAS; i++) {
            const double before = furnace(rough[k / 2], distribution, alphas[i], "single", &noise);
            const double after =
                furnace(rough[k / 2], distribution, alphas[i], "compensated", &noise);
            printf(" %+.3f %+.5f |", before, after);
            CHECK(after < 5e-4 && after > (strstr(rough[k / 2], "dielectric") ? -6e-3 : -1e-3));
        }
        printf("\n");
    }
    printf("\nThe means are right to %.0e.\n", noise);
}

int main(int argc, char **argv) {
    if (argc < 2)
        every_entry_has_a_row();
    if (argc > 1 && strcmp(argv[1], "furnace") == 0)
        print_furnace();
    else
        print_whites(argc, argv);
    return check_result();
}
