// SPDX-License-Identifier: Apache-2.0
// The sky as triangles: together they are the sphere, they keep its light, and they are small where
// it is.
#include "light/light_triangles.h"

#include "check.h"

// Integrals over the sphere: 4 pi; (2 pi / 3)(1, 1, 1) + ...; the disk's 2 pi (1 - cos r).
static spectrum one(const void *ctx, vec3 w) {
    (void)ctx;
    (void)w;
    return spectrum_grey(1);
}

static spectrum smooth(const void *ctx, vec3 w) {
    (void)ctx;
    return spectrum_rgb(w[1] * w[1], 1 + w[0], maxf(w[2], 0));
}

static spectrum sun(const void *ctx, vec3 w) {
    const float *radius = ctx;
    return spectrum_grey(dot(w, normalize(v3(0.3f, 0.8f, -0.2f))) > cosf(*radius) ? 1e6f : 0.01f);
}

static spectrum dark(const void *ctx, vec3 w) {
    (void)ctx;
    (void)w;
    return spectrum_grey(0);
}

static double covered(const struct light_triangles *t) {
    double sum = 0;
    for (uint32_t i = 0; i < t->count; i++)
        sum += t->items[i].solid_angle;
    return sum;
}

static void keeps_light(void) {
    static const uint32_t sizes[] = {8, 100, 400, 4000, 16000};
    for (int i = 0; i < 5; i++) {
        struct light_triangles t;
        light_triangles_init(&t, &(struct sky){one, NULL, 0}, sizes[i], 2);
        CHECK(t.count <= sizes[i] && t.count + 3 > sizes[i]);
        CHECK_NEAR(t.power[1], 4 * M_PI, 1e-10);
        CHECK_NEAR(covered(&t), 4 * M_PI, 1e-10);
        light_triangles_finish(&t);
        light_triangles_init(&t, &(struct sky){smooth, NULL, 0}, sizes[i], 2);
        CHECK_NEAR(t.power[0], 4 * M_PI / 3, 1e-4);
        CHECK_NEAR(t.power[1], 4 * M_PI, 1e-6);
        CHECK_NEAR(t.power[2], M_PI, 1e-4);
        light_triangles_finish(&t);
    }
}

// A disk of 0.27 degrees that is most of the light gets most of the triangles that are small.
static void refines_where_light_is(void) {
    const float radius = 0.27f * PI / 180;
    const double disk = 2 * M_PI * (1 - cos((double)radius)) * (1e6 - 0.01);
    struct light_triangles t;
    light_triangles_init(&t, &(struct sky){sun, &radius, (double)radius}, 4000, 2);
    CHECK_NEAR(t.power[0], disk + 4 * M_PI * 0.01, 0.01 * disk);
    uint32_t small = 0;
    double brightest = 0;
    for (uint32_t i = 0; i < t.count; i++) {
        small += t.items[i].solid_angle < 1e-5;
        brightest = fmax(brightest, t.items[i].power[0]);
    }
    printf("sun: %.3f %% off, %u small triangles, the brightest has %.2g of the light\n",
           100 * (t.power[0] / (disk + 4 * M_PI * 0.01) - 1), small, brightest / t.power[0]);
    CHECK(small > 500 && brightest < 0.01 * t.power[0]);
    light_triangles_finish(&t);
}

static void leaves_out_darkness(void) {
    struct light_triangles t;
    light_triangles_init(&t, &(struct sky){dark, NULL, 0}, 400, 1);
    CHECK(t.count == 0);
    light_triangles_finish(&t);
}

// A list for few triangles and what one for many has more are the list for many.
static void is_refined(void) {
    struct light_triangles few, many, more;
    double sum[3] = {0}, negative = 0;
    uint32_t taken = 0;
    light_triangles_init(&few, &(struct sky){smooth, NULL, 0}, 400, 2);
    light_triangles_init(&many, &(struct sky){smooth, NULL, 0}, 4000, 2);
    light_triangles_init(&more, &(struct sky){smooth, NULL, 0}, 4000, 2);
    light_triangles_refine(&more, &few);
    for (uint32_t i = 0; i < more.count; i++) {
        const double power = more.items[i].power[1];
        taken += power < 0;
        negative -= power < 0 ? power : 0;
        for (int k = 0; k < 3; k++)
            sum[k] += more.items[i].power[k];
    }
    printf("from 400 to 4000: %u triangles, %u of them taken away\n", more.count, taken);
    CHECK(few.count - taken + (more.count - taken) == many.count);
    CHECK(taken > 100 && taken <= few.count && negative > 0);
    for (int k = 0; k < 3; k++)
        CHECK_NEAR(sum[k], 0, 1e-9);
    light_triangles_refine(&many, &many);
    CHECK(many.count == 0);
    light_triangles_finish(&few);
    light_triangles_finish(&many);
    light_triangles_finish(&more);
}

int main(void) {
    is_refined();
    keeps_light();
    refines_where_light_is();
    leaves_out_darkness();
    return check_result();
}
