// SPDX-License-Identifier: Apache-2.0
// Shares of WIDE_LANES triangles at once against those of one (unit/overlap has these against points), and
// matrices against the vectors of their curves.
#include "integrator/wide_overlap.h"

#include <string.h>

#include "check.h"
#include "integrator/wide_angles.h"
#include "triangles.h"

enum { MOST = 128 };

// As many whatever the lanes, so that all builds see the same.
enum { TRIANGLES = 16 };

// Triangles above the surface, a quarter of them around the mirror direction.
static void make_triangles(const double wo[3], double size, struct overlap_triangle t[TRIANGLES]) {
    for (int i = 0; i < TRIANGLES; i++) {
        double middle[3], corner[3][3];
        unit(middle);
        middle[2] = fabs(middle[2]);
        if (i % 4 == 0)
            memcpy(middle, (double[3]){-wo[0], -wo[1], wo[2]}, sizeof middle);
        make_triangle(middle, size, corner);
        overlap_triangle_make(&t[i], corner);
    }
}

static const double light[OVERLAP_CHANNELS] = {1, 0, 2};

// Of one of the triangles, beside its neighbours.
static void shares_of(struct wide_overlap *o, const double wo[3], const struct overlap_triangle *all,
                      uint32_t which, size_t count) {
    const uint32_t lane = which % WIDE_LANES;
    const struct overlap_triangle *t = &all[which - lane];
    struct wide_nodes n;
    struct wide_fit fit[OVERLAP_AXES];
    wide gamma[OVERLAP_AXES][OVERLAP_NODES];
    memcpy(o->scalar.wo, wo, sizeof o->scalar.wo);
    memset(o->scalar.sums, 0, count * 3 * sizeof *o->scalar.sums);
    for (int k = 0; k < OVERLAP_NODES; k++)
        for (int i = 0; i < WIDE_LANES; i++)
            wide3_set_lane(&n.node[k], i, v3((float)t[i].node[k][0], (float)t[i].node[k][1],
                                             (float)t[i].node[k][2]));
    for (int k = 0; k < FIT_COARSE; k++)
        for (int i = 0; i < WIDE_LANES; i++)
            n.part[k][i] = (float)t[i].part[k];
    n.tolerance = wide_of((float)o->scalar.tolerance);
    for (uint32_t x = 0; x < o->scalar.axes; x++)
        for (int k = 0; k < OVERLAP_NODES; k++)
            gamma[x][k] = wide_gamma(&o->axis[x].axis->gamma, (struct direction){wo[0], wo[1], wo[2]},
                                     &n.node[k]);
    wide_overlap_fit(o, &n, gamma, fit);
    wide_overlap_add(o, fit, &n, lane, &t[lane], light);
}

static void exact_shares(struct overlap *o, const double wo[3], const struct overlap_triangle *t,
                         size_t count) {
    double gamma[OVERLAP_AXES][OVERLAP_NODES];
    memcpy(o->wo, wo, sizeof o->wo);
    memset(o->sums, 0, count * 3 * sizeof *o->sums);
    for (int i = 0; i < OVERLAP_NODES; i++) {
        struct angles a = angles_make(wo, t->node[i]);
        for (uint32_t x = 0; x < o->axes; x++)
            gamma[x][i] = overlap_gamma(&o->axis[x].gamma, &a);
    }
    overlap_add(o, t, gamma, light);
}

static const enum gamma_kind kinds[] = {GAMMA_THETA_H, GAMMA_THETA_D, GAMMA_THETA_I, GAMMA_THETA_R,
                                        GAMMA_POWER_U, GAMMA_POWER_V, GAMMA_RATIO, GAMMA_SLOPE_U,
                                        GAMMA_SLOPE_V};
enum { KINDS = sizeof kinds / sizeof *kinds };

struct bench {
    struct arena arena;
    double *sums, *expected;
};

static void make_overlap(struct bench *b, struct wide_overlap *o, const struct gamma *g0,
                         const struct gamma *g1, const struct basis basis[2], double tolerance) {
    const struct gamma *const g[2] = {g0, g1};
    const struct basis *const both[2] = {&basis[0], &basis[1]};
    wide_overlap_init(o, g, both, g1 ? 2 : 1, &b->arena);
    o->scalar.sums = b->sums;
    o->scalar.tolerance = tolerance;
}

static void wo_of(double wo[3]) {
    unit(wo);
    wo[2] = fabs(wo[2]) + 0.05;
    normalise(wo);
}

