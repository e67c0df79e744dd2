// SPDX-License-Identifier: Apache-2.0
#include "bsdf/facet_loss.h"

#include "math/elementary.h"
#include "math/fresnel.h"

// Cosines are equally spaced in their square roots, azimuths over a quarter turn, roughnesses in
// sqrt(alpha / (1 + alpha)).
enum { COSINES = 128, AZIMUTHS = 32, ALPHAS = 40 };

enum { NODES = 96, NODES_OF_MANY = 48 }; // of E's quadrature, in each dimension

const char *const energy_choices[] = {"single", "compensated", NULL};

double facet_albedo_error(int nodes, bool critical) {
    if (nodes >= NODES)
        return critical ? 2.7e-3 : 3e-4;
    return critical ? 1.1e-2 : 1.5e-3;
}

static vec3 direction(int azimuth, int azimuths, int cosine) {
    const float s = (float)cosine / COSINES, mu = maxf(s * s, 1e-6f);
    const float r = safe_sqrt((1 - mu) * (1 + mu));
    const float phi = azimuths > 1 ? 0.5f * PI * (float)azimuth / (float)(azimuths - 1) : 0;
    return v3(r * cosf(phi), r * sinf(phi), mu);
}

// Adds to cell[i] the integral of 2 lost(mu) mu dmu = 4 lost(s) s^3 ds over each cell of a row,
// where lost is linear in s: exact.
static void add_cells(double *cell, const float *row, double factor) {
    for (int i = 0; i < COSINES; i++) {
        const double a = i, b = i + 1; // moments of s^3 and s^4 over [a, b], in cells
        const double m3 = (pow(b, 4) - pow(a, 4)) / 4, m4 = (pow(b, 5) - pow(a, 5)) / 5;
        const double sum = (double)row[i] * (b * m3 - m4) + (double)row[i + 1] * (m4 - a * m3);
        cell[i] += factor * 4 * sum / pow(COSINES, 4);
    }
}

// The rows of roughness k; cdf and mean are those of the mean over azimuths.
static void fill(struct facet_loss *loss, int k, float alpha_u, float alpha_v,
                 facet_albedo_fn albedo, const void *context) {
    const bool many = loss->alphas > 1 || loss->azimuths > 1;
    const int nodes = many ? NODES_OF_MANY : NODES;
    const int turns = loss->azimuths > 1 ? loss->azimuths - 1 : 1;
    double cell[COSINES] = {0}, sum = 0;
    for (int j = 0; j < loss->azimuths; j++) {
        float *row = loss->lost + (size_t)(k * loss->azimuths + j) * (COSINES + 1);
        for (int i = 0; i <= COSINES; i++) {
            const vec3 v = direction(j, loss->azimuths, i);
            row[i] = clampf((float)(1 - albedo(context, alpha_u, alpha_v, v, nodes)), 0, 1);
        }
        const bool end = j == 0 || j == loss->azimuths - 1;
        add_cells(cell, row, (loss->azimuths > 1 && end ? 0.5 : 1) / turns);
    }
    float *cdf = loss->cdf + (size_t)k * (COSINES + 1);
    for (int i = 0; i < COSINES; i++)
        sum += cell[i];
    loss->mean[k] = (float)sum;
    cdf[0] = 0;
    for (int i = 0; i < COSINES; i++)
        cdf[i + 1] = sum > 0 ? minf(cdf[i] + (float)(cell[i] / sum), 1) : 0;
    cdf[COSINES] = 1;
}

static void allocate(struct facet_loss *loss, int alphas, int azimuths, struct arena *arena) {
    const size_t rows = (size_t)alphas * (size_t)azimuths;
    loss->alphas = alphas;
    loss->azimuths = azimuths;
    loss->lost = arena_alloc(arena, rows * (COSINES + 1) * sizeof(float));
    loss->mean = arena_alloc(arena, (size_t)alphas * sizeof(float));
    loss->cdf = arena_alloc(arena, (size_t)alphas * (COSINES + 1) * sizeof(float));
}

void facet_loss_make(struct facet_loss *loss, float alpha_u, float alpha_v, facet_albedo_fn albedo,
                     const void *context, struct arena *arena) {
    allocate(loss, 1, alpha_u == alpha_v ? 1 : AZIMUTHS + 1, arena);
    fill(loss, 0, alpha_u, alpha_v, albedo, context);
}

