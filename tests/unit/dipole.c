// SPDX-License-Identifier: Apache-2.0
// The dipole's profile against its closed form, and its sampling against its density.
#include "math/dipole.h"

#include <string.h>

#include "check.h"
#include "math/fresnel.h"
#include "math/quadrature.h"
#include "statistics.h"

static const double FALSE_ALARMS = 1e-3;

// Reduced coefficients; the last lane does not scatter at all.
static const struct test_case {
    const char *name;
    float sigma_s[3], sigma_a[3];
} cases[] = {
    {"skim milk", {700, 1220, 1900}, {1.4f, 2.5f, 14.2f}},
    {"ketchup", {180, 70, 30}, {61, 970, 1450}},
    {"nothing absorbed", {1, 100, 1e4f}, {0, 0, 0}},
    {"hardly scatters", {1e-3f, 1, 0}, {1, 1e-4f, 1}},
    {"small and large", {1e12f, 1e-6f, 1}, {1e11f, 1e-6f, 1e-9f}},
};
enum { CASES = sizeof cases / sizeof *cases };

static struct dipole make(const struct test_case *c, float eta, enum dipole_model model) {
    return dipole_make(spectrum_rgb(c->sigma_s[0], c->sigma_s[1], c->sigma_s[2]),
                       spectrum_rgb(c->sigma_a[0], c->sigma_a[1], c->sigma_a[2]), eta, model);
}

// What is integrated: one lane of R_d, or the density (lane -1).
static double value(const struct dipole *d, int lane, double r) {
    return lane < 0 ? (double)dipole_pdf_area(d, (float)r) : (double)dipole_Rd(d, (float)r)[lane];
}

// Over the disc from r0 to r1, in the logarithm of r.
static double over_annulus(const struct dipole *d, int lane, double r0, double r1) {
    enum { NODES = 16, PIECES = 24 };
    double x[NODES], w[NODES], sum = 0;
    gauss_legendre(NODES, x, w);
    const double piece = log(r1 / r0) / PIECES;
    for (int i = 0; i < PIECES; i++)
        for (int k = 0; k < NODES; k++) {
            const double r = r0 * exp((i + x[k]) * piece);
            sum += w[k] * piece * 2 * 3.14159265358979 * r * r * value(d, lane, r);
        }
    return sum;
}

// Over the plane: what is left out below 1e-4 and beyond 1e5 free paths is under 2e-4.
static double over_plane(const struct dipole *d, int lane, double free_path) {
    return over_annulus(d, lane, 1e-4 * free_path, 1e5 * free_path);
}

static void test_integrals(float eta, enum dipole_model model) {
    for (int i = 0; i < CASES; i++) {
        const struct dipole d = make(&cases[i], eta, model);
        const spectrum albedo = dipole_albedo(&d);
        double density = 0;
        for (int lane = 0; lane < SPECTRUM_LANES; lane++) {
            const double whole = over_plane(&d, lane, (double)d.z_r[lane]);
            CHECK_NEAR(whole, (double)albedo[lane], 2e-4);
            CHECK(albedo[lane] >= 0 && albedo[lane] <= 1 + 1e-5f);
            struct dipole one = d; // the density of this lane alone
            for (int other = 0; other < SPECTRUM_LANES; other++)
                if (other != lane)
                    one.pick_r[other] = one.pick_v[other] = 0;
            density += over_plane(&one, -1, (double)d.z_r[lane]);
        }
        CHECK_NEAR(density, 1, 3e-4);
    }
}

// Jensen et al. 2001, in closed form (Jensen and Buhler 2002, eq. 7).
static void test_published_albedo(void) {
    for (int k = 0; k < 4; k++) {
        const float eta = 1.1f + 0.3f * (float)k;
        for (double alpha = 0.05; alpha < 1; alpha += 0.1) {
            const double A = (1 + (double)dipole_2c1(eta)) / (1 - (double)dipole_2c1(eta));
            const double root = sqrt(3 * (1 - alpha));
            const double expected = alpha / 2 * (1 + exp(-4.0 / 3 * A * root)) * exp(-root);
            const struct test_case c = {"", {(float)(7 * alpha)}, {(float)(7 * (1 - alpha))}};
            const struct dipole d = make(&c, eta, DIPOLE_JENSEN);
            CHECK_NEAR((double)dipole_albedo(&d)[0], expected, 1e-5);
        }
    }
}

static void test_white(void) {
    for (int model = DIPOLE_JENSEN; model <= DIPOLE_BETTER; model++)
        for (float eta = 0.7f; eta < 2.6f; eta += 0.1f) {
            const struct test_case c = {"", {1, 1e3f, 1e-3f}, {0, 0, 0}};
            const struct dipole d = make(&c, eta, (enum dipole_model)model);
            for (int lane = 0; lane < SPECTRUM_LANES; lane++)
                CHECK_NEAR((double)dipole_albedo(&d)[lane], 1, 1e-5);
        }
}

