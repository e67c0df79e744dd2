// SPDX-License-Identifier: Apache-2.0
#include "medium/tracking.h"

#include "math/elementary.h"
#include "medium/majorant.h"

// -log(1 - u) where u continues below the 24 bits of the first number, so that the thinnest media
// collide as often as they should and depths beyond 16 are reached.
static float exponential(float u, struct rng *rng) {
    const float rest = rng_float(rng) * 0x1p-24f;
    if (u >= 0.5f)
        return -fast_log(maxf((1 - u) - rest, 0x1p-50f));
    const float x = u + rest, w = 1 - x;
    // log(1 - x) = log(w) x / (1 - w) makes up for the rounding of w (Goldberg 1991, theorem 4)
    return w == 1 ? x : -fast_log(w) * (x / (1 - w));
}

static spectrum attenuation(spectrum depth) {
    return (spectrum){fast_exp(-depth[0]), fast_exp(-depth[1]), fast_exp(-depth[2]), 0};
}

// a t where 0 INFINITY is 0
static spectrum depth_over(spectrum sigma, float t) {
    spectrum depth = {0};
    for (int k = 0; k < SPECTRUM_LANES; k++)
        depth[k] = sigma[k] > 0 ? sigma[k] * t : 0;
    return depth;
}

static spectrum positive(spectrum s) {
    return (spectrum){maxf(s[0], 0), maxf(s[1], 0), maxf(s[2], 0), 0};
}

// ---- one majorant for all lanes -----------------------------------------------------------------

// A collision under the majorant: true when it scatters.
static bool collide_grey(const struct medium *m, vec3 p, float majorant, struct flight *f) {
    struct medium_point c;
    medium_at(m, p, &c);
    if (m->emits)
        f->emitted += f->beta * c.emission / (majorant * flight_ratio(f->ratio));
    const spectrum sigma_n = positive(majorant * spectrum_grey(1) - c.sigma_t);
    const float scatter = spectrum_mean(f->beta * c.sigma_s);
    const float null = spectrum_mean(f->beta * sigma_n);
    const float sum = scatter + null;
    if (!(sum > 0)) {
        f->beta = spectrum_grey(0);
        return false;
    }
    const bool scatters = null == 0 || (scatter > 0 && rng_float(f->rng) * sum < scatter);
    f->beta *= (scatters ? c.sigma_s : sigma_n) / majorant;
    f->beta *= sum / (scatters ? scatter : null);
    return scatters;
}

static bool fly_grey(const struct medium *m, vec3 o, vec3 d, float end, float u, struct flight *f,
                     float *t) {
    struct majorant_walk walk;
    struct majorant_piece piece;
    float left = exponential(u, f->rng);
    majorant_begin(&walk, m, o, d, end);
    while (majorant_next(&walk, &piece)) {
        const float majorant = spectrum_max(piece.most);
        float at = piece.a;
        while (majorant > 0 && at + left / majorant < piece.b) {
            at += left / majorant;
            if (collide_grey(m, o + at * d, majorant, f)) {
                *t = at;
                return true;
            }
            if (spectrum_is_black(f->beta))
                return false;
            left = exponential(rng_float(f->rng), f->rng);
        }
        if (majorant > 0)
            left = maxf(left - majorant * (piece.b - at), 0);
    }
    return false;
}

// ---- a majorant for each lane -------------------------------------------------------------------

// Only beta over ratio matters: keeps both far from overflow.
static void rescale(struct flight *f) {
    const float most = spectrum_max(f->ratio);
    if (most > 1e6f) {
        f->beta /= most;
        f->ratio /= most;
    }
}

// Goes on by `depth` (an optical depth a lane) with what the lane that is followed makes of it.
static void pass_spectral(spectrum depth, struct flight *f) {
    const spectrum T = attenuation(depth - depth[f->lane] * spectrum_grey(1));
    f->beta *= T;
    f->ratio *= T;
    rescale(f);
}

static bool collide_spectral(const struct medium *m, vec3 p, spectrum majorant, struct flight *f) {
    struct medium_point c;
    medium_at(m, p, &c);
    const int lane = f->lane;
    f->ratio *= majorant / majorant[lane];
    if (m->emits)
        f->emitted += f->beta * c.emission / (majorant[lane] * flight_ratio(f->ratio));
    const spectrum sigma_n = positive(majorant - c.sigma_t);
    const spectrum sum = c.sigma_s + sigma_n;
    if (!(sum[lane] > 0)) {
        f->beta = spectrum_grey(0);
        return false;
    }
    const float share = c.sigma_s[lane] / sum[lane];
    const bool scatters = share == 1 || rng_float(f->rng) < share;
    const spectrum chosen = scatters ? c.sigma_s : sigma_n;
    f->beta *= chosen / majorant[lane] * (sum[lane] / chosen[lane]);
    for (int k = 0; k < SPECTRUM_LANES; k++)
        f->ratio[k] = sum[k] > 0 ? f->ratio[k] * (chosen[k] / sum[k]) * (sum[lane] / chosen[lane]) : 0;
    return scatters;
}

