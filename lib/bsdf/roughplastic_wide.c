// SPDX-License-Identifier: Apache-2.0
// roughplastic.c for all lanes: single scattering by a coat that is not smooth. A kind for each
// distribution, so that the lanes of a call share it.
#include "bsdf/roughplastic.h"
#include "math/wide_fresnel.h"
#include "math/wide_microfacet.h"

struct roughplastic_lanes {
    const struct roughplastic *self[WIDE_LANES];
    struct wide_microfacet facets;
    struct wide3 wo;
    wide quarter_area, eta, p_specular;
    struct wide3 specular, diffuse;
};

_Static_assert(sizeof(struct roughplastic_lanes) <= sizeof(struct wide_closures), "");

// boundary_lookup in the table that lies at an offset in struct roughplastic.
static wide look_up(const struct roughplastic *const self[WIDE_LANES], size_t offset, wide cosine) {
    const wide x = wide_sqrt(cosine) * BOUNDARY_TABLE;
    const wide_int at = __builtin_convertvector(wide_min(x, wide_of(BOUNDARY_TABLE - 1)), wide_int);
    const wide t = x - __builtin_convertvector(at, wide);
    float low[WIDE_LANES], high[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++) {
        const float *table = (const void *)((const char *)self[i] + offset);
        low[i] = table[at[i]];
        high[i] = table[at[i] + 1];
    }
    return (1 - t) * wide_load(low) + t * wide_load(high);
}

static wide transmitted(const struct roughplastic_lanes *c, wide cosine) {
    return look_up(c->self, offsetof(struct roughplastic, outside.transmitted), cosine);
}

static wide reflected(const struct roughplastic_lanes *c, wide cosine) {
    return look_up(c->self, offsetof(struct roughplastic, outside.reflected), cosine);
}

// One channel of plastic_base.
static wide base(wide diffuse, wide_mask nonlinear, wide leaving, wide eta) {
    const wide a = wide_select(nonlinear, diffuse, wide_of(1));
    const wide loss = (1 - a) + a * leaving;
    return diffuse / loss / (eta * eta);
}

static wide mean(struct wide3 v) {
    return (v.x + v.y + v.z) * (1.0f / 3);
}

// The diffuse base as seen from wo; what all of it would reflect decides between the lobes.
static void resolve_base(const struct wide_points *points, wide_mask nonlinear,
                         struct roughplastic_lanes *c) {
    wide coat[4], out[4]; // eta, entering, leaving, ...; mean_transmitted, ...
    wide_data4(points, offsetof(struct roughplastic, coat), coat);
    wide_data4(points, offsetof(struct roughplastic, mean_transmitted), out);
    const struct wide3 d = wide_textures(points, offsetof(struct roughplastic, diffuse));
    c->eta = coat[0];
    const struct wide3 below = {base(d.x, nonlinear, coat[2], c->eta),
                                base(d.y, nonlinear, coat[2], c->eta),
                                base(d.z, nonlinear, coat[2], c->eta)};
    c->diffuse = wide3_scale(transmitted(c, c->wo.z), below);
    const wide s = mean(wide3_scale(reflected(c, c->wo.z), c->specular));
    const wide sum = s + mean(wide3_scale(out[0], c->diffuse));
    c->p_specular = wide_select(sum > 0, s / sum, wide_of(1));
}

static void resolve(enum microfacet_type type, const struct wide_points *points,
                    const struct wide3 *wo, struct wide_closures *closures) {
    struct roughplastic_lanes *c = (void *)closures;
    const struct microfacet *facets[WIDE_LANES];
    uint32_t nonlinear = 0;
    for (int i = 0; i < WIDE_LANES; i++) {
        c->self[i] = points->data[i];
        facets[i] = &c->self[i]->facets;
        nonlinear |= (uint32_t)c->self[i]->nonlinear << i;
    }
    c->facets = wide_microfacet_gather(type, facets);
    c->wo = *wo;
    c->quarter_area = 0.25f / wide_microfacet_area(&c->facets, *wo);
    c->specular = wide_textures(points, offsetof(struct roughplastic, specular));
    resolve_base(points, wide_mask_of(nonlinear), c);
}

static void resolve_beckmann(const struct wide_points *points, const struct wide3 *wo,
                             struct wide_closures *closures) {
    resolve(MICROFACET_BECKMANN, points, wo, closures);
}

static void resolve_ggx(const struct wide_points *points, const struct wide3 *wo,
                        struct wide_closures *closures) {
    resolve(MICROFACET_GGX, points, wo, closures);
}

static struct wide3 eval(const struct wide_closures *closures, const struct wide3 *wi,
                         wide *pdf_sa) {
    const struct roughplastic_lanes *c = (const void *)closures;
    const struct wide3 none = {0}, h = wide_normalize(wide3_add(c->wo, *wi));
    const wide_mask above = wide_whole(wi->z > 0);
    const wide pdf_specular = wide_microfacet_D(&c->facets, h) * c->quarter_area;
    const wide F = wide_fresnel_dielectric(wide_dot(c->wo, h), c->eta);
    const wide diffuse = wi->z * INV_PI;
    const wide pdf = (1 - c->p_specular) * diffuse + c->p_specular * pdf_specular;
    const wide coat = F * pdf_specular * wide_microfacet_G1(&c->facets, *wi);
    const wide under = transmitted(c, wi->z) * diffuse;
    *pdf_sa = wide_select(above, pdf, none.x);
    return wide3_select(
        above, wide3_add(wide3_scale(coat, c->specular), wide3_scale(under, c->diffuse)), none);
}

static wide_mask sample(const struct wide_closures *closures, wide u1, const wide u2[2],
                        struct wide_samples *s) {
    const struct roughplastic_lanes *c = (const void *)closures;
    const wide_mask specular = wide_whole(u1 < c->p_specular);
    s->wi = wide_cosine_hemisphere(u2);
    if (wide_any(specular)) {
        const struct wide3 h = wide_microfacet_sample(&c->facets, c->wo, u2);
        s->wi = wide3_select(specular, wide_normalize(wide_reflect(c->wo, h)), s->wi);
    }
    const struct wide3 f = eval(closures, &s->wi, &s->pdf_sa);
    s->weight = (struct wide3){f.x / s->pdf_sa, f.y / s->pdf_sa, f.z / s->pdf_sa};
    s->lobe = (wide_uint)wide_int_select(specular, wide_int_of(LOBE_GLOSSY | LOBE_REFLECTION),
                                         wide_int_of(LOBE_DIFFUSE | LOBE_REFLECTION));
    return s->pdf_sa > 0;
}

const struct wide_bsdf roughplastic_wide[] = {
    [MICROFACET_BECKMANN] = {.lobes = LOBE_GLOSSY | LOBE_DIFFUSE | LOBE_REFLECTION,
                             .draws_lobe = true, .resolve = resolve_beckmann, .eval = eval,
                             .sample = sample},
    [MICROFACET_GGX] = {.lobes = LOBE_GLOSSY | LOBE_DIFFUSE | LOBE_REFLECTION, .draws_lobe = true,
                        .resolve = resolve_ggx, .eval = eval, .sample = sample},
};
