// SPDX-License-Identifier: Apache-2.0
// Goniometer tables: a synthetic goniometer of a known lobe (section 1.3 of Muehlbacher 2012: Kurt,
// Szirmay-Kalos and Krivanek's model with alpha = 0), written, read and reconstructed.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "capture.h"
#include "check.h"
#include "make_object.h"
#include "math/hash.h"
#include "table/goniometer.h"

enum { THETAS = 6, OUT_THETAS = 91, OUT_PHIS = 180 };

static const double ROUGHNESS = 0.1;
static char path[64];

// f = D / (4 u): Beckmann without Fresnel and shadowing
static double lobe(vec3 wi, vec3 wo) {
    const vec3 h = normalize(wi + wo);
    const double z2 = (double)(h[2] * h[2]), m2 = ROUGHNESS * ROUGHNESS;
    const double d = exp(-(1 - z2) / (z2 * m2)) / (M_PI * m2 * z2 * z2);
    return 0.3 * d / (4 * fmax((double)dot(wi, h), 1e-3)) + 0.05;
}

static vec3 direction(double theta, double phi) {
    return v3((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta));
}

// Incident angles every 15 degrees, outgoing directions every 1 and 2 degrees.
static void make_table(struct goniometer_table *t, bool transmits) {
    *t = (struct goniometer_table){.theta_count = THETAS, .phi_count = 1, .symmetry = 1,
                                   .out_thetas = OUT_THETAS, .out_phis = OUT_PHIS};
    const size_t slice = goniometer_slice(t);
    t->theta = mem_array(THETAS, sizeof(float));
    t->phi = mem_array(1, sizeof(float));
    for (int side = 0; side < 1 + transmits; side++)
        t->f[side] = mem_array(THETAS * slice, sizeof(float[3]));
    for (int k = 0; k < THETAS; k++) {
        t->theta[k] = (float)(k * 15 * M_PI / 180);
        for (size_t i = 0; i < slice; i++) {
            const vec3 out = direction((double)(i / OUT_PHIS) * M_PI / 180,
                                       (double)(i % OUT_PHIS) * M_PI / 90);
            const double f = lobe(direction((double)t->theta[k], 0), out);
            for (int side = 0; side < 1 + transmits; side++)
                for (int c = 0; c < 3; c++)
                    t->f[side][(size_t)k * slice + i][c] = (float)(f * (side ? 0.4 : 1));
        }
    }
}

static void finish_table(struct goniometer_table *t) {
    mem_free(t->theta);
    mem_free(t->phi);
    mem_free(t->f[0]);
    mem_free(t->f[1]);
}

static const struct object *load(struct arena *arena, const char *file) {
    char overrides[4200];
    snprintf(overrides, sizeof overrides, "filename=%s", file);
    return make_bsdf(arena, "goniometer", overrides, NULL);
}

static double eval_f(const struct object *o, vec3 wo, vec3 wi) {
    struct closure_stack stack = {0};
    const struct bsdf_point point = {0};
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    float pdf;
    return c ? (double)(closure_eval(c, wi, &pdf)[1] / fabsf(wi[2])) : 0;
}

// Section 6.B 1 of the specification.
static void nodes_return_what_was_stored(const struct object *o) {
    double worst = 0;
    for (int k = 0; k < THETAS; k++)
        for (int i = 0; i < 90; i += 7)
            for (int j = 0; j < OUT_PHIS; j += 11) {
                const vec3 wo = direction(k * 15 * M_PI / 180, 0);
                const vec3 wi = direction(i * M_PI / 180, j * M_PI / 90);
                const double expected = lobe(wo, wi);
                worst = fmax(worst, fabs(eval_f(o, wo, wi) / expected - 1));
            }
    printf("largest relative error at nodes: %.2g\n", worst);
    CHECK(worst < 2e-3); // seven digits and bilinear weights of rounded directions
}

// Cross-fading of the two neighbours, as quadrilinear interpolation has it.
static double cross_fade(double theta, vec3 wi) {
    const double k = floor(theta / (15 * M_PI / 180)), t = theta / (15 * M_PI / 180) - k;
    return (1 - t) * lobe(direction(k * 15 * M_PI / 180, 0), wi) +
           t * lobe(direction((k + 1) * 15 * M_PI / 180, 0), wi);
}

