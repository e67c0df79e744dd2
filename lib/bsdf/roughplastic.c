// SPDX-License-Identifier: Apache-2.0
// Diffuse base under a rough dielectric coat, as Mitsuba 3 defines it: the coat reflects by
// microfacets, and the base is seen through the transmittances T of the coat for both directions,
//
//     f = F D G / (4 cos_o cos_i) + base(diffuse) T(cos_o) T(cos_i) / pi
//
// T is what single scattering transmits from outside, tabulated before rendering. What the coat
// reflects inside is a mean over 64 equally spaced cosines that counts both ends in full, as in
// Mitsuba: 1.6 % below the integral, which makes the base 2 % darker at an index of 1.5. Reference
// pictures show that; plastic has the integral.
//
// With compensated energy the light that facets send to each other is given back
// (bsdf/facet_loss.h): a broad lobe is added to the coat's reflection, the rest to T, and what the
// coat reflects inside is all that it does not transmit, so that a white material returns
// everything.
#include "bsdf/roughplastic.h"

#include "math/fresnel.h"
#include "math/quadrature.h"
#include "math/warp.h"

enum { NODES_OUTSIDE = 32, NODES_INSIDE = 32, DIRECTIONS = 64, OUTSIDE = 32 };
enum { NODES_COMPENSATED = 96 };

struct rough_data {
    struct closure head;
    const struct roughplastic *self;
    vec3 wo;
    float quarter_area; // 1 / (4 sigma(wo))
    float p_specular;
    spectrum specular, diffuse; // the latter: f / T(wi), times pi
    bool compensated;
    struct facet_loss_at loss;
    spectrum regained; // f / lost(wi), times pi
    spectrum albedo;
};

static const struct param params[] = {
    {"diffuse_reflectance", PARAM_TEXTURE, offsetof(struct roughplastic, diffuse), .def = "0.5",
     .max = 1, .unit = "", .help = "reflectance of the base"},
    {"nonlinear", PARAM_BOOL, offsetof(struct roughplastic, nonlinear), .def = "false",
     .unit = "", .help = "colours shift by scattering inside"},
    DIELECTRIC_INDEX_PARAMS(struct roughplastic, index, "polypropylene"),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct roughplastic, specular), .def = "1",
     .max = 1, .unit = "", .help = "factor on the coat's reflection"},
    {"distribution", PARAM_CHOICE, offsetof(struct roughplastic, distribution),
     .def = "beckmann", .unit = "", .help = "distribution of facet normals",
     .choices = roughness_distributions},
    {"alpha", PARAM_FLOAT, offsetof(struct roughplastic, alpha), .def = "0.1", .max = 1000,
     .unit = "", .help = "roughness; below 1e-4 the coat is smooth, but the base darker than plastic's, "
                         "as Mitsuba's: by 2 % at an index of 1.5"},
    {"sample_visible", PARAM_IGNORED, 0, .unit = "", .help = "visible normals are always sampled"},
    ENERGY_PARAM(struct roughplastic, energy),
    PARAM_END,
};

// What the coat reflects inside, from direction cosine c.
static double reflected_inside(const struct roughplastic *self, float c) {
    double r, t;
    float cos_t;
    if (self->smooth)
        return fresnel_dielectric(c, 1 / self->coat.eta, &cos_t);
    microfacet_albedo(&self->facets, 1 / self->coat.eta, c, NODES_INSIDE, &r, &t);
    return r;
}

// What the coat lets out of diffuse light inside: what it does not reflect. The sum may leave nothing
// by its error where nearly all is reflected; a smooth coat's share is there at least.
static void integrate_inside(struct roughplastic *self) {
    double sum = 0;
    for (int i = 0; i < DIRECTIONS; i++) {
        const double c = fmax((double)i / (DIRECTIONS - 1), 1e-6);
        sum += c * reflected_inside(self, (float)c);
    }
    const double least = fresnel_dielectric_transmitted(1 / (double)self->coat.eta);
    self->coat.leaving = (float)fmax(1 - 2 * sum / DIRECTIONS, 0.5 * least);
}

// Mean over diffuse light of what the coat transmits from outside.
static void integrate_outside(struct roughplastic *self) {
    double c[OUTSIDE], w[OUTSIDE], out = 0;
    gauss_legendre(OUTSIDE, c, w);
    for (int i = 0; i < OUTSIDE; i++)
        out += 2 * w[i] * c[i] * boundary_lookup(self->outside.transmitted, (float)c[i]);
    self->mean_transmitted = (float)out;
}

// ---- compensated energy ---------------------------------------------------------------------

struct coat_side {
    const struct roughplastic *self;
    float eta;
};

static double coat_albedo(const void *context, float alpha_u, float alpha_v, vec3 v, int nodes) {
    const struct coat_side *side = context;
    const struct microfacet m = microfacet_make(side->self->facets.type, alpha_u, alpha_v);
    double reflected, transmitted;
    microfacet_albedo_from(&m, side->eta, v, nodes, &reflected, &transmitted);
    return reflected + transmitted + facet_albedo_error(nodes, side->eta < 1);
}

