// SPDX-License-Identifier: Apache-2.0
#include <math.h>

#include "driver/brdf.h"
#include "math/hash.h"

enum { SAMPLES = 1 << 16, PAIRS = 20000, ANGLES = 8 };

static const double angles[ANGLES] = {0, 15, 30, 45, 60, 75, 85, 89};

struct sums {
    double mean[3], squares;
    double above, below; // shares of the mean that go to either side
};

static vec3 direction(double theta, double phi) {
    return v3((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta));
}

// Albedos are of energy: refraction's scaling of radiance is divided out.
static struct sums sample_from(const struct material *m, vec3 wo, int count, struct rng *rng) {
    struct closure_stack stack;
    struct sums s = {0};
    const struct closure *c = material_at(m, wo, &stack);
    for (int i = 0; c && i < count; i++) {
        struct bsdf_sample b;
        const float u1 = rng_float(rng), u = rng_float(rng), v = rng_float(rng);
        if (!closure_sample(c, u1, (struct vec2){u, v}, &b))
            continue;
        const bool reflected = b.wi[2] * wo[2] > 0;
        const spectrum energy = b.weight * (reflected ? 1 : sqr(b.eta));
        const double mean = (double)spectrum_mean(energy);
        for (int k = 0; k < SPECTRUM_LANES; k++)
            s.mean[k] += (double)energy[k] / count;
        s.squares += mean * mean / count;
        *(reflected ? &s.above : &s.below) += mean / count;
    }
    return s;
}

static double error_of(const struct sums *s, int count) {
    const double mean = s->above + s->below;
    return sqrt(fmax(s->squares - mean * mean, 0) / count);
}

static void add_colour(struct json *out, const char *name, const double rgb[3]) {
    struct json *array = json_add_array(out, name);
    for (int k = 0; k < 3; k++)
        json_append_number(array, rgb[k]);
}

static double add_directional(const struct material *m, struct json *out) {
    struct json *list = json_add_array(out, "directional_albedo");
    double most = 0;
    for (int i = 0; i < ANGLES; i++) {
        struct rng rng = {1};
        const struct sums s =
            sample_from(m, direction(angles[i] * M_PI / 180, 0), SAMPLES, &rng);
        struct json *o = json_append_object(list);
        json_add_number(o, "degrees", angles[i]);
        add_colour(o, "albedo", s.mean);
        json_add_number(o, "reflected", s.above);
        json_add_number(o, "transmitted", s.below);
        json_add_number(o, "standard_error", error_of(&s, SAMPLES));
        for (int k = 0; k < 3; k++)
            most = fmax(most, s.mean[k]);
    }
    return most;
}

// Mean of the directional albedos over the projected hemisphere: a sample of each of many eyes.
static void add_hemispherical(const struct material *m, struct json *out) {
    struct rng rng = {2};
    double sum[3] = {0};
    for (int i = 0; i < SAMPLES; i++) {
        const double z2 = (i + (double)rng_float(&rng)) / SAMPLES;
        const double phi = 2 * M_PI * (double)rng_float(&rng);
        const struct sums s = sample_from(m, direction(acos(sqrt(z2)), phi), 1, &rng);
        for (int k = 0; k < 3; k++)
            sum[k] += s.mean[k] / SAMPLES;
    }
    add_colour(out, "hemispherical_albedo", sum);
}

static double value(const struct material *m, vec3 wo, vec3 wi) {
    struct closure_stack stack;
    const struct closure *c = material_at(m, wo, &stack);
    float pdf;
    return c ? (double)(spectrum_mean(closure_eval(c, wi, &pdf)) / fabsf(wi[2])) : 0;
}

static void add_reciprocity(const struct material *m, struct json *out) {
    struct rng rng = {3};
    double difference = 0, total = 0, worst = 0;
    for (int i = 0; i < PAIRS; i++) {
        vec3 w[2];
        for (int k = 0; k < 2; k++)
            w[k] = direction(acos(0.02 + 0.98 * (double)rng_float(&rng)),
                             2 * M_PI * (double)rng_float(&rng));
        const double a = value(m, w[0], w[1]), b = value(m, w[1], w[0]);
        difference += fabs(a - b);
        total += 0.5 * (a + b);
        worst = fmax(worst, a + b > 0 ? 2 * fabs(a - b) / (a + b) : 0);
    }
    struct json *o = json_add_object(out, "reciprocity_error");
    json_add_number(o, "mean", total > 0 ? difference / total : 0);
    json_add_number(o, "largest", worst);
}

static void add_lobes(const struct material *m, struct json *out) {
    static const struct {
        uint32_t lobe;
        const char *name;
    } names[] = {{LOBE_DIFFUSE, "diffuse"}, {LOBE_GLOSSY, "glossy"}, {LOBE_SPECULAR, "specular"},
                 {LOBE_NULL, "null"}, {LOBE_REFLECTION, "reflection"},
                 {LOBE_TRANSMISSION, "transmission"}, {LOBE_ANISOTROPIC, "anisotropic"}};
    struct json *list = json_add_array(out, "lobes");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (bsdf_lobes(m->object) & names[i].lobe)
            json_append_text(list, names[i].name);
}

void brdf_report(const struct material *m, struct json *out) {
    json_add_text(out, "model", m->object->type->name);
    add_lobes(m, out);
    const double most = add_directional(m, out);
    add_hemispherical(m, out);
    json_add_number(out, "energy_error", fmax(most - 1, 0));
    add_reciprocity(m, out);
}
