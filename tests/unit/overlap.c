// SPDX-License-Identifier: Apache-2.0
// Shares of a spherical triangle in the functions of a curve's basis, against points spread evenly
// over the triangle.
#include "curve/overlap.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "triangles.h"

enum { MOST = 512 };

static void shares_of(struct overlap *o, const double wo[3], const double corner[3][3],
                      size_t count) {
    const double light[3] = {1, 0, 2};
    struct overlap_triangle t;
    double gamma[OVERLAP_AXES][OVERLAP_NODES];
    overlap_triangle_make(&t, corner);
    memcpy(o->wo, wo, sizeof o->wo);
    memset(o->sums, 0, count * 3 * sizeof *o->sums);
    for (int i = 0; i < OVERLAP_NODES; i++) {
        struct angles a = angles_make(wo, t.node[i]);
        for (uint32_t x = 0; x < o->axes; x++)
            gamma[x][i] = overlap_gamma(&o->axis[x].gamma, &a);
    }
    overlap_add(o, &t, gamma, light);
}

// Shares by points of a fine subdivision, weighted by the area each stands for.
static void shares_by_points(const struct overlap *o, const double wo[3], const double corner[3][3],
                             int n, double *share, size_t count) {
    double sum = 0;
    memset(share, 0, count * sizeof *share);
    for (int i = 0; i < n; i++)
        for (int j = 0; i + j < n; j++)
            for (int up = 0; up < 2 && i + j + up < n; up++) {
                const double u = (i + (up ? 2.0 : 1.0) / 3) / n, v = (j + (up ? 2.0 : 1.0) / 3) / n;
                double w[3], value[OVERLAP_AXES][2] = {{1}, {1}}, l = 0;
                uint32_t index[OVERLAP_AXES][2] = {{0}, {0}}, found[OVERLAP_AXES] = {1, 1};
                for (int k = 0; k < 3; k++) {
                    w[k] = corner[0][k] * (1 - u - v) + corner[1][k] * u + corner[2][k] * v;
                    l += w[k] * w[k];
                }
                normalise(w);
                const double part = 1 / (l * sqrt(l)); // solid angle of a plane element, its tilt apart
                struct angles a = angles_make(wo, w);
                sum += part;
                for (uint32_t x = 0; x < o->axes; x++) {
                    double g = fabs(overlap_gamma(&o->axis[x].gamma, &a));
                    const bool ends = o->axis[x].gamma.kind == GAMMA_THETA_R;
                    g = ends ? g : fmin(g, CURVE_END);
                    found[x] = basis_at(&o->axis[x].basis, g, index[x], value[x]);
                }
                for (uint32_t p = 0; p < found[0]; p++)
                    for (uint32_t q = 0; q < found[1]; q++)
                        share[index[0][p] * (o->axes > 1 ? o->axis[1].basis.count : 1) + index[1][q]] +=
                            part * value[0][p] * value[1][q];
            }
    for (size_t i = 0; i < count; i++)
        share[i] /= sum;
}

static const enum gamma_kind kinds[] = {GAMMA_THETA_H, GAMMA_THETA_D, GAMMA_THETA_I, GAMMA_THETA_R,
                                        GAMMA_POWER_U, GAMMA_POWER_V, GAMMA_RATIO, GAMMA_SLOPE_U,
                                        GAMMA_SLOPE_V};
enum { KINDS = sizeof kinds / sizeof *kinds };

// All of a triangle is dealt, for any triangle, whatever the tolerance.
static void sums_to_one(void) {
    struct arena arena = {0};
    const char *full = getenv("RELUME_TEST_FULL");
    const int count = full ? 100000 : 20000;
    double *sums = mem_array(MOST * 3, sizeof *sums), worst = 0;
    for (int n = 0; n < count; n++) {
        const struct gamma gamma = {kinds[n % KINDS], 50}, *const g[2] = {&gamma, NULL};
        const enum basis_kind kind = n / KINDS % 2 ? BASIS_HAT : BASIS_BOX;
        const struct basis b = basis_make(&arena, kind, n / 7 % 3 ? 128 : 2, n % 2 ? SPACING_UNIFORM
                                                                               : SPACING_QUADRATIC);
        const struct basis *const basis[2] = {&b, NULL};
        struct overlap o;
        double wo[3], middle[3], corner[3][3], sum = 0;
        overlap_init(&o, g, basis, 1, &arena);
        o.sums = sums;
        unit(wo);
        wo[2] = fabs(wo[2]);
        unit(middle);
        middle[2] = fabs(middle[2]) + 1e-3;
        make_triangle(middle, pow(10, -6 * uniform()), corner);
        shares_of(&o, wo, corner, b.count);
        for (uint32_t j = 0; j < b.count; j++) {
            sum += sums[3 * j];
            CHECK(sums[3 * j] >= 0 && sums[3 * j + 1] == 0 && sums[3 * j + 2] == 2 * sums[3 * j]);
        }
        if (gamma.kind != GAMMA_THETA_R)
            worst = fmax(worst, fabs(sum - 1));
        if (n % 64 == 63)
            arena_finish(&arena);
    }
    printf("shares of %d triangles: sum off 1 by at most %.2g\n", count, worst);
    CHECK(worst < 1e-6);
    arena_finish(&arena);
    mem_free(sums);
}

