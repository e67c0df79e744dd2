// SPDX-License-Identifier: Apache-2.0
// The principled material (Burley 2012 and 2015) as Mitsuba 3 has it: a GGX lobe whose Fresnel term
// runs from dielectric to metal, its refraction for glass, a diffuse base with retro-reflection and
// sheen, and a clear coat of GTR1. From inside there are the GGX lobes only, and only where
// spec_trans is above 0.
//
// Lobes are sampled in proportion to (coat/4 : 1 : diffuse share), times the rates; refraction
// takes its share of the main one by the facet's Fresnel term. Two differences from Mitsuba: at an
// index of exactly 1 the metallic part does not vanish, and with transmission every index closer to
// 1 than 0.001 is taken for 1 + 0.001, not 1 alone.
#include "bsdf/principled.h"
#include "bsdf/rough_boundary.h"
#include "math/fresnel.h"
#include "math/ior.h"
#include "math/warp.h"

struct principled {
    struct texture_ref base_color, roughness, anisotropic, spec_trans, spec_tint, sheen, sheen_tint,
        flatness, metallic, clearcoat, clearcoat_gloss;
    float eta, specular; // below 0: not given
    float specular_rate, clearcoat_rate, diffuse_rate;
    float index; // made by prepare: inside over outside
};

struct principled_data {
    struct closure head;
    struct microfacet facets;
    bool mirrored; // wo was below
    vec3 wo;       // above
    float eta;     // of the far side over wo's
    float inv_area; // 1 / sigma(wo)
    // Fresnel term of the main reflection: dielectric F + tinted + w (schlick - tinted)
    float dielectric, schlick;
    spectrum tinted;
    spectrum transmittance; // of the refraction, which includes the radiance's scaling
    float transmitted;      // share of (1 - F) that is sampled as refraction
    spectrum diffuse, sheen; // the former: base colour / pi
    float roughness, flatness;
    float coat, coat_alpha; // a quarter of the clearcoat
    float p_main, p_coat, p_diffuse;
};

static const struct param params[] = {
    PRINCIPLED_BASE_PARAMS(struct principled),
    {"metallic", PARAM_TEXTURE_SCALAR, offsetof(struct principled, metallic), .def = "0",
     .max = 1, .unit = "", .help = "from dielectric (0) to metal (1)"},
    {"eta", PARAM_FLOAT, offsetof(struct principled, eta), .def = "-1", .min = -1,
     .max = IOR_MOST, .unit = "", .help = "index inside over index outside (-1: from specular)"},
    {"specular", PARAM_FLOAT, offsetof(struct principled, specular), .def = "-1", .min = -1,
     .max = 1, .unit = "", .help = "reflectance at the normal, 1 for 8 % (-1: 0.5)"},
    {"clearcoat", PARAM_TEXTURE_SCALAR, offsetof(struct principled, clearcoat), .def = "0",
     .max = 1, .unit = "", .help = "strength of a second, isotropic reflection"},
    {"clearcoat_gloss", PARAM_TEXTURE_SCALAR, offsetof(struct principled, clearcoat_gloss),
     .def = "0", .max = 1, .unit = "", .help = "from satin (0) to glossy coat (1)"},
    PRINCIPLED_RATE_PARAM(struct principled, diffuse_rate, "diffuse_reflectance_sampling_rate",
                          "diffuse reflection"),
    PRINCIPLED_RATE_PARAM(struct principled, specular_rate, "main_specular_sampling_rate",
                          "main specular lobes"),
    PRINCIPLED_RATE_PARAM(struct principled, clearcoat_rate, "clearcoat_sampling_rate",
                          "clear coat"),
    PARAM_END,
};

