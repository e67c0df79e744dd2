// SPDX-License-Identifier: Apache-2.0
#include "bsdf/roughness.h"

const char *const roughness_distributions[] = {"beckmann", "ggx", NULL};

#define ALPHA_DEFAULT 0.1f // in the parameter table, too

static bool is_given(const struct texture_ref *r) {
    return r->texture || r->value[0] >= 0;
}

bool roughness_prepare(const struct roughness *r, const struct object *self) {
    if (is_given(&r->alpha_u) != is_given(&r->alpha_v)) {
        log_error_at(self->at, "%s: one of alpha_u and alpha_v was found, both are needed",
                     self->type->name);
        return false;
    }
    if (!is_given(&r->alpha_u) || (!r->alpha.texture && r->alpha.value[0] == ALPHA_DEFAULT))
        return true;
    log_error_at(self->at, "%s: alpha was found beside alpha_u and alpha_v, expected either",
                 self->type->name);
    return false;
}

uint32_t roughness_lobes(const struct roughness *r) {
    const bool pair = is_given(&r->alpha_u);
    const struct texture_ref *u = pair ? &r->alpha_u : &r->alpha, *v = pair ? &r->alpha_v : u;
    const uint32_t turned = pair ? LOBE_ANISOTROPIC : 0;
    if (u->texture || v->texture)
        return LOBE_GLOSSY | LOBE_SPECULAR | turned;
    return maxf(u->value[0], v->value[0]) >= MICROFACET_ALPHA_MIN ? LOBE_GLOSSY | turned
                                                                  : LOBE_SPECULAR;
}

bool roughness_constant(const struct roughness *r, struct microfacet *m) {
    const struct texture_point nowhere = {0};
    return !r->alpha.texture && !r->alpha_u.texture && !r->alpha_v.texture &&
           roughness_at(r, &nowhere, m);
}

bool roughness_loss(const struct roughness *r, const struct object *self, facet_albedo_fn albedo,
                    const void *context, struct facet_loss *loss, struct arena *arena) {
    const bool pair = is_given(&r->alpha_u);
    const struct texture_ref *u = pair ? &r->alpha_u : &r->alpha, *v = pair ? &r->alpha_v : u;
    if (!u->texture && !v->texture) {
        facet_loss_make(loss, u->value[0], v->value[0], albedo, context, arena);
        return true;
    }
    if (pair) {
        log_error_at(self->at, "%s: textures of alpha_u and alpha_v were found with compensated "
                     "energy, expected one of alpha", self->type->name);
        return false;
    }
    facet_loss_make_all(loss, albedo, context, arena);
    return true;
}
