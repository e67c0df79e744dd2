// SPDX-License-Identifier: Apache-2.0
// The anisotropic Beckmann model with exponent alpha, up to four lobes over a diffuse base, each
// reflected or transmitted through a thin sheet; formulas and sources in math/kskk.h. With a
// transmitted lobe the surface is a sheet that is alike from both sides.
//
// As published (energy=literal), nothing bounds the sum, and lobes with alpha > 1/2 reflect more
// than arrives, without bound towards grazing angles. By default f is divided by
//
//     max(1, a(wo), a(wi)),    a: the literal model's directional albedo, greatest channel
//
// which stays reciprocal, makes the albedo at most 1, and changes nothing where a is at most 1 for
// both directions. a is tabulated for each lobe, as the greatest of all azimuths.
#include "math/kskk.h"

#include "bsdf/glossy.h"

enum { LOBES = 4, NODES = 128, AZIMUTHS = 8 };
enum energy { BOUNDED, LITERAL };

struct kskk_lobe {
    struct texture_ref k;
    float mx, my, r0, alpha;
    bool transmits;
    // made by prepare
    bool used;
    struct kskk model;
    float table[NODES + 1]; // albedo times cos^alpha at cos = (i / NODES)^3
};

struct kskk_bsdf {
    struct texture_ref diffuse;
    int energy;
    struct kskk_lobe lobes[LOBES];
    bool sheet; // made by prepare
};

struct kskk_data {
    struct glossy glossy;
    const struct kskk_bsdf *self;
    spectrum diffuse, k[LOBES];
    float chosen[LOBES]; // probability of each lobe among all, running sum
    float albedo;        // a(wo)
};

static const char *const energies[] = {"bounded", "literal", NULL};

#define LOBE_PARAMS(i, k_default)                                                                  \
    {"k_" #i, PARAM_TEXTURE, offsetof(struct kskk_bsdf, lobes[i - 1].k), .def = k_default,         \
     .max = 1, .unit = "", .help = "factor on lobe " #i},                                          \
    {"mx_" #i, PARAM_FLOAT, offsetof(struct kskk_bsdf, lobes[i - 1].mx), .def = "0.1", .max = 1,   \
     .unit = "", .help = "roughness along the tangent; at least 1e-4 is taken"},                   \
    {"my_" #i, PARAM_FLOAT, offsetof(struct kskk_bsdf, lobes[i - 1].my), .def = "-1", .min = -1,   \
     .max = 1, .unit = "", .help = "roughness along the bitangent (-1: as along the tangent)"},    \
    {"r0_" #i, PARAM_FLOAT, offsetof(struct kskk_bsdf, lobes[i - 1].r0), .def = "1", .max = 1,     \
     .unit = "", .help = "Fresnel reflectance at normal incidence, rising to 1 (Schlick)"},        \
    {"alpha_" #i, PARAM_FLOAT, offsetof(struct kskk_bsdf, lobes[i - 1].alpha), .def = "0.5",       \
     .max = 1, .unit = "", .help = "exponent in place of shadowing: brighter towards grazing"},    \
    {"transmits_" #i, PARAM_BOOL, offsetof(struct kskk_bsdf, lobes[i - 1].transmits),              \
     .def = "false", .unit = "", .help = "straight through a thin sheet, by 1 - Fresnel"}

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct kskk_bsdf, diffuse), .def = "0",
     .max = 1, .unit = "", .help = "reflectance kd of the base"},
    {"energy", PARAM_CHOICE, offsetof(struct kskk_bsdf, energy), .def = "bounded", .unit = "",
     .help = "literal: as published, with albedos that may exceed 1", .choices = energies},
    LOBE_PARAMS(1, "1"),
    LOBE_PARAMS(2, "0"),
    LOBE_PARAMS(3, "0"),
    LOBE_PARAMS(4, "0"),
    PARAM_END,
};

