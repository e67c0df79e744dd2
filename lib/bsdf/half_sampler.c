// SPDX-License-Identifier: Apache-2.0
#include "bsdf/half_sampler.h"

#include "math/distribution.h"
#include "math/frame.h"
#include "math/warp.h"

static const float COSINE_SHARE = 0.1f;

// Azimuth of wo as a rotation; 1, 0 at the pole.
struct turn {
    float c, s;
};

static struct turn turn_of(vec3 wo) {
    const float across = sqrtf(wo[0] * wo[0] + wo[1] * wo[1]);
    return across > 0 ? (struct turn){wo[0] / across, wo[1] / across} : (struct turn){1, 0};
}

static double ring_edge(int i) {
    const double u = (double)i / HALF_RINGS;
    const double sine = sin(u * u * M_PI / 4);
    return sine * sine;
}

// The half vector of sin^2(theta/2) = s and azimuth phi relative to the eye's.
static vec3 half_vector(float s, float phi_turns, struct turn t) {
    float sine, cosine;
    const float z = 1 - 2 * s, r = 2 * sqrtf(maxf(s * (1 - s), 0));
    sincos_turn(phi_turns, &sine, &cosine);
    return v3(r * (cosine * t.c - sine * t.s), r * (sine * t.c + cosine * t.s), z);
}

// Integral of f cos_i over the cell.
static spectrum cell_value(half_value value, const void *table, vec3 wo, int ring, int sector) {
    enum { ACROSS = 2, AROUND = 2 };
    const double a = ring_edge(ring), b = ring_edge(ring + 1);
    const struct turn turn = turn_of(wo);
    spectrum sum = spectrum_grey(0);
    for (int i = 0; i < ACROSS; i++)
        for (int j = 0; j < AROUND; j++) {
            const double s = a + (b - a) * (i + 0.5) / ACROSS;
            const double phi = (sector + (j + 0.5) / AROUND) / HALF_SECTORS;
            const vec3 h = half_vector((float)s, (float)phi, turn), wi = reflect(wo, h);
            if (wi[2] > 0 && dot(wo, h) > 0)
                sum += value(table, wo, normalize(wi)) * (4 * dot(wo, h));
        }
    const double solid_angle = 4 * M_PI * (b - a) / HALF_SECTORS;
    return sum * (float)(solid_angle / (ACROSS * AROUND));
}

static vec3 eye_direction(float phi, float theta) {
    const float t = minf(theta, 0.4999f * PI); // grazing has a lobe, too
    return v3(sinf(t) * cosf(phi), sinf(t) * sinf(phi), cosf(t));
}

static void build_cdf(float *cdf, const double *weights) {
    double total = 0, sum = 0;
    for (int i = 0; i < HALF_CELLS; i++)
        total += weights[i];
    for (int i = 0; i < HALF_CELLS; i++) {
        sum += weights[i];
        cdf[i + 1] = total > 0 ? (float)(sum / total) : (float)(i + 1) / HALF_CELLS;
    }
    cdf[HALF_CELLS] = 1;
}

static spectrum build_slice(half_value value, const void *table, vec3 wo, double *weights) {
    spectrum albedo = spectrum_grey(0);
    for (int i = 0; i < HALF_CELLS; i++) {
        const spectrum v = cell_value(value, table, wo, i / HALF_SECTORS, i % HALF_SECTORS);
        albedo += v;
        weights[i] = (double)spectrum_mean(v);
    }
    return albedo;
}

spectrum half_sampler_integrate(half_value value, const void *table, vec3 wo) {
    double weights[HALF_CELLS];
    return build_slice(value, table, wo, weights);
}

void half_sampler_init(struct half_sampler *s, const int counts[2], const float *const params[2],
                       half_value value, const void *table, struct arena *arena) {
    const size_t slices = (size_t)counts[0] * (size_t)counts[1];
    *s = (struct half_sampler){.counts = {counts[0], counts[1]}, .params = {params[0], params[1]}};
    s->cdf = arena_alloc(arena, slices * sizeof *s->cdf);
    s->albedo = arena_alloc(arena, slices * sizeof *s->albedo);
    for (int i = 0; i <= HALF_RINGS; i++)
        s->ring[i] = (float)ring_edge(i);
    for (size_t i = 0; i < slices; i++) {
        double weights[HALF_CELLS];
        const vec3 wo = eye_direction(params[0][i / (size_t)counts[1]],
                                      params[1][i % (size_t)counts[1]]);
        s->albedo[i] = build_slice(value, table, wo, weights);
        build_cdf(s->cdf[i], weights);
    }
}

struct slice_mix half_sampler_at(const struct half_sampler *s, vec3 wo) {
    const float theta = atan2f(sqrtf(wo[0] * wo[0] + wo[1] * wo[1]), wo[2]);
    const float phi = s->counts[0] > 1 ? atan2f(wo[1], wo[0]) : 0;
    return slice_mix_at(s->counts, s->params, phi < 0 ? phi + TWO_PI : phi, theta);
}

spectrum half_sampler_albedo(const struct half_sampler *s, const struct slice_mix *mix) {
    spectrum sum = spectrum_grey(0);
    for (int k = 0; k < mix->count; k++)
        sum += mix->weight[k] * s->albedo[mix->slice[k]];
    return sum;
}

vec3 half_sampler_sample(const struct half_sampler *s, const struct slice_mix *mix, vec3 wo,
                         float u1, struct vec2 u2) {
    if (u1 < COSINE_SHARE)
        return warp_cosine_hemisphere(u2);
    float u = (u1 - COSINE_SHARE) / (1 - COSINE_SHARE), across;
    int k = 0;
    while (k + 1 < mix->count && u >= mix->weight[k])
        u -= mix->weight[k++];
    const int cell = (int)cdf_find(s->cdf[mix->slice[k]], HALF_CELLS, u2.x, &across);
    const int ring = cell / HALF_SECTORS, sector = cell % HALF_SECTORS;
    const float around = ((float)sector + u2.y) * (1.0f / HALF_SECTORS);
    const vec3 h = half_vector(lerpf(across, s->ring[ring], s->ring[ring + 1]), around, turn_of(wo));
    return normalize(reflect(wo, h));
}

float half_sampler_pdf_sa(const struct half_sampler *s, const struct slice_mix *mix, vec3 wo,
                          vec3 wi) {
    const vec3 h = normalize(wo + wi);
    const struct turn t = turn_of(wo);
    const float theta = 2 * asinf(minf(0.5f * length(h - v3(0, 0, 1)), 1));
    const float x = h[0] * t.c + h[1] * t.s, y = h[1] * t.c - h[0] * t.s;
    const float turns = atan2f(y, x) * (1 / TWO_PI);
    int ring = (int)(sqrtf(theta * (2 / PI)) * HALF_RINGS);
    int sector = (int)((turns < 0 ? turns + 1 : turns) * HALF_SECTORS);
    ring = ring < HALF_RINGS ? ring : HALF_RINGS - 1;
    sector = sector < HALF_SECTORS ? sector : HALF_SECTORS - 1;
    const int cell = ring * HALF_SECTORS + sector;
    float probability = 0;
    for (int k = 0; k < mix->count; k++)
        probability += mix->weight[k] * (s->cdf[mix->slice[k]][cell + 1] - s->cdf[mix->slice[k]][cell]);
    const float solid_angle = 4 * PI / HALF_SECTORS * (s->ring[ring + 1] - s->ring[ring]);
    return (1 - COSINE_SHARE) * probability / (solid_angle * 4 * maxf(dot(wo, h), 1e-6f)) +
           COSINE_SHARE * INV_PI * maxf(wi[2], 0);
}
