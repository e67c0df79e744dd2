// SPDX-License-Identifier: Apache-2.0
// The principled material for thin sheets (Burley 2015, 5.3) as Mitsuba 3 has it: both sides alike,
// light that goes through is not bent. The sheet mixes a specular part, GGX reflection and the same
// lobe turned to the far side with a roughness that grows with the index, and a diffuse part, which
// reflects and transmits.
//
// As in Mitsuba, light passes no facet that is seen from the wrong side: at grazing angles this
// takes away rays through the sheet, and not the same ones in both directions, so that reciprocity
// is not exact there.
#include "bsdf/principled.h"
#include "math/fresnel.h"
#include "math/ior.h"
#include "math/warp.h"

struct principledthin {
    struct texture_ref base_color, roughness, anisotropic, spec_trans, spec_tint, sheen, sheen_tint,
        flatness, diff_trans, eta;
    float specular_reflection_rate, specular_transmission_rate;
    float diffuse_reflection_rate, diffuse_transmission_rate;
};

enum part { GLOSSY_REFLECTED, GLOSSY_TRANSMITTED, DIFFUSE_REFLECTED, DIFFUSE_TRANSMITTED, PARTS };

static const uint32_t part_lobes[PARTS] = {
    LOBE_GLOSSY | LOBE_REFLECTION, LOBE_GLOSSY | LOBE_TRANSMISSION,
    LOBE_DIFFUSE | LOBE_REFLECTION, LOBE_DIFFUSE | LOBE_TRANSMISSION};

struct thin_data {
    struct closure head;
    bool mirrored; // wo was below
    vec3 wo;       // above
    struct microfacet facets[2]; // of reflection, of transmission
    float inv_area[2];           // 1 / sigma(wo) of each
    float eta, roughness, flatness;
    // reflectance of a facet: dielectric F + tinted + w (schlick - tinted)
    float dielectric, schlick;
    spectrum tinted;
    spectrum through, diffuse, sheen, diffuse_through; // the diffuse ones: times base colour / pi
    float p[PARTS];
};

static const struct param params[] = {
    PRINCIPLED_BASE_PARAMS(struct principledthin),
    {"eta", PARAM_TEXTURE_SCALAR, offsetof(struct principledthin, eta), .def = "1.5",
     .min = IOR_LEAST, .max = IOR_MOST, .unit = "",
     .help = "index of the sheet over the one around it"},
    {"diff_trans", PARAM_TEXTURE_SCALAR, offsetof(struct principledthin, diff_trans), .def = "0",
     .max = 2, .unit = "", .help = "from diffuse reflection (0) to diffuse transmission (2)"},
    PRINCIPLED_RATE_PARAM(struct principledthin, diffuse_reflection_rate,
                          "diffuse_reflectance_sampling_rate", "diffuse reflection"),
    PRINCIPLED_RATE_PARAM(struct principledthin, specular_reflection_rate,
                          "specular_reflectance_sampling_rate", "specular reflection"),
    PRINCIPLED_RATE_PARAM(struct principledthin, specular_transmission_rate,
                          "specular_transmittance_sampling_rate", "specular transmission"),
    PRINCIPLED_RATE_PARAM(struct principledthin, diffuse_transmission_rate,
                          "diffuse_transmittance_sampling_rate", "diffuse transmission"),
    PARAM_END,
};

static uint32_t lobes(const void *data) {
    const struct principledthin *self = data;
    const bool glossy = principled_has(&self->spec_trans);
    const bool through = glossy || principled_has(&self->diff_trans);
    const uint32_t turned =
        glossy && principled_has(&self->anisotropic) ? LOBE_ANISOTROPIC : 0;
    return LOBE_DIFFUSE | LOBE_REFLECTION | (glossy ? LOBE_GLOSSY : 0) |
           (through ? LOBE_TRANSMISSION : 0) | turned;
}