// The greatest albedo of all azimuths; those near the smoother axis are where it changes fast. What
// is missed between them is less than the 1 % added.
static double greatest_albedo(const struct kskk *k, double cos_o) {
    static const double degrees[AZIMUTHS] = {0, 3, 6, 10, 16, 25, 45, 90};
    const double mx = k->slopes.mx, my = k->slopes.my;
    if (mx == my)
        return kskk_albedo(k, cos_o, 0);
    double most = 0;
    for (int i = 0; i < AZIMUTHS; i++) {
        const double phi = (mx < my ? degrees[i] : 90 - degrees[i]) * (M_PI / 180);
        most = fmax(most, kskk_albedo(k, cos_o, phi));
    }
    return 1.01 * most;
}

static void tabulate(struct kskk_lobe *l) {
    for (int i = 0; i <= NODES; i++) {
        const double x = (double)i / NODES, cos_o = fmax(x * x * x, 1e-9);
        l->table[i] = (float)(greatest_albedo(&l->model, cos_o) * pow(cos_o, l->model.alpha));
    }
}

// Cubic interpolation (Catmull and Rom 1974) in the cube root of the cosine.
static float lobe_albedo(const struct kskk_lobe *l, double cos_o) {
    const double x = NODES * cbrt(cos_o);
    const int i = (int)fmin(x, NODES - 1);
    const float t = (float)(x - i), *p = l->table;
    const float p1 = p[i], p2 = p[i + 1];
    const float d1 = 0.5f * (p2 - p[i > 0 ? i - 1 : 0]);
    const float d2 = 0.5f * (p[i + 2 <= NODES ? i + 2 : NODES] - p1);
    const float a = 2 * (p1 - p2) + d1 + d2, b = 3 * (p2 - p1) - 2 * d1 - d2;
    return maxf(p1 + t * (d1 + t * (b + t * a)), 0) / (float)pow(cos_o, l->model.alpha);
}

static bool prepare(struct object *self, struct arena *arena) {
    struct kskk_bsdf *b = self->data;
    (void)arena;
    for (int i = 0; i < LOBES; i++) {
        struct kskk_lobe *l = &b->lobes[i];
        const float my = l->my < 0 ? l->mx : l->my;
        l->used = l->k.texture || !spectrum_is_black(l->k.value);
        l->model = (struct kskk){{(double)maxf(l->mx, GLOSSY_ROUGHNESS_MIN),
                                  (double)maxf(my, GLOSSY_ROUGHNESS_MIN)},
                                 (double)l->r0, (double)l->alpha, l->transmits};
        b->sheet = b->sheet || (l->used && l->transmits);
        if (l->used)
            tabulate(l);
    }
    return true;
}

static uint32_t lobe_bits(const struct kskk_lobe *l) {
    const bool round = l->model.slopes.mx == l->model.slopes.my;
    return LOBE_GLOSSY | (l->transmits ? LOBE_TRANSMISSION : LOBE_REFLECTION) |
           (round ? 0 : LOBE_ANISOTROPIC);
}

