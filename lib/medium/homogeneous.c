// SPDX-License-Identifier: Apache-2.0
// The same medium everywhere.
#include "medium/medium.h"
#include "medium/named.h"

struct homogeneous {
    struct medium_common common;
    const char *material;
    struct volume_ref sigma_t, albedo, sigma_s, sigma_a;
};

#define FIELD(name) offsetof(struct homogeneous, name)
#define COEFFICIENT .min = 0, .max = 1e30, .unit = "1/m"

static const struct param params[] = {
    {"sigma_t", PARAM_VOLUME, FIELD(sigma_t), .optional = true, COEFFICIENT,
     .help = "extinction; 1 where nothing is given"},
    {"albedo", PARAM_VOLUME, FIELD(albedo), .optional = true, .min = 0, .max = 1, .unit = "",
     .help = "share of the extinction that is scattering; 0.75 where nothing is given"},
    {"sigma_s", PARAM_VOLUME, FIELD(sigma_s), .optional = true, COEFFICIENT,
     .help = "scattering; with sigma_a, instead of sigma_t and albedo"},
    {"sigma_a", PARAM_VOLUME, FIELD(sigma_a), .optional = true, COEFFICIENT, .help = "absorption"},
    {"material", PARAM_STRING, FIELD(material), .optional = true,
     .help = "a measured medium by name, in 1/mm: scale by 1000 where the scene is in metres"},
    MEDIUM_PARAMS(struct homogeneous, common),
    PARAM_END,
};

static bool is_constant(const struct volume_ref *r, const char *name, const struct object *self) {
    if (!volume_bounds(r))
        return true;
    log_error_at(self->at, "\"%s\" varies in space; expected a constant, or type \"heterogeneous\"",
                 name);
    return false;
}

static spectrum value_or(const struct volume_ref *r, float otherwise) {
    return r->given ? volume_maximum(r) : spectrum_grey(otherwise);
}

// sigma_t and sigma_s in the file's unit, by whichever pair is given.
static bool read_coefficients(const struct homogeneous *d, const struct object *self,
                              struct medium_point *c, float *mean_cosine) {
    const bool pair = d->sigma_s.given || d->sigma_a.given;
    const bool other = d->sigma_t.given || d->albedo.given;
    if (pair + other + (d->material != NULL) > 1) {
        log_error_at(self->at, "expected one of: sigma_t and albedo; sigma_s and sigma_a; material");
        return false;
    }
    if (d->material)
        return named_medium_find(d->material, self->at, c, mean_cosine);
    if (pair) {
        c->sigma_s = value_or(&d->sigma_s, 0);
        c->sigma_t = c->sigma_s + value_or(&d->sigma_a, 0);
        return true;
    }
    c->sigma_t = value_or(&d->sigma_t, 1);
    c->sigma_s = c->sigma_t * value_or(&d->albedo, 0.75f);
    return true;
}

static bool prepare(struct object *self, struct arena *arena, struct medium *m) {
    const struct homogeneous *d = self->data;
    struct medium_point *c = &m->constant;
    float mean_cosine = 0;
    if (!is_constant(&d->sigma_t, "sigma_t", self) || !is_constant(&d->albedo, "albedo", self) ||
        !is_constant(&d->sigma_s, "sigma_s", self) || !is_constant(&d->sigma_a, "sigma_a", self) ||
        !is_constant(&d->common.emission, "emission", self) ||
        !read_coefficients(d, self, c, &mean_cosine))
        return false;
    medium_init(m, &d->common, mean_cosine, arena);
    c->sigma_s = c->sigma_s * m->scale;
    c->sigma_t = c->sigma_t * m->scale;
    c->emission = (c->sigma_t - c->sigma_s) * volume_maximum(&d->common.emission);
    if (!spectrum_is_finite(c->sigma_t) || !spectrum_is_finite(c->emission)) {
        log_error_at(self->at, "its coefficients exceed the range of numbers");
        return false;
    }
    m->homogeneous = true;
    m->scatters = !spectrum_is_black(c->sigma_s);
    m->emits = !spectrum_is_black(c->emission);
    m->grey = spectrum_max(c->sigma_t) == spectrum_min(c->sigma_t);
    m->most_t = c->sigma_t;
    return true;
}

const struct medium_type medium_homogeneous = {
    .entry = {.name = "homogeneous", .help = "the same everywhere", .params = params,
              .size = sizeof(struct homogeneous)},
    .prepare = prepare,
};
