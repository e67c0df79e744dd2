// SPDX-License-Identifier: Apache-2.0
// diffuse.c for all lanes.
#include "bsdf/diffuse.h"

struct diffuse_lanes {
    struct wide3 reflectance;
};

static void resolve(const struct wide_points *points, const struct wide3 *wo,
                    struct wide_closures *closures) {
    struct diffuse_lanes *c = (void *)closures;
    (void)wo;
    c->reflectance = wide_textures(points, offsetof(struct diffuse, reflectance));
}

static struct wide3 eval(const struct wide_closures *closures, const struct wide3 *wi,
                         wide *pdf_sa) {
    const struct diffuse_lanes *c = (const void *)closures;
    *pdf_sa = wide_max(wi->z, wide_of(0)) * INV_PI;
    return wide3_scale(*pdf_sa, c->reflectance);
}

static wide_mask sample(const struct wide_closures *closures, wide u1, const wide u2[2],
                        struct wide_samples *s) {
    const struct diffuse_lanes *c = (const void *)closures;
    (void)u1;
    s->wi = wide_cosine_hemisphere(u2);
    s->pdf_sa = s->wi.z * INV_PI;
    s->weight = c->reflectance;
    s->lobe = (wide_uint)wide_int_of(LOBE_DIFFUSE | LOBE_REFLECTION);
    return s->pdf_sa > 0;
}

const struct wide_bsdf diffuse_wide = {
    .lobes = LOBE_DIFFUSE | LOBE_REFLECTION,
    .resolve = resolve, .eval = eval, .sample = sample,
};