// Section 6.B 2: L1 errors midway between incident directions, and where the peak is.
static void half_vectors_beat_cross_fading(const struct object *o) {
    for (int k = 0; k < THETAS - 1; k++) {
        const double theta = (k + 0.5) * 15 * M_PI / 180;
        const vec3 wo = direction(theta, 0);
        double ours = 0, naive = 0, peak = 0, peak_at = 0;
        for (int i = 0; i < 85; i++)
            for (int j = 0; j < OUT_PHIS; j++) {
                const vec3 wi = direction(i * M_PI / 180, j * M_PI / 90);
                const double truth = lobe(wo, wi), found = eval_f(o, wo, wi);
                ours += fabs(found - truth) * sin(i * M_PI / 180);
                naive += fabs(cross_fade(theta, wi) - truth) * sin(i * M_PI / 180);
                if (found * cos(i * M_PI / 180) > peak) {
                    peak = found * cos(i * M_PI / 180);
                    peak_at = i;
                }
            }
        printf("at %g degrees: error %.3g of cross-fading's, peak at %g\n", theta * 180 / M_PI,
               ours / naive, peak_at);
        CHECK(ours < 0.25 * naive);
        CHECK(fabs(peak_at - theta * 180 / M_PI) <= 2);
    }
}

// The integral is that of the neighbours, interpolated.
static void integrals_are_interpolated(const struct object *o) {
    double albedo[9];
    for (int k = 0; k < 9; k++) {
        double sum = 0;
        const vec3 wo = direction(k * 7.5 * M_PI / 180, 0);
        for (int i = 0; i < 360; i++)
            for (int j = 0; j < 360; j++) {
                const double theta = (i + 0.5) * M_PI / 720, phi = (j + 0.5) * M_PI / 180;
                sum += eval_f(o, wo, direction(theta, phi)) * cos(theta) * sin(theta) *
                       (M_PI / 720) * (M_PI / 180);
            }
        albedo[k] = sum;
    }
    for (int k = 1; k < 8; k += 2) {
        printf("albedo at %g degrees: %.4f between %.4f and %.4f\n", k * 7.5, albedo[k],
               albedo[k - 1], albedo[k + 1]);
        CHECK_NEAR(albedo[k], 0.5 * (albedo[k - 1] + albedo[k + 1]), 0.02 * albedo[k]);
    }
}

// ---- rejection, the oracle ------------------------------------------------------------------

enum { BINS = 10, DRAWS = 200000 };

static int bin_of(vec3 wi) {
    const int bin = (int)(wi[2] * BINS);
    return bin < BINS ? bin : BINS - 1;
}

static vec3 uniform_direction(struct rng *rng) {
    const double z = (double)rng_float(rng);
    return direction(acos(z), 2 * M_PI * (double)rng_float(rng));
}

// Directions by rejection: uniform candidates, accepted with probability p / max. frozen: the
// threshold is drawn once for all candidates of a direction, as the thesis prints it.
static double reject(const struct object *o, vec3 wo, double most, bool frozen, double share[BINS]) {
    struct rng rng = {11};
    int tries = 0;
    memset(share, 0, BINS * sizeof *share);
    for (int i = 0; i < DRAWS / 10; i++) {
        double x = (double)rng_float(&rng);
        vec3 wi;
        for (;;) {
            wi = uniform_direction(&rng);
            tries++;
            if (x * most < eval_f(o, wo, wi) * (double)wi[2])
                break;
            if (!frozen)
                x = (double)rng_float(&rng);
        }
        share[bin_of(wi)] += 1.0 / (DRAWS / 10);
    }
    return (double)tries / (DRAWS / 10);
}

static double chi2(const double share[BINS], const double expected[BINS]) {
    double sum = 0;
    for (int k = 0; k < BINS; k++)
        sum += (share[k] - expected[k]) * (share[k] - expected[k]) / expected[k] * (DRAWS / 10);
    return sum;
}