// Mean and largest error of shares that are not 0, triangles of 0.6 to 6 degrees, a fifth of them
// around the mirror direction.
static void agrees_with_points(enum basis_kind kind, uint32_t bins) {
    struct arena arena = {0};
    double *sums = mem_array(MOST * 3, sizeof *sums), *share = mem_array(MOST, sizeof *share);
    const int points = getenv("RELUME_TEST_FULL") ? 1000 : 120; // a side: 1e6 or 14 400 of them
    for (int k = 0; k < KINDS; k++) {
        double mean = 0, largest = 0;
        int shares = 0;
        for (int n = 0; n < 25; n++) {
            const struct gamma gamma = {kinds[k], 50}, *const g[2] = {&gamma, NULL};
            const struct basis b = basis_make(&arena, kind, bins, SPACING_UNIFORM);
            const struct basis *const basis[2] = {&b, NULL};
            struct overlap o;
            double wo[3], middle[3], corner[3][3];
            overlap_init(&o, g, basis, 1, &arena);
            o.sums = sums;
            unit(wo);
            wo[2] = fabs(wo[2]) + 0.05;
            normalise(wo);
            unit(middle);
            middle[2] = fabs(middle[2]);
            if (n % 5 == 0)
                memcpy(middle, (double[3]){-wo[0], -wo[1], wo[2]}, sizeof middle);
            make_triangle(middle, 0.01 + 0.05 * uniform(), corner);
            shares_of(&o, wo, corner, bins);
            shares_by_points(&o, wo, corner, points, share, bins);
            for (uint32_t j = 0; j < bins; j++)
                if (share[j] > 0) {
                    mean += fabs(sums[3 * j] - share[j]);
                    largest = fmax(largest, fabs(sums[3 * j] - share[j]));
                    shares++;
                }
        }
        printf("%-8s %s %3u: %4d shares, mean error %.1e, largest %.1e\n", gamma_names[kinds[k]],
               kind == BASIS_HAT ? "hat" : "box", bins, shares, mean / shares, largest);
        CHECK(mean / shares <= 2e-3 && largest <= 1e-2);
        arena_finish(&arena);
    }
    mem_free(sums);
    mem_free(share);
}

// With two curves the shares of a pair come nearer as parts are split further.
static void deals_to_pairs(void) {
    struct arena arena = {0};
    double *sums = mem_array(32 * 32 * 3, sizeof *sums), *share = mem_array(32 * 32, sizeof *share);
    double error[4] = {0};
    for (int n = 0; n < 20; n++) {
        const struct gamma u = {GAMMA_POWER_U, 0}, v = {GAMMA_POWER_V, 0}, *const g[2] = {&u, &v};
        const struct basis b = basis_make(&arena, n % 2 ? BASIS_HAT : BASIS_BOX, 32, SPACING_UNIFORM);
        const struct basis *const basis[2] = {&b, &b};
        struct overlap o;
        double wo[3], middle[3], corner[3][3];
        unit(wo);
        wo[2] = fabs(wo[2]) + 0.1;
        normalise(wo);
        unit(middle);
        middle[2] = fabs(middle[2]);
        make_triangle(middle, 0.15, corner);
        overlap_init(&o, g, basis, 2, &arena);
        o.sums = sums;
        shares_by_points(&o, wo, corner, 120, share, 32 * 32);
        for (int splits = 0; splits < 4; splits++) {
            double sum = 0;
            o.splits = splits;
            shares_of(&o, wo, corner, 32 * 32);
            for (int j = 0; j < 32 * 32; j++) {
                error[splits] += fabs(sums[3 * j] - share[j]) / 20;
                sum += sums[3 * j];
            }
            CHECK_NEAR(sum, 1, 1e-6);
        }
        arena_finish(&arena);
    }
    printf("pairs: share in the wrong place %.3g, %.3g, %.3g, %.3g with 0 to 3 splits\n", error[0] / 2,
           error[1] / 2, error[2] / 2, error[3] / 2);
    CHECK(error[1] < error[0] && error[2] < error[1] && error[3] < 0.05);
    mem_free(sums);
    mem_free(share);
}

int main(void) {
    sums_to_one();
    agrees_with_points(BASIS_BOX, 256);
    agrees_with_points(BASIS_BOX, 16);
    agrees_with_points(BASIS_HAT, 128);
    deals_to_pairs();
    return check_result();
}
