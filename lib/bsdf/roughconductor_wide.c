// SPDX-License-Identifier: Apache-2.0
// roughconductor.c for all lanes: single scattering by facets whose roughness is not textured.
// A kind for each distribution, so that the lanes of a call share it.
#include "bsdf/roughconductor.h"
#include "math/wide_fresnel.h"
#include "math/wide_microfacet.h"

struct roughconductor_lanes {
    struct wide_microfacet facets;
    struct wide3 wo;
    wide quarter_area;
    struct wide3 eta, k, reflectance;
};

_Static_assert(sizeof(struct roughconductor_lanes) <= sizeof(struct wide_closures), "");

static struct wide3 colours(const struct wide_points *points, size_t offset) {
    wide f[4];
    wide_data4(points, offset, f);
    return (struct wide3){f[0], f[1], f[2]};
}

static void resolve(enum microfacet_type type, const struct wide_points *points,
                    const struct wide3 *wo, struct wide_closures *closures) {
    struct roughconductor_lanes *c = (void *)closures;
    const struct microfacet *facets[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        facets[i] = &((const struct roughconductor *)points->data[i])->facets;
    c->facets = wide_microfacet_gather(type, facets);
    c->wo = *wo;
    c->quarter_area = 0.25f / wide_microfacet_area(&c->facets, *wo);
    c->eta = colours(points, offsetof(struct roughconductor, index.eta));
    c->k = colours(points, offsetof(struct roughconductor, index.k));
    c->reflectance = wide_textures(points, offsetof(struct roughconductor, reflectance));
}

static void resolve_beckmann(const struct wide_points *points, const struct wide3 *wo,
                             struct wide_closures *closures) {
    resolve(MICROFACET_BECKMANN, points, wo, closures);
}

static void resolve_ggx(const struct wide_points *points, const struct wide3 *wo,
                        struct wide_closures *closures) {
    resolve(MICROFACET_GGX, points, wo, closures);
}

static struct wide3 quotient(const struct roughconductor_lanes *c, struct wide3 h,
                             struct wide3 wi) {
    const struct wide3 F = wide_fresnel_conductor(wide_dot(c->wo, h), c->eta, c->k);
    const wide G1 = wide_microfacet_G1(&c->facets, wi);
    return (struct wide3){c->reflectance.x * F.x * G1, c->reflectance.y * F.y * G1,
                          c->reflectance.z * F.z * G1};
}

static struct wide3 eval(const struct wide_closures *closures, const struct wide3 *wi,
                         wide *pdf_sa) {
    const struct roughconductor_lanes *c = (const void *)closures;
    const struct wide3 none = {0}, h = wide_normalize(wide3_add(c->wo, *wi));
    const wide pdf = wide_microfacet_D(&c->facets, h) * c->quarter_area;
    const wide_mask some = wide_both(wi->z > 0, pdf > 0);
    *pdf_sa = wide_select(some, pdf, none.x);
    return wide3_select(some, wide3_scale(pdf, quotient(c, h, *wi)), none);
}

static wide_mask sample(const struct wide_closures *closures, wide u1, const wide u2[2],
                        struct wide_samples *s) {
    const struct roughconductor_lanes *c = (const void *)closures;
    const struct wide3 h = wide_microfacet_sample(&c->facets, c->wo, u2);
    (void)u1;
    s->wi = wide_normalize(wide_reflect(c->wo, h));
    s->pdf_sa = wide_microfacet_D(&c->facets, h) * c->quarter_area;
    s->weight = quotient(c, h, s->wi);
    s->lobe = (wide_uint)wide_int_of(LOBE_GLOSSY | LOBE_REFLECTION);
    return wide_both(s->wi.z > 0, s->pdf_sa > 0);
}

const struct wide_bsdf roughconductor_wide[] = {
    [MICROFACET_BECKMANN] = {.lobes = LOBE_GLOSSY | LOBE_REFLECTION, .resolve = resolve_beckmann,
                             .eval = eval, .sample = sample},
    [MICROFACET_GGX] = {.lobes = LOBE_GLOSSY | LOBE_REFLECTION, .resolve = resolve_ggx,
                        .eval = eval, .sample = sample},
};
