// SPDX-License-Identifier: Apache-2.0
// Materials of the RGL database, evaluated and sampled as their authors define it (Dupuy and Jakob
// 2018, An Adaptive Parameterization for Efficient Material Acquisition and Rendering; table/rgl.h).
// The eye stands at the measured incident direction, as in Mitsuba's plugin of the same name.
#include "bsdf/bsdf.h"
#include "math/density2d.h"
#include "table/rgl.h"

struct measured {
    const char *filename;
    // made by prepare
    const struct measured_maps *maps;
};

// What objects that name the same file share.
struct measured_maps {
    const struct rgl_table *table;
    struct density2d vndf, luminance;
};

struct measured_data {
    struct closure head;
    const struct measured_maps *maps;
    struct slice_mix mix, colours; // of vndf and luminance; of the red planes
    vec3 wo;            // in the octant that was measured
    float flip_x, flip_y; // 1 or -1: back from it
    float cos_phi, sin_phi; // of wo where the material is isotropic, else 1, 0
    float scale;        // 1 / (4 sigma)
};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct measured, filename), .unit = "",
     .help = "material of the RGL database (.bsdf); spectral files are converted to RGB"},
    PARAM_END,
};

static bool prepare(struct object *self, struct arena *arena) {
    struct measured *m = self->data;
    m->maps = arena_find(arena, "measured", m->filename);
    if (m->maps)
        return true;
    const struct rgl_table *t = rgl_read(m->filename, arena);
    if (!t)
        return false;
    struct measured_maps *maps = arena_alloc(arena, sizeof *maps);
    const int counts[2] = {t->phi_count, t->theta_count};
    const float *const values[2] = {t->phi, t->theta};
    maps->table = t;
    density2d_init(&maps->vndf, t->vndf, t->vndf_size[1], t->vndf_size[0], counts, values, arena);
    density2d_init(&maps->luminance, t->luminance, t->size[1], t->size[0], counts, values, arena);
    arena_keep(arena, "measured", m->filename, maps);
    m->maps = maps;
    return true;
}

static uint32_t lobes(const void *data) {
    const struct measured *self = data;
    return LOBE_GLOSSY | LOBE_REFLECTION | (self->maps->table->isotropic ? 0 : LOBE_ANISOTROPIC);
}

// Angle to +z, precise near it.
static float elevation(vec3 w) {
    return 2 * asinf(minf(0.5f * length(w - v3(0, 0, 1)), 1));
}

static float theta_to_u(float theta) {
    return sqrtf(theta * (2 / PI));
}

static float phi_to_u(float phi) {
    const float u = (phi + PI) * (1 / TWO_PI);
    return u - floorf(u);
}

// Symmetries of the measurement bring wo into -x, -y (Mitsuba's reduction).
static void reduce(struct measured_data *c, int reduction) {
    c->flip_x = c->flip_y = 1;
    if (reduction < 2)
        return;
    const float y = c->wo[1], x = reduction == 4 ? c->wo[0] : y;
    c->flip_x = -copysignf(1, x);
    c->flip_y = -copysignf(1, y);
}

static vec3 flip(const struct measured_data *c, vec3 w) {
    return v3(w[0] * c->flip_x, w[1] * c->flip_y, w[2]);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct measured *self = data;
    const struct rgl_table *t = self->maps->table;
    (void)point;
    if (!(cos_theta(wo) > 0))
        return NULL;
    struct measured_data *c = closure_alloc(stack, &bsdf_measured, sizeof *c, lobes(data));
    c->maps = self->maps;
    c->wo = wo;
    reduce(c, t->reduction);
    c->wo = flip(c, wo);
    const float theta = elevation(c->wo), phi = atan2f(c->wo[1], c->wo[0]);
    c->mix = slice_mix_at(self->maps->vndf.counts, self->maps->vndf.params, phi, theta);
    c->colours = c->mix;
    for (int k = 0; k < c->mix.count; k++)
        c->colours.slice[k] *= 3;
    const float across = hypotf(wo[0], wo[1]);
    c->cos_phi = t->isotropic && across > 0 ? wo[0] / across : 1;
    c->sin_phi = t->isotropic && across > 0 ? wo[1] / across : 0;
    const struct vec2 u = {theta_to_u(theta), phi_to_u(phi)};
    const float sigma = grid_eval(t->sigma, t->sigma_size[1], t->sigma_size[0], u);
    c->scale = sigma > 0 ? 0.25f / sigma : 0;
    return &c->head;
}