static void resolve_glossy(struct thin_data *c, const struct principledthin *self,
                           const struct texture_point *at, spectrum base, float spec_trans) {
    const float anisotropic = principled_share(&self->anisotropic, at);
    const float tint = principled_share(&self->spec_tint, at);
    const float R0 = sqr((c->eta - 1) / (c->eta + 1));
    // Roughness of the transmission: Burley 2015, figure 15.
    c->facets[0] = principled_facets(c->roughness, anisotropic);
    c->facets[1] = principled_facets((0.65f * c->eta - 0.35f) * c->roughness, anisotropic);
    for (int i = 0; i < 2; i++)
        c->inv_area[i] = 1 / microfacet_area(&c->facets[i], c->wo);
    c->dielectric = spec_trans * (1 - tint);
    c->schlick = spec_trans * tint;
    c->tinted = spec_trans * tint * R0 * principled_tint(base);
    c->through = spec_trans * base;
}

static void resolve_diffuse(struct thin_data *c, const struct principledthin *self,
                            const struct texture_point *at, spectrum base, float reflected,
                            float transmitted) {
    const float tint = principled_share(&self->sheen_tint, at);
    c->flatness = principled_share(&self->flatness, at);
    c->diffuse = base * (reflected * INV_PI);
    c->diffuse_through = base * (transmitted * INV_PI);
    c->sheen = reflected * principled_share(&self->sheen, at) *
               (spectrum_grey(1 - tint) + tint * principled_tint(base));
}

static void resolve_rates(struct thin_data *c, const struct principledthin *self, float spec_trans,
                          float reflected, float transmitted) {
    c->p[GLOSSY_REFLECTED] = 0.5f * spec_trans * self->specular_reflection_rate;
    c->p[GLOSSY_TRANSMITTED] = 0.5f * spec_trans * self->specular_transmission_rate;
    c->p[DIFFUSE_REFLECTED] = reflected * self->diffuse_reflection_rate;
    c->p[DIFFUSE_TRANSMITTED] = transmitted * self->diffuse_transmission_rate;
    const float sum = c->p[0] + c->p[1] + c->p[2] + c->p[3];
    for (int i = 0; i < PARTS; i++)
        c->p[i] = sum > 0 ? c->p[i] / sum : 0;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct principledthin *self = data;
    const struct texture_point *at = &point->at;
    const float spec_trans = principled_share(&self->spec_trans, at);
    const float half = clampf(0.5f * texture_eval_scalar(&self->diff_trans, at), 0, 1);
    const float reflected = (1 - spec_trans) * (1 - half), transmitted = (1 - spec_trans) * half;
    if (cos_theta(wo) == 0)
        return NULL;
    struct thin_data *c = closure_alloc(stack, &bsdf_principledthin, sizeof *c, lobes(self));
    const spectrum base = texture_eval(&self->base_color, at);
    c->mirrored = cos_theta(wo) < 0;
    c->wo = v3(wo[0], wo[1], fabsf(wo[2]));
    c->eta = clampf(texture_eval_scalar(&self->eta, at), IOR_LEAST, IOR_MOST);
    c->roughness = principled_share(&self->roughness, at);
    resolve_glossy(c, self, at, base, spec_trans);
    resolve_diffuse(c, self, at, base, reflected, transmitted);
    resolve_rates(c, self, spec_trans, reflected, transmitted);
    return &c->head;
}

static spectrum facet_reflectance(const struct thin_data *c, float cos_o, float F, float cos_t) {
    const float w = schlick_weight_eta(cos_o, cos_t, c->eta);
    return spectrum_grey(c->dielectric * F + c->schlick * w) + c->tinted * (1 - w);
}

