// SPDX-License-Identifier: Apache-2.0
// Elementary functions and angles of a number a lane, against those of the library.
#include "integrator/wide_angles.h"

#include "check.h"
#include "curve/overlap.h"
#include "integrator/wide_quotient.h"
#include "math/wide_arc.h"

static uint64_t state = 7;

static double uniform(void) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static double relative(double found, double expected) {
    return fabs(found - expected) / fmax(fabs(expected), 1e-30);
}

static void functions_agree(void) {
    double worst[5] = {0};
    for (int n = 0; n < 20000; n++) {
        wide x, y;
        for (int i = 0; i < WIDE_LANES; i++) {
            const float sign = uniform() < 0.5 ? -1 : 1;
            x[i] = (float)pow(10, 14 * uniform() - 12);
            y[i] = (float)pow(10, 14 * uniform() - 12) * sign;
        }
        const wide e = wide_exp(wide_min(x, wide_of(80))), l = wide_log(x), lp = wide_log1p(x);
        const wide em = wide_expm1(wide_min(x, wide_of(80))), a = wide_atan2(y, wide_negate(y < 0.1f, x));
        for (int i = 0; i < WIDE_LANES; i++) {
            const double v = (double)x[i], c = fmin(v, 80), s = y[i] < 0.1f ? -v : v;
            worst[0] = fmax(worst[0], relative((double)e[i], exp(c)));
            worst[1] = fmax(worst[1], fabs((double)l[i] - log(v)) / fmax(fabs(log(v)), 0.1));
            worst[2] = fmax(worst[2], relative((double)lp[i], log1p(v)));
            worst[3] = fmax(worst[3], relative((double)em[i], expm1(c)));
            worst[4] = fmax(worst[4], relative((double)a[i], atan2((double)y[i], s)));
        }
    }
    printf("relative errors: exp %.1e, log %.1e, log1p %.1e, expm1 %.1e, atan2 %.1e\n", worst[0],
           worst[1], worst[2], worst[3], worst[4]);
    for (int i = 0; i < 5; i++)
        CHECK(worst[i] < 1e-6);
    CHECK(wide_atan2(wide_of(0), wide_of(0))[0] == 0);
}

static struct direction random_direction(double least_z, double most_z) {
    const double z = least_z + (most_z - least_z) * uniform(), phi = 2 * M_PI * uniform();
    const double r = sqrt(1 - z * z);
    return (struct direction){r * cos(phi), r * sin(phi), z};
}

// Between them and wo the half vector is near the normal.
static struct direction near_mirrored(struct direction wo) {
    const double x = 1e-3 * uniform(), y = 1e-3 * uniform();
    return direction_of(x - wo.x, y - wo.y, wo.z);
}

static void angles_agree(void) {
    for (int kind = GAMMA_THETA_H; kind < GAMMA_COUNT; kind++) {
        const struct gamma g = {(enum gamma_kind)kind, 225};
        double worst = 0;
        for (int n = 0; n < 5000; n++) {
            const struct direction wo = random_direction(n % 10 ? 0.02 : 0.999999, 1);
            struct wide3 wi;
            for (int i = 0; i < WIDE_LANES; i++)
                wide3_set_lane(&wi, i, direction_round(n % 3 ? random_direction(0, 1) : near_mirrored(wo)));
            const wide found = wide_gamma(&g, wo, &wi);
            for (int i = 0; i < WIDE_LANES; i++) {
                const struct direction d = direction_from(wide3_lane(&wi, i));
                const double o[3] = {wo.x, wo.y, wo.z}, w[3] = {d.x, d.y, d.z};
                struct angles a = angles_make(o, w);
                const double expected = overlap_gamma(&g, &a);
                // rounding of the half vector turns it the further, the nearer it is to the normal
                const double room = kind == GAMMA_PHI_H || kind == GAMMA_RATIO
                                        ? 1e-6 / fmax(a.sin_h, 1e-6) : 1e-6;
                // and the sign is not where gamma is 0
                const double off = fabs(fabs((double)found[i]) - fabs(expected));
                worst = fmax(worst, off / room * 1e-6);
            }
        }
        printf("%-8s off by at most %.1e\n", gamma_names[kind], worst);
        CHECK(worst < 3e-6);
    }
}

static void quotients_agree(void) {
    for (int kind = 0; kind < QUOTIENT_COUNT; kind++) {
        struct arena arena = {0};
        struct quotient q = {.kind = (enum quotient_kind)kind, .roughness = 0.1, .isotropy = 0.5,
                             .has_fresnel = kind % 2};
        struct wide_quotient w;
        double worst = 0;
        for (int c = 0; c < CURVE_CHANNELS; c++)
            q.fresnel[c] = (struct curve_function){
                .kind = c ? FUNCTION_FRESNEL : FUNCTION_SCHLICK_F, .p = {c ? 1.5 : 0.04, c > 1 ? 3 : 0}};
        wide_quotient_init(&w, &q, &arena);
        for (int n = 0; n < 5000 && w.fits; n++) {
            const struct direction wo = random_direction(0.01, 1);
            struct wide3 wi;
            wide out[CURVE_CHANNELS];
            for (int i = 0; i < WIDE_LANES; i++)
                wide3_set_lane(&wi, i, direction_round(random_direction(-0.1, 1)));
            wide_quotient_cos(&w, wo, &wi, out);
            for (int i = 0; i < WIDE_LANES; i++) {
                const struct direction d = direction_from(wide3_lane(&wi, i));
                struct angles a = angles_make((double[3]){wo.x, wo.y, wo.z}, (double[3]){d.x, d.y, d.z});
                double expected[CURVE_CHANNELS];
                quotient_cos(&q, &a, expected);
                for (int c = 0; c < CURVE_CHANNELS; c++)
                    worst = fmax(worst, fabs((double)out[c][i] - expected[c]) /
                                            (fabs(expected[c]) + 1e-3));
            }
        }
        printf("%-12s off by at most %.1e\n", quotient_names[kind], worst);
        CHECK(worst < 3e-5);
        arena_finish(&arena);
    }
}

int main(void) {
    functions_agree();
    angles_agree();
    quotients_agree();
    return check_result();
}
