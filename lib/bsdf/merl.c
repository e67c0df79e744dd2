// SPDX-License-Identifier: Apache-2.0
// Measured isotropic reflectance from a MERL table (table/merl.h).
#include "bsdf/bsdf.h"
#include "bsdf/half_sampler.h"
#include "table/merl.h"

enum { INTERPOLATE_LINEAR, INTERPOLATE_NEAREST };

struct merl {
    const char *filename;
    int interpolation;
    // made by prepare
    const struct merl_shared *shared;
};

// What objects that name the same file and interpolate alike share.
struct merl_shared {
    const struct merl_table *table;
    bool nearest;
    struct half_sampler sampler;
};

struct merl_data {
    struct closure head;
    const struct merl_shared *shared;
    struct slice_mix mix;
    vec3 wo;
};

static const char *const interpolations[] = {"linear", "nearest", NULL};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct merl, filename), .unit = "",
     .help = "MERL table (.binary); invalid cells are filled from their neighbours"},
    {"interpolation", PARAM_CHOICE, offsetof(struct merl, interpolation), .def = "linear",
     .unit = "", .help = "between cells; nearest is what the authors' program does",
     .choices = interpolations},
    PARAM_END,
};

static spectrum value(const void *table, vec3 wo, vec3 wi) {
    const struct merl_shared *s = table;
    return merl_eval(s->table, s->nearest, wi, wo) * wi[2];
}

static const struct merl_table *table_of(const char *path, struct arena *arena) {
    struct merl_table *t = arena_find(arena, "merl table", path);
    if (!t && (t = merl_read(path, arena)))
        arena_keep(arena, "merl table", path, t);
    return t;
}

static void build_sampler(struct merl_shared *s, struct arena *arena) {
    enum { ANGLES = 46 };
    static const float azimuth[1] = {0};
    float *angles = arena_alloc(arena, ANGLES * sizeof *angles);
    for (int i = 0; i < ANGLES; i++)
        angles[i] = (float)i * (0.5f * PI / (ANGLES - 1));
    const int counts[2] = {1, ANGLES};
    const float *const slices[2] = {azimuth, angles};
    half_sampler_init(&s->sampler, counts, slices, value, s, arena);
}

static bool prepare(struct object *self, struct arena *arena) {
    struct merl *m = self->data;
    const char *kind = m->interpolation == INTERPOLATE_NEAREST ? "merl nearest" : "merl linear";
    m->shared = arena_find(arena, kind, m->filename);
    if (m->shared)
        return true;
    const struct merl_table *t = table_of(m->filename, arena);
    if (!t)
        return false;
    struct merl_shared *s = arena_alloc(arena, sizeof *s);
    s->table = t;
    s->nearest = m->interpolation == INTERPOLATE_NEAREST;
    build_sampler(s, arena);
    arena_keep(arena, kind, m->filename, s);
    m->shared = s;
    return true;
}

static uint32_t lobes(const void *data) {
    (void)data;
    return LOBE_GLOSSY | LOBE_REFLECTION;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct merl *self = data;
    (void)point;
    if (!(cos_theta(wo) > 0))
        return NULL;
    struct merl_data *c = closure_alloc(stack, &bsdf_merl, sizeof *c, LOBE_GLOSSY | LOBE_REFLECTION);
    c->shared = self->shared;
    c->mix = half_sampler_at(&self->shared->sampler, wo);
    c->wo = wo;
    return &c->head;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct merl_data *c = (const void *)closure;
    *pdf_sa = 0;
    if (!(cos_theta(wi) > 0))
        return spectrum_grey(0);
    *pdf_sa = half_sampler_pdf_sa(&c->shared->sampler, &c->mix, c->wo, wi);
    return value(c->shared, c->wo, wi);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct merl_data *c = (const void *)closure;
    s->wi = half_sampler_sample(&c->shared->sampler, &c->mix, c->wo, u1, u2);
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f * (1 / s->pdf_sa);
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct merl_data *c = (const void *)closure;
    return half_sampler_albedo(&c->shared->sampler, &c->mix);
}

const struct bsdf_type bsdf_merl = {
    .entry = {.name = "merl", .help = "measured isotropic material (Matusik et al. 2003)",
              .params = params, .size = sizeof(struct merl)},
    .claims = CLAIM_RECIPROCAL,
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