static bool prepare(struct object *object, struct arena *arena) {
    enum { CLOSEST = 1000 }; // parts of 1 by which an index that transmits must differ from 1
    struct principled *self = object->data;
    (void)arena;
    if (self->eta >= 0 && self->specular >= 0) {
        log_error_at(object->at, "%s: eta and specular were found, at most one is expected",
                     object->type->name);
        return false;
    }
    if (self->eta >= 0 && self->eta < IOR_LEAST) {
        log_error_at(object->at, "%s: eta is %g, expected %g to %g", object->type->name,
                     (double)self->eta, (double)IOR_LEAST, (double)IOR_MOST);
        return false;
    }
    const float specular = self->specular >= 0 ? self->specular : 0.5f;
    self->index = self->eta >= 0 ? self->eta : 2 / (1 - sqrtf(0.08f * specular)) - 1;
    if (principled_has(&self->spec_trans) && fabsf(self->index - 1) < 1.0f / CLOSEST)
        self->index = 1 + 1.0f / CLOSEST;
    return true;
}

static uint32_t lobes(const void *data) {
    const struct principled *self = data;
    const uint32_t turned = principled_has(&self->anisotropic) ? LOBE_ANISOTROPIC : 0;
    const uint32_t through = principled_has(&self->spec_trans) ? LOBE_TRANSMISSION : 0;
    return LOBE_DIFFUSE | LOBE_GLOSSY | LOBE_REFLECTION | turned | through;
}

static void resolve_opaque(struct principled_data *c, const struct principled *self,
                           const struct texture_point *at, spectrum base, float metallic,
                           float opaque) {
    c->diffuse = base * (opaque * INV_PI);
    c->flatness = principled_share(&self->flatness, at);
    c->sheen = spectrum_grey(0);
    const float sheen = opaque > 0 ? principled_share(&self->sheen, at) * (1 - metallic) : 0;
    if (sheen > 0) {
        const float tint = principled_share(&self->sheen_tint, at);
        c->sheen = sheen * (spectrum_grey(1 - tint) + tint * principled_tint(base));
    }
    const float clearcoat = principled_share(&self->clearcoat, at);
    c->coat = 0.25f * clearcoat;
    c->coat_alpha = lerpf(principled_share(&self->clearcoat_gloss, at), 0.1f, 0.001f);
    c->p_main = self->specular_rate;
    c->p_coat = c->coat * self->clearcoat_rate;
    c->p_diffuse = opaque * self->diffuse_rate;
    const float sum = c->p_main + c->p_coat + c->p_diffuse, scale = sum > 0 ? 1 / sum : 0;
    c->p_main *= scale;
    c->p_coat *= scale;
    c->p_diffuse *= scale;
}

// From outside the main reflection mixes metal, tinted and plain dielectric.
static void resolve_fresnel(struct principled_data *c, const struct principled *self,
                            const struct texture_point *at, spectrum base, float metallic) {
    const float tint = principled_share(&self->spec_tint, at);
    const float R0 = sqr((c->eta - 1) / (c->eta + 1));
    c->dielectric = (1 - metallic) * (1 - tint);
    c->schlick = metallic + (1 - metallic) * tint;
    c->tinted = metallic * base;
    if (tint > 0)
        c->tinted += (1 - metallic) * tint * R0 * principled_tint(base);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct principled *self = data;
    const struct texture_point *at = &point->at;
    const float metallic = principled_share(&self->metallic, at);
    const float spec_trans = principled_share(&self->spec_trans, at);
    const float glass = (1 - metallic) * spec_trans;
    if (cos_theta(wo) == 0 || (cos_theta(wo) < 0 && glass == 0))
        return NULL;
    const bool inside = cos_theta(wo) < 0;
    struct principled_data *c = closure_alloc(stack, &bsdf_principled, sizeof *c,
                                              LOBE_GLOSSY | LOBE_REFLECTION |
                                                  (inside ? 0 : LOBE_DIFFUSE) |
                                                  (glass > 0 ? LOBE_TRANSMISSION : 0));
    const spectrum base = texture_eval(&self->base_color, at);
    c->mirrored = inside;
    c->wo = v3(wo[0], wo[1], fabsf(wo[2]));
    c->eta = c->mirrored ? 1 / self->index : self->index;
    c->roughness = principled_share(&self->roughness, at);
    c->facets = principled_facets(c->roughness, principled_share(&self->anisotropic, at));
    c->inv_area = 1 / microfacet_area(&c->facets, c->wo);
    c->transmittance = spectrum_map(safe_sqrt, base) * (glass / (c->eta * c->eta));
    if (c->mirrored) {
        c->dielectric = glass;
        c->transmitted = c->p_main = 1;
        c->schlick = c->coat = c->p_coat = c->p_diffuse = 0;
        c->tinted = spectrum_grey(0);
    } else {
        c->transmitted = glass;
        resolve_fresnel(c, self, at, base, metallic);
        resolve_opaque(c, self, at, base, metallic, (1 - metallic) * (1 - spec_trans));
    }
    return &c->head;
}

