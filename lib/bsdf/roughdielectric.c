// SPDX-License-Identifier: Apache-2.0
// Rough boundary between two dielectrics (Walter et al. 2007, Microfacet Models for Refraction
// through Rough Surfaces): every facet reflects and refracts as glass does. The interior is the
// side opposite to the normal. Light that leaves a facet for another one is lost, or given back by
// broad lobes on both sides (bsdf/facet_loss.h).
#include "bsdf/rough_boundary.h"
#include "bsdf/roughness.h"
#include "bsdf/smooth.h"
#include "math/fresnel.h"

struct roughdielectric {
    struct dielectric_index index;
    struct roughness roughness;
    struct texture_ref reflectance, transmittance;
    int energy;
    struct facet_loss loss[2]; // made by prepare: outside, inside
};

struct rough_data {
    struct closure head;
    struct microfacet facets;
    vec3 wo;       // above the surface: all is mirrored when it was below
    bool mirrored;
    float eta;     // of the far side over wo's
    float inv_area; // 1 / sigma(wo)
    spectrum reflectance, transmittance; // the latter includes the radiance's scaling
    bool compensated;
    struct facet_loss_at loss[2]; // on wo's side, on the far one
    float regained[2];   // of the broad lobes there: energy form of f / lost(wi), times pi
    float p_regained[2]; // their probabilities
};

static const struct param params[] = {
    DIELECTRIC_INDEX_PARAMS(struct roughdielectric, index, "bk7"),
    ROUGHNESS_PARAMS(struct roughdielectric, roughness),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct roughdielectric, reflectance),
     .def = "1", .max = 1, .unit = "", .help = "factor on the reflection"},
    {"specular_transmittance", PARAM_TEXTURE, offsetof(struct roughdielectric, transmittance),
     .def = "1", .max = 1, .unit = "", .help = "factor on the refraction"},
    ENERGY_PARAM(struct roughdielectric, energy),
    PARAM_END,
};

struct boundary {
    enum microfacet_type type;
    float eta;
};

static double boundary_albedo(const void *context, float alpha_u, float alpha_v, vec3 v,
                              int nodes) {
    const struct boundary *b = context;
    const struct microfacet m = microfacet_make(b->type, alpha_u, alpha_v);
    double reflected, transmitted;
    microfacet_albedo_from(&m, b->eta, v, nodes, &reflected, &transmitted);
    return reflected + transmitted + facet_albedo_error(nodes, b->eta < 1);
}

static bool prepare(struct object *self, struct arena *arena) {
    struct roughdielectric *r = self->data;
    const float eta = r->index.int_ior / r->index.ext_ior;
    if (!roughness_prepare(&r->roughness, self))
        return false;
    for (int i = 0; i < 2 && r->energy == ENERGY_COMPENSATED; i++) {
        const struct boundary b = {(enum microfacet_type)r->roughness.distribution,
                                   i ? 1 / eta : eta};
        if (!roughness_loss(&r->roughness, self, boundary_albedo, &b, &r->loss[i], arena))
            return false;
    }
    return true;
}

static uint32_t lobes(const void *data) {
    const struct roughdielectric *self = data;
    const float eta = self->index.int_ior / self->index.ext_ior;
    if (eta == 1)
        return dielectric_lobes(eta);
    const uint32_t nearly_equal = fabsf(eta - 1) < 0.05f ? LOBE_SPECULAR : 0;
    return roughness_lobes(&self->roughness) | nearly_equal | LOBE_REFLECTION | LOBE_TRANSMISSION;
}

static void resolve_regained(struct rough_data *c, const struct roughdielectric *self) {
    for (int i = 0; i < 2; i++)
        c->loss[i] = facet_loss_at(&self->loss[c->mirrored ? 1 - i : i], c->facets.alpha_u);
    const float lost = facet_lost(&c->loss[0], c->wo);
    float share, back;
    facet_loss_share(c->eta, c->loss[0].mean, c->loss[1].mean, &share, &back);
    c->p_regained[0] = lost * (1 - share);
    c->p_regained[1] = lost * share;
    for (int i = 0; i < 2; i++)
        c->regained[i] = c->loss[i].mean > 0 ? c->p_regained[i] / c->loss[i].mean : 0;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct roughdielectric *self = data;
    const float eta = self->index.int_ior / self->index.ext_ior;
    const spectrum R = texture_eval(&self->reflectance, &point->at);
    const spectrum T = texture_eval(&self->transmittance, &point->at);
    struct microfacet facets;
    if (!roughness_at(&self->roughness, &point->at, &facets) ||
        maxf(facets.alpha_u, facets.alpha_v) * fabsf(eta - 1) < REFRACTION_SPREAD_MIN)
        return dielectric_closure(eta, R, T, wo, stack);
    if (cos_theta(wo) == 0)
        return NULL;
    struct rough_data *c = closure_alloc(stack, &bsdf_roughdielectric, sizeof *c,
                                         LOBE_GLOSSY | LOBE_REFLECTION | LOBE_TRANSMISSION);
    c->mirrored = cos_theta(wo) < 0;
    c->wo = v3(wo[0], wo[1], fabsf(wo[2]));
    c->facets = facets;
    c->eta = c->mirrored ? 1 / eta : eta;
    c->inv_area = 1 / microfacet_area(&facets, c->wo);
    c->reflectance = R;
    c->transmittance = T / (c->eta * c->eta);
    c->compensated = self->energy == ENERGY_COMPENSATED;
    if (c->compensated)
        resolve_regained(c, self);
    return &c->head;
}

