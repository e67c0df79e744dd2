// SPDX-License-Identifier: Apache-2.0
// Flights and transmittance against closed forms: homogeneous, grey and coloured grids. Monte Carlo
// tests are z-tests; all of them together raise a false alarm with probability 1e-3 (seeds are
// fixed).
#include "check.h"
#include "medium/tracking.h"
#include "medium_text.h"
#include "statistics.h"

enum { TESTS = 200 };

struct sums {
    double n, sum, squares;
};

static void add(struct sums *s, double x) {
    s->n++;
    s->sum += x;
    s->squares += x * x;
}

// The mean against what is expected.
static void check_mean(const char *what, const struct sums *s, double expected) {
    const double mean = s->sum / s->n;
    const double ulps = 1e-6 * expected; // what is computed without noise
    const double error = sqrt(fmax(s->squares / s->n - mean * mean, 0) / s->n) + ulps;
    const double z = error > 0 ? (mean - expected) / error : 0;
    printf("  %-46s %.6g +- %.2g, expected %.6g, z %+.2f\n", what, mean, error, expected, z);
    check_count++;
    if (!(normal_p_value(z) > sidak(1e-3, TESTS)) || (error == 0 && mean != expected)) {
        check_failures++;
        printf("%s:%d: failed: %s\n", __FILE__, __LINE__, what);
    }
}

static struct flight fresh(struct rng *rng, int lane) {
    return (struct flight){.beta = spectrum_grey(1), .ratio = spectrum_grey(1), .lane = lane,
                           .rng = rng};
}

// ---- flights ------------------------------------------------------------------------------------

struct expectations {
    double T[3], scattered[3], emitted[3];
};

// What flights bring per lane, in both modes: what gets through, what scatters, what glows.
static void test_flights(const char *name, const struct medium *m, vec3 o, vec3 d, float end,
                         const struct expectations *e, int n) {
    for (int spectral = 0; spectral < 2; spectral++) {
        struct sums T[3] = {{0}}, scattered[3] = {{0}}, emitted[3] = {{0}};
        struct rng rng = {5};
        for (int i = 0; i < n; i++) {
            float t = -1;
            const float u = rng_float(&rng);
            struct flight f = fresh(&rng, spectral ? i % 3 : -1);
            const bool hit = medium_fly(m, o, d, end, u, &f, &t);
            const spectrum weight = f.beta / flight_ratio(f.ratio);
            for (int k = 0; k < 3; k++) {
                add(&T[k], hit ? 0 : (double)weight[k]);
                add(&scattered[k], hit ? (double)weight[k] : 0);
                add(&emitted[k], (double)f.emitted[k]);
            }
        }
        for (int k = 0; k < 3; k++) {
            char what[96];
            snprintf(what, sizeof what, "%s %s %c passes", name, spectral ? "spectral" : "grey",
                     "rgb"[k]);
            check_mean(what, &T[k], e->T[k]);
            snprintf(what, sizeof what, "%s %s %c scatters", name, spectral ? "spectral" : "grey",
                     "rgb"[k]);
            check_mean(what, &scattered[k], e->scattered[k]);
            snprintf(what, sizeof what, "%s %s %c glows", name, spectral ? "spectral" : "grey",
                     "rgb"[k]);
            check_mean(what, &emitted[k], e->emitted[k]);
        }
    }
}

// Homogeneous or of constant albedo: all follows from the optical depths.
static struct expectations expect(const double depth[3], const double albedo[3], double Le) {
    struct expectations e;
    for (int k = 0; k < 3; k++) {
        e.T[k] = exp(-depth[k]);
        e.scattered[k] = albedo[k] * (1 - e.T[k]);
        e.emitted[k] = Le * (1 - albedo[k]) * (1 - e.T[k]);
    }
    return e;
}

