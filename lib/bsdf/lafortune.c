// SPDX-License-Identifier: Apache-2.0
// Up to three generalised cosine lobes over a diffuse base; formulas and source in
// math/lafortune.h.
//
// A normalised lobe is ks (n + 2) / (2 pi) (C wo . wi)^n with the greatest component of C made 1,
// so that ks bounds its albedo; where kd and all ks together exceed 1, they are scaled down alike.
// Published coefficients mean ks (C wo . wi)^n with C as it stands: normalised=false.
#include "math/lafortune.h"

#include "bsdf/glossy.h"

enum { LOBES = 3 };

struct lafortune_lobe {
    struct texture_ref specular;
    vec3 c;
    float exponent;
    // made by prepare
    struct direction ratio; // c, the greatest component made 1; all zero: nothing
    float scale;            // f = ks scale (n + 2) / (2 pi) (ratio wo . wi)^n
};

struct lafortune {
    struct texture_ref diffuse;
    bool normalised;
    struct lafortune_lobe lobes[LOBES];
};

struct lafortune_data {
    struct glossy glossy;
    const struct lafortune *self;
    spectrum diffuse, specular[LOBES];
    float chosen[LOBES]; // probability of each lobe among all, running sum
};

#define LOBE_PARAMS(i, ks)                                                                         \
    {"specular_reflectance_" #i, PARAM_TEXTURE,                                                    \
     offsetof(struct lafortune, lobes[i - 1].specular), .def = ks, .max = 1, .unit = "",           \
     .help = "reflectance ks of lobe " #i},                                                        \
    {"c_" #i, PARAM_VECTOR, offsetof(struct lafortune, lobes[i - 1].c), .def = "-1, -1, 1",        \
     .unit = "", .help = "coefficients of tangent, bitangent, normal; of Phong: -1, -1, 1"},       \
    {"exponent_" #i, PARAM_FLOAT, offsetof(struct lafortune, lobes[i - 1].exponent), .def = "30",  \
     .max = 1e8, .unit = "", .help = "sharpness of lobe " #i}

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct lafortune, diffuse), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance kd of the base"},
    {"normalised", PARAM_BOOL, offsetof(struct lafortune, normalised), .def = "true", .unit = "",
     .help = "only ratios of c count; false: c as published, and no bound on what is reflected"},
    LOBE_PARAMS(1, "0.2"),
    LOBE_PARAMS(2, "0"),
    LOBE_PARAMS(3, "0"),
    PARAM_END,
};

static bool prepare_lobe(struct lafortune_lobe *l, bool normalised, const struct object *self) {
    const double x = (double)l->c[0], y = (double)l->c[1], z = (double)l->c[2];
    const double most = fmax(fabs(x), fmax(fabs(y), fabs(z))), n = (double)l->exponent;
    const double inv = most > 0 ? 1 / most : 0, peak = n > 0 && most > 0 ? n * log(most) : 0;
    l->ratio = (struct direction){x * inv, y * inv, z * inv};
    l->scale = 1;
    if (normalised)
        return true;
    if (peak > log(1e6)) {
        log_error_at(self->at, "%s: c=%g %g %g to the power of %g was found; expected 1e6 at most",
                     self->type->name, x, y, z, n);
        return false;
    }
    l->scale = (float)(exp(peak) * 2 * M_PI / (n + 2));
    return true;
}

static bool prepare(struct object *self, struct arena *arena) {
    struct lafortune *l = self->data;
    (void)arena;
    for (int i = 0; i < LOBES; i++)
        if (!prepare_lobe(&l->lobes[i], l->normalised, self))
            return false;
    return true;
}

static uint32_t lobes(const void *data) {
    const struct lafortune *self = data;
    bool round = true;
    for (int i = 0; i < LOBES; i++)
        round = round && self->lobes[i].ratio.x == self->lobes[i].ratio.y;
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION | (round ? 0 : LOBE_ANISOTROPIC);
}

static double length_of(struct direction d) {
    return sqrt(direction_dot(d, d));
}

