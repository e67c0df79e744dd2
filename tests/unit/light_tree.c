// SPDX-License-Identifier: Apache-2.0
// The light tree against brute force: what can light a place has a probability, the probabilities
// of all lights sum to 1, choose draws from them (chi-square, false alarm 1e-3 in all), all lanes
// together have the bits of each alone, and nothing depends on the unit of length or of intensity.
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "check.h"
#include "light/light_tree.h"
#include "math/hash.h"
#include "statistics.h"

enum { MOST = 4000, PLACES = 40 };

struct emitter {
    vec3 v[3];      // of a triangle; all the same: a point
    vec3 n;         // of the triangle
    vec3 axis;      // of a spot
    float cutoff;   // cosine; -1: a point that shines all around
    float strength; // radiance or intensity
};

static struct emitter emitters[MOST];
static struct light_bounds bounds[MOST];
static int tested;

static float number(struct rng *r) {
    return 2 * rng_float(r) - 1;
}

static vec3 direction(struct rng *r) {
    for (;;) {
        const vec3 d = v3(number(r), number(r), number(r));
        if (length2(d) > 0.01f && length2(d) < 1)
            return normalize(d);
    }
}

static struct light_bounds bounds_of(const struct emitter *e) {
    struct light_bounds b = {.min = e->v[0], .max = e->v[0], .axis = e->n, .cos_o = 1};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            b.min[k] = minf(b.min[k], e->v[i][k]);
            b.max[k] = maxf(b.max[k], e->v[i][k]);
        }
    const vec3 c = cross(e->v[1] - e->v[0], e->v[2] - e->v[0]);
    if (length2(e->n) > 0) {
        b.intensity = 0.5f * length(c) * e->strength;
        return b;
    }
    b.axis = e->axis;
    b.cos_o = e->cutoff;
    b.cos_e = e->cutoff > -1 ? 0.99f : 0;
    b.intensity = e->strength;
    return b;
}

// Clouds of lights: small triangles, large ones, points, spots; some without area, some black.
static void make(struct rng *r, int count, float scale) {
    for (int i = 0; i < count; i++) {
        const vec3 centre = v3(number(r), number(r), 0.3f * number(r)) * (i % 3 ? 1.0f : 5.0f);
        const float size = i % 7 == 0 ? 2 : 0.05f;
        struct emitter *e = &emitters[i];
        *e = (struct emitter){.strength = expf(6 * number(r)), .cutoff = -1};
        for (int k = 0; k < 3; k++)
            e->v[k] = scale * (centre + size * direction(r));
        if (i % 5 == 0) {
            e->v[1] = e->v[2] = e->v[0] = scale * centre;
            e->axis = direction(r);
            e->cutoff = i % 10 ? 0.9f * number(r) : -1;
        } else {
            e->n = normalize(cross(e->v[1] - e->v[0], e->v[2] - e->v[0]));
        }
        if (i % 101 == 1)
            e->v[2] = e->v[1], e->n = direction(r), e->strength = 1; // a line
        if (i % 103 == 1)
            e->strength = 0;
        bounds[i] = bounds_of(e);
    }
}

// Whether the emitter lights p from one of several of its points.
static bool lights(const struct emitter *e, vec3 p, struct rng *r) {
    if (!(e->strength > 0))
        return false;
    if (!(length2(e->n) > 0))
        return length2(p - e->v[0]) > 0 && dot(normalize(p - e->v[0]), e->axis) > e->cutoff;
    if (!(length2(cross(e->v[1] - e->v[0], e->v[2] - e->v[0])) > 0))
        return false;
    for (int i = 0; i < 8; i++) {
        const float b1 = rng_float(r), b2 = (1 - b1) * rng_float(r);
        const vec3 q = (1 - b1 - b2) * e->v[0] + b1 * e->v[1] + b2 * e->v[2];
        if (dot(p - q, e->n) > 1e-6f * length(p - q))
            return true;
    }
    return false;
}

// Places around, on and far from the lights.
static struct light_place place(struct rng *r, int k, int count, float scale) {
    const struct emitter *e = &emitters[(int)(rng_float(r) * (float)count)];
    vec3 p = scale * v3(6 * number(r), 6 * number(r), number(r));
    if (k % 4 == 1)
        p = (e->v[0] + e->v[1] + e->v[2]) / 3; // on a light
    if (k % 4 == 2)
        p += 1e4f * scale * direction(r);
    if (k % 4 == 3)
        p = e->v[0] + 1e-3f * scale * direction(r);
    return (struct light_place){p, k % 3 ? direction(r) : v3(0, 0, 0)};
}

