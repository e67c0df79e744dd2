// SPDX-License-Identifier: Apache-2.0
// Tables of what facets lose: against direct quadrature between their nodes, for one roughness, an
// anisotropic one and all of them; their lobe has the albedo they say, and its directions the
// density they claim.
#include "bsdf/facet_loss.h"

#include "check.h"
#include "math/hash.h"
#include "math/microfacet.h"

static double mirror(const void *context, float alpha_u, float alpha_v, vec3 v, int nodes) {
    const struct microfacet m = microfacet_make(MICROFACET_GGX, alpha_u, alpha_v);
    (void)context;
    return microfacet_albedo_mirror(&m, v, nodes);
}

static vec3 direction(double cosine, double phi) {
    const double r = sqrt(1 - cosine * cosine);
    return v3((float)(r * cos(phi)), (float)(r * sin(phi)), (float)cosine);
}

// Largest difference to quadrature with many nodes.
static double table_error(const struct facet_loss_at *at, float alpha_u, float alpha_v) {
    struct rng rng = {3};
    double worst = 0;
    for (int i = 0; i < 40; i++) {
        const double s = (double)rng_float(&rng), phi = 2 * M_PI * (double)rng_float(&rng);
        const vec3 v = direction(s * s, phi);
        const double exact = 1 - mirror(NULL, alpha_u, alpha_v, v, 200);
        worst = fmax(worst, fabs((double)facet_lost(at, v) - exact));
    }
    return worst;
}

// 1 / (pi mean) * integral of lost cos, and integral of the sampling density: both 1.
static void check_integrals(const struct facet_loss_at *at) {
    enum { COSINES = 2560, AZIMUTHS = 64 };
    double lost = 0, pdf = 0;
    for (int i = 0; i < COSINES; i++) {
        for (int j = 0; j < AZIMUTHS; j++) {
            const double s = (i + 0.5) / COSINES, cosine = s * s;
            const vec3 v = direction(cosine, 2 * M_PI * (j + 0.5) / AZIMUTHS);
            const double solid_angle = 2 * s / COSINES * 2 * M_PI / AZIMUTHS;
            lost += (double)facet_lost(at, v) * cosine * solid_angle;
            pdf += (double)facet_loss_pdf_sa(at, v) * solid_angle;
        }
    }
    CHECK_NEAR(lost / (M_PI * (double)at->mean), 1, 2e-4);
    CHECK_NEAR(pdf, 1, 2e-4);
}

// Cosines below a limit come as often as the density says: binomial, 4.4 standard errors each (1e-5
// false alarms).
static void check_samples(const struct facet_loss_at *at) {
    enum { N = 100000, LIMITS = 5, CELLS = 12800 };
    int below[LIMITS] = {0};
    struct rng rng = {8};
    for (int i = 0; i < N; i++) {
        const float u = rng_float(&rng), w = rng_float(&rng);
        const vec3 v = facet_loss_sample(at, (struct vec2){u, w});
        CHECK(v[2] >= 0 && fabsf(length(v) - 1) < 1e-5f);
        for (int k = 0; k < LIMITS; k++)
            below[k] += v[2] < 0.1f + 0.2f * (float)k;
    }
    for (int k = 0; k < LIMITS; k++) {
        double p = 0;
        const double top = sqrt(0.1 + 0.2 * k);
        for (int i = 0; i < CELLS; i++) {
            const double s = top * (i + 0.5) / CELLS, cosines = 2 * s * top / CELLS;
            p += 2 * M_PI * (double)facet_loss_pdf_sa(at, direction(s * s, 0)) * cosines;
        }
        CHECK_NEAR((double)below[k] / N, p, 4.4 * sqrt(fmax(p * (1 - p), 1e-5) / N));
    }
}

static void one_roughness_is_tabulated(void) {
    static const float alphas[][2] = {{0.1f, 0.1f}, {0.5f, 0.5f}, {1, 1}, {0.1f, 0.6f}};
    for (int i = 0; i < 4; i++) {
        struct arena arena = {0};
        struct facet_loss loss;
        facet_loss_make(&loss, alphas[i][0], alphas[i][1], mirror, NULL, &arena);
        const struct facet_loss_at at = facet_loss_at(&loss, alphas[i][0]);
        const double error = table_error(&at, alphas[i][0], alphas[i][1]);
        printf("alpha %g, %g: mean loss %.4f, error %.5f\n", (double)alphas[i][0],
               (double)alphas[i][1], (double)at.mean, error);
        CHECK(error < (i < 3 ? 6e-4 : 2e-3));
        check_integrals(&at);
        check_samples(&at);
        arena_finish(&arena);
    }
}

static void all_roughnesses_are_tabulated(void) {
    static const float alphas[] = {0.03f, 0.1f, 0.25f, 0.5f, 0.9f, 2};
    struct arena arena = {0};
    struct facet_loss loss;
    facet_loss_make_all(&loss, mirror, NULL, &arena);
    for (int i = 0; i < 6; i++) {
        const struct facet_loss_at at = facet_loss_at(&loss, alphas[i]);
        const double error = table_error(&at, alphas[i], alphas[i]);
        printf("alpha %g of all: mean loss %.4f, error %.5f\n", (double)alphas[i],
               (double)at.mean, error);
        CHECK(error < 3e-3);
        check_integrals(&at);
        check_samples(&at);
    }
    arena_finish(&arena);
}

// n1^2 mean1 share12 = n2^2 mean2 share21; neither transmits more than the smooth boundary.
static void shares_keep_detailed_balance(void) {
    for (int i = 0; i < 8; i++) {
        const float eta = 0.4f + 0.3f * (float)i, mean1 = 0.02f * (float)(i + 1), mean2 = 0.1f;
        float share12, share21;
        facet_loss_share(eta, mean1, mean2, &share12, &share21);
        CHECK_NEAR(mean1 * share12, eta * eta * mean2 * share21, 1e-6);
        CHECK(share12 >= 0 && share12 <= 1 && share21 >= 0 && share21 <= 1);
    }
}

int main(void) {
    one_roughness_is_tabulated();
    all_roughnesses_are_tabulated();
    shares_keep_detailed_balance();
    return check_result();
}
