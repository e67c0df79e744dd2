// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "driver/brdf.h"
#include "table/goniometer.h"
#include "table/merl.h"

static spectrum value(const struct material *m, vec3 wo, vec3 wi) {
    struct closure_stack stack;
    const struct closure *c = material_at(m, wo, &stack);
    float pdf;
    return c ? closure_eval(c, wi, &pdf) * (1 / fabsf(wi[2])) : spectrum_grey(0);
}

static vec3 turned(vec3 w, float phi) {
    const float c = cosf(phi), s = sinf(phi);
    return v3(w[0] * c - w[1] * s, w[0] * s + w[1] * c, w[2]);
}

struct mean_value {
    int turns;                // azimuths that the mean is over
    double difference, total; // of values and those with the directions exchanged
};

// Over azimuths, and both ways: the format knows isotropic, reciprocal materials only.
static spectrum mean_value(const struct material *m, vec3 wo, vec3 wi, struct mean_value *over) {
    spectrum there = spectrum_grey(0), back = spectrum_grey(0);
    for (int k = 0; k < over->turns; k++) {
        const float phi = TWO_PI * (float)k / (float)over->turns;
        const vec3 o = turned(wo, phi), i = turned(wi, phi);
        there += value(m, o, i);
        back += value(m, i, o);
    }
    const double cosines = (double)(wo[2] * wi[2]);
    const double a = cosines * (double)spectrum_mean(there);
    const double b = cosines * (double)spectrum_mean(back);
    over->difference += fabs(a - b);
    over->total += 0.5 * (a + b);
    return (there + back) * (0.5f / (float)over->turns);
}

static void warn_of_means(const char *path, const struct mean_value *over) {
    if (over->turns > 1)
        log_warn("%s: the material is anisotropic; the table holds its mean over azimuths", path);
    if (over->difference > 0.01 * over->total)
        log_warn("%s: the material is not reciprocal, by %.0f %% in the mean; the table holds the "
                 "mean of both ways", path, 100 * over->difference / over->total);
}

// Nodes that no pair of directions above the surface meets become invalid, as in measured tables.
float (*brdf_merl_values(const struct material *m, const char *path))[3] {
    struct mean_value over = {.turns = bsdf_lobes(m->object) & LOBE_ANISOTROPIC ? 8 : 1};
    float(*rgb)[3] = mem_array(MERL_CELLS, sizeof *rgb);
    for (int i = 0; i < MERL_CELLS; i++) {
        vec3 wi, wo;
        merl_directions(i / (MERL_THETA_D * MERL_PHI_D), i / MERL_PHI_D % MERL_THETA_D,
                        i % MERL_PHI_D, &wi, &wo);
        const bool visible = merl_is_visible(wi, wo);
        const spectrum f = visible ? mean_value(m, wo, wi, &over) : spectrum_grey(-1);
        for (int c = 0; c < 3; c++)
            rgb[i][c] = f[c];
    }
    warn_of_means(path, &over);
    return rgb;
}

static bool to_merl(const struct material *m, const char *path) {
    float(*rgb)[3] = brdf_merl_values(m, path);
    const bool good = merl_write(path, (const float(*)[3])rgb);
    mem_free(rgb);
    return good;
}

enum { TABLE_THETAS = 18, TABLE_PHIS = 13, OUT_THETAS = 46, OUT_PHIS = 120 };

static vec3 direction(float theta, float phi) {
    return v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

static void fill_table(const struct material *m, const struct goniometer_table *t) {
    const size_t slice = goniometer_slice(t);
    const size_t incident = (size_t)t->theta_count * (size_t)t->phi_count;
    for (size_t k = 0; k < incident * slice; k++) {
        const size_t in = k / slice, out = k % slice;
        const vec3 wo = direction(t->theta[in % TABLE_THETAS], t->phi[in / TABLE_THETAS]);
        const float theta = minf((float)(out / OUT_PHIS) / (OUT_THETAS - 1), 0.9999f) * (PI / 2);
        const vec3 wi = direction(theta, (float)(out % OUT_PHIS) * (TWO_PI / OUT_PHIS));
        for (int side = 0; side < 2; side++)
            if (t->f[side]) {
                const spectrum f = value(m, wo, v3(wi[0], wi[1], side ? -wi[2] : wi[2]));
                memcpy(t->f[side][k], &f, sizeof t->f[side][k]);
            }
    }
}

// Incident angles every 5 degrees, and azimuths every 30 for an anisotropic material.
static bool to_transfer(const struct material *m, const char *path) {
    const uint32_t lobes = bsdf_lobes(m->object);
    struct arena arena = {0};
    struct goniometer_table t = {.theta_count = TABLE_THETAS, .symmetry = 1,
                                 .phi_count = lobes & LOBE_ANISOTROPIC ? TABLE_PHIS : 1,
                                 .out_thetas = OUT_THETAS, .out_phis = OUT_PHIS};
    const size_t nodes = (size_t)t.theta_count * (size_t)t.phi_count * goniometer_slice(&t);
    t.theta = arena_alloc(&arena, TABLE_THETAS * sizeof *t.theta);
    t.phi = arena_alloc(&arena, TABLE_PHIS * sizeof *t.phi);
    for (int i = 0; i < TABLE_THETAS; i++)
        t.theta[i] = (float)i * (5 * PI / 180);
    for (int i = 0; i < TABLE_PHIS; i++)
        t.phi[i] = (float)i * (TWO_PI / (TABLE_PHIS - 1));
    for (int side = 0; side < 1 + ((lobes & LOBE_TRANSMISSION) != 0); side++)
        t.f[side] = arena_alloc(&arena, nodes * sizeof *t.f[side]);
    fill_table(m, &t);
    const bool good = transfer_write(path, &t);
    arena_finish(&arena);
    return good;
}

bool brdf_wants_curves(const char *path) {
    char extension[16];
    file_extension(path, extension, sizeof extension);
    return strcmp(extension, "json") == 0 || strcmp(extension, "csv") == 0;
}

bool brdf_convert(const struct material *m, const char *path) {
    char extension[16];
    file_extension(path, extension, sizeof extension);
    if (brdf_wants_curves(path))
        return brdf_write_curves(m, path);
    if (bsdf_lobes(m->object) & LOBE_DELTA)
        log_warn("%s: specular lobes have no value and are left out", path);
    if (strcmp(extension, "binary") == 0)
        return to_merl(m, path);
    if (strcmp(extension, "transfer") == 0)
        return to_transfer(m, path);
    log_error("%s: is no format of materials that is written; expected .binary (MERL), .transfer, "
              ".json or .csv (curves)", path);
    return false;
}