// Density of reflection at the facet h that reflects the share F.
static float pdf_reflected(const struct rough_data *c, vec3 h, float F) {
    return 0.25f * F * microfacet_D(&c->facets, h) * c->inv_area;
}

// Density of refraction at the facet h under cosines of both sides.
static float pdf_refracted(const struct rough_data *c, vec3 h, float F, float cos_o, float cos_t) {
    return (1 - F) * refracted_pdf_sa(&c->facets, c->inv_area, c->eta, h, cos_o, cos_t);
}

// Single scattering; wi is of the mirrored frame.
static spectrum eval_once(const struct rough_data *c, vec3 wi, float *pdf_sa) {
    float cos_t;
    *pdf_sa = 0;
    if (wi[2] > 0) {
        const vec3 h = normalize(c->wo + wi);
        *pdf_sa = pdf_reflected(c, h, fresnel_dielectric(dot(c->wo, h), c->eta, &cos_t));
        return c->reflectance * (*pdf_sa * microfacet_G1(&c->facets, wi));
    }
    vec3 h;
    if (!(wi[2] < 0) || !refracting_facet(c->eta, c->wo, wi, &h))
        return spectrum_grey(0);
    const float cos_o = dot(c->wo, h);
    const float F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    *pdf_sa = pdf_refracted(c, h, F, cos_o, cos_t);
    return c->transmittance * (*pdf_sa * microfacet_G1(&c->facets, -wi));
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct rough_data *c = (const void *)closure;
    if (c->mirrored)
        wi[2] = -wi[2];
    const spectrum once = eval_once(c, wi, pdf_sa);
    if (!c->compensated)
        return once;
    const int far = wi[2] > 0 ? 0 : 1;
    const float cosine = INV_PI * fabsf(wi[2]);
    const vec3 up = v3(wi[0], wi[1], fabsf(wi[2]));
    *pdf_sa = (1 - c->p_regained[0] - c->p_regained[1]) * *pdf_sa +
              c->p_regained[far] * facet_loss_pdf_sa(&c->loss[far], up);
    return once + (far ? c->transmittance : c->reflectance) *
                      (c->regained[far] * facet_lost(&c->loss[far], up) * cosine);
}

// Through a facet; what is sampled is single scattering, in the mirrored frame.
static bool sample_once(const struct rough_data *c, float u1, struct vec2 u2,
                        struct bsdf_sample *s) {
    const vec3 h = microfacet_sample(&c->facets, c->wo, u2);
    const float cos_o = dot(c->wo, h);
    if (!(cos_o > 0))
        return false;
    float cos_t;
    const float F = fresnel_dielectric(cos_o, c->eta, &cos_t);
    if (u1 < F) {
        s->wi = normalize(2 * cos_o * h - c->wo);
        s->pdf_sa = pdf_reflected(c, h, F);
        s->weight = c->reflectance;
        s->eta = 1;
        s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    } else {
        s->wi = refract_at_facet(c->eta, c->wo, h, cos_o, cos_t);
        s->pdf_sa = pdf_refracted(c, h, F, cos_o, cos_t);
        s->weight = c->transmittance;
        s->eta = c->eta;
        s->lobe = LOBE_GLOSSY | LOBE_TRANSMISSION;
    }
    if ((s->wi[2] > 0) != (u1 < F) || !(s->pdf_sa > 0))
        return false; // the light met another facet
    s->weight *= microfacet_G1(&c->facets, u1 < F ? s->wi : -s->wi);
    return true;
}

static void sample_regained(const struct rough_data *c, bool far, struct vec2 u2,
                            struct bsdf_sample *s) {
    s->wi = facet_loss_sample(&c->loss[far], u2);
    s->wi[2] = far ? -s->wi[2] : s->wi[2];
    s->eta = far ? c->eta : 1;
    s->lobe = LOBE_GLOSSY | (far ? LOBE_TRANSMISSION : LOBE_REFLECTION);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct rough_data *c = (const void *)closure;
    const float back = c->compensated ? c->p_regained[0] : 0;
    const float regained = c->compensated ? back + c->p_regained[1] : 0;
    if (u1 < regained)
        sample_regained(c, u1 >= back, u2, s);
    else if (!sample_once(c, (u1 - regained) / (1 - regained), u2, s))
        return false;
    if (c->mirrored)
        s->wi[2] = -s->wi[2];
    if (!c->compensated)
        return true;
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f / s->pdf_sa;
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct rough_data *c = (const void *)closure;
    float cos_t;
    const float F = fresnel_dielectric(cos_theta(c->wo), c->eta, &cos_t);
    return F * c->reflectance + (1 - F) * c->eta * c->eta * c->transmittance;
}

static spectrum null_transmittance(const void *data, const struct bsdf_point *point, vec3 wo) {
    const struct roughdielectric *self = data;
    (void)wo;
    if (self->index.int_ior != self->index.ext_ior)
        return spectrum_grey(0);
    return texture_eval(&self->transmittance, &point->at);
}

const struct bsdf_type bsdf_roughdielectric = {
    .entry = {.name = "roughdielectric", .help = "rough boundary of glass (Walter et al. 2007)",
              .params = params, .size = sizeof(struct roughdielectric)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo, .null_transmittance = null_transmittance,
};
