// SPDX-License-Identifier: Apache-2.0
// What tabulating the curves of an editable material at J bins adds to its error, J from 8 to 512:
// for each model over directions around its highlight, and for Blinn-Phong under uniform light,
// where the answer is known (prints both tables).
#include <string.h>

#include "check.h"
#include "curve/model.h"
#include "math/hash.h"

enum { SIZES = 7 };

static const uint32_t sizes[SIZES] = {8, 16, 32, 64, 128, 256, 512};

static double uniform(struct rng *r) {
    return ((double)rng_u32(r) + (double)rng_float(r)) * 0x1p-32;
}

// ---- every model ----------------------------------------------------------------------------

// wo anywhere up to 80 degrees, wi mirrored at a half vector up to 40 degrees from the normal.
static void random_pair(struct rng *r, double wo[3], double wi[3]) {
    do {
        const double z = 0.17 + 0.83 * uniform(r), phi = 2 * M_PI * uniform(r);
        const double t = 0.7 * uniform(r), psi = 2 * M_PI * uniform(r);
        const double h[3] = {sin(t) * cos(psi), sin(t) * sin(psi), cos(t)};
        const double s = sqrt(1 - z * z), w[3] = {s * cos(phi), s * sin(phi), z};
        const double c = 2 * (w[0] * h[0] + w[1] * h[1] + w[2] * h[2]);
        for (int k = 0; k < 3; k++) {
            wo[k] = w[k];
            wi[k] = c * h[k] - w[k];
        }
    } while (!(wi[2] > 0.02));
}

// Root mean square difference of two forms over that of the first, all channels.
static double distance(const struct form *a, const struct form *b) {
    struct rng rng = {17};
    double top = 0, bottom = 0;
    for (int i = 0; i < 8000; i++) {
        double wo[3], wi[3], x[CURVE_CHANNELS], y[CURVE_CHANNELS];
        random_pair(&rng, wo, wi);
        form_eval(a, wo, wi, x);
        form_eval(b, wo, wi, y);
        for (int k = 0; k < CURVE_CHANNELS; k++) {
            top += (x[k] - y[k]) * (x[k] - y[k]);
            bottom += x[k] * x[k];
        }
    }
    return sqrt(top / bottom);
}

static double tabulated_distance(const struct form *form, enum basis_kind kind, uint32_t size,
                                 enum basis_spacing spacing) {
    struct arena arena = {0};
    struct form table = *form;
    const struct basis basis = basis_make(&arena, kind, size, spacing);
    for (uint32_t c = 0; c < table.curves; c++)
        form_tabulate(&table, c, &basis, form_filter(form, c), &arena);
    const double d = distance(form, &table);
    arena_finish(&arena);
    return d;
}

static void a_model_converges(const struct model *m) {
    struct arena arena = {0};
    struct model_parameters p = model_defaults;
    struct form form;
    p.exponent_u = 100;
    p.exponent_v = 200;
    p.alpha_u = 0.15;
    p.alpha_v = 0.1;
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        p.eta[k] = 0.2 + 0.4 * k;
        p.k[k] = 3.9 - k;
    }
    CHECK(model_make(m, &p, &arena, &form, "test"));
    for (int i = 0; i < 4; i++) {
        static const char *const names[] = {"box", "box, quadratic", "hat", "hat, quadratic"};
        double d[SIZES];
        for (int j = 0; j < SIZES; j++)
            d[j] = tabulated_distance(&form, i < 2 ? BASIS_BOX : BASIS_HAT, sizes[j],
                                      i % 2 ? SPACING_QUADRATIC : SPACING_UNIFORM);
        if (d[0] == 0)
            continue; // curves are constant
        printf("%-17s %-15s", m->name, names[i]);
        for (int j = 0; j < SIZES; j++)
            printf(" %8.1e", d[j]);
        printf("\n");
        CHECK(d[6] < 0.6 * d[5] && d[5] < 0.6 * d[4]); // first order
        if (i >= 2)
            CHECK(d[6] < 0.3 * d[5]); // second order
    }
    arena_finish(&arena);
}