// Reflectance of the facets that are met at cos_o.
static spectrum main_fresnel(const struct principled_data *c, float F, float cos_o, float cos_t) {
    const float w = schlick_weight_eta(cos_o, cos_t, c->eta);
    return spectrum_grey(c->dielectric * F + c->schlick * w) + c->tinted * (1 - w);
}

// ---- clear coat -----------------------------------------------------------------------------

// GTR1 (Burley 2012, eq. 4 with gamma = 1); 1 - (1 - a^2) cos^2 is formed from the sine.
static float coat_D(float alpha, vec3 h) {
    const float a2 = sqr(alpha), s2 = sqr(h[0]) + sqr(h[1]);
    return (1 - a2) / (-PI * 2 * logf(alpha) * (s2 + a2 * sqr(h[2])));
}

// Facet normals in proportion to D cos: 1 - (1 - a^2) cos^2 = a^(2 (1 - u)).
static vec3 coat_sample(float alpha, struct vec2 u) {
    const float a2 = sqr(alpha);
    const float s2 = clampf((powf(a2, 1 - u.y) - a2) / (1 - a2), 0, 1), s = sqrtf(s2);
    float sine, cosine;
    sincos_turn(u.x, &sine, &cosine);
    return v3(s * cosine, s * sine, sqrtf(1 - s2));
}

// GGX masking of fixed roughness 0.25
static float coat_G1(vec3 w) {
    return 2 * w[2] / (w[2] + sqrtf(sqr(w[2]) + 0.0625f * (sqr(w[0]) + sqr(w[1]))));
}

// Reflection by the coat, and its density in *pdf_sa.
static float coat_eval(const struct principled_data *c, vec3 h, vec3 wi, float cos_o, float cos_t,
                       float *pdf_sa) {
    const float D = coat_D(c->coat_alpha, h), w = schlick_weight_eta(cos_o, cos_t, c->eta);
    *pdf_sa = 0.25f * D * h[2] / cos_o;
    return c->coat * lerpf(w, 0.04f, 1) * D * coat_G1(c->wo) * coat_G1(wi) * wi[2];
}

// ---- all lobes ------------------------------------------------------------------------------

static spectrum eval_reflected(const struct principled_data *c, vec3 wi, float *pdf_sa) {
    const vec3 h = normalize(c->wo + wi);
    const float cos_o = dot(c->wo, h);
    *pdf_sa = 0;
    if (!(cos_o > 0 && h[2] > 0))
        return spectrum_grey(0);
    float cos_t;
    const float F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    const float pdf_main = 0.25f * microfacet_D(&c->facets, h) * c->inv_area;
    spectrum f = main_fresnel(c, F, cos_o, cos_t) * (pdf_main * microfacet_G1(&c->facets, wi));
    *pdf_sa = c->p_main * (1 - c->transmitted * (1 - F)) * pdf_main;
    if (c->mirrored)
        return f;
    f += c->diffuse * principled_diffuse(c->roughness, c->flatness, c->wo[2], wi[2], cos_o);
    f += c->sheen * (schlick_weight(cos_o) * wi[2]);
    *pdf_sa += c->p_diffuse * INV_PI * wi[2];
    if (c->coat > 0) {
        float pdf_coat;
        f += spectrum_grey(coat_eval(c, h, wi, cos_o, cos_t, &pdf_coat));
        *pdf_sa += c->p_coat * pdf_coat;
    }
    return f;
}