// Sections 6.B 3 and 4. Chi-square of 9 degrees: above 33.7 once in 10 000.
static void samples_agree_with_rejection(const struct object *o) {
    const vec3 wo = direction(0.6, 0);
    double expected[BINS] = {0}, sampled[BINS] = {0}, share[BINS], total = 0, most = 0;
    for (int i = 0; i < 500; i++)
        for (int j = 0; j < 500; j++) { // uniform in solid angle
            const vec3 wi = direction(acos((i + 0.5) / 500), (j + 0.5) * 2 * M_PI / 500);
            const double p = eval_f(o, wo, wi) * (double)wi[2];
            expected[bin_of(wi)] += p * 2 * M_PI / 250000;
            most = fmax(most, p);
        }
    for (int k = 0; k < BINS; k++)
        total += expected[k];
    for (int k = 0; k < BINS; k++)
        expected[k] /= total;
    struct rng rng = {12};
    struct closure_stack stack = {0};
    const struct bsdf_point point = {0};
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    for (int i = 0; i < DRAWS; i++) {
        struct bsdf_sample b;
        const float u1 = rng_float(&rng), u = rng_float(&rng), v = rng_float(&rng);
        if (closure_sample(c, u1, (struct vec2){u, v}, &b))
            sampled[bin_of(b.wi)] += (double)b.weight[1] / total / DRAWS;
    }
    for (int k = 0; k < BINS; k++)
        CHECK_NEAR(sampled[k], expected[k], 0.02 * expected[k] + 1e-3);
    const double tries = reject(o, wo, most * 1.001, false, share);
    const double good = chi2(share, expected);
    reject(o, wo, most * 1.001, true, share);
    const double frozen = chi2(share, expected);
    printf("rejection: chi-square %.1f, frozen threshold %.0f; %.3f tries, expected %.3f\n", good,
           frozen, tries, 2 * M_PI * most * 1.001 / total);
    CHECK(good < 33.7);
    CHECK(frozen > 100);
    CHECK_NEAR(tries, 2 * M_PI * most * 1.001 / total, 0.02 * tries);
}

// What is written is read again; missing values are filled and counted; lies are refused.
static void transfer_files_round_trip(void) {
    struct arena arena = {0};
    struct goniometer_table t;
    make_table(&t, true);
    CHECK(transfer_write(path, &t));
    const struct goniometer_table *back = goniometer_read(path, GONIOMETER_AUTO, &arena);
    double worst = 0;
    CHECK(back && back->f[1] && !back->retro && back->invalid == 0);
    for (size_t i = 0; back && i < THETAS * goniometer_slice(&t); i++)
        if (i / OUT_PHIS % OUT_THETAS < 90)
            worst = fmax(worst, fabs((double)(back->f[1][i][2] / t.f[1][i][2]) - 1));
    printf("round trip: %.2g\n", worst);
    CHECK(worst < 1e-6);
    for (size_t i = 0; i < 40; i++) {
        const float bad[] = {NAN, INFINITY, -1, 1e20f};
        t.f[0][7 * i + 500][i % 3] = bad[i % 4];
    }
    CHECK(transfer_write(path, &t));
    capture_begin();
    back = goniometer_read(path, GONIOMETER_MIRROR, &arena);
    capture_end();
    CHECK(!back); // nan is no number: the writer's caller must say '-'
    for (size_t i = 0; i < 40; i++)
        t.f[0][7 * i + 500][i % 3] = -1;
    CHECK(transfer_write(path, &t));
    capture_begin();
    back = goniometer_read(path, GONIOMETER_MIRROR, &arena);
    capture_end();
    CHECK(back && back->invalid == 40);
    for (size_t i = 0; back && i < 40; i++)
        CHECK(back->f[0][7 * i + 500][1] > 0);
    arena_finish(&arena);
    finish_table(&t);
}

// A retro-reflector and paints, as far as they are there.
static void real_files_are_read(void) {
    static const char *const files[] = {"retro-alta/retro-gray-tape.dat", "cornell/garnet_red.brdf",
                                        "cornell/cayman.brdf", "cornell/acryl_blue.brdf"};
    const char *shared = getenv("RELUME_SHARED_DATA");
    for (int i = 0; i < 4 && shared; i++) {
        struct arena arena = {0};
        char file[4096];
        snprintf(file, sizeof file, "%s/brdf/%s", shared, files[i]);
        capture_begin();
        const struct object *o = load(&arena, file);
        capture_end();
        const vec3 wo = direction(0.5, 0.3);
        const double mirrored = eval_f(o, wo, v3(-wo[0], -wo[1], wo[2])), back = eval_f(o, wo, wo);
        printf("%s: mirrored %.4g, back %.4g\n", files[i], mirrored, back);
        CHECK(i == 0 ? back > 10 * mirrored : mirrored > back);
        arena_finish(&arena);
    }
}

int main(void) {
    struct arena arena = {0};
    struct goniometer_table t;
    snprintf(path, sizeof path, "goniometer-test-%d.transfer", (int)getpid());
    make_table(&t, false);
    CHECK(transfer_write(path, &t));
    const struct object *o = load(&arena, path);
    nodes_return_what_was_stored(o);
    half_vectors_beat_cross_fading(o);
    integrals_are_interpolated(o);
    samples_agree_with_rejection(o);
    finish_table(&t);
    arena_finish(&arena);
    transfer_files_round_trip();
    real_files_are_read();
    remove(path);
    return check_result();
}