static void check_place(const struct light_tree *t, const struct light_place *at, int count,
                        struct rng *r) {
    double sum = 0;
    int unreachable = 0;
    for (int i = 0; i < count; i++) {
        const float pmf = light_tree_pmf(t, at, (uint32_t)i);
        CHECK(pmf >= 0 && pmf <= 1);
        sum += (double)pmf;
        unreachable += !(pmf > 0) && lights(&emitters[i], at->p, r);
    }
    CHECK(unreachable == 0);
    // Below 1 where a node was entered all of whose children turn out to be dark.
    CHECK(sum <= 1 + 1e-5);
    for (int i = 0; i < 200; i++) {
        const struct light_leaf *leaf;
        float pmf;
        if (!light_tree_choose(t, at, (double)rng_float(r), &leaf, &pmf))
            continue;
        CHECK(leaf->item < (uint32_t)count && pmf > 0);
        CHECK_NEAR(light_tree_pmf(t, at, leaf->item) / pmf, 1, 1e-5);
    }
}

// All lanes together have the bits of each alone.
static void check_lanes(const struct light_tree *t, int count, float scale, struct rng *r) {
    struct light_place at[WIDE_LANES];
    double u[WIDE_LANES];
    const struct light_leaf *leaves[WIDE_LANES];
    float pmfs[WIDE_LANES];
    const uint32_t wanted = rng_u32(r) & WIDE_ALL;
    for (int i = 0; i < WIDE_LANES; i++) {
        at[i] = place(r, i, count, scale);
        u[i] = (double)rng_float(r);
    }
    const uint32_t found = light_tree_choose_lanes(t, wanted, at, u, leaves, pmfs);
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct light_leaf *leaf = NULL;
        float pmf = 0;
        const bool lit = wanted >> i & 1 && light_tree_choose(t, &at[i], u[i], &leaf, &pmf);
        CHECK(lit == (found >> i & 1));
        CHECK(!lit || (leaf == leaves[i] && pmf == pmfs[i]));
    }
}

static double choice_p_value(const struct light_tree *t, const struct light_place *at, int count,
                             struct rng *r) {
    static int observed[MOST];
    enum { SAMPLES = 200000 };
    struct chi2_bins bins = {0};
    int refused = 0;
    double sum = 0;
    memset(observed, 0, sizeof observed);
    for (int i = 0; i < SAMPLES; i++) {
        const struct light_leaf *leaf;
        float pmf;
        if (light_tree_choose(t, at, (double)rng_float(r) + 0x1p-24 * (double)rng_float(r), &leaf,
                              &pmf))
            observed[leaf->item]++;
        else
            refused++;
    }
    for (int i = 0; i < count; i++) {
        const double pmf = (double)light_tree_pmf(t, at, (uint32_t)i);
        chi2_add(&bins, observed[i], pmf * SAMPLES);
        sum += pmf;
    }
    chi2_add(&bins, refused, fmax(1 - sum, 0) * SAMPLES);
    tested++;
    return chi2_finish(&bins);
}

static void check_clouds(void) {
    static const int counts[] = {1, 2, 3, 4, 5, 17, 300, MOST};
    static const float scales[] = {1e-6f, 1, 1e6f};
    double least = 1;
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
        for (int s = 0; s < 3; s++) {
            struct rng r = {100 * c + (size_t)s};
            struct light_tree t;
            make(&r, counts[c], scales[s]);
            light_tree_init(&t, bounds, (uint32_t)counts[c]);
            for (int k = 0; k < PLACES; k++) {
                const struct light_place at = place(&r, k, counts[c], scales[s]);
                check_place(&t, &at, counts[c], &r);
                check_lanes(&t, counts[c], scales[s], &r);
                if (k < 2)
                    least = fmin(least, choice_p_value(&t, &at, counts[c], &r));
            }
            light_tree_finish(&t);
        }
    printf("%d chi-square tests, smallest p %.3g\n", tested, least);
    CHECK(least >= 1e-3 / tested);
}