static spectrum eval_refracted(const struct principled_data *c, vec3 wi, float *pdf_sa) {
    vec3 h;
    *pdf_sa = 0;
    if (!(c->transmitted > 0) || !refracting_facet(c->eta, c->wo, wi, &h))
        return spectrum_grey(0);
    float cos_t;
    const float cos_o = dot(c->wo, h), F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    const float pdf = (1 - F) * refracted_pdf_sa(&c->facets, c->inv_area, c->eta, h, cos_o, cos_t);
    *pdf_sa = c->p_main * c->transmitted * pdf;
    return c->transmittance * (pdf * microfacet_G1(&c->facets, -wi));
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct principled_data *c = (const void *)closure;
    if (c->mirrored)
        wi[2] = -wi[2];
    if (wi[2] > 0)
        return eval_reflected(c, wi, pdf_sa);
    if (wi[2] < 0)
        return eval_refracted(c, wi, pdf_sa);
    *pdf_sa = 0;
    return spectrum_grey(0);
}

// A direction of the main lobes, by the facet that u2 chooses and the share u in [0,1) left of u1.
static bool sample_main(const struct principled_data *c, float u, struct vec2 u2, vec3 *wi,
                        uint32_t *lobe) {
    const vec3 h = microfacet_sample(&c->facets, c->wo, u2);
    const float cos_o = dot(c->wo, h);
    float cos_t;
    if (!(cos_o > 0))
        return false;
    const float F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    const bool through = u < c->transmitted * (1 - F);
    *lobe = LOBE_GLOSSY | (through ? LOBE_TRANSMISSION : LOBE_REFLECTION);
    *wi = through ? refract_at_facet(c->eta, c->wo, h, cos_o, cos_t)
                  : normalize(reflect(c->wo, h));
    return through == ((*wi)[2] < 0); // else the light met another facet
}

static bool sample_lobe(const struct principled_data *c, float u1, struct vec2 u2, vec3 *wi,
                        uint32_t *lobe) {
    if (u1 < c->p_diffuse) {
        *lobe = LOBE_DIFFUSE | LOBE_REFLECTION;
        *wi = warp_cosine_hemisphere(u2);
        return true;
    }
    u1 -= c->p_diffuse;
    if (u1 < c->p_coat) {
        *lobe = LOBE_GLOSSY | LOBE_REFLECTION;
        *wi = normalize(reflect(c->wo, coat_sample(c->coat_alpha, u2)));
        return (*wi)[2] > 0;
    }
    return c->p_main > 0 && sample_main(c, (u1 - c->p_coat) / c->p_main, u2, wi, lobe);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct principled_data *c = (const void *)closure;
    if (!sample_lobe(c, u1, u2, &s->wi, &s->lobe))
        return false;
    const bool through = s->lobe & LOBE_TRANSMISSION;
    const spectrum f = through ? eval_refracted(c, s->wi, &s->pdf_sa)
                               : eval_reflected(c, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f / s->pdf_sa;
    s->eta = through ? c->eta : 1;
    if (c->mirrored)
        s->wi[2] = -s->wi[2];
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct principled_data *c = (const void *)closure;
    float cos_t;
    const float cos_o = cos_theta(c->wo), F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    spectrum sum = main_fresnel(c, F, cos_o, cos_t) +
                   c->transmittance * ((1 - F) * c->eta * c->eta);
    if (!c->mirrored)
        sum += c->diffuse * PI;
    return sum;
}

const struct bsdf_type bsdf_principled = {
    .entry = {.name = "principled", .help = "many materials in one (Burley 2012, 2015)",
              .params = params, .size = sizeof(struct principled)},
    .claims = CLAIM_RECIPROCAL,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
