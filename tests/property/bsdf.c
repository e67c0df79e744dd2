// SPDX-License-Identifier: Apache-2.0
// Every material of the registry, in 20 parameter sets and more (every fifth one where
// RELUME_TEST_SANITIZED is set) and seen from 20 directions; only those named by arguments if there are
// any:
//
//  - samples against the density they claim: chi-square over bins around the lobe's peak, delta
//    lobes and failures to scatter as bins of their own; the bins' probabilities by adaptive
//    cubature; for each direction, and for the sum over all of them, which sees roughness that is
//    wrong by 3 % (1 % with RELUME_TEST_FULL). All tests together raise a false alarm with
//    probability 1 % (Sidak), once per choice of seeds;
//  - a sample's density and weight equal eval's; the density integrates to at most 1;
//  - the mean weight equals the directional albedo by cubature (z-test, counted with the above);
//  - reciprocity and energy where claimed; the albedos are printed as a table.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "cubature.h"
#include "math/hash.h"
#include "property/bsdf_cases.h"
#include "statistics.h"

enum { QUANTILES = 10, RINGS = 40, SECTORS = 6, DELTAS = 4 };

static int samples = 30000, wide_panels = 3;
static const double FALSE_ALARMS = 0.01;

// One hemisphere of wi, in polar coordinates (r, phi) around the direction of greatest density: at
// the angle and azimuth of the plane's point (r cos phi, squeeze r sin phi). At grazing incidence
// lobes are squeezed across the plane of incidence, which holds the frame's s.
struct side {
    float sign;
    struct frame pole;
    float pole_pdf;
    double squeeze;
    double edges[RINGS + 1];
    int rings;
    int count[RINGS][SECTORS];
};

struct delta {
    uint32_t lobe;
    double probability, weight; // weight: energy, lane mean
    int count;
};

struct run {
    const struct bsdf_case *c;
    const struct closure *closure;
    vec3 wo;
    float eta; // of the far side over wo's, as samples have it
    struct side sides[2];
    struct delta deltas[DELTAS];
    int failures;
    double sum, sum2; // of weights as energy
    const struct side *current;
};

// Energy per radiance: refraction's scaling of radiance divided out.
static float energy_factor(const struct run *r, vec3 wi) {
    return r->wo[2] * wi[2] > 0 ? 1 : sqr(r->eta);
}

static bool is_sane(spectrum f, float pdf) {
    return spectrum_is_finite(f) && spectrum_min(f) >= 0 && isfinite(pdf) && pdf >= 0;
}

static struct pair density(void *ctx, double radius, double phi) {
    const struct run *r = ctx;
    const double x = radius * cos(phi), y = r->current->squeeze * radius * sin(phi);
    const double theta = hypot(x, y);
    if (!(theta < M_PI))
        return (struct pair){0, 0};
    const double sinc = theta > 0 ? sin(theta) / theta : 1;
    const vec3 l = v3((float)(sinc * x), (float)(sinc * y), (float)cos(theta));
    const vec3 wi = normalize(to_world(&r->current->pole, l));
    float pdf;
    if (!(wi[2] * r->current->sign > 0))
        return (struct pair){0, 0};
    const spectrum f = closure_eval(r->closure, wi, &pdf);
    CHECK(is_sane(f, pdf));
    const double area = sinc * r->current->squeeze * radius;
    return (struct pair){pdf * area,
                         spectrum_mean(f) * energy_factor(r, wi) * area};
}

static struct side *side_of(struct run *r, vec3 wi) {
    return &r->sides[wi[2] > 0 ? 0 : 1];
}