void facet_loss_make_all(struct facet_loss *loss, facet_albedo_fn albedo, const void *context,
                         struct arena *arena) {
    allocate(loss, ALPHAS + 1, 1, arena);
    for (int i = 0; i <= ALPHAS; i++) {
        const float t = (float)i / ALPHAS, alpha = i < ALPHAS ? t * t / (1 - t * t) : 1000;
        fill(loss, i, alpha, alpha, albedo, context);
    }
}

struct facet_loss_at facet_loss_at(const struct facet_loss *loss, float alpha) {
    const size_t size = (size_t)loss->azimuths * (COSINES + 1);
    const float x = loss->alphas > 1 ? sqrtf(alpha / (1 + alpha)) * ALPHAS : 0;
    const int i = (int)minf(x, ALPHAS - 1), next = loss->alphas > 1 ? i + 1 : i;
    const float weight = x - (float)i;
    return (struct facet_loss_at){
        .row = {loss->lost + (size_t)i * size, loss->lost + (size_t)next * size},
        .cdf = {loss->cdf + (size_t)i * (COSINES + 1), loss->cdf + (size_t)next * (COSINES + 1)},
        .weight = weight,
        .mean = lerpf(weight, loss->mean[i], loss->mean[next]),
        .azimuths = loss->azimuths};
}

static float row_at(const float *row, float x, int i) {
    return lerpf(x - (float)i, row[i], row[i + 1]);
}

static float azimuth_at(const float *rows, int azimuths, vec3 v, float x, int i) {
    const float y = atan2f(fabsf(v[1]), fabsf(v[0])) * (2 / PI) * (float)(azimuths - 1);
    const int j = (int)minf(y, (float)(azimuths - 2));
    const float *row = rows + (size_t)j * (COSINES + 1);
    return lerpf(y - (float)j, row_at(row, x, i), row_at(row + COSINES + 1, x, i));
}

float facet_lost(const struct facet_loss_at *at, vec3 v) {
    const float x = sqrtf(clampf(v[2], 0, 1)) * COSINES;
    const int i = (int)minf(x, COSINES - 1);
    if (at->azimuths > 1)
        return azimuth_at(at->row[0], at->azimuths, v, x, i);
    const float a = row_at(at->row[0], x, i);
    return at->weight > 0 ? lerpf(at->weight, a, row_at(at->row[1], x, i)) : a;
}

// A cell in proportion to its loss, in it a cosine uniform in its square, as the cosine law has it.
vec3 facet_loss_sample(const struct facet_loss_at *at, struct vec2 u) {
    const int k = u.x < at->weight;
    const float x = k ? u.x / at->weight : (u.x - at->weight) / (1 - at->weight);
    const float *cdf = at->cdf[k];
    int lo = 0, hi = COSINES;
    while (hi - lo > 1) {
        const int middle = (lo + hi) / 2;
        if (cdf[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    const float width = cdf[lo + 1] - cdf[lo], t = width > 0 ? (x - cdf[lo]) / width : 0;
    const float a = (float)lo / COSINES, b = (float)(lo + 1) / COSINES;
    const float z = minf(sqrtf(lerpf(clampf(t, 0, 1), sqr(sqr(a)), sqr(sqr(b)))), 1);
    float sine, cosine;
    sincos_turn(u.y, &sine, &cosine);
    const float r = safe_sqrt((1 - z) * (1 + z));
    return v3(r * cosine, r * sine, z);
}

float facet_loss_pdf_sa(const struct facet_loss_at *at, vec3 v) {
    const int i = (int)minf(sqrtf(clampf(v[2], 0, 1)) * COSINES, COSINES - 1);
    const float a = (float)i / COSINES, b = (float)(i + 1) / COSINES;
    const float p = lerpf(at->weight, at->cdf[0][i + 1] - at->cdf[0][i],
                          at->cdf[1][i + 1] - at->cdf[1][i]);
    return p / (sqr(sqr(b)) - sqr(sqr(a))) * v[2] * INV_PI;
}

void facet_loss_share(float eta, float mean1, float mean2, float *share12, float *share21) {
    const float most = maxf(mean1, mean2);
    const float smooth = (float)fresnel_dielectric_transmitted((double)eta);
    const float through = most > 0 ? smooth / most : 0;
    *share12 = through * mean2;
    *share21 = through / (eta * eta) * mean1;
}