static uint32_t lobes(const void *data) {
    const struct kskk_bsdf *self = data;
    const bool base = self->diffuse.texture || !spectrum_is_black(self->diffuse.value);
    uint32_t bits = base ? LOBE_DIFFUSE | LOBE_REFLECTION : 0;
    for (int i = 0; i < LOBES; i++)
        bits |= self->lobes[i].used ? lobe_bits(&self->lobes[i]) : 0;
    return bits;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct kskk_bsdf *self = data;
    if (wo[2] == 0 || (wo[2] < 0 && !self->sheet))
        return NULL;
    const double cos_o = fmax((double)fabsf(wo[2]), GLOSSY_COS_MIN);
    const spectrum diffuse = texture_eval(&self->diffuse, &point->at);
    spectrum all = spectrum_grey(0), k[LOBES], sum[LOBES];
    uint32_t bits = 0;
    for (int i = 0; i < LOBES; i++) {
        const struct kskk_lobe *l = &self->lobes[i];
        k[i] = l->used ? texture_eval(&l->k, &point->at) : spectrum_grey(0);
        sum[i] = all = all + (l->used ? k[i] * lobe_albedo(l, cos_o) : k[i]);
        bits |= spectrum_is_black(k[i]) ? 0 : lobe_bits(l);
    }
    struct kskk_data *c =
        glossy_alloc(stack, &bsdf_kskk, sizeof *c, wo, diffuse, all, bits);
    if (!c)
        return NULL;
    c->self = self;
    c->diffuse = diffuse;
    c->albedo = spectrum_max(diffuse + all);
    for (int i = 0; i < LOBES; i++) {
        c->k[i] = k[i];
        c->chosen[i] = spectrum_mean(all) > 0 ? spectrum_mean(sum[i]) / spectrum_mean(all) : 1;
    }
    return &c->glossy.head;
}

// 1 / max(1, a(wo), a(wi))
static float bound(const struct kskk_data *c, double cos_i) {
    if (c->self->energy == LITERAL)
        return 1;
    spectrum a = c->diffuse;
    for (int i = 0; i < LOBES; i++)
        if (c->self->lobes[i].used)
            a = a + c->k[i] * lobe_albedo(&c->self->lobes[i], fmax(cos_i, GLOSSY_COS_MIN));
    return 1 / maxf(maxf(1, c->albedo), spectrum_max(a));
}

static struct glossy_value kskk_eval(const struct glossy *g, struct direction wi) {
    const struct kskk_data *c = (const void *)g;
    const struct direction up = wi.z < 0 ? direction_flip(wi) : wi;
    const float scale = bound(c, up.z);
    struct glossy_value value = {.base = c->diffuse * scale};
    struct half_vector v;
    if (!half_vector_make(g->wo, up, &v))
        return value;
    for (int i = 0; i < LOBES; i++) {
        const struct kskk *k = &c->self->lobes[i].model;
        const double p = (double)(c->chosen[i] - (i ? c->chosen[i - 1] : 0));
        if (!(p > 0) || k->transmits != (wi.z < 0))
            continue;
        const double pdf = kskk_pdf(k, &v);
        value.pdf_sa += p * pdf;
        value.f_cos = value.f_cos + c->k[i] * (scale * (float)(pdf * kskk_weight(k, &v)));
    }
    return value;
}

static bool kskk_sample(const struct glossy *g, double u1, struct vec2 u2, struct direction *wi) {
    const struct kskk_data *c = (const void *)g;
    int i = 0;
    while (i < LOBES - 1 && u1 >= (double)c->chosen[i])
        i++;
    const struct kskk *k = &c->self->lobes[i].model;
    const struct direction h = beckmann_sample(&k->slopes, (double)u2.x, (double)u2.y);
    if (!(direction_dot(g->wo, h) > 0))
        return false;
    *wi = direction_mirror(g->wo, h);
    if (!(wi->z > 0))
        return false;
    if (k->transmits)
        *wi = direction_flip(*wi);
    return true;
}

GLOSSY_FUNCTIONS(kskk)

static spectrum albedo(const struct closure *closure) {
    const struct kskk_data *c = (const void *)closure;
    spectrum sum = c->diffuse;
    for (int i = 0; i < LOBES; i++)
        if (c->self->lobes[i].used)
            sum = sum + c->k[i] * lobe_albedo(&c->self->lobes[i], c->glossy.wo.z);
    return c->self->energy == LITERAL ? sum : sum / maxf(1, c->albedo);
}

const struct bsdf_type bsdf_kskk = {
    .entry = {.name = "kskk",
              .help = "anisotropic Beckmann lobes, also of thin sheets (Kurt et al. 2010)",
              .params = params, .size = sizeof(struct kskk_bsdf)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
