// SPDX-License-Identifier: Apache-2.0
// Window materials (table/window.h): all four of reflection and transmission, front and back. The
// eye stands at the incident direction where the table is given for its side; where only the other
// side's transmission is given, light does (Helmholtz reciprocity), as in Radiance.
//
// Sampling: for every patch of the eye's hemisphere, the patches of the light's hemisphere by their
// value times projected solid angle; a share is cosine-distributed.
#include "bsdf/bsdf.h"
#include "math/distribution.h"
#include "math/warp.h"
#include "table/window.h"

static const float COSINE_SHARE = 0.05f;

struct window {
    const char *filename;
    // made by prepare
    const struct window_shared *shared;
};

// One of the four ways from the eye to the light.
struct passage {
    const struct window_part *part; // NULL: black
    bool eye_in;                    // the eye stands at the incident direction
    const struct window_cells *eye, *light;
    float *cdf;     // [eye cell][light cells + 1]
    float *albedo;  // of each eye cell
};

// What objects that name the same file share.
struct window_shared {
    const struct window_table *t;
    struct passage passages[2][2]; // [eye below][light below]
};

struct window_data {
    struct closure head;
    const struct passage *passages; // of the eye's side
    vec3 wo;                        // mirrored to the upper hemisphere
    float below;                    // -1: the eye is below the surface
    int cell[2];                    // of the eye, for each side of the light
    float reflected;                // share of samples
};

static const struct param params[] = {
    {"filename", PARAM_FILE, offsetof(struct window, filename), .unit = "",
     .help = "window material (.xml): Klems matrices or tensor trees"},
    PARAM_END,
};

// eye and light mirrored to the upper hemisphere.
static float look(const struct passage *p, vec3 eye, vec3 light) {
    return p->eye_in ? window_look(p->part, eye, light) : window_look(p->part, light, eye);
}

// The patch of the eye is where it stands; the matrix turns incident azimuths itself.
static int eye_cell(const struct passage *p, vec3 eye) {
    return window_cell_of(p->eye, eye);
}

// Mean value between two patches.
static float cell_value(const struct passage *p, int eye, int light) {
    enum { N = 2 };
    const bool constant = p->part->rank == 2;
    float sum = 0;
    for (int i = 0; i < (constant ? 1 : N * N); i++) {
        const struct vec2 u = {constant ? 0.5f : ((float)(i % N) + 0.5f) / N,
                               constant ? 0.5f : ((float)(i / N) + 0.5f) / N};
        const struct vec2 v = {u.y, 1 - u.x};
        sum += look(p, window_cell_sample(p->eye, eye, u), window_cell_sample(p->light, light, v));
    }
    return constant ? sum : sum / (N * N);
}

static void build_passage(struct passage *p, struct arena *arena) {
    const int eyes = p->eye->count, lights = p->light->count;
    p->cdf = arena_alloc(arena, (size_t)eyes * ((size_t)lights + 1) * sizeof *p->cdf);
    p->albedo = arena_alloc(arena, (size_t)eyes * sizeof *p->albedo);
    double *weights = mem_array((size_t)lights, sizeof *weights);
    for (int e = 0; e < eyes; e++) {
        float *cdf = p->cdf + (size_t)e * ((size_t)lights + 1);
        double total = 0, sum = 0;
        for (int l = 0; l < lights; l++)
            total += weights[l] = (double)cell_value(p, e, l) * window_cell_psa(p->light, l);
        for (int l = 0; l < lights; l++) {
            sum += weights[l];
            cdf[l + 1] = (float)(total > 0 ? sum / total : (l + 1.0) / lights);
        }
        p->albedo[e] = (float)total;
    }
    mem_free(weights);
}

static void choose_part(struct window_shared *s, bool eye_below, bool light_below) {
    const struct window_part *parts = s->t->parts;
    struct passage *p = &s->passages[eye_below][light_below];
    const int own = (eye_below == light_below ? WINDOW_FRONT_REFLECTION : WINDOW_FRONT_TRANSMISSION) +
                    eye_below;
    const int other = light_below + WINDOW_FRONT_TRANSMISSION;
    if (parts[own].rank)
        *p = (struct passage){.part = &parts[own], .eye_in = true};
    else if (eye_below != light_below && parts[other].rank)
        *p = (struct passage){.part = &parts[other], .eye_in = false};
    if (!p->part)
        return;
    p->eye = p->eye_in ? &p->part->in : &p->part->out;
    p->light = p->eye_in ? &p->part->out : &p->part->in;
}

static bool prepare(struct object *self, struct arena *arena) {
    struct window *w = self->data;
    w->shared = arena_find(arena, "window", w->filename);
    if (w->shared)
        return true;
    struct window_shared *s = arena_alloc(arena, sizeof *s);
    s->t = window_read(w->filename, arena);
    if (!s->t)
        return false;
    for (int i = 0; i < 4; i++) {
        choose_part(s, i >> 1, i & 1);
        if (s->passages[i >> 1][i & 1].part)
            build_passage(&s->passages[i >> 1][i & 1], arena);
    }
    arena_keep(arena, "window", w->filename, s);
    w->shared = s;
    return true;
}

