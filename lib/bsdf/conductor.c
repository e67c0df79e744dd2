// SPDX-License-Identifier: Apache-2.0
// Smooth metal: mirror reflection by the Fresnel equations of a complex index.
#include "bsdf/smooth.h"
#include "math/fresnel.h"
#include "math/ior.h"

struct conductor {
    struct conductor_index index;
    struct texture_ref reflectance;
};

struct conductor_data {
    struct closure head;
    vec3 wi;
    spectrum weight;
};

static const struct param params[] = {
    CONDUCTOR_INDEX_PARAMS(struct conductor, index),
    {"specular_reflectance", PARAM_TEXTURE, offsetof(struct conductor, reflectance), .def = "1",
     .max = 1, .unit = "", .help = "factor on the reflection"},
    PARAM_END,
};

bool conductor_index_prepare(struct conductor_index *index, const struct object *self) {
    if (index->material) {
        if (spectrum_max(index->eta) != 0 || spectrum_min(index->k) != 1 ||
            spectrum_max(index->k) != 1) {
            log_error_at(self->at, "%s: eta or k was found beside material, expected either",
                         self->type->name);
            return false;
        }
        if (!ior_conductor_find(index->material, &index->eta, &index->k)) {
            const char *nearest = ior_conductor_nearest(index->material);
            log_error_at(self->at, "%s: material \"%s\" is not known; %s%s%s", self->type->name,
                         index->material, nearest ? "did you mean \"" : "expected a metal such as ",
                         nearest ? nearest : "Au, Ag, Al, Cu, or none", nearest ? "\"?" : "");
            return false;
        }
        if (index->material[0] == 'n' && index->material[1] == 'o') // none: a perfect mirror
            return true;
    }
    index->eta = index->eta / index->ext_eta;
    index->k = index->k / index->ext_eta;
    return true;
}

const struct closure *conductor_closure(spectrum eta, spectrum k, spectrum reflectance, vec3 wo,
                                        struct closure_stack *stack) {
    struct conductor_data *c = closure_alloc(stack, &bsdf_conductor, sizeof *c,
                                             LOBE_SPECULAR | LOBE_REFLECTION);
    c->wi = v3(-wo[0], -wo[1], wo[2]);
    c->weight = reflectance * fresnel_conductor(cos_theta(wo), eta, k);
    return &c->head;
}

static bool prepare(struct object *self, struct arena *arena) {
    struct conductor *c = self->data;
    (void)arena;
    return conductor_index_prepare(&c->index, self);
}

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_SPECULAR | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct conductor *self = data;
    if (!(cos_theta(wo) > 0))
        return NULL;
    return conductor_closure(self->index.eta, self->index.k,
                             texture_eval(&self->reflectance, &point->at), wo, stack);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct conductor_data *c = (const void *)closure;
    (void)u1;
    (void)u2;
    *s = (struct bsdf_sample){c->wi, c->weight, 1, 1, LOBE_SPECULAR | LOBE_REFLECTION};
    return true;
}

static spectrum albedo(const struct closure *closure) {
    return ((const struct conductor_data *)(const void *)closure)->weight;
}

const struct bsdf_type bsdf_conductor = {
    .entry = {.name = "conductor", .help = "smooth metal", .params = params,
              .size = sizeof(struct conductor)},
    .claims = CLAIM_RECIPROCAL | CLAIM_ENERGY | CLAIM_LOSSLESS,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = closure_eval_delta, .sample = sample,
    .albedo = albedo,
};