// Adds to T its share of what is lost, and finds what remains inside from what leaves: transmission
// of diffuse light is the same from both sides but for the factor eta^2.
static void compensate(struct roughplastic *self, struct arena *arena) {
    const float eta = self->coat.eta;
    const struct coat_side outside = {self, eta}, inside = {self, 1 / eta};
    struct facet_loss within;
    float share, back;
    facet_loss_make(&self->loss, self->alpha, self->alpha, coat_albedo, &outside, arena);
    facet_loss_make(&within, self->alpha, self->alpha, coat_albedo, &inside, arena);
    facet_loss_share(eta, self->loss.mean[0], within.mean[0], &share, &back);
    self->regained = 1 - share;
    const struct facet_loss_at loss = facet_loss_at(&self->loss, self->alpha);
    for (int i = 0; i <= BOUNDARY_TABLE; i++)
        self->outside.transmitted[i] +=
            share * facet_lost(&loss, v3(0, 0, sqr((float)i / BOUNDARY_TABLE)));
    integrate_outside(self);
    self->coat.leaving = self->mean_transmitted / (eta * eta);
}

static bool prepare(struct object *object, struct arena *arena) {
    struct roughplastic *self = object->data;
    const bool compensated = self->energy == ENERGY_COMPENSATED;
    self->smooth = self->alpha < MICROFACET_ALPHA_MIN;
    self->facets = microfacet_make((enum microfacet_type)self->distribution, self->alpha,
                                   self->alpha);
    const float eta = self->index.int_ior / self->index.ext_ior;
    self->coat = (struct plastic_coat){.eta = eta, .nonlinear = self->nonlinear,
                                       .entering = (float)fresnel_dielectric_transmitted(eta)};
    if (!self->smooth)
        boundary_tabulate(&self->facets, eta, compensated ? NODES_COMPENSATED : NODES_OUTSIDE,
                          &self->outside);
    integrate_inside(self);
    if (!self->smooth)
        integrate_outside(self);
    if (!self->smooth && compensated)
        compensate(self, arena);
    return true;
}

static uint32_t lobes(const void *data) {
    const struct roughplastic *self = data;
    return (self->smooth ? LOBE_SPECULAR : LOBE_GLOSSY) | LOBE_DIFFUSE | LOBE_REFLECTION;
}

static bool widen(const void *data, struct wide_material *m) {
    const struct roughplastic *self = data;
    m->kind = &roughplastic_wide[self->distribution];
    m->data = self;
    m->textured = self->diffuse.texture || self->specular.texture;
    return !self->smooth && self->energy != ENERGY_COMPENSATED;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct roughplastic *self = data;
    const float cos_o = cos_theta(wo);
    if (!(cos_o > 0))
        return NULL;
    const spectrum diffuse = texture_eval(&self->diffuse, &point->at);
    const spectrum specular = texture_eval(&self->specular, &point->at);
    if (self->smooth)
        return plastic_closure(&self->coat, diffuse, specular, wo, stack);
    struct rough_data *c = closure_alloc(stack, &bsdf_roughplastic, sizeof *c,
                                         LOBE_GLOSSY | LOBE_DIFFUSE | LOBE_REFLECTION);
    c->self = self;
    c->wo = wo;
    c->quarter_area = 0.25f / microfacet_area(&self->facets, wo);
    c->specular = specular;
    c->diffuse = plastic_base(diffuse, &self->coat) *
                 boundary_lookup(self->outside.transmitted, cos_o);
    const spectrum s = specular * boundary_lookup(self->outside.reflected, cos_o);
    spectrum d = c->diffuse * self->mean_transmitted;
    c->compensated = self->energy == ENERGY_COMPENSATED;
    if (c->compensated) {
        c->loss = facet_loss_at(&self->loss, self->alpha);
        c->regained = specular * (self->regained * facet_lost(&c->loss, wo));
        d += c->regained;
        c->regained = c->loss.mean > 0 ? c->regained / c->loss.mean : spectrum_grey(0);
    }
    const float sum = spectrum_mean(s) + spectrum_mean(d);
    c->p_specular = sum > 0 ? spectrum_mean(s) / sum : 1;
    c->albedo = s + d;
    return &c->head;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct rough_data *c = (const void *)closure;
    const float cos_i = cos_theta(wi);
    if (!(cos_i > 0)) {
        *pdf_sa = 0;
        return spectrum_grey(0);
    }
    const struct roughplastic *self = c->self;
    const vec3 h = normalize(c->wo + wi);
    const float pdf_specular = microfacet_D(&self->facets, h) * c->quarter_area;
    float cos_t;
    const float F = fresnel_dielectric(dot(c->wo, h), self->coat.eta, &cos_t);
    const float diffuse = cos_i * INV_PI;
    *pdf_sa = lerpf(c->p_specular, diffuse, pdf_specular);
    const spectrum f = c->specular * (F * pdf_specular * microfacet_G1(&self->facets, wi)) +
                       c->diffuse * (boundary_lookup(self->outside.transmitted, cos_i) * diffuse);
    return c->compensated ? f + c->regained * (facet_lost(&c->loss, wi) * diffuse) : f;
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct rough_data *c = (const void *)closure;
    const bool specular = u1 < c->p_specular;
    if (specular)
        s->wi = normalize(reflect(c->wo, microfacet_sample(&c->self->facets, c->wo, u2)));
    else
        s->wi = warp_cosine_hemisphere(u2);
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f / s->pdf_sa;
    s->eta = 1;
    s->lobe = (specular ? LOBE_GLOSSY : LOBE_DIFFUSE) | LOBE_REFLECTION;
    return true;
}

static spectrum albedo(const struct closure *closure) {
    return ((const struct rough_data *)(const void *)closure)->albedo;
}

const struct bsdf_type bsdf_roughplastic = {
    .entry = {.name = "roughplastic", .help = "diffuse base under a rough coat",
              .params = params, .size = sizeof(struct roughplastic)},
    .claims = CLAIM_RECIPROCAL,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo, .widen = widen,
};
