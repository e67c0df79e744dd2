// SPDX-License-Identifier: Apache-2.0
// A medium whose density and albedo vary in space. It ends where the volume of its density does.
#include "medium/medium.h"

struct heterogeneous {
    struct medium_common common;
    struct volume_ref sigma_t, albedo;
};

#define FIELD(name) offsetof(struct heterogeneous, name)

static const struct param params[] = {
    {"sigma_t", PARAM_VOLUME, FIELD(sigma_t), .def = "1", .min = 0, .max = 1e30, .unit = "1/m",
     .help = "extinction", .aka = "density"},
    {"albedo", PARAM_VOLUME, FIELD(albedo), .def = "0.75", .min = 0, .max = 1, .unit = "",
     .help = "share of the extinction that is scattering"},
    MEDIUM_PARAMS(struct heterogeneous, common),
    // how other renderers track
    {"method", PARAM_IGNORED}, {"step_size", PARAM_IGNORED},
    {"has_spectral_extinction", PARAM_IGNORED}, {"majorant_resolution_factor", PARAM_IGNORED},
    PARAM_END,
};

static void at(const void *data, vec3 p, struct medium_point *point) {
    const struct heterogeneous *d = data;
    point->sigma_t = d->common.scale * volume_eval(&d->sigma_t, p);
    const spectrum albedo = spectrum_clamp(volume_eval(&d->albedo, p), 0, 1);
    point->sigma_s = albedo * point->sigma_t;
    point->emission = (point->sigma_t - point->sigma_s) * volume_eval(&d->common.emission, p);
}

static const struct volume_ref *density(const void *data) {
    return &((const struct heterogeneous *)data)->sigma_t;
}

static bool prepare(struct object *self, struct arena *arena, struct medium *m) {
    const struct heterogeneous *d = self->data;
    medium_init(m, &d->common, 0, arena);
    m->most_t = m->scale * volume_maximum(&d->sigma_t);
    if (!spectrum_is_finite(m->most_t * volume_maximum(&d->common.emission))) {
        log_error_at(self->at, "its coefficients exceed the range of numbers");
        return false;
    }
    m->bounds = volume_bounds(&d->sigma_t);
    m->scatters = !spectrum_is_black(m->most_t * volume_maximum(&d->albedo));
    m->grey = m->bounds ? m->bounds->lanes == 1
                        : spectrum_max(m->most_t) == spectrum_min(m->most_t);
    return true;
}

const struct medium_type medium_heterogeneous = {
    .entry = {.name = "heterogeneous", .help = "density and albedo vary in space",
              .params = params, .size = sizeof(struct heterogeneous)},
    .prepare = prepare, .at = at, .density = density,
};