static uint32_t lobes(const void *data) {
    const struct window_shared *s = ((const struct window *)data)->shared;
    const bool through = s->passages[0][1].part || s->passages[1][0].part;
    uint32_t anisotropic = 0;
    for (int i = 0; i < WINDOW_PARTS; i++)
        if (s->t->parts[i].rank == 2 || s->t->parts[i].rank == 4)
            anisotropic = LOBE_ANISOTROPIC;
    return LOBE_GLOSSY | LOBE_REFLECTION | (through ? LOBE_TRANSMISSION : 0) | anisotropic;
}

static const struct closure *resolve(const void *data, const struct bsdf_point *point, vec3 wo,
                                     struct closure_stack *stack) {
    const struct window_shared *s = ((const struct window *)data)->shared;
    const bool below = wo[2] < 0;
    float albedo[2] = {0};
    (void)point;
    if (wo[2] == 0)
        return NULL;
    struct window_data *c = closure_alloc(stack, &bsdf_window, sizeof *c, lobes(data));
    c->passages = s->passages[below];
    c->below = below ? -1 : 1;
    c->wo = v3(wo[0], wo[1], fabsf(wo[2]));
    for (int side = 0; side < 2; side++)
        if (c->passages[side].part) {
            c->cell[side] = eye_cell(&c->passages[side], c->wo);
            albedo[side] = c->passages[side].albedo[c->cell[side]];
        }
    const float mirrored = albedo[below], sum = albedo[0] + albedo[1];
    c->reflected = sum > 0 ? clampf(mirrored / sum, 0.02f, 0.98f) : 0.5f;
    if (!c->passages[!below].part)
        c->reflected = 1;
    else if (!c->passages[below].part)
        c->reflected = 0;
    return c->passages[0].part || c->passages[1].part ? &c->head : NULL;
}

static float light_pdf_sa(const struct passage *p, int eye, vec3 w) {
    const int l = window_cell_of(p->light, w);
    const float *cdf = p->cdf + (size_t)eye * ((size_t)p->light->count + 1);
    const float density = (cdf[l + 1] - cdf[l]) / (float)window_cell_psa(p->light, l);
    return w[2] * ((1 - COSINE_SHARE) * density + COSINE_SHARE * INV_PI);
}

static spectrum eval(const struct closure *closure, vec3 wi, float *pdf_sa) {
    const struct window_data *c = (const void *)closure;
    const int side = wi[2] < 0;
    const struct passage *p = &c->passages[side];
    const vec3 w = v3(wi[0], wi[1], fabsf(wi[2]));
    const bool reflection = wi[2] * c->below > 0;
    *pdf_sa = 0;
    if (wi[2] == 0 || !p->part)
        return spectrum_grey(0);
    *pdf_sa = light_pdf_sa(p, c->cell[side], w) * (reflection ? c->reflected : 1 - c->reflected);
    return spectrum_grey(look(p, c->wo, w) * w[2]);
}

static vec3 sample_light(const struct passage *p, int eye, float u1, struct vec2 u2) {
    if (u1 < COSINE_SHARE)
        return warp_cosine_hemisphere(u2);
    const float *cdf = p->cdf + (size_t)eye * ((size_t)p->light->count + 1);
    struct vec2 u = u2;
    const int cell = (int)cdf_find(cdf, (uint32_t)p->light->count, u2.x, &u.x);
    return window_cell_sample(p->light, cell, u);
}

static bool sample(const struct closure *closure, float u1, struct vec2 u2,
                   struct bsdf_sample *s) {
    const struct window_data *c = (const void *)closure;
    const bool reflection = u1 < c->reflected;
    const float share = reflection ? c->reflected : 1 - c->reflected;
    const float u = minf((reflection ? u1 : u1 - c->reflected) / share, 1 - 0x1p-24f);
    const float sign = reflection ? c->below : -c->below;
    const int side = sign < 0;
    const vec3 w = sample_light(&c->passages[side], c->cell[side], u, u2);
    s->wi = v3(w[0], w[1], sign * w[2]);
    const spectrum f = eval(closure, s->wi, &s->pdf_sa);
    if (!(s->pdf_sa > 0))
        return false;
    s->weight = f * (1 / s->pdf_sa);
    s->eta = 1;
    s->lobe = LOBE_GLOSSY | (reflection ? LOBE_REFLECTION : LOBE_TRANSMISSION);
    return true;
}

static spectrum albedo(const struct closure *closure) {
    const struct window_data *c = (const void *)closure;
    float sum = 0;
    for (int side = 0; side < 2; side++)
        if (c->passages[side].part)
            sum += c->passages[side].albedo[c->cell[side]];
    return spectrum_grey(sum);
}

const struct bsdf_type bsdf_window = {
    .entry = {.name = "window",
              .help = "window material of LBNL WINDOW or Radiance (Klems 1994, Ward et al. 2012)",
              .params = params, .size = sizeof(struct window)},
    .prepare = prepare, .lobes = lobes, .resolve = resolve, .eval = eval, .sample = sample,
    .albedo = albedo,
};