// The fits against quadrature of Fresnel's formula on the inside.
static void test_moments(void) {
    enum { N = 64 };
    double x[N], w[N], worst1 = 0, worst2 = 0, worst_t = 0;
    gauss_legendre(N, x, w);
    for (float eta = 1.02f; eta <= 2; eta += 0.01f) {
        const double critical = sqrt(1 - 1 / ((double)eta * (double)eta));
        double c1 = critical * critical, c2 = critical * critical * critical;
        for (int i = 0; i < N; i++) {
            const double c = critical + (1 - critical) * x[i] * x[i];
            const double dc = w[i] * (1 - critical) * 2 * x[i];
            float cos_t;
            const double F = (double)fresnel_dielectric((float)c, 1 / eta, &cos_t);
            c1 += dc * 2 * c * F;
            c2 += dc * 3 * c * c * F;
        }
        worst1 = fmax(worst1, fabs((double)dipole_2c1(eta) - c1));
        worst2 = fmax(worst2, fabs((double)dipole_3c2(eta) - c2));
        const double T = 1 - fresnel_dielectric_average((double)eta);
        worst_t = fmax(worst_t, fabs((double)dipole_diffuse_transmittance(eta) / T - 1));
    }
    printf("fits, eta 1.02 to 2: 2 C1 off by %.2g, 3 C2 by %.2g; transmittance by %.2g of itself\n",
           worst1, worst2, worst_t);
    CHECK(worst1 < 5e-3 && worst2 < 5e-3 && worst_t < 1e-2);
}

// Samples fall into rings as the density says.
static void test_sampling(void) {
    enum { RINGS = 40, SAMPLES = 200000 };
    const double limit = sidak(FALSE_ALARMS, CASES);
    for (int i = 0; i < CASES; i++) {
        const struct dipole d = make(&cases[i], 1.4f, DIPOLE_BETTER);
        const double z = (double)d.z_r[0], first = 0.02 * z, ratio = 1.3;
        double counts[RINGS + 2] = {0};
        uint32_t state = 1;
        float pair[2];
        for (int n = 0; n < SAMPLES; n++) {
            for (int k = 0; k < 2; k++) {
                state = state * 747796405u + 2891336453u;
                const uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
                pair[k] = (float)((word >> 22 ^ word) >> 8) * 0x1p-24f;
            }
            const float r = dipole_sample(&d, pair[0], pair[1]);
            CHECK(r >= 0);
            const double ring = 1 + log(fmax((double)r, 1e-300) / first) / log(ratio);
            counts[ring < 0 ? 0 : ring >= RINGS + 1 ? RINGS + 1 : (int)ring]++;
        }
        struct chi2_bins bins = {.slack = 1};
        double inside = 0;
        for (int k = 0; k <= RINGS; k++) {
            const double r1 = first * pow(ratio, k);
            const double share = over_annulus(&d, -1, k ? r1 / ratio : 1e-5 * r1, r1);
            inside += share;
            chi2_add(&bins, counts[k], SAMPLES * share);
        }
        chi2_add(&bins, counts[RINGS + 1], SAMPLES * (1 - inside));
        const double p = chi2_finish(&bins);
        printf("%-18s %d samples, p = %.3f\n", cases[i].name, SAMPLES, p);
        CHECK(p > limit);
    }
}

// Jensen's profile is sampled as it is; d'Eon's within a bounded factor.
static void test_weights(void) {
    for (int i = 0; i < CASES; i++) {
        for (int lane = 0; lane < SPECTRUM_LANES; lane++) {
            struct test_case one = cases[i];
            for (int other = 0; other < SPECTRUM_LANES; other++)
                if (other != lane)
                    one.sigma_s[other] = 0;
            if (!(one.sigma_s[lane] > 0))
                continue;
            for (int model = DIPOLE_JENSEN; model <= DIPOLE_BETTER; model++) {
                const struct dipole d = make(&one, 1.5f, (enum dipole_model)model);
                const double albedo = (double)dipole_albedo(&d)[lane];
                for (float free_paths = 1e-3f; free_paths < 40; free_paths *= 2) {
                    const float r = free_paths * d.z_r[lane];
                    const double ratio = (double)(dipole_Rd(&d, r)[lane] / dipole_pdf_area(&d, r));
                    if (model == DIPOLE_JENSEN)
                        CHECK_NEAR(ratio, albedo, 2e-5 * albedo);
                    else
                        CHECK(ratio > 0 && ratio < 5 * albedo);
                }
            }
        }
    }
}

static void test_extremes(void) {
    static const float sigma[] = {0, 1e-38f, 1e-20f, 1, 1e20f, 1e30f};
    static const float etas[] = {0.1f, 0.999999f, 1, 1.000001f, 3, 100};
    for (int k = 0; k < 6 * 6 * 6 * 2; k++) {
        const float s = sigma[k % 6], a = sigma[k / 6 % 6], eta = etas[k / 36 % 6];
        const struct test_case c = {"", {s, a, 1}, {a, s, 0}};
        const struct dipole d = make(&c, eta, (enum dipole_model)(k / 216));
        CHECK(spectrum_is_finite(dipole_albedo(&d)) && isfinite(dipole_reach(&d)));
        for (int n = 0; n < 8; n++) {
            const float u = n < 7 ? (float)n / 7 : 0x1.fffffep-1f;
            const float r = dipole_sample(&d, u, 1 - u > 0x1p-24f ? u * u : u);
            CHECK(isfinite(r) && r >= 0);
            const spectrum Rd = dipole_Rd(&d, r);
            CHECK(spectrum_is_finite(Rd) && spectrum_min(Rd) >= 0);
            CHECK(isfinite(dipole_pdf_area(&d, r)) && dipole_pdf_area(&d, r) >= 0);
        }
    }
}

int main(void) {
    for (int model = DIPOLE_JENSEN; model <= DIPOLE_BETTER; model++)
        for (int k = 0; k < 3; k++)
            test_integrals(1.05f + 0.35f * (float)k, (enum dipole_model)model);
    test_published_albedo();
    test_white();
    test_moments();
    test_sampling();
    test_weights();
    test_extremes();
    return check_result();
}