static void test_homogeneous(struct arena *arena) {
    static const struct {
        const char *name, *parameters;
        double depth[3], albedo[3], Le;
    } cases[] = {
        {"grey", "sigma_t=1 albedo=0.5,0.9,0.1", {2, 2, 2}, {0.5, 0.9, 0.1}, 0},
        {"coloured", "sigma_t=0.2,1,3 albedo=0.5", {0.4, 2, 6}, {0.5, 0.5, 0.5}, 0},
        {"one colour", "sigma_s=0,0.5,0 sigma_a=0,0,0.5", {0, 1, 1}, {0, 1, 0}, 0},
        {"glowing", "sigma_t=0.1,1,1 albedo=0.5 emission=3", {0.2, 2, 2}, {0.5, 0.5, 0.5}, 3},
        {"absorbing", "sigma_s=0 sigma_a=0.1,1,1 emission=3", {0.2, 2, 2}, {0, 0, 0}, 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct medium m = test_medium(arena, "homogeneous", cases[i].parameters);
        const struct expectations e = expect(cases[i].depth, cases[i].albedo, cases[i].Le);
        test_flights(cases[i].name, &m, v3(0, 0, 0), v3(0, 0, 1), 2, &e, 300000);
    }
}

// Thin: how often anything happens at all.
static void test_thin(struct arena *arena) {
    static const double depths[] = {1e-4, 1e-3, 1e-2};
    const struct medium m = test_medium(arena, "homogeneous", "sigma_t=1 albedo=1");
    for (int i = 0; i < 3; i++) {
        struct sums s = {0};
        struct rng rng = {9};
        for (int k = 0; k < 4000000; k++) {
            float t;
            const float u = rng_float(&rng);
            struct flight f = fresh(&rng, -1);
            add(&s, medium_fly(&m, v3(0, 0, 0), v3(0, 0, 1), (float)depths[i], u, &f, &t));
        }
        char what[64];
        snprintf(what, sizeof what, "1 - T at depth %g", depths[i]);
        check_mean(what, &s, -expm1(-(double)(float)depths[i]));
    }
}

// ---- grids --------------------------------------------------------------------------------------

enum { SIDE = 20 };

// Noise, and far from the rays one voxel that raises the majorant of its cell tenfold.
static void fill(float *values, int channels, bool sparse) {
    struct rng rng = {21};
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        for (int c = 0; c < channels; c++)
            values[i * channels + c] = (sparse ? 0.05f : 0.02f) + (sparse ? 0.1f : 1) *
                                       rng_float(&rng) * (float)(c + 1);
    if (sparse)
        values[0] = 1;
}

// Trilinear, written once more and in double: values in the middles of voxels, clamped outside.
static double interpolate(const float *values, int channels, int c, const double p[3]) {
    double sum = 0;
    for (int corner = 0; corner < 8; corner++) {
        double w = 1;
        int index[3];
        for (int k = 0; k < 3; k++) {
            const double x = p[k] * SIDE - 0.5, below = floor(x);
            const int i = (int)below + (corner >> k & 1);
            w *= corner >> k & 1 ? x - below : 1 - (x - below);
            index[k] = i < 0 ? 0 : i >= SIDE ? SIDE - 1 : i;
        }
        sum += w * (double)values[((index[2] * SIDE + index[1]) * SIDE + index[0]) * channels + c];
    }
    return sum;
}

// Optical depth of the unit cube by brute force: the part of the ray inside, in small steps.
static double brute_depth(const float *values, int channels, int c, vec3 o, vec3 d, double end) {
    enum { STEPS = 400000 };
    double t0 = 0, t1 = end, sum = 0;
    for (int k = 0; k < 3; k++) {
        const double a = (0 - (double)o[k]) / (double)d[k], b = (1 - (double)o[k]) / (double)d[k];
        t0 = fmax(t0, fmin(a, b));
        t1 = fmin(t1, fmax(a, b));
    }
    for (int i = 0; i < STEPS && t0 < t1; i++) {
        const double t = t0 + (t1 - t0) * (i + 0.5) / STEPS;
        const double p[3] = {(double)o[0] + t * (double)d[0], (double)o[1] + t * (double)d[1],
                             (double)o[2] + t * (double)d[2]};
        sum += interpolate(values, channels, c, p);
    }
    return fmax(t1 - t0, 0) * sum / STEPS;
}

static const vec3 from = {-0.3f, 0.31f, 0.62f, 0};

static vec3 direction(void) {
    return normalize(v3(0.9f, 0.2f, -0.15f));
}

// T and 1 - T by ratio tracking; the depth is set by the medium's scale.
static void test_ratio_tracking(struct arena *arena, const struct object *density, double unit) {
    static const double depths[] = {1e-3, 1e-2, 0.1, 1, 5, 10, 20};
    for (size_t i = 0; i < sizeof depths / sizeof *depths; i++) {
        char text[64], what[64];
        snprintf(text, sizeof text, "scale=%.9g", depths[i] / unit);
        const struct medium m = test_grid_medium(arena, density, text);
        struct sums T = {0}, rest = {0};
        struct rng rng = {33};
        for (int k = 0; k < 400000; k++) {
            const double x = (double)medium_transmittance(&m, from, direction(), 2, &rng)[0];
            CHECK(x >= 0 && x <= 1);
            add(&T, x);
            add(&rest, 1 - x);
        }
        snprintf(what, sizeof what, "%s at depth %g", depths[i] < 0.05 ? "1 - T" : "T", depths[i]);
        if (depths[i] < 0.05)
            check_mean(what, &rest, -expm1(-depths[i]));
        else
            check_mean(what, &T, exp(-depths[i]));
    }
}

static void test_deep(struct arena *arena, const struct object *density) {
    struct rng rng = {4};
    for (double scale = 1e2; scale < 1e6; scale *= 10) {
        char text[64];
        snprintf(text, sizeof text, "scale=%.9g", scale);
        const struct medium m = test_grid_medium(arena, density, text);
        for (int k = 0; k < 100; k++) {
            const spectrum T = medium_transmittance(&m, from, direction(), 2, &rng);
            CHECK(spectrum_is_finite(T) && spectrum_min(T) >= 0);
        }
    }
}

// Quadrature against brute force, on rays from inside and outside.
static void test_optical_depth(const struct medium *m, const float *values, int channels) {
    struct rng rng = {12};
    double worst = 0;
    for (int i = 0; i < 20; i++) {
        vec3 o = {0}, d = {0};
        double depth[SPECTRUM_LANES];
        for (int k = 0; k < 3; k++) {
            o[k] = 1.4f * rng_float(&rng) - 0.2f;
            d[k] = rng_float(&rng) - 0.5f;
        }
        d = normalize(d);
        medium_optical_depth(m, o, d, 1.5f, depth);
        const int c = i % channels;
        const double expected = (double)m->scale * brute_depth(values, channels, c, o, d, 1.5);
        if (expected > 0)
            worst = fmax(worst, fabs(depth[c] / expected - 1));
        else
            CHECK(depth[c] == 0);
    }
    printf("  optical depth in %d channels: off by %.2g at most\n", channels, worst);
    CHECK(worst < 1e-5);
}

static void test_grid_flights(struct arena *arena, const struct object *grey,
                              const struct object *coloured) {
    double depth[3];
    const double albedo[3] = {0.7, 0.7, 0.7};
    struct medium m = test_grid_medium(arena, grey, "scale=4 albedo=0.7 emission=2");
    medium_optical_depth(&m, from, direction(), 2, depth);
    struct expectations e = expect(depth, albedo, 2);
    test_flights("grid", &m, from, direction(), 2, &e, 300000);
    m = test_grid_medium(arena, coloured, "scale=2 albedo=0.7 emission=2");
    medium_optical_depth(&m, from, direction(), 2, depth);
    e = expect(depth, albedo, 2);
    test_flights("coloured grid", &m, from, direction(), 2, &e, 300000);
}

static void test_grids(struct arena *arena) {
    static float grey[SIDE * SIDE * SIDE], sparse[SIDE * SIDE * SIDE], rgb[3 * SIDE * SIDE * SIDE];
    const int size[3] = {SIDE, SIDE, SIDE};
    double unit[SPECTRUM_LANES];
    fill(grey, 1, false);
    fill(sparse, 1, true);
    fill(rgb, 3, false);
    struct object *thin = test_grid(arena, size, 1, sparse, "");
    struct object *one = test_grid(arena, size, 1, grey, "");
    struct object *three = test_grid(arena, size, 3, rgb, "");
    struct medium m = test_grid_medium(arena, thin, "");
    medium_optical_depth(&m, from, direction(), 2, unit);
    test_ratio_tracking(arena, thin, unit[0]);
    test_deep(arena, thin);
    m = test_grid_medium(arena, one, "scale=1e4");
    test_optical_depth(&m, grey, 1);
    m = test_grid_medium(arena, three, "scale=0.01");
    test_optical_depth(&m, rgb, 3);
    test_grid_flights(arena, one, three);
    volume_gridvolume.finish(thin->data);
    volume_gridvolume.finish(one->data);
    volume_gridvolume.finish(three->data);
}

// ---- weights ------------------------------------------------------------------------------------

// Albedo 1: no event changes the weight.
static void test_weights(struct arena *arena) {
    struct rng rng = {8};
    float worst = 0;
    for (float sigma = 1e-3f; sigma < 1e6f; sigma *= 7.3f) {
        char text[64];
        snprintf(text, sizeof text, "sigma_t=%.9g albedo=1", (double)sigma);
        const struct medium m = test_medium(arena, "homogeneous", text);
        for (int i = 0; i < 1000; i++) {
            float t;
            struct flight f = fresh(&rng, i % 4 - 1);
            medium_fly(&m, v3(0, 0, 0), v3(0, 0, 1), 1, rng_float(&rng), &f, &t);
            worst = maxf(worst, fabsf(f.beta[0] / flight_ratio(f.ratio) - 1));
        }
    }
    printf("  weight of an event at albedo 1: off by %.2g at most\n", (double)worst);
    CHECK(worst < 1e-7f);
}

int main(void) {
    struct arena arena = {0};
    test_homogeneous(&arena);
    test_thin(&arena);
    test_grids(&arena);
    test_weights(&arena);
    arena_finish(&arena);
    return check_result();
}