// f |cos| where the half vector is at u_m and its inverse image at s.
static spectrum value(const struct measured_data *c, struct vec2 u_m, struct vec2 s) {
    const struct rgl_table *t = c->maps->table;
    const size_t plane = (size_t)t->size[0] * (size_t)t->size[1];
    float rgb[3];
    for (size_t k = 0; k < 3; k++)
        rgb[k] = grid_eval_mix(t->rgb + k * plane, t->size[1], t->size[0], plane, &c->colours, s);
    const float d = t->jacobian
                        ? grid_eval(t->ndf, t->ndf_size[1], t->ndf_size[0], u_m) * c->scale : 1;
    return spectrum_clamp(d * spectrum_rgb(rgb[0], rgb[1], rgb[2]), 0, 1e30f);
}

// Solid angle of wi per area of u_m: theta = u^2 pi/2, phi = 2 pi v, and 4 wo.m of reflection.
static float jacobian(const struct measured_data *c, vec3 m, float u) {
    const float sine = hypotf(m[0], m[1]);
    return maxf(2 * PI * PI * u * sine, 1e-6f) * 4 * maxf(dot(c->wo, m), 1e-6f);
}

// The half vector in the file's coordinates.
static struct vec2 half_to_u(const struct measured_data *c, vec3 m) {
    const float x = m[0] * c->cos_phi + m[1] * c->sin_phi;
    const float y = m[1] * c->cos_phi - m[0] * c->sin_phi;
    return (struct vec2){theta_to_u(elevation(m)), phi_to_u(atan2f(y, x))};
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct measured_data *c = (const void *)closure;
    *pdf_sa = 0;
    if (!(cos_theta(wi) > 0))
        return spectrum_grey(0);
    const vec3 m = normalize(c->wo + flip(c, wi));
    const struct vec2 u_m = half_to_u(c, m);
    float pdf_m, pdf_s;
    const struct vec2 s = density2d_invert(&c->maps->vndf, &c->mix, u_m, &pdf_m);
    const struct density2d *luminance = &c->maps->luminance;
    pdf_s = grid_eval_mix(luminance->data, luminance->width, luminance->height,
                          (size_t)luminance->width * (size_t)luminance->height, &c->mix, s);
    *pdf_sa = pdf_m * pdf_s / jacobian(c, m, u_m.x);
    return value(c, u_m, s);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *out) {
    const struct measured_data *c = (const void *)closure;
    (void)u1;
    float pdf_s, pdf_m, sine, cosine;
    const struct vec2 s = density2d_sample(&c->maps->luminance, &c->mix,
                                           (struct vec2){u2.y, u2.x}, &pdf_s);
    const struct vec2 u_m = density2d_sample(&c->maps->vndf, &c->mix, s, &pdf_m);
    const float theta = u_m.x * u_m.x * (PI / 2);
    sine = sinf((2 * u_m.y - 1) * PI);
    cosine = cosf((2 * u_m.y - 1) * PI);
    const float r = sinf(theta);
    const vec3 m = v3(r * (cosine * c->cos_phi - sine * c->sin_phi),
                      r * (sine * c->cos_phi + cosine * c->sin_phi), cosf(theta));
    out->wi = normalize(flip(c, reflect(c->wo, m)));
    out->pdf_sa = pdf_m * pdf_s / jacobian(c, m, u_m.x);
    if (!(cos_theta(out->wi) > 0) || !(out->pdf_sa > 0))
        return false;
    out->weight = spectrum_clamp(value(c, u_m, s) * (1 / out->pdf_sa), 0, 1e30f);
    out->eta = 1;
    out->lobe = LOBE_GLOSSY | LOBE_REFLECTION;
    return true;
}

// By its mean over a few sampled directions.
static spectrum albedo(const struct closure *closure) {
    enum { N = 4 };
    spectrum sum = spectrum_grey(0);
    for (int i = 0; i < N * N; i++) {
        struct bsdf_sample s;
        const struct vec2 u = {((float)(i % N) + 0.5f) / N, ((float)(i / N) + 0.5f) / N};
        if (sample(closure, 0, u, &s))
            sum += s.weight;
    }
    return sum * (1.0f / (N * N));
}

const struct bsdf_type bsdf_measured = {
    .entry = {.name = "measured",
              .help = "measured material of the RGL database (Dupuy and Jakob 2018)",
              .params = params, .size = sizeof(struct measured)},
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