static void polar(const struct side *s, vec3 wi, double *radius, double *phi) {
    const vec3 l = to_local(&s->pole, wi);
    const double across = hypot(l[0], l[1]), theta = atan2(across, l[2]);
    const double scale = across > 0 ? theta / across : 1;
    const double x = scale * l[0], y = scale * l[1] / s->squeeze;
    *radius = hypot(x, y);
    *phi = atan2(y, x);
    if (*phi < 0)
        *phi += 2 * M_PI;
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool draw(struct run *r, struct rng *rng, struct bsdf_sample *s) {
    const float u1 = rng_float(rng);
    const float u = rng_float(rng), v = rng_float(rng);
    return closure_sample(r->closure, u1, (struct vec2){u, v}, s);
}

// The index that refracted samples report; it must be the expected one where that is known.
static void learn_eta(struct run *r, const struct bsdf_sample *s) {
    if (s->wi[2] * r->wo[2] > 0 || s->lobe & LOBE_NULL)
        return;
    r->eta = s->eta;
    if (r->c->eta > 0)
        CHECK_NEAR(r->eta, r->wo[2] > 0 ? r->c->eta : 1 / r->c->eta, 1e-6);
}

// Rings of equal probability, by the sorted radii of pilot samples; then each twice as wide as all
// before it, so that cubature cannot overlook what is left.
static void place_rings(struct side *side, const double *radius, int n) {
    const int quantiles = n > 10 * QUANTILES ? QUANTILES : 2;
    side->rings = 0;
    for (int i = 1; i < quantiles && n > 4; i++)
        side->edges[++side->rings] = radius[n * i / quantiles];
    if (n <= 4)
        side->edges[++side->rings] = 0.1;
    while (side->rings < RINGS - 1 && 2 * side->edges[side->rings] < M_PI / side->squeeze) {
        side->edges[side->rings + 1] = 2 * side->edges[side->rings];
        side->rings++;
    }
    side->edges[++side->rings] = M_PI / side->squeeze;
}

// Poles and rings from a pilot run.
static void place_bins(struct run *r) {
    enum { PILOT = 1500 };
    static double radius[2][PILOT];
    static struct bsdf_sample s[PILOT];
    struct rng rng = {77};
    int used = 0, n[2] = {0, 0};
    for (int i = 0; i < 2; i++)
        r->sides[i] = (struct side){.sign = i ? -1 : 1, .squeeze = 1,
                                    .pole = frame_from_normal(v3(0, 0, i ? -1 : 1))};
    for (int i = 0; i < PILOT; i++) {
        if (!draw(r, &rng, &s[used]))
            continue;
        learn_eta(r, &s[used]);
        if (s[used].lobe & LOBE_DELTA)
            continue;
        struct side *side = side_of(r, s[used].wi);
        if (s[used].pdf_sa > side->pole_pdf) {
            side->pole_pdf = s[used].pdf_sa;
            side->pole = frame_from_normal_tangent(s[used].wi, v3(0, 0, 1));
            side->pole = frame_from_normal_tangent(s[used].wi, side->pole.s); // to full precision
            side->squeeze = side->pole_pdf > 50 ? fabsf(r->wo[2]) : 1;
        }
        used++;
    }
    for (int i = 0; i < used; i++) {
        const int k = s[i].wi[2] > 0 ? 0 : 1;
        double phi;
        polar(&r->sides[k], s[i].wi, &radius[k][n[k]++], &phi);
    }
    for (int k = 0; k < 2; k++) {
        qsort(radius[k], (size_t)n[k], sizeof(double), compare_doubles);
        place_rings(&r->sides[k], radius[k], n[k]);
    }
}

static void count_smooth(struct run *r, vec3 wi) {
    struct side *side = side_of(r, wi);
    double radius, phi;
    polar(side, wi, &radius, &phi);
    int ring = 0;
    while (ring + 1 < side->rings && radius >= side->edges[ring + 1])
        ring++;
    const int sector = (int)(phi / (2 * M_PI) * SECTORS);
    side->count[ring][sector < SECTORS ? sector : SECTORS - 1]++;
}

static void count_delta(struct run *r, const struct bsdf_sample *s, double energy) {
    for (int i = 0; i < DELTAS; i++) {
        struct delta *d = &r->deltas[i];
        if (d->count && (d->lobe != s->lobe || fabs(d->probability - s->pdf_sa) > 1e-6))
            continue;
        d->lobe = s->lobe;
        d->probability = s->pdf_sa;
        d->weight = energy;
        d->count++;
        return;
    }
    CHECK(!"more delta lobes than expected");
}

// A half vector found in single precision is off by about delta = 2^-24 / cos_o along the surface. At
// the slope t that changes Beckmann's exp(-t^2 / alpha^2) by 2 t delta / alpha^2, and t reaches 3.2
// alpha in 25 000 samples (exp(-10) are beyond): 6.4 delta / alpha. GGX changes by at most
// 2 delta / alpha. Found are up to 1.3 of this where delta decides, 0.048 at alpha = 2e-4 and cos_o =
// 0.03; half as much again is let pass.
static double tolerance_of(const struct run *r) {
    const double tolerance = r->c->tolerance > 0 ? r->c->tolerance : 2e-3;
    const double delta = 0x1p-24 / fabs((double)r->wo[2]);
    return r->c->alpha > 0 ? tolerance + 10 * delta / r->c->alpha : tolerance;
}

// A sample agrees with what eval says of its direction.
static void check_against_eval(const struct run *r, const struct bsdf_sample *s) {
    const double tolerance = tolerance_of(r);
    float pdf;
    const spectrum f = closure_eval(r->closure, s->wi, &pdf);
    CHECK(is_sane(f, pdf));
    if (!(pdf > 0) && s->pdf_sa < 1e-3f)
        return; // at the very edge of the lobe, to rounding
    CHECK_NEAR(pdf / s->pdf_sa, 1, tolerance);
    CHECK_NEAR(spectrum_max(f / pdf), spectrum_max(s->weight),
               tolerance * fmax(0.02, spectrum_max(s->weight)));
}

static void draw_samples(struct run *r, uint64_t seed) {
    struct rng rng = {seed};
    for (int i = 0; i < samples; i++) {
        struct bsdf_sample s;
        if (!draw(r, &rng, &s)) {
            r->failures++;
            continue;
        }
        CHECK(is_sane(s.weight, s.pdf_sa) && s.pdf_sa > 0 && s.eta > 0);
        CHECK(fabsf(length(s.wi) - 1) < 1e-5f);
        CHECK((s.lobe & r->closure->lobes) == s.lobe);
        CHECK(!(s.lobe & LOBE_REFLECTION) == !(s.wi[2] * r->wo[2] > 0));
        const double energy = spectrum_mean(s.weight) * sqr(s.eta);
        r->sum += energy;
        r->sum2 += energy * energy;
        if (s.lobe & LOBE_DELTA)
            count_delta(r, &s, energy);
        else
            count_smooth(r, s.wi);
        if (!(s.lobe & LOBE_DELTA) && i % 16 == 0)
            check_against_eval(r, &s);
    }
}

static void add_side(struct run *r, struct side *side, int fineness, struct chi2_bins *bins,
                     struct pair *total) {
    r->current = side;
    for (int i = 0; i < side->rings; i++) {
        for (int j = 0; j < SECTORS; j++) {
            const double w = 2 * M_PI / SECTORS;
            const int panels = fineness * (side->edges[i + 1] < 0.1 ? 1 : wide_panels);
            const struct pair p = cubature_panels(density, r, side->edges[i], side->edges[i + 1],
                                                  j * w, (j + 1) * w, panels,
                                                  (r->c->steps ? 6 : 0.6) / samples);
            chi2_add(bins, side->count[i][j], p.a * samples);
            total->a += p.a;
            total->b += p.b;
        }
    }
}

struct verdict {
    double p_chi2, p_mean, albedo;
    double statistic;
    int degrees;
};

static struct verdict judge(struct run *r, int fineness) {
    // what cubature misses
    struct chi2_bins bins = {.slack = (r->c->steps ? 2e-4 : 2e-5) * samples};
    struct pair total = {0, 0};
    for (int i = 0; i < 2; i++)
        add_side(r, &r->sides[i], fineness, &bins, &total);
    for (int i = 0; i < DELTAS && r->deltas[i].count; i++) {
        chi2_add(&bins, r->deltas[i].count, r->deltas[i].probability * samples);
        total.a += r->deltas[i].probability;
        total.b += r->deltas[i].probability * r->deltas[i].weight;
    }
    CHECK(total.a <= 1 + 2e-3);
    chi2_add(&bins, r->failures, fmax(1 - total.a, 0) * samples);
    const double mean = r->sum / samples;
    const double variance = fmax(r->sum2 / samples - mean * mean, 0) / samples;
    const double floor = r->c->steps ? 2e-3 : 4e-4; // of the cubature
    const double p_chi2 = chi2_finish(&bins);
    return (struct verdict){p_chi2,
                            normal_p_value((mean - total.b) / sqrt(variance + floor * floor)),
                            total.b, bins.statistic, bins.degrees > 0 ? bins.degrees - 1 : 0};
}

// Cubature that starts too coarsely can overlook a sliver: what fails is looked at more closely. The
// samples stay the same.
static struct verdict judge_well(struct run *r, double level) {
    struct verdict v = judge(r, 1);
    for (int fineness = 4; fineness <= 64 && (v.p_chi2 < level || v.p_mean < level); fineness *= 4)
        v = judge(r, fineness);
    return v;
}

static void check_reciprocity(const struct object *o, struct run *r) {
    struct rng rng = {5};
    const struct bsdf_point point = bsdf_case_point();
    const double tolerance = 2 * tolerance_of(r);
    for (int i = 0; i < 60; i++) {
        static struct closure_stack stack;
        struct bsdf_sample s;
        float pdf;
        if (!draw(r, &rng, &s) || s.lobe & LOBE_DELTA || fabsf(s.wi[2]) < 1e-3f)
            continue;
        const spectrum forth = closure_eval(r->closure, s.wi, &pdf) / fabsf(s.wi[2]) *
                               energy_factor(r, s.wi);
        stack.used = 0;
        const struct closure *back = bsdf_resolve(o, &point, s.wi, &stack);
        CHECK(back);
        if (!back)
            continue;
        const spectrum f = closure_eval(back, r->wo, &pdf) / fabsf(r->wo[2]);
        CHECK_NEAR(spectrum_max(f), spectrum_max(forth),
                   tolerance * fmax(spectrum_max(forth), 1e-3));
    }
}

static uint32_t claims_of(const struct object *o, const struct bsdf_case *c) {
    uint32_t claims = bsdf_type_of(o)->claims & ~c->waived;
    for (int i = 0; i < 2 && c->children[i]; i++) {
        char name[64];
        bsdf_first_word(c->children[i], name, sizeof name);
        const struct entry *e = registry_find(&bsdfs, name);
        claims &= ((const struct bsdf_type *)(const void *)e)->claims;
    }
    return claims;
}

static void check_verdict(const struct verdict *v, const struct bsdf_case *c, uint32_t claims,
                          int direction, double level) {
    if (v->p_chi2 < level || v->p_mean < level)
        printf("%s %s: direction %d: p(chi-square) %.3g, p(mean) %.3g, required %.3g\n", c->name,
               c->overrides, direction, v->p_chi2, v->p_mean, level);
    CHECK(v->p_chi2 >= level);
    CHECK(v->p_mean >= level);
    if (claims & CLAIM_ENERGY)
        CHECK(v->albedo <= 1 + 3e-4);
    if (claims & CLAIM_LOSSLESS && !c->overrides[0])
        CHECK_NEAR(v->albedo, 1, 1e-5);
}

static void print_albedos(const struct bsdf_case *c, const double *albedo) {
    for (int side = 0; side < 2; side++) {
        printf("%c", side ? '-' : '+');
        for (int d = 0; d < 10; d++)
            printf(" %.3f", albedo[10 * side + d]);
        printf("  ");
        bsdf_case_print(c);
        printf("\n");
    }
}

static uint64_t seed_of(const struct bsdf_case *c, int direction) {
    uint64_t seed = (uint64_t)direction;
    for (const char *s = c->name; *s; s++)
        seed = hash_u64(seed + (unsigned char)*s);
    for (const char *s = c->overrides; *s; s++)
        seed = hash_u64(seed + (unsigned char)*s);
    return seed;
}

static void run_case(struct arena *arena, const struct bsdf_case *c, double level) {
    const struct object *o = bsdf_case_make(arena, c);
    const struct bsdf_point point = bsdf_case_point();
    const uint32_t claims = claims_of(o, c);
    double albedo[BSDF_DIRECTIONS] = {0}, statistic = 0;
    int degrees = 0;
    for (int d = 0; d < BSDF_DIRECTIONS; d++) {
        static struct closure_stack stack;
        stack.used = 0;
        struct run r = {.c = c, .wo = bsdf_direction(d), .eta = 1};
        r.closure = bsdf_resolve(o, &point, r.wo, &stack);
        if (!r.closure)
            continue;
        CHECK((r.closure->lobes & bsdf_lobes(o)) == r.closure->lobes);
        place_bins(&r);
        draw_samples(&r, seed_of(c, d));
        const struct verdict v = judge_well(&r, level);
        albedo[d] = v.albedo;
        statistic += v.statistic;
        degrees += v.degrees;
        check_verdict(&v, c, claims, d, level);
        if (claims & CLAIM_RECIPROCAL)
            check_reciprocity(o, &r);
    }
    const double p_all = chi2_p_value(statistic, degrees);
    if (p_all < level)
        printf("%s %s: all directions: chi-square %.1f of %d degrees, p %.3g\n", c->name,
               c->overrides, statistic, degrees, p_all);
    CHECK(p_all >= level);
    print_albedos(c, albedo);
}

static void every_entry_has_its_sets(int argc, char **argv) {
    for (const struct entry *const *e = bsdfs.entries; *e; e++) {
        const int n = bsdf_set_count((*e)->name);
        if (!bsdf_is_asked(argc, argv, (*e)->name) || n >= BSDF_SETS)
            continue;
        if (n == 0 || (*e)->params) {
            printf("%s: %d parameter sets, expected %d\n", (*e)->name, n, BSDF_SETS);
            CHECK(!"enough parameter sets");
        }
    }
}

int main(int argc, char **argv) {
    const bool full = getenv("RELUME_TEST_FULL");
    if (full)
        samples = 400000, wide_panels = 8; // slivers of the hemisphere count then
    every_entry_has_its_sets(argc, argv);
    const double level = sidak(FALSE_ALARMS, bsdf_set_count(NULL) * (2 * BSDF_DIRECTIONS + 1));
    printf("directional albedo from outside (+) and inside (-) at 1 12 27 40 52 63 72 80 86 89 "
           "degrees\n");
    // Sanitizers look for other faults than wrong densities.
    const int stride = getenv("RELUME_TEST_SANITIZED") ? 5 : 1;
    for (int row = 0, set = 0; row < BSDF_ROWS; row++) {
        for (int i = 0; i < bsdf_row_sets(row); i++) {
            if (bsdf_is_asked(argc, argv, bsdf_rows[row].name) && set++ % stride)
                continue;
            struct arena arena = {0};
            if (bsdf_is_asked(argc, argv, bsdf_rows[row].name)) {
                const struct bsdf_case c = bsdf_case_at(&arena, row, i);
                run_case(&arena, &c, level);
            }
            arena_finish(&arena);
        }
    }
    return check_result();
}