// Estimates what a lobe reflects; at least a little of each that is there, for the parts above the
// surface of lobes whose axis is below.
static spectrum estimate(const struct lafortune_lobe *l, spectrum specular, struct direction wo) {
    const struct direction axis = lafortune_axis(l->ratio, wo);
    const double r = length_of(axis), n = (double)l->exponent;
    const double up = fmax(axis.z, 0) + (r - fmax(axis.z, 0)) / (n + 2);
    return specular * (l->scale * (float)(up * pow(r, n)) + 1e-4f);
}

static void scaled_reflectances(const struct lafortune *self, const struct texture_point *at,
                                    spectrum *diffuse, spectrum specular[LOBES]) {
    spectrum sum = spectrum_grey(0);
    *diffuse = texture_eval(&self->diffuse, at);
    for (int i = 0; i < LOBES; i++) {
        specular[i] = texture_eval(&self->lobes[i].specular, at);
        sum = sum + specular[i];
    }
    const float limit = self->normalised ? 1 / maxf(1, spectrum_max(*diffuse + sum)) : 1;
    *diffuse = *diffuse * limit;
    for (int i = 0; i < LOBES; i++)
        specular[i] = specular[i] * limit;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct lafortune *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    spectrum diffuse, specular[LOBES], all = spectrum_grey(0), sum[LOBES];
    scaled_reflectances(self, &point->at, &diffuse, specular);
    for (int i = 0; i < LOBES; i++)
        sum[i] = all = all + estimate(&self->lobes[i], specular[i], direction_from(wo));
    struct lafortune_data *c = glossy_alloc(stack, &bsdf_lafortune, sizeof *c, wo, diffuse, all,
                                            LOBE_GLOSSY | LOBE_REFLECTION);
    if (!c)
        return NULL;
    c->self = self;
    c->diffuse = diffuse;
    for (int i = 0; i < LOBES; i++) {
        c->specular[i] = specular[i];
        c->chosen[i] = spectrum_mean(all) > 0 ? spectrum_mean(sum[i]) / spectrum_mean(all) : 1;
    }
    return &c->glossy.head;
}

static struct glossy_value lafortune_eval(const struct glossy *g, struct direction wi) {
    const struct lafortune_data *c = (const void *)g;
    struct glossy_value value = {.base = c->diffuse};
    for (int i = 0; i < LOBES; i++) {
        const struct lafortune_lobe *l = &c->self->lobes[i];
        const double p = (double)(c->chosen[i] - (i ? c->chosen[i - 1] : 0));
        const struct direction axis = lafortune_axis(l->ratio, g->wo);
        const double r = length_of(axis), n = (double)l->exponent;
        if (!(p > 0 && r > 0))
            continue;
        const double cos_a = direction_dot(axis, wi) / r, lobe = cosine_lobe_pdf(cos_a, n);
        value.pdf_sa += p * lobe;
        value.f_cos = value.f_cos + c->specular[i] * (l->scale * (float)(lobe * pow(r, n) *
                                                                         (n + 2) / (n + 1) * wi.z));
    }
    return value;
}

static bool lafortune_sample(const struct glossy *g, double u1, struct vec2 u2,
                             struct direction *wi) {
    const struct lafortune_data *c = (const void *)g;
    int i = 0;
    while (i < LOBES - 1 && u1 >= (double)c->chosen[i])
        i++;
    const struct lafortune_lobe *l = &c->self->lobes[i];
    const struct direction axis = lafortune_axis(l->ratio, g->wo);
    const double r = length_of(axis);
    if (!(r > 0))
        return false;
    *wi = cosine_lobe_sample((struct direction){axis.x / r, axis.y / r, axis.z / r},
                             (double)l->exponent, (double)u2.x, (double)u2.y);
    return true;
}

GLOSSY_FUNCTIONS(lafortune)

static spectrum albedo(const struct closure *closure) {
    const struct lafortune_data *c = (const void *)closure;
    spectrum sum = c->diffuse;
    for (int i = 0; i < LOBES; i++)
        sum = sum + estimate(&c->self->lobes[i], c->specular[i], c->glossy.wo);
    return sum;
}

const struct bsdf_type bsdf_lafortune = {
    .entry = {.name = "lafortune",
              .help = "generalised cosine lobes over a diffuse base (Lafortune et al. 1997)",
              .params = params, .size = sizeof(struct lafortune)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
