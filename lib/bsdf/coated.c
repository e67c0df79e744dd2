// SPDX-License-Identifier: Apache-2.0
// A clear dielectric coat over any material: the coat reflects, and what it leaves reaches the base,
//
//     f = w F D G / (4 cos_o cos_i) + base min(1 - w R(cos_o), 1 - w R(cos_i))
//
// with R the directional albedo of the coat's outside. The scaling of the base is reciprocal and
// creates no energy over any base (after Kulla and Conty 2017, Revisiting physically based shading,
// whose product over the mean creates some over mirrors); light that the coat would reflect back
// inside is not followed, as in glTF's clear coat, and directions are not refracted. Over a base that
// transmits, light is held to what the coat leaves on its outside. From behind, only the base is seen.
#include "bsdf/boundary_table.h"
#include "bsdf/roughness.h"
#include "bsdf/smooth.h"
#include "math/fresnel.h"

enum { NODES = 96, LEVELS = 33, LEVEL_NODES = 48 };

struct coated {
    const struct object *base;
    struct texture_ref weight;
    struct dielectric_index index;
    int distribution;
    struct texture_ref alpha;
    // made by prepare
    float eta;
    struct boundary_table *outside; // of that alpha; of a texture: by its root, from 0 to 1
};

struct coated_data {
    struct closure head;
    const struct coated *self;
    const struct closure *base; // NULL: black
    vec3 wo;
    float weight, alpha;
    struct microfacet facets;
    float left;         // 1 - w R(cos_o)
    float quarter_area; // 1 / (4 sigma(wo)); 0: smooth
    float p_coat;
};

static const struct param params[] = {
    {"bsdf", PARAM_BSDF, offsetof(struct coated, base), .unit = "", .help = "the material below"},
    {"weight", PARAM_TEXTURE_SCALAR, offsetof(struct coated, weight), .def = "1", .max = 1,
     .unit = "", .help = "how much of a coat there is"},
    DIELECTRIC_INDEX_PARAMS(struct coated, index, "1.5"),
    {"distribution", PARAM_CHOICE, offsetof(struct coated, distribution), .def = "ggx", .unit = "",
     .help = "distribution of facet normals", .choices = roughness_distributions},
    {"alpha", PARAM_TEXTURE_SCALAR, offsetof(struct coated, alpha), .def = "0", .max = 1000,
     .unit = "", .help = "roughness, of a texture up to 1; below 1e-4 the coat is smooth"},
    PARAM_END,
};

static struct microfacet facets_of(const struct coated *self, float alpha) {
    return microfacet_make((enum microfacet_type)self->distribution, alpha, alpha);
}

static bool is_smooth(float alpha) {
    return alpha < MICROFACET_ALPHA_MIN;
}

static float alpha_of_level(int level) {
    return maxf(sqr((float)level / (LEVELS - 1)), MICROFACET_ALPHA_MIN);
}

static bool prepare(struct object *object, struct arena *arena) {
    struct coated *self = object->data;
    const bool textured = self->alpha.texture != NULL;
    const float alpha = self->alpha.value[0];
    self->eta = self->index.int_ior / self->index.ext_ior;
    const int tables = textured ? LEVELS : is_smooth(alpha) ? 0 : 1;
    if (tables > 0)
        self->outside = arena_alloc(arena, (size_t)tables * sizeof *self->outside);
    for (int i = 0; i < tables; i++) {
        const struct microfacet m = facets_of(self, textured ? alpha_of_level(i) : alpha);
        boundary_tabulate(&m, self->eta, textured ? LEVEL_NODES : NODES, &self->outside[i]);
    }
    return bsdf_check_nesting(object);
}

static uint32_t lobes(const void *data) {
    const struct coated *self = data;
    const uint32_t smooth = self->alpha.texture || !self->outside ? LOBE_SPECULAR : 0;
    return bsdf_lobes(self->base) | smooth | (self->outside ? LOBE_GLOSSY : 0) | LOBE_REFLECTION;
}

static float alpha_at(const struct coated *self, const struct texture_point *at) {
    const float alpha = texture_eval_scalar(&self->alpha, at);
    return self->alpha.texture ? clampf(alpha, 0, 1) : alpha;
}

// R at a cosine above 0.
static float reflected(const struct coated *self, float alpha, float cosine) {
    float cos_t;
    if (is_smooth(alpha))
        return fresnel_dielectric(cosine, self->eta, &cos_t);
    cosine = minf(cosine, 1);
    if (!self->alpha.texture)
        return boundary_lookup(self->outside->reflected, cosine);
    const float x = sqrtf(alpha) * (LEVELS - 1);
    const int i = (int)minf(x, LEVELS - 2);
    return lerpf(x - (float)i, boundary_lookup(self->outside[i].reflected, cosine),
                 boundary_lookup(self->outside[i + 1].reflected, cosine));
}