// Powers of two in length and intensity change no bit.
static void check_units(void) {
    struct rng r = {3};
    struct light_tree t, scaled;
    static struct light_bounds big[300];
    make(&r, 300, 1);
    for (int i = 0; i < 300; i++) {
        big[i] = bounds[i];
        big[i].min *= 0x1p20f;
        big[i].max *= 0x1p20f;
        big[i].intensity *= 0x1p31f;
    }
    light_tree_init(&t, bounds, 300);
    light_tree_init(&scaled, big, 300);
    for (int k = 0; k < PLACES; k++) {
        const struct light_place at = place(&r, k, 300, 1);
        const struct light_place far = {at.p * 0x1p20f, at.n};
        for (uint32_t i = 0; i < 300; i++)
            CHECK(light_tree_pmf(&t, &at, i) == light_tree_pmf(&scaled, &far, i));
    }
    light_tree_finish(&t);
    light_tree_finish(&scaled);
}

// All in one place, intensities as far apart as they get, nothing that shines, no light at all.
static void check_extremes(void) {
    struct light_tree t;
    const struct light_place at = {v3(1, 2, 3), v3(0, 0, 1)};
    const struct light_leaf *leaf;
    float pmf;
    for (int i = 0; i < 1000; i++)
        bounds[i] = (struct light_bounds){.axis = v3(0, 0, 1), .cos_o = -1,
                                          .intensity = i % 2 ? 1e-30f : 3e38f};
    light_tree_init(&t, bounds, 1000);
    double sum = 0;
    for (uint32_t i = 0; i < 1000; i++) {
        CHECK(light_tree_pmf(&t, &at, i) > 0);
        sum += (double)light_tree_pmf(&t, &at, i);
    }
    CHECK_NEAR(sum, 1, 1e-5);
    const struct light_place on = {v3(0, 0, 0), v3(0, 0, 1)};
    CHECK(light_tree_choose(&t, &on, 0.3, &leaf, &pmf) && pmf > 0 && pmf <= 1);
    light_tree_finish(&t);
    for (int i = 0; i < 10; i++)
        bounds[i].intensity = 0;
    light_tree_init(&t, bounds, 10);
    CHECK(!light_tree_choose(&t, &at, 0.3, &leaf, &pmf) && light_tree_pmf(&t, &at, 3) == 0);
    light_tree_finish(&t);
    light_tree_init(&t, bounds, 0);
    CHECK(!light_tree_choose(&t, &at, 0.3, &leaf, &pmf));
    light_tree_finish(&t);
}

// Nodes on the way to a chosen light, in the mean, at places in its middle.
static double nodes_visited(const struct light_tree *t, struct rng *r) {
    enum { CHOICES = 2000 };
    size_t nodes = 0;
    for (int i = 0; i < CHOICES; i++) {
        const struct light_place at = {0.5f * v3(number(r), number(r), number(r)), direction(r)};
        const struct light_leaf *leaf;
        float pmf;
        CHECK(light_tree_choose(t, &at, (double)rng_float(r), &leaf, &pmf));
        nodes += (size_t)light_tree_depth(t, leaf->item);
    }
    return (double)nodes / CHOICES;
}

static void check_size(void) {
    enum { MANY = 1000000 };
    struct light_bounds *many = mem_array(MANY, sizeof *many);
    struct rng r = {8};
    struct light_tree t;
    for (int i = 0; i < MANY; i++) {
        const vec3 d = direction(&r);
        many[i] = (struct light_bounds){.min = d, .max = d * 1.001f, .axis = -d, .cos_o = 1,
                                        .intensity = 1e-6f};
    }
    // log n: no more than 1.4 times the depth of a full tree of sixteen children
    for (uint32_t n = 100; n < MANY; n *= 100) {
        light_tree_init(&t, many, n);
        const double nodes = nodes_visited(&t, &r);
        printf("%u lights: %.1f nodes a choice\n", n, nodes);
        CHECK(nodes < 1.4 * log(n) / log(16));
        light_tree_finish(&t);
    }
    const double start = time_seconds();
    light_tree_init(&t, many, MANY);
    const double bytes = (double)light_tree_bytes(&t) / MANY;
    printf("1e6 lights: built in %.2f s, %.1f bytes each\n", time_seconds() - start, bytes);
    CHECK(bytes < 120);
    const double nodes = nodes_visited(&t, &r);
    printf("1e6 lights: %.1f nodes a choice\n", nodes);
    CHECK(nodes < 1.4 * log(MANY) / log(16));
    light_tree_finish(&t);
    mem_free(many);
}

int main(void) {
    check_clouds();
    check_units();
    check_extremes();
    check_size();
    return check_result();
}