// ---- Blinn-Phong under uniform light --------------------------------------------------------

enum { RINGS = 20000, SECTORS = 64 };

static double kernel[RINGS]; // what cos^n(theta_h) is weighted with, per radian of theta_h

// Over half vectors: d wi = 4 cos_d dh, and f cos_i = cos^n G / (4 cos_o) for wo at 30 degrees.
static void make_kernel(void) {
    const double o[3] = {0.5, 0, sqrt(0.75)};
    for (int i = 0; i < RINGS; i++) {
        const double t = CURVE_END * (i + 0.5) / RINGS, c = cos(t);
        for (int j = 0; j < SECTORS; j++) {
            const double phi = 2 * M_PI * (j + 0.5) / SECTORS;
            const double d = o[0] * sin(t) * cos(phi) + o[2] * c, z = 2 * d * c - o[2];
            const double G = fmin(1, fmin(2 * c * o[2], 2 * c * z) / d);
            if (d > 0 && z > 0)
                kernel[i] += G / o[2] * d * sin(t) * 2 * M_PI / SECTORS;
        }
    }
}

static double reflected(const struct curve *c, double n) {
    double sum = 0;
    for (int i = 0; i < RINGS; i++) {
        const double t = CURVE_END * (i + 0.5) / RINGS;
        sum += kernel[i] * (c ? curve_at(c, 0, t) : pow(cos(t), n));
    }
    return sum;
}

static double albedo_error(double n, enum basis_kind kind, uint32_t size,
                           enum curve_filter filter) {
    struct arena arena = {0};
    const struct curve_function f = {.kind = FUNCTION_COS_POWER, .p = {n}};
    const struct basis basis = basis_make(&arena, kind, size, SPACING_UNIFORM);
    struct curve c = curve_make(&arena, &basis, 1);
    function_project(&c, 0, &f, filter);
    const double e = reflected(&c, n) / reflected(NULL, n) - 1;
    arena_finish(&arena);
    return e;
}

// Errors of plain means of boxes as published with the specification of the method, in percent, for
// J = 8 to 128.
static void means_err_as_known(void) {
    static const double exponents[] = {16, 64, 200, 1024};
    static const double known[4][5] = {{3.5, 0.87, 0.22, 0.05, 0.01}, {21, 5.0, 1.2, 0.31, 0.08},
                                       {75, 16.5, 4.0, 1.0, 0.25}, {289, 97, 22, 5.2, 1.3}};
    static const struct {
        const char *name;
        enum basis_kind kind;
        enum curve_filter filter;
    } ways[] = {{"box, plain mean", BASIS_BOX, FILTER_MEAN}, {"box, sine", BASIS_BOX, FILTER_SINE},
                {"hat, sine", BASIS_HAT, FILTER_SINE}, {"hat, points", BASIS_HAT, FILTER_POINT}};
    make_kernel();
    for (int i = 0; i < 4; i++)
        for (int w = 0; w < 4; w++) {
            printf("exponent %-6g  %-16s", exponents[i], ways[w].name);
            for (int j = 0; j < SIZES; j++) {
                const double e = 100 * albedo_error(exponents[i], ways[w].kind, sizes[j],
                                                    ways[w].filter);
                printf(" %8.3f", e);
                if (w == 0 && j < 5)
                    CHECK_NEAR(e, known[i][j], 0.01 + 0.04 * known[i][j]);
                if (w == 1)
                    CHECK(fabs(e) < 2);
            }
            printf("\n");
        }
}

int main(void) {
    printf("root mean square error around the highlight, relative; J =");
    for (int j = 0; j < SIZES; j++)
        printf(" %u", sizes[j]);
    printf("\n");
    for (const struct model *const *m = models; *m; m++)
        if (strcmp((*m)->name, "freehand") != 0)
            a_model_converges(*m);
    printf("error of the light reflected from uniform surroundings to 30 degrees, percent\n");
    means_err_as_known();
    return check_result();
}