static bool fly_spectral(const struct medium *m, vec3 o, vec3 d, float end, float u,
                         struct flight *f, float *t) {
    struct majorant_walk walk;
    struct majorant_piece piece;
    float left = exponential(u, f->rng);
    majorant_begin(&walk, m, o, d, end);
    while (majorant_next(&walk, &piece)) {
        const float majorant = piece.most[f->lane];
        float at = piece.a;
        while (majorant > 0 && at + left / majorant < piece.b) {
            pass_spectral(piece.most * (left / majorant), f);
            at += left / majorant;
            if (collide_spectral(m, o + at * d, piece.most, f)) {
                *t = at;
                return true;
            }
            if (spectrum_is_black(f->beta))
                return false;
            left = exponential(rng_float(f->rng), f->rng);
        }
        pass_spectral(depth_over(piece.most, piece.b - at), f);
        left = maxf(left - (majorant > 0 ? majorant * (piece.b - at) : 0), 0);
    }
    return false;
}

// ---- what both share ----------------------------------------------------------------------------

// A medium that scatters nowhere: light only fades, and what glows adds to it.
static void pass_absorbing(const struct medium *m, vec3 o, vec3 d, float end, float u,
                           struct flight *f) {
    const spectrum before = f->beta;
    float t;
    if (m->emits) // the collisions say what is gained; how much is left is known better
        (void)(f->lane < 0 ? fly_grey : fly_spectral)(m, o, d, end, u, f, &t);
    f->beta = before * medium_transmittance(m, o, d, end, f->rng);
}

bool medium_fly(const struct medium *m, vec3 o, vec3 d, float end, float u, struct flight *f,
                float *t) {
    f->emitted = spectrum_grey(0);
    if (!m->scatters) {
        const spectrum ratio = f->ratio;
        pass_absorbing(m, o, d, end, u, f);
        f->ratio = ratio;
        return false;
    }
    if (f->lane < 0 || (m->homogeneous && m->grey))
        return fly_grey(m, o, d, end, u, f, t);
    return fly_spectral(m, o, d, end, u, f, t);
}

float medium_free_path(const struct medium *m, float u, struct rng *rng) {
    return exponential(u, rng) / m->constant.sigma_t[0];
}

void medium_scatter(const struct medium *m, struct flight *f) {
    f->beta *= m->constant.sigma_s / m->constant.sigma_t[0];
}

spectrum medium_transmittance(const struct medium *m, vec3 o, vec3 d, float end, struct rng *rng) {
    const float speed = length(d);
    if (m->homogeneous)
        return attenuation(depth_over(m->constant.sigma_t, end * speed));
    struct majorant_walk walk;
    struct majorant_piece piece;
    spectrum T = spectrum_grey(1);
    float left = exponential(rng_float(rng), rng);
    majorant_begin(&walk, m, o, d, end);
    while (majorant_next(&walk, &piece)) {
        const float majorant = spectrum_max(piece.most), rate = majorant * speed;
        float at = piece.a;
        while (rate > 0 && at + left / rate < piece.b) {
            struct medium_point c;
            at += left / rate;
            medium_at(m, o + at * d, &c);
            T *= positive(spectrum_grey(1) - c.sigma_t / majorant);
            if (spectrum_is_black(T))
                return T;
            left = exponential(rng_float(rng), rng);
        }
        if (rate > 0)
            left = maxf(left - rate * (piece.b - at), 0);
    }
    return T;
}

// ---- quadrature ---------------------------------------------------------------------------------

struct depth_sum {
    const struct medium *m;
    vec3 o, d;
    double *out;
};

// Two points of Gauss and Legendre: exact for the cubics that trilinear voxels make along a ray.
static void add_piece(void *user, double a, double b) {
    const struct depth_sum *s = user;
    const double h = 0.5 * (b - a), x = 0.57735026918962576;
    for (int i = 0; i < 2; i++) {
        struct medium_point c;
        const double t = a + h * (1 + (i ? x : -x));
        medium_at(s->m, s->o + (float)t * s->d, &c);
        for (int k = 0; k < SPECTRUM_LANES; k++)
            s->out[k] += h * (double)c.sigma_t[k];
    }
}

void medium_optical_depth(const struct medium *m, vec3 o, vec3 d, float end,
                          double out[SPECTRUM_LANES]) {
    const struct volume_ref *density = m->type->density ? m->type->density(m->data) : NULL;
    const struct volume_type *type =
        density && density->volume ? volume_type_of(density->volume) : NULL;
    const double speed = (double)length(d);
    struct depth_sum sum = {m, o, d, out};
    for (int k = 0; k < SPECTRUM_LANES; k++)
        out[k] = 0;
    if (type && type->pieces) {
        type->pieces(density->volume->data, o, d, 0, end, add_piece, &sum);
        for (int k = 0; k < SPECTRUM_LANES; k++)
            out[k] *= speed;
        return;
    }
    for (int k = 0; k < SPECTRUM_LANES; k++)
        out[k] = m->most_t[k] > 0 ? (double)m->most_t[k] * (double)end * speed : 0;
}
