// SPDX-License-Identifier: Apache-2.0
// Materials measured by goniometers (table/goniometer.h), between the measured directions by their
// half vectors (Muehlbacher 2012, Real-time Rendering of Measured Materials, section 2.4, after
// Rusinkiewicz 1998): for the eye at wo and the light at wi with half vector h, each neighbour wo_k
// of wo among the incident directions is asked for the density p = f cos with which it sends light
// towards its own mirror image about h.
//
// The eye stands at the incident direction, which by reciprocity is the same. Transmission uses wi
// mirrored at the surface, and light that comes back (retro-reflectors) wi turned by pi: both then
// look like reflection. Directions that end below the horizon give 0; the lobe is scaled so that its
// integral is that of the measured neighbours, interpolated, and no more than all light leaves.
// A sheet that transmits looks the same from its other side.
#include <string.h>

#include "bsdf/bsdf.h"
#include "bsdf/half_sampler.h"
#include "table/goniometer.h"

struct goniometer {
    const char *filename;
    int lobe;
    // made by prepare
    const struct gonio_shared *shared;
};

// What objects that name the same file share.
struct gonio_shared {
    const struct goniometer_table *t;
    vec3 *incident;                 // [phi][theta]
    struct half_sampler sampler[2]; // of reflection and transmission
    float *scale[2];                // of each slice of the sampler
};

struct gonio_data {
    struct closure head;
    const struct gonio_shared *shared;
    vec3 wo;                    // as the table has it
    struct slice_mix mix, slices; // of incident directions; of the sampler
    float turn_c, turn_s;       // rotation into the table's azimuth
    float flip_x, flip_y, flip_z;
    float scale[2], reflected;  // reflected: share of samples
};

// A table and one side of it, as the sampler asks for it.
struct one_side {
    const struct gonio_shared *shared;
    int side;
};

static const char *const lobe_names[] = {"auto", "mirror", "retro", NULL};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct goniometer, filename), .unit = "",
     .help = "goniometer table: .brdf (Cornell), .dat (ALTA) or .transfer"},
    {"lobe", PARAM_CHOICE, offsetof(struct goniometer, lobe), .def = "auto", .unit = "",
     .help = "whether light is mirrored or comes back; auto: as the table says",
     .choices = lobe_names},
    PARAM_END,
};

// ---- the table between its incident directions ----------------------------------------------

static struct slice_mix incident_mix(const struct goniometer_table *t, vec3 wo) {
    const int counts[2] = {t->phi_count, t->theta_count};
    const float *const values[2] = {t->phi, t->theta};
    const float theta = atan2f(sqrtf(wo[0] * wo[0] + wo[1] * wo[1]), wo[2]);
    const float phi = t->phi_count > 1 ? atan2f(wo[1], wo[0]) : 0;
    return slice_mix_at(counts, values, phi < 0 ? phi + TWO_PI : phi, theta);
}

// f cos_i before scaling; wo and wi above the surface, as the table has them.
static spectrum reconstruct(const struct gonio_shared *s, int side, const struct slice_mix *mix,
                            vec3 wo, vec3 wi) {
    const vec3 h = normalize(wo + wi);
    spectrum sum = spectrum_grey(0);
    for (int k = 0; k < mix->count; k++) {
        const vec3 out = reflect(s->incident[mix->slice[k]], h);
        if (out[2] > 0)
            sum += mix->weight[k] * out[2] * goniometer_look(s->t, side, mix->slice[k], out);
    }
    return sum;
}

static spectrum value(const void *table, vec3 wo, vec3 wi) {
    const struct one_side *o = table;
    const struct slice_mix mix = incident_mix(o->shared->t, wo);
    return reconstruct(o->shared, o->side, &mix, wo, wi);
}

// ---- building -------------------------------------------------------------------------------

