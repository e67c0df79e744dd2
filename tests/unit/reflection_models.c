// SPDX-License-Identifier: Apache-2.0
// The formulas of the classic reflection models against closed forms, published values and
// quadrature. Sampling, energy and reciprocity of the materials made of them: property/bsdf.c.
#include "check.h"
#include "math/ashikhmin_shirley.h"
#include "math/blinn_phong.h"
#include "math/cook_torrance.h"
#include "math/eon.h"
#include "math/fresnel.h"
#include "math/hash.h"
#include "math/kskk.h"
#include "math/lafortune.h"
#include "math/oren_nayar.h"
#include "math/quadrature.h"
#include "math/schlick.h"
#include "math/ward.h"

static const double degree = M_PI / 180;

static struct direction towards(double theta, double phi) {
    return (struct direction){sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
}

static struct direction random_direction(struct rng *rng) {
    const double z = 1e-3 + 0.999 * (double)rng_float(rng);
    return towards(acos(z), 2 * M_PI * (double)rng_float(rng));
}

typedef double (*direction_fn)(const void *ctx, struct direction w);

// Integral over the upper hemisphere; nodes gather at the normal and at the horizon.
static double integrate(direction_fn f, const void *ctx) {
    enum { N = 256, AZIMUTHS = 512 };
    static double x[N], w[N];
    double sum = 0;
    gauss_legendre(N, x, w);
    for (int i = 0; i < N; i++) {
        const double theta = 0.5 * M_PI * x[i] * x[i] * (3 - 2 * x[i]);
        const double area = sin(theta) * 0.5 * M_PI * 6 * x[i] * (1 - x[i]) * w[i];
        for (int j = 0; j < AZIMUTHS; j++)
            sum += area * f(ctx, towards(theta, 2 * M_PI * (j + 0.5) / AZIMUTHS));
    }
    return sum * 2 * M_PI / AZIMUTHS;
}

// ---- distributions of half vectors ----------------------------------------------------------

// In slopes, where d omega = cos^3 dx dy.
static void beckmann_is_normalised(void) {
    const double m[4] = {0.005, 0.05, 0.2, 0.5};
    enum { N = 64 };
    double x[N], w[N];
    gauss_legendre(N, x, w);
    for (int i = 0; i < 16; i++) {
        const struct beckmann b = {m[i / 4], m[i % 4]};
        double sum = 0;
        for (int j = 0; j < N * N; j++) {
            const double r = 7 * x[j / N], phi = 2 * M_PI * x[j % N];
            const struct direction h =
                direction_of(b.mx * r * cos(phi), b.my * r * sin(phi), 1);
            const double area = b.mx * b.my * r * 7 * w[j / N] * 2 * M_PI * w[j % N];
            sum += area * h.z * h.z * h.z * h.z * beckmann_D(&b, h);
        }
        CHECK_NEAR(sum, 1, 1e-9);
    }
}

struct pair_of {
    double a, b;
};

static double blinn_phong_projected(const void *ctx, struct direction h) {
    return blinn_phong_D(h.z, ((const struct pair_of *)ctx)->a) * h.z;
}

static double ashikhmin_shirley_density(const void *ctx, struct direction h) {
    const struct pair_of *n = ctx;
    return ashikhmin_shirley_D(h, n->a, n->b);
}

static double schlick_density(const void *ctx, struct direction h) {
    const struct pair_of *s = ctx;
    const struct schlick_azimuth z = schlick_azimuth_make(s->b);
    return schlick_pdf_h(h, s->a, s->b, &z);
}

static void cosine_powers_are_normalised(void) {
    const struct pair_of n[] = {{0, 0}, {1e-3, 1e-3}, {1, 10}, {30, 30}, {200, 5}, {1000, 1000}};
    for (int i = 0; i < 6; i++) {
        CHECK_NEAR(integrate(blinn_phong_projected, &n[i]), 1, 1e-8);
        CHECK_NEAR(integrate(ashikhmin_shirley_density, &n[i]), 1, 1e-8);
    }
}

static void schlick_is_normalised_by_the_mean_of_A(void) {
    const struct pair_of rp[] = {{1, 1}, {0.1, 1}, {1, 0.3}, {0.2, 0.05}, {0.01, 0.5}};
    for (int i = 0; i < 5; i++)
        CHECK_NEAR(integrate(schlick_density, &rp[i]), 1, 1e-8);
    CHECK_NEAR(schlick_azimuth_make(1).mean, 1, 1e-15);
}

// The share of A's integral up to the sampled azimuth is the random number again.
static void schlick_azimuths_invert_the_integral_of_A(void) {
    const double p[] = {1, 0.5, 0.1, 1e-2, 1e-4};
    enum { N = 200 };
    double x[N], w[N];
    gauss_legendre(N, x, w);
    for (int i = 0; i < 5 * 64; i++) {
        const struct schlick_azimuth z = schlick_azimuth_make(p[i / 64]);
        const double u = (i % 64 + 0.5) / 256; // a quarter; tan(phi) = exp(t) / p^1/2 spreads A
        const double phi = schlick_azimuth_sample(&z, u), root = sqrt(p[i / 64]);
        const double end = log(tan(phi) * root), start = -40;
        double share = 0;
        for (int j = 0; j < N; j++) {
            const double tangent = exp(start + (end - start) * x[j]) / root;
            const struct direction h = direction_of(1, tangent, 0);
            share += w[j] * (end - start) * tangent / (1 + tangent * tangent) *
                     schlick_A(h, p[i / 64]) / (2 * M_PI * z.mean);
        }
        CHECK_NEAR(share, u, 1e-9);
    }
}

// ---- directional albedos in closed form ------------------------------------------------------

struct seen {
    struct direction wo;
    double n, alpha;
    enum ward_variant variant;
};

static double phong_reflected(const void *ctx, struct direction wi) {
    const struct seen *s = ctx;
    return phong_brdf(s->wo, wi, s->n) * wi.z;
}

// Exponent 0: the lune that wi and the mirrored hemisphere share. Exponent 1: the integral of two
// clamped cosines at an angle t, 2/3 (sin t + (pi - t) cos t).
static void phong_reflects_what_closed_forms_say(void) {
    for (int i = 0; i < 6; i++) {
        struct seen s = {.wo = {0, 0, 1}, .n = (double[]){0, 1e-3, 1, 5, 30, 300}[i]};
        CHECK_NEAR(integrate(phong_reflected, &s), 1, 1e-8);
    }
    for (int i = 0; i < 9; i++) {
        const double t = 10 * i * degree;
        struct seen s = {.wo = towards(t, 0.3), .n = 1e-12};
        CHECK_NEAR(integrate(phong_reflected, &s), 0.5 * (1 + cos(t)), 2e-3); // an edge
        s.n = 1;
        CHECK_NEAR(integrate(phong_reflected, &s), (sin(t) + (M_PI - t) * cos(t)) / M_PI, 1e-5);
    }
}

static double ward_reflected(const void *ctx, struct direction wi) {
    const struct seen *s = ctx;
    const struct beckmann b = {s->alpha, s->alpha};
    struct half_vector v;
    return half_vector_make(s->wo, wi, &v) ? ward_brdf(&v, s->variant, &b) * wi.z : 0;
}

// From the normal, in x = tan^2(theta_h) of density exp(-x / alpha^2) / alpha^2 up to x = 1: the
// quotients with D cos_h / (4 cos_d) are 1 - x (bounded), (1 + x)^-2 (Duer) and, with cos_i =
// (1 - x) / (1 + x), (1 + x)^-2 sqrt(cos_i) (original).
static void ward_reflects_what_closed_forms_say(void) {
    enum { N = 128 };
    double x[N], w[N];
    gauss_legendre(N, x, w);
    for (int i = 0; i < 4; i++) {
        const double alpha = (double[]){0.05, 0.2, 0.5, 1}[i], a2 = alpha * alpha;
        struct seen s = {.wo = {0, 0, 1}, .alpha = alpha, .variant = WARD_BOUNDED};
        CHECK_NEAR(integrate(ward_reflected, &s), 1 - a2 * (1 - exp(-1 / a2)), 1e-7);
        double original = 0, duer = 0;
        for (int j = 0; j < N; j++) {
            const double t = 1 - x[j] * x[j]; // nodes gather at t = 1
            const double q = w[j] * 2 * x[j] * exp(-t / a2) / (a2 * (1 + t) * (1 + t));
            duer += q;
            original += q * sqrt((1 - t) / (1 + t));
        }
        s.variant = WARD_ORIGINAL;
        CHECK_NEAR(integrate(ward_reflected, &s), original, 1e-5);
        s.variant = WARD_DUER;
        CHECK_NEAR(integrate(ward_reflected, &s), duer, 1e-5);
    }
}

static double qualitative_reflected(const void *ctx, struct direction wi) {
    const struct seen *s = ctx;
    const struct oren_nayar_angles a = oren_nayar_angles(s->wo, wi);
    return oren_nayar_qualitative(&a, s->alpha) * wi.z / M_PI;
}

static double fujii_reflected(const void *ctx, struct direction wi) {
    const struct seen *s = ctx;
    return fujii_brdf(s->wo, wi, s->alpha) * wi.z / M_PI;
}

static double eon_reflected(const void *ctx, struct direction wi) {
    const struct seen *s = ctx;
    const double multiple = eon_multiple_reflectance(1, s->alpha);
    return fujii_reflected(ctx, wi) +
           multiple * eon_multiple(s->wo.z, wi.z, s->alpha) * wi.z / M_PI;
}

static void oren_nayar_reflects_what_closed_forms_say(void) {
    for (int i = 0; i < 5 * 9; i++) {
        const double theta = fmax(10 * (i % 9), 1) * degree, s = sin(theta), c = cos(theta);
        const double sigma = (double[]){0, 1e-6, 0.1, 0.5, 1}[i / 9], s2 = sigma * sigma;
        const struct seen seen = {.wo = towards(theta, 0.3), .alpha = sigma};
        const double q = c * (1 + s + s * s) / (1 + s); // (1 - s^3) / c
        const double A = 1 - 0.5 * s2 / (s2 + 0.33), B = 0.45 * s2 / (s2 + 0.09);
        CHECK_NEAR(integrate(qualitative_reflected, &seen),
                   A + B / M_PI * s * (theta - s * c + 2.0 / 3 * q), 2e-5);
        CHECK_NEAR(integrate(fujii_reflected, &seen), fujii_albedo(c, sigma), 2e-5);
        CHECK_NEAR(integrate(eon_reflected, &seen), 1, 2e-5);
    }
}

static void fujii_average_is_the_mean_of_the_albedo(void) {
    enum { N = 128 };
    double x[N], w[N];
    gauss_legendre(N, x, w);
    for (int i = 0; i <= 4; i++) {
        double sum = 0;
        for (int j = 0; j < N; j++)
            sum += w[j] * 2 * x[j] * fujii_albedo(x[j], 0.25 * i);
        CHECK_NEAR(sum, fujii_average(0.25 * i), 1e-7);
    }
}

static void lafortune_contains_phong(void) {
    struct rng rng = {1};
    for (int i = 0; i < 1000; i++) {
        const struct direction wo = random_direction(&rng), wi = random_direction(&rng);
        const double n = 100 * (double)rng_float(&rng);
        CHECK_NEAR((n + 2) / (2 * M_PI) *
                       lafortune_brdf((struct direction){-1, -1, 1}, n, wo, wi),
                   phong_brdf(wo, wi, n), 1e-12 * n);
    }
}

static void conductors_agree_in_both_precisions(void) {
    const float eta[] = {1, 1.0000001f, 0.05f, 0.2f, 1.5f, 4, 1e3f};
    const float k[] = {0, 1e-6f, 0.1f, 2, 8, 1e3f};
    for (int i = 0; i < 7 * 6 * 91; i++) {
        const float c = cosf((float)(i % 91) * (PI / 180));
        const float e = eta[i / 91 % 7], x = k[i / 91 / 7];
        const double F = conductor_reflectance((double)c, (double)e, (double)x);
        CHECK(F >= 0 && F <= 1);
        CHECK_NEAR((double)fresnel_conductor(c, spectrum_grey(e), spectrum_grey(x))[0], F, 2e-5);
    }
}

// ---- the anisotropic Beckmann lobes of Kurt et al. -------------------------------------------

static void kskk_meets_published_values(void) {
    static const double rows[][13] = {
        // theta_i phi_i theta_o phi_o, mx my r0 alpha, F D f_r pdf f_t
        {0, 0, 0, 0, .1, .1, .04, 0, .04, 31.830989, .31830989, 7.9577472, 7.6394373},
        {30, 0, 30, 180, .1, .1, .04, 0, .040041437, 31.830989, .36793335, 9.1888149, 8.8208816},
        {30, 0, 30, 180, .1, .1, .04, .5, .040041437, 31.830989, .42485284, 9.1888149, 10.185477},
        {45, 0, 45, 180, .11, .072, .89, .43, .8902371, 40.190642, 17.042313, 14.209538, 2.1012533},
        {45, 90, 40, 270, .11, .072, .89, .43, .89013768, 27.930513, 10.973305, 9.4618158,
         1.3543441},
        {45, 0, 40, 180, .11, .072, .89, .43, .89013768, 34.463455, 13.53996, 11.674933, 1.671125},
        {75, 0, 75, 180, .124, .136, .029, .5, .24619033, 18.875112, 17.342355, 18.231958,
         53.100521},
        {75, 0, 60, 180, .124, .136, .029, .5, .11604802, 6.3279481, 1.3335763, 4.098565,
         10.158014},
        {20, 10, 35, 200, .25, .17, .75, .6, .75000444, 5.1090874, 1.2624005, 1.4249552, .42079022},
    };
    for (int i = 0; i < 9; i++) {
        const double *r = rows[i];
        const struct direction wi = towards(r[0] * degree, r[1] * degree);
        const struct direction wo = towards(r[2] * degree, r[3] * degree);
        struct kskk k = {{r[4], r[5]}, r[6], r[7], false};
        struct half_vector v;
        CHECK(half_vector_make(wo, wi, &v));
        CHECK_NEAR(schlick_fresnel(v.cos_d, k.r0) / r[8], 1, 1e-7);
        CHECK_NEAR(beckmann_D(&k.slopes, v.h) / r[9], 1, 1e-7);
        CHECK_NEAR(kskk_brdf(&k, &v) / r[10], 1, 1e-7);
        CHECK_NEAR(kskk_pdf(&k, &v) / r[11], 1, 1e-7);
        k.transmits = true;
        CHECK_NEAR(kskk_brdf(&k, &v) / r[12], 1, 1e-7);
    }
}

// f cos_i = weight pdf, and f is the same both ways, to rounding.
static void kskk_is_reciprocal_and_weighs_its_samples_rightly(void) {
    struct rng rng = {7};
    for (int i = 0; i < 100000; i++) {
        const struct direction wo = random_direction(&rng), wi = random_direction(&rng);
        const struct kskk k = {{0.05 + (double)rng_float(&rng), 0.05 + (double)rng_float(&rng)},
                               (double)rng_float(&rng), (double)rng_float(&rng), i % 2};
        struct half_vector v, back;
        CHECK(half_vector_make(wo, wi, &v));
        CHECK(half_vector_make(wi, wo, &back));
        const double f = kskk_brdf(&k, &v);
        CHECK_NEAR(kskk_brdf(&k, &back), f, 1e-12 * f);
        CHECK_NEAR(kskk_weight(&k, &v) * kskk_pdf(&k, &v), f * wi.z, 1e-12 * f);
    }
}

static void kskk_albedos_meet_published_values(void) {
    static const double rows[][9] = { // alpha, m; at 0 30 45 60 75 85 89 degrees, F = 1
        {0, .05, .9963, .8628, .7045, .4981, .2579, .0905, .0377},
        {0, .15, .9671, .8375, .6838, .4840, .2613, .1320, .0920},
        {0, .3, .8769, .7599, .6246, .4603, .2956, .2002, .1671},
        {.25, .15, .9777, .9085, .8183, .6811, .4822, .3464, .3728},
        {.5, .01, 1, .9999, .9999, .9999, .9996, .9966, .9152},
        {.5, .05, .9987, .9985, .9981, .9968, .9892, .9143, 1.0521},
        {.5, .15, .9886, .9866, .9822, .9664, .9065, .9340, 1.5567},
        {.5, .3, .9526, .9406, .9176, .8798, .8711, 1.0958, 2.1088},
        {.75, .15, .9997, 1.0726, 1.1829, 1.3850, 1.7457, 2.6067, 6.7519},
        {1, .15, 1.0111, 1.1675, 1.4299, 2.0091, 3.4725, 7.6239, 30.8355},
    };
    static const double degrees[] = {0, 30, 45, 60, 75, 85, 89};
    for (int i = 0; i < 70; i++) {
        const double *r = rows[i / 7];
        const struct kskk k = {{r[1], r[1]}, 1, r[0], false};
        CHECK_NEAR(kskk_albedo(&k, cos(degrees[i % 7] * degree), 0.4), r[2 + i % 7], 5e-4);
    }
}

static void smooth_kskk_reflects_a_power_of_the_cosine(void) {
    for (int i = 0; i < 5 * 6; i++) {
        const double c = cos(15 * (i % 6) * degree), alpha = 0.25 * (i / 6);
        const struct kskk k = {{1e-3, 1e-3}, 0.3, alpha, false};
        const double limit = schlick_fresnel(c, 0.3) * pow(c, 1 - 2 * alpha);
        CHECK_NEAR(kskk_albedo(&k, c, 1) / limit, 1, 5e-3);
    }
}

// F + (1 - F) = 1
static void kskk_sheets_share_between_reflection_and_transmission(void) {
    for (int i = 0; i < 4 * 9; i++) {
        const double c = cos(10 * (i % 9) * degree), r0 = (double[]){0, 0.04, 0.5, 1}[i / 9];
        const struct kskk r = {{0.1, 0.3}, r0, 0, false}, t = {{0.1, 0.3}, r0, 0, true};
        const struct kskk all = {{0.1, 0.3}, 1, 0, false};
        const double sum = kskk_albedo(&r, c, 1) + kskk_albedo(&t, c, 1);
        CHECK(sum <= 1);
        CHECK_NEAR(sum, kskk_albedo(&all, c, 1), 1e-12);
    }
}

int main(void) {
    beckmann_is_normalised();
    cosine_powers_are_normalised();
    schlick_is_normalised_by_the_mean_of_A();
    schlick_azimuths_invert_the_integral_of_A();
    phong_reflects_what_closed_forms_say();
    ward_reflects_what_closed_forms_say();
    oren_nayar_reflects_what_closed_forms_say();
    fujii_average_is_the_mean_of_the_albedo();
    lafortune_contains_phong();
    conductors_agree_in_both_precisions();
    kskk_meets_published_values();
    kskk_is_reciprocal_and_weighs_its_samples_rightly();
    kskk_albedos_meet_published_values();
    smooth_kskk_reflects_a_power_of_the_cosine();
    kskk_sheets_share_between_reflection_and_transmission();
    return check_result();
}