// What the coat leaves the base of light between the two directions.
static float left_of(const struct coated_data *c, vec3 wi) {
    const bool seen_through = cos_theta(c->wo) > 0, lit_through = cos_theta(wi) > 0;
    const float from_eye = seen_through ? c->left : 1;
    if (!lit_through)
        return from_eye;
    return minf(from_eye, 1 - c->weight * reflected(c->self, c->alpha, cos_theta(wi)));
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct coated *self = data;
    const float w = clampf(texture_eval_scalar(&self->weight, &point->at), 0, 1);
    const struct closure *base = bsdf_resolve(self->base, point, wo, stack);
    if (w == 0 || (!base && !(cos_theta(wo) > 0)))
        return base;
    struct coated_data *c = closure_alloc(stack, &bsdf_coated, sizeof *c, base ? base->lobes : 0);
    *c = (struct coated_data){.head = c->head, .self = self, .base = base, .wo = wo, .weight = w,
                              .alpha = alpha_at(self, &point->at), .left = 1};
    if (!(cos_theta(wo) > 0))
        return &c->head;
    const bool smooth = is_smooth(c->alpha);
    c->head.lobes |= (smooth ? LOBE_SPECULAR : LOBE_GLOSSY) | LOBE_REFLECTION;
    const float coat = w * reflected(self, c->alpha, cos_theta(wo));
    c->left = 1 - coat;
    if (!smooth) {
        c->facets = facets_of(self, c->alpha);
        c->quarter_area = 0.25f / microfacet_area(&c->facets, wo);
    }
    const float below = base ? c->left * spectrum_mean(closure_albedo(base)) : 0;
    c->p_coat = coat + below > 0 ? coat / (coat + below) : 1;
    return &c->head;
}

// The rough coat's own reflection; 0 from behind and of a smooth coat.
static float eval_coat(const struct coated_data *c, vec3 wi, float *pdf_sa) {
    *pdf_sa = 0;
    if (c->quarter_area == 0 || !(cos_theta(wi) > 0))
        return 0;
    const vec3 h = normalize(c->wo + wi);
    float cos_t;
    *pdf_sa = microfacet_D(&c->facets, h) * c->quarter_area;
    return c->weight * fresnel_dielectric(dot(c->wo, h), c->self->eta, &cos_t) * *pdf_sa *
           microfacet_G1(&c->facets, wi);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct coated_data *c = (const void *)closure;
    float pdf_coat, pdf_base = 0;
    spectrum f = spectrum_grey(eval_coat(c, wi, &pdf_coat));
    if (c->base)
        f += left_of(c, wi) * closure_eval(c->base, wi, &pdf_base);
    *pdf_sa = lerpf(c->p_coat, pdf_base, pdf_coat);
    return f;
}

static bool sample_base(const struct coated_data *c, float u1, struct vec2 u2,
                        struct bsdf_sample *s) {
    if (!c->base || !closure_sample(c->base, u1, u2, s))
        return false;
    if (s->lobe & LOBE_DELTA) {
        s->pdf_sa *= 1 - c->p_coat;
        s->weight = s->weight * (left_of(c, s->wi) / (1 - c->p_coat));
        return true;
    }
    const spectrum f = eval(&c->head, s->wi, &s->pdf_sa);
    s->weight = f / s->pdf_sa;
    return true;
}

static bool sample_coat(const struct coated_data *c, struct vec2 u2, struct bsdf_sample *s) {
    s->eta = 1;
    if (c->quarter_area == 0) {
        *s = (struct bsdf_sample){v3(-c->wo[0], -c->wo[1], c->wo[2]),
                                  spectrum_grey((1 - c->left) / c->p_coat), c->p_coat, 1,
                                  LOBE_SPECULAR | LOBE_REFLECTION};
        return true;
    }
    s->wi = normalize(reflect(c->wo, microfacet_sample(&c->facets, c->wo, u2)));
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    if (!(cos_theta(s->wi) > 0)) // there the base alone may have a density
        return false;
    const spectrum f = eval(&c->head, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f / s->pdf_sa;
    return true;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct coated_data *c = (const void *)closure;
    if (u1 < c->p_coat)
        return sample_coat(c, u2, s);
    return sample_base(c, minf((u1 - c->p_coat) / (1 - c->p_coat), 0x1.fffffep-1f), u2, s);
}

static spectrum albedo(const struct closure *closure) {
    const struct coated_data *c = (const void *)closure;
    const spectrum coat = spectrum_grey(1 - c->left);
    return c->base ? coat + c->left * closure_albedo(c->base) : coat;
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct coated *self = data;
    const float w = clampf(texture_eval_scalar(&self->weight, &point->at), 0, 1);
    return (1 - w * reflected(self, alpha_at(self, &point->at), fabsf(cos_theta(wo)))) *
           bsdf_null_transmittance(self->base, point, wo);
}

const struct bsdf_type bsdf_coated = {
    .entry = {.name = "coated", .help = "a clear coat over any material", .params = params,
              .size = sizeof(struct coated)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo, .null_transmittance = null_transmittance,
};