static spectrum eval_reflected(const struct thin_data *c, vec3 wi, float *pdf_sa) {
    const vec3 h = normalize(c->wo + wi);
    const float cos_o = dot(c->wo, h);
    const float diffuse = principled_diffuse(c->roughness, c->flatness, c->wo[2], wi[2], cos_o);
    const spectrum f = c->diffuse * diffuse + c->sheen * (schlick_weight(cos_o) * wi[2]);
    *pdf_sa = c->p[DIFFUSE_REFLECTED] * INV_PI * wi[2];
    if (!(cos_o > 0) || c->dielectric + c->schlick == 0)
        return f;
    float cos_t;
    const float F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    const float pdf = 0.25f * microfacet_D(&c->facets[0], h) * c->inv_area[0];
    *pdf_sa += c->p[GLOSSY_REFLECTED] * pdf;
    return f + facet_reflectance(c, cos_o, F, cos_t) * (pdf * microfacet_G1(&c->facets[0], wi));
}

// Whether light passes the facet between wo and the mirror image of wi, which is below.
static bool facet_passes(const struct thin_data *c, vec3 wi, vec3 *h) {
    *h = normalize(c->wo + v3(wi[0], wi[1], -wi[2]));
    return dot(c->wo, *h) > 0 && dot(wi, *h) < 0;
}

// wi is below.
static spectrum eval_transmitted(const struct thin_data *c, vec3 wi, float *pdf_sa) {
    const spectrum f = c->diffuse_through * -wi[2];
    *pdf_sa = c->p[DIFFUSE_TRANSMITTED] * INV_PI * -wi[2];
    vec3 h;
    if (c->dielectric + c->schlick == 0 || !facet_passes(c, wi, &h))
        return f;
    float cos_t;
    const float F = fresnel_dielectric(dot(c->wo, h), c->eta, &cos_t);
    const float pdf = 0.25f * microfacet_D(&c->facets[1], h) * c->inv_area[1];
    *pdf_sa += c->p[GLOSSY_TRANSMITTED] * pdf;
    const float G1 = microfacet_G1(&c->facets[1], v3(wi[0], wi[1], -wi[2]));
    return f + c->through * ((1 - F) * pdf * G1);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct thin_data *c = (const void *)closure;
    if (c->mirrored)
        wi[2] = -wi[2];
    if (wi[2] > 0)
        return eval_reflected(c, wi, pdf_sa);
    if (wi[2] < 0)
        return eval_transmitted(c, wi, pdf_sa);
    *pdf_sa = 0;
    return spectrum_grey(0);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct thin_data *c = (const void *)closure;
    int part = 0;
    while (part < PARTS - 1 && u1 >= c->p[part])
        u1 -= c->p[part++];
    const bool glossy = part <= GLOSSY_TRANSMITTED;
    const bool through = part == GLOSSY_TRANSMITTED || part == DIFFUSE_TRANSMITTED;
    s->wi = glossy ? normalize(reflect(c->wo, microfacet_sample(&c->facets[part], c->wo, u2)))
                   : warp_cosine_hemisphere(u2);
    if (!(s->wi[2] > 0))
        return false; // the light met another facet
    if (through)
        s->wi[2] = -s->wi[2];
    vec3 h;
    if (part == GLOSSY_TRANSMITTED && !facet_passes(c, s->wi, &h))
        return false;
    const spectrum f = through ? eval_transmitted(c, s->wi, &s->pdf_sa)
                               : eval_reflected(c, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f / s->pdf_sa;
    s->eta = 1;
    s->lobe = part_lobes[part];
    if (c->mirrored)
        s->wi[2] = -s->wi[2];
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct thin_data *c = (const void *)closure;
    float cos_t;
    const float cos_o = cos_theta(c->wo), F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    return facet_reflectance(c, cos_o, F, cos_t) + c->through * (1 - F) +
           (c->diffuse + c->diffuse_through) * PI;
}

const struct bsdf_type bsdf_principledthin = {
    .entry = {.name = "principledthin", .help = "many thin sheets in one (Burley 2015)",
              .params = params, .size = sizeof(struct principledthin)},
    .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample, .albedo = albedo,
};
