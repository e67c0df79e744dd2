// SPDX-License-Identifier: Apache-2.0
// Any reflection as curves: f = H(theta_h) G(theta_d), a channel each, the non-negative factors of
// measured materials that an edit works on (J. Lawrence et al. 2006). Squared errors count over the
// value itself: over its square the highlight, over 1 the body of the material would be lost.
#include "driver/brdf_factor.h"

#include <math.h>

#include "driver/brdf.h"
#include "table/merl.h"

enum { ROUNDS = 50 };             // of taking turns between H and G
static const double LEAST = 1e-6; // 1/sr: what is darker counts as this

// Means over phi_d, and what they count, with both cosines, so that grazing noise is quiet.
struct plane {
    double mean[MERL_THETA_H][MERL_THETA_D], weight[MERL_THETA_H][MERL_THETA_D];
};

static double weight_of(size_t cell) {
    vec3 wi, wo;
    merl_directions((int)(cell / (MERL_THETA_D * MERL_PHI_D)),
                    (int)(cell / MERL_PHI_D % MERL_THETA_D), (int)(cell % MERL_PHI_D), &wi, &wo);
    return merl_is_visible(wi, wo) ? (double)(wi[2] * wo[2]) : 0;
}

static void fill_plane(struct plane *p, const float (*rgb)[3], int channel) {
    double *const mean = &p->mean[0][0], *const weight = &p->weight[0][0];
    *p = (struct plane){.mean = {{0}}};
    for (size_t i = 0; i < MERL_CELLS; i++) {
        const double w = weight_of(i);
        mean[i / MERL_PHI_D] += w > 0 ? w * w * (double)rgb[i][channel] : 0;
        weight[i / MERL_PHI_D] += w * w;
    }
    for (int i = 0; i < MERL_THETA_H * MERL_THETA_D; i++) {
        mean[i] /= weight[i] > 0 ? weight[i] : 1;
        weight[i] /= fmax(mean[i], LEAST);
    }
}

// The factor that stands at `count` places a stride apart, the other as it is. Where nothing is seen
// it goes on from its neighbour.
static void fit_factor(const double *mean, const double *weight, int count, int stride,
                       double *factor, const double *other, int others, int other_stride) {
    for (int i = 0; i < count; i++) {
        double product = 0, square = 0;
        for (int j = 0; j < others; j++) {
            const int at = i * stride + j * other_stride;
            product += weight[at] * mean[at] * other[j];
            square += weight[at] * other[j] * other[j];
        }
        factor[i] = square > 0 ? product / square : i > 0 ? factor[i - 1] : 0;
    }
}

// What the factors miss of f cos_i cos_o, root of squares over the cells, relative.
static double missing(const float (*rgb)[3], int channel, const double *half,
                      const double *difference) {
    double squares = 0, rest = 0;
    for (size_t i = 0; i < MERL_CELLS; i++) {
        const double w = weight_of(i), f = (double)rgb[i][channel];
        const double g = half[i / (MERL_THETA_D * MERL_PHI_D)] *
                         difference[i / MERL_PHI_D % MERL_THETA_D];
        squares += w > 0 ? w * f * (w * f) : 0;
        rest += w > 0 ? w * (f - g) * (w * (f - g)) : 0;
    }
    return squares > 0 ? sqrt(rest / squares) : 0;
}

// Factors of one channel. Returns what they miss.
static double fit(struct plane *p, const float (*rgb)[3], int channel, double *half,
                  double *difference) {
    const double *const mean = &p->mean[0][0], *const weight = &p->weight[0][0];
    fill_plane(p, rgb, channel);
    for (int j = 0; j < MERL_THETA_D; j++)
        difference[j] = 1;
    for (int round = 0; round < ROUNDS; round++) {
        fit_factor(mean, weight, MERL_THETA_H, MERL_THETA_D, half, difference, MERL_THETA_D, 1);
        fit_factor(mean, weight, MERL_THETA_D, 1, difference, half, MERL_THETA_H, MERL_THETA_D);
    }
    return missing(rgb, channel, half, difference);
}

// A curve over the nodes of the table, and one at 90 degrees.
static struct curve *add_table(struct form *f, struct form_slot *slot, const char *name,
                               enum gamma_kind gamma, uint32_t count, enum basis_spacing spacing,
                               struct arena *arena) {
    *slot = form_add_curve(f, name, gamma, FUNCTION_CONSTANT, 1);
    const struct basis basis = basis_make(arena, BASIS_HAT, count + 1, spacing);
    struct curve *table = arena_alloc(arena, sizeof *table);
    *table = curve_make(arena, &basis, CURVE_CHANNELS);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        f->curve[slot->curve].f[k] = (struct curve_function){.kind = FUNCTION_TABLE, .table = table};
    return table;
}

bool brdf_factor(const struct material *m, const char *path, struct form *f, struct arena *arena) {
    if (bsdf_lobes(m->object) & (LOBE_DELTA | LOBE_TRANSMISSION)) {
        log_error("%s: %s lets light through or mirrors it, which curves do not hold; expected a "
                  "reflection without a delta", path, m->object->type->name);
        return false;
    }
    static const double white[CURVE_CHANNELS] = {1, 1, 1};
    float(*rgb)[3] = brdf_merl_values(m, path);
    struct plane *p = mem_array(1, sizeof *p);
    struct form_term *t = form_add_term(f, "specular", QUOTIENT_ONE, white, 1);
    struct curve *half = add_table(f, &t->slots[SLOT_A], "half", GAMMA_THETA_H, MERL_THETA_H,
                                   SPACING_QUADRATIC, arena);
    struct curve *difference = add_table(f, &t->slots[SLOT_B], "difference", GAMMA_THETA_D,
                                         MERL_THETA_D, SPACING_UNIFORM, arena);
    double rest = 0;
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        double *h = half->values + (size_t)k * (MERL_THETA_H + 1);
        double *d = difference->values + (size_t)k * (MERL_THETA_D + 1);
        rest = fmax(rest, fit(p, (const float(*)[3])rgb, k, h, d));
        h[MERL_THETA_H] = h[MERL_THETA_H - 1];
        d[MERL_THETA_D] = d[MERL_THETA_D - 1];
    }
    log_info("%s: factors of theta_h and theta_d; they miss %.1f %% of the values (root of squares, "
             "with both cosines)", path, 100 * rest);
    mem_free(rgb);
    mem_free(p);
    return true;
}