// Mean and largest error of shares, triangles of 0.6 to 12 degrees.
static void agrees_with_one(struct bench *b, enum basis_kind kind, uint32_t bins) {
    for (int k = 0; k < KINDS; k++) {
        double mean = 0, largest = 0, sums = 0;
        int shares = 0;
        for (int n = 0; n < 40; n++) {
            const struct gamma gamma = {kinds[k], 50};
            const struct basis basis[2] = {
                basis_make(&b->arena, kind, bins, n % 3 ? SPACING_UNIFORM : SPACING_QUADRATIC)};
            struct overlap_triangle t[TRIANGLES];
            struct wide_overlap o;
            double wo[3], sum = 0;
            const uint32_t which = (uint32_t)n % TRIANGLES;
            make_overlap(b, &o, &gamma, NULL, basis, 1e-3);
            wo_of(wo);
            make_triangles(wo, 0.01 + (n % 4 ? 0.05 : 0.2) * uniform(), t);
            shares_of(&o, wo, t, which, bins);
            o.scalar.sums = b->expected;
            o.scalar.tolerance = 1e-5;
            exact_shares(&o.scalar, wo, &t[which], bins);
            for (uint32_t j = 0; j < bins; j++) {
                const double e = fabs(b->sums[3 * j] - b->expected[3 * j]);
                sum += b->sums[3 * j];
                CHECK(b->sums[3 * j] >= 0 && b->sums[3 * j + 1] == 0);
                mean += e;
                largest = fmax(largest, e);
                shares += b->expected[3 * j] > 0;
            }
            sums = fmax(sums, kinds[k] == GAMMA_THETA_R ? 0 : fabs(sum - 1));
            arena_finish(&b->arena);
        }
        printf("%-8s %s %3u: %4d shares, mean error %.1e, largest %.1e, sums %.1e off\n",
               gamma_names[kinds[k]], kind == BASIS_HAT ? "hat" : "box", bins, shares, mean / shares,
               largest, sums);
        CHECK(mean / shares <= 1e-3 && largest <= 1e-2 && sums < 2e-6);
    }
}

// A sum over one curve of a matrix is the vector of the other.
static void sums_to_vectors(struct bench *b, enum basis_kind kind) {
    static const enum gamma_kind pairs[][2] = {{GAMMA_THETA_H, GAMMA_THETA_D},
                                               {GAMMA_POWER_U, GAMMA_POWER_V}};
    enum { ROWS = 64, COLUMNS = 32 };
    double worst = 0;
    for (int n = 0; n < 400; n++) {
        const struct gamma g[2] = {{pairs[n % 2][0], 0}, {pairs[n % 2][1], 0}};
        const struct basis basis[2] = {basis_make(&b->arena, kind, ROWS, SPACING_UNIFORM),
                                       basis_make(&b->arena, kind, COLUMNS, SPACING_UNIFORM)};
        struct overlap_triangle t[TRIANGLES];
        struct wide_overlap o;
        double wo[3], sum[2][ROWS] = {{0}};
        const uint32_t which = (uint32_t)n % TRIANGLES;
        wo_of(wo);
        make_triangles(wo, 0.01 + (n % 4 ? 0.05 : 0.8) * uniform(), t);
        const double tolerance = n % 3 ? 1e-3 : 1e-2;
        make_overlap(b, &o, &g[0], &g[1], basis, tolerance);
        shares_of(&o, wo, t, which, ROWS * COLUMNS);
        for (int i = 0; i < ROWS * COLUMNS; i++) {
            sum[0][i / COLUMNS] += b->sums[3 * i];
            sum[1][i % COLUMNS] += b->sums[3 * i];
        }
        for (int x = 0; x < 2; x++) {
            const uint32_t count = x ? COLUMNS : ROWS;
            make_overlap(b, &o, &g[x], NULL, &basis[x], tolerance);
            shares_of(&o, wo, t, which, count);
            for (uint32_t j = 0; j < count; j++)
                worst = fmax(worst, fabs(sum[x][j] - b->sums[3 * j]));
        }
        arena_finish(&b->arena);
    }
    printf("sums of matrices of %s: %.1e off\n", kind == BASIS_HAT ? "hats" : "boxes", worst);
    CHECK(worst < 2e-6);
}

int main(void) {
    struct bench b = {.sums = mem_array(MOST * MOST * 3 + WIDE_OVERLAP_SPARE, sizeof(double)),
                      .expected = mem_array(MOST * MOST * 3 + WIDE_OVERLAP_SPARE, sizeof(double))};
    state = 7;
    agrees_with_one(&b, BASIS_BOX, 128);
    agrees_with_one(&b, BASIS_BOX, 16);
    agrees_with_one(&b, BASIS_HAT, 128);
    sums_to_vectors(&b, BASIS_BOX);
    sums_to_vectors(&b, BASIS_HAT);
    mem_free(b.sums);
    mem_free(b.expected);
    return check_result();
}