static vec3 direction(float theta, float phi) {
    return v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

// The values with 0, the midpoints and the last one besides.
static float *refine(const float *values, int count, float last, int *refined,
                     struct arena *arena) {
    float *out = arena_alloc(arena, (2 * (size_t)count + 2) * sizeof *out);
    int n = 0;
    if (values[0] > 0)
        out[n++] = 0;
    for (int i = 0; i < count; i++) {
        if (n > 0)
            out[n] = 0.5f * (out[n - 1] + values[i]), n++;
        out[n++] = values[i];
    }
    if (out[n - 1] < last - 1e-3f)
        out[n++] = last;
    *refined = n;
    return out;
}

// Integrals of the measured directions themselves.
static float *measured_albedos(const struct one_side *o, struct arena *arena) {
    const struct goniometer_table *t = o->shared->t;
    const size_t count = (size_t)t->theta_count * (size_t)t->phi_count;
    float *albedo = arena_alloc(arena, count * sizeof *albedo);
    for (size_t i = 0; i < count; i++)
        albedo[i] = spectrum_mean(half_sampler_integrate(value, o, o->shared->incident[i]));
    return albedo;
}

static void build_side(struct gonio_shared *s, int side, const int counts[2],
                       const float *const slices[2], struct arena *arena) {
    const struct one_side o = {s, side};
    half_sampler_init(&s->sampler[side], counts, slices, value, &o, arena);
    const float *measured = measured_albedos(&o, arena);
    const size_t count = (size_t)counts[0] * (size_t)counts[1];
    s->scale[side] = arena_alloc(arena, count * sizeof(float));
    for (size_t i = 0; i < count; i++) {
        const vec3 wo = direction(slices[1][i % (size_t)counts[1]], slices[0][i / (size_t)counts[1]]);
        const struct slice_mix mix = incident_mix(s->t, wo);
        const float found = spectrum_mean(s->sampler[side].albedo[i]);
        float expected = 0;
        for (int k = 0; k < mix.count; k++)
            expected += mix.weight[k] * measured[mix.slice[k]];
        s->scale[side][i] = found > 1e-6f ? clampf(expected / found, 0, 10) : 1;
    }
}

// Measurement noise may sum up to more light than arrives.
static void limit_energy(struct gonio_shared *s, size_t slices) {
    for (size_t i = 0; i < slices; i++) {
        float sum = 0;
        for (int side = 0; side < 2; side++)
            if (s->scale[side])
                sum += s->scale[side][i] * spectrum_max(s->sampler[side].albedo[i]);
        for (int side = 0; side < 2; side++)
            if (s->scale[side]) {
                s->scale[side][i] /= maxf(sum, 1);
                s->sampler[side].albedo[i] *= s->scale[side][i];
            }
    }
}

static struct gonio_shared *build(const struct goniometer_table *t, struct arena *arena) {
    struct gonio_shared *s = arena_alloc(arena, sizeof *s);
    int counts[2];
    s->t = t;
    s->incident = arena_alloc(arena, (size_t)t->theta_count * (size_t)t->phi_count * sizeof(vec3));
    for (int p = 0; p < t->phi_count; p++)
        for (int i = 0; i < t->theta_count; i++)
            s->incident[p * t->theta_count + i] = direction(t->theta[i], t->phi[p]);
    const float *const slices[2] = {t->phi, refine(t->theta, t->theta_count, 0.5f * PI, &counts[1],
                                                   arena)};
    counts[0] = t->phi_count;
    for (int side = 0; side < 2; side++)
        if (t->f[side])
            build_side(s, side, counts, slices, arena);
    limit_energy(s, (size_t)counts[0] * (size_t)counts[1]);
    return s;
}

static bool prepare(struct object *self, struct arena *arena) {
    struct goniometer *g = self->data;
    const char *kind = arena_printf(arena, "goniometer %s", lobe_names[g->lobe]);
    g->shared = arena_find(arena, kind, g->filename);
    if (g->shared)
        return true;
    const struct goniometer_table *t =
        goniometer_read(g->filename, (enum goniometer_lobe)g->lobe, arena);
    if (!t)
        return false;
    struct gonio_shared *s = build(t, arena);
    arena_keep(arena, kind, g->filename, s);
    g->shared = s;
    return true;
}

static uint32_t lobes(const void *data) {
    const struct goniometer_table *t = ((const struct goniometer *)data)->shared->t;
    return LOBE_GLOSSY | LOBE_REFLECTION | (t->f[1] ? LOBE_TRANSMISSION : 0) |
           (t->phi_count > 1 ? LOBE_ANISOTROPIC : 0);
}

// ---- at a hit -------------------------------------------------------------------------------

// Brings wo to the side, the azimuth and the quadrant that were measured.
static void place_eye(struct gonio_data *c, vec3 wo) {
    const struct goniometer_table *t = c->shared->t;
    const float across = sqrtf(wo[0] * wo[0] + wo[1] * wo[1]);
    const bool isotropic = t->phi_count == 1 && across > 0;
    c->flip_z = wo[2] < 0 ? -1 : 1;
    c->turn_c = isotropic ? wo[0] / across : 1;
    c->turn_s = isotropic ? wo[1] / across : 0;
    c->flip_x = !isotropic && t->symmetry == 4 && wo[0] < 0 ? -1 : 1;
    c->flip_y = !isotropic && t->symmetry >= 2 && wo[1] < 0 ? -1 : 1;
    c->wo = isotropic ? v3(across, 0, fabsf(wo[2]))
                      : v3(wo[0] * c->flip_x, wo[1] * c->flip_y, fabsf(wo[2]));
}

// A direction of the light in the table's coordinates, and which side it is on.
static vec3 to_table(const struct gonio_data *c, vec3 wi, int *side) {
    const float x = wi[0] * c->turn_c + wi[1] * c->turn_s;
    const float y = wi[1] * c->turn_c - wi[0] * c->turn_s, z = wi[2] * c->flip_z;
    *side = z < 0;
    const float back = c->shared->t->retro && *side == 0 ? -1 : 1;
    return v3(back * x * c->flip_x, back * y * c->flip_y, fabsf(z));
}

static vec3 from_table(const struct gonio_data *c, vec3 w, int side) {
    const float back = c->shared->t->retro && side == 0 ? -1 : 1;
    const float x = back * w[0] * c->flip_x, y = back * w[1] * c->flip_y;
    return v3(x * c->turn_c - y * c->turn_s, y * c->turn_c + x * c->turn_s,
              (side ? -1.0f : 1.0f) * w[2] * c->flip_z);
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct gonio_shared *s = ((const struct goniometer *)data)->shared;
    (void)point;
    if (cos_theta(wo) == 0 || (cos_theta(wo) < 0 && !s->t->f[1]))
        return NULL;
    struct gonio_data *c = closure_alloc(stack, &bsdf_goniometer, sizeof *c, lobes(data));
    c->shared = s;
    place_eye(c, wo);
    c->mix = incident_mix(s->t, c->wo);
    c->slices = half_sampler_at(&s->sampler[0], c->wo);
    float albedo[2] = {0};
    for (int side = 0; side < 2; side++) {
        c->scale[side] = 0;
        for (int k = 0; k < c->slices.count && s->scale[side]; k++)
            c->scale[side] += c->slices.weight[k] * s->scale[side][c->slices.slice[k]];
        if (s->scale[side])
            albedo[side] = spectrum_mean(half_sampler_albedo(&s->sampler[side], &c->slices));
    }
    const float sum = albedo[0] + albedo[1];
    c->reflected = !s->t->f[1] ? 1 : sum > 0 ? clampf(albedo[0] / sum, 0.05f, 0.95f) : 0.5f;
    return &c->head;
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct gonio_data *c = (const void *)closure;
    int side;
    const vec3 w = to_table(c, wi, &side);
    *pdf_sa = 0;
    if (!(w[2] > 0) || !c->shared->t->f[side])
        return spectrum_grey(0);
    *pdf_sa = half_sampler_pdf_sa(&c->shared->sampler[side], &c->slices, c->wo, w) *
              (side ? 1 - c->reflected : c->reflected);
    return reconstruct(c->shared, side, &c->mix, c->wo, w) * c->scale[side];
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct gonio_data *c = (const void *)closure;
    const int side = u1 >= c->reflected;
    const float share = side ? 1 - c->reflected : c->reflected;
    const float u = minf((side ? u1 - c->reflected : u1) / share, 1 - 0x1p-24f);
    const vec3 w = half_sampler_sample(&c->shared->sampler[side], &c->slices, c->wo, u, u2);
    if (!(w[2] > 0))
        return false;
    s->wi = from_table(c, w, side);
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f * (1 / s->pdf_sa);
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | (side ? LOBE_TRANSMISSION : LOBE_REFLECTION);
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct gonio_data *c = (const void *)closure;
    spectrum sum = spectrum_grey(0);
    for (int side = 0; side < 2; side++)
        if (c->shared->t->f[side])
            sum += half_sampler_albedo(&c->shared->sampler[side], &c->slices);
    return sum;
}

const struct bsdf_type bsdf_goniometer = {
    .entry = {.name = "goniometer",
              .help = "material measured for some incident directions (Muehlbacher 2012)",
              .params = params, .size = sizeof(struct goniometer)},
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
