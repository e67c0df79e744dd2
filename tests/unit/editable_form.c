// SPDX-License-Identifier: Apache-2.0
// The editable form against closed forms: every model, random parameters and directions, in double
// and in single precision; then what tabulating the curves at J bins adds, as a table over J.
//
// The closed forms are written here as printed in their sources, with powers and arc cosines.
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "curve/model.h"
#include "math/hash.h"

struct view {
    double o[3], i[3]; // wo, wi
    double cos_o, cos_i, cos_d;
    double cos_h, sin2_h; // of theta_h
    double x2, y2;        // squared cosine and sine of h's azimuth
};

static double uniform(struct rng *r) {
    const double high = (double)rng_u32(r);
    return (high + (double)rng_float(r)) * 0x1p-32;
}

static double between(struct rng *r, double lo, double hi) {
    return lo + (hi - lo) * uniform(r);
}

// Of equal probability on a logarithmic scale.
static double decades(struct rng *r, double lo, double hi) {
    return lo * pow(hi / lo, uniform(r));
}

// Of any azimuth.
static void direction(struct rng *r, double z, double w[3]) {
    const double s = sqrt((1 - z) * (1 + z)), phi = between(r, 0, 2 * M_PI);
    w[0] = s * cos(phi);
    w[1] = s * sin(phi);
    w[2] = z;
}

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double unit(double w[3]) {
    const double l = sqrt(dot3(w, w));
    for (int k = 0; k < 3; k++)
        w[k] /= l;
    return l;
}

static void finish_view(struct view *v) {
    double h[3];
    unit(v->o);
    unit(v->i);
    for (int k = 0; k < 3; k++)
        h[k] = v->o[k] + v->i[k];
    const double length = unit(h), r2 = h[0] * h[0] + h[1] * h[1];
    v->cos_o = v->o[2];
    v->cos_i = v->i[2];
    v->cos_h = h[2];
    v->sin2_h = r2;
    v->cos_d = 0.5 * length; // dot(h, wi) asks for exactly unit vectors where they are opposite
    v->x2 = r2 > 0 ? h[0] * h[0] / r2 : 1;
    v->y2 = r2 > 0 ? h[1] * h[1] / r2 : 0;
}

// Half of them near the mirror direction, at all distances, where highlights are.
static struct view random_view(struct rng *r) {
    struct view v;
    direction(r, between(r, 2e-3, 1), v.o);
    do {
        direction(r, between(r, 2e-3, 1), v.i);
        if (uniform(r) < 0.5) {
            double h[3];
            direction(r, cos(decades(r, 1e-4, 1.2)), h);
            const double c = 2 * dot3(h, v.o);
            for (int k = 0; k < 3; k++)
                v.i[k] = c * h[k] - v.o[k];
        }
    } while (v.i[2] < 2e-3);
    finish_view(&v);
    return v;
}

// ---- closed forms, one channel --------------------------------------------------------------

static double fresnel(double c, double eta, double k) {
    // Born and Wolf, with the complex square root u + i v of (eta + i k)^2 - sin^2
    const double s2 = 1 - c * c, m = eta * eta - k * k - s2;
    const double norm = sqrt(m * m + 4 * eta * eta * k * k);
    const double u = sqrt(0.5 * (norm + m)), v2 = 0.5 * (norm - m);
    const double s = ((u - c) * (u - c) + v2) / ((u + c) * (u + c) + v2), t = s2 / c;
    return 0.5 * s * (1 + ((u - t) * (u - t) + v2) / ((u + t) * (u + t) + v2));
}

static double v_cavity(const struct view *v) {
    return fmin(1, fmin(2 * v->cos_h * v->cos_o / v->cos_d, 2 * v->cos_h * v->cos_i / v->cos_d));
}

static double tan2_h(const struct view *v) {
    return v->sin2_h / (v->cos_h * v->cos_h);
}

static double schlick_f(double c, double r0) {
    return r0 + (1 - r0) * pow(1 - c, 5);
}

static double phong(const struct view *v, const struct model_parameters *p, int k) {
    const double c = v->cos_o * v->cos_i - v->o[0] * v->i[0] - v->o[1] * v->i[1];
    const double n = p->exponent_u;
    (void)k;
    return (p->literal ? sqrt(n) : (n + 2) / (2 * M_PI)) * (c > 0 ? pow(c, n) : 0);
}

static double blinnphong(const struct view *v, const struct model_parameters *p, int k) {
    return (p->exponent_u + 2) / (2 * M_PI) * pow(v->cos_h, p->exponent_u) * v_cavity(v) *
           fresnel(v->cos_d, p->eta[k], p->k[k]) / (4 * v->cos_o * v->cos_i);
}

static double cooktorrance(const struct view *v, const struct model_parameters *p, int k) {
    const double m2 = p->alpha_u * p->alpha_u;
    const double D = exp(-tan2_h(v) / m2) / (m2 * pow(v->cos_h, 4));
    return (p->literal ? 1 : 0.25) * fresnel(v->cos_d, p->eta[k], p->k[k]) / M_PI * D *
           v_cavity(v) / (v->cos_i * v->cos_o);
}

static double ashikhmin(const struct view *v, const struct model_parameters *p, int k) {
    return sqrt((p->exponent_u + 1) * (p->exponent_v + 1)) / (8 * M_PI) *
           pow(v->cos_h, p->exponent_u * v->x2 + p->exponent_v * v->y2) /
           (v->cos_d * fmax(v->cos_i, v->cos_o)) * schlick_f(v->cos_d, p->r0[k]);
}

static double ward(const struct view *v, const struct model_parameters *p, int k) {
    const double e = tan2_h(v) * (v->x2 / (p->alpha_u * p->alpha_u) +
                                  v->y2 / (p->alpha_v * p->alpha_v));
    const double lobe = exp(-e) / (4 * M_PI * p->alpha_u * p->alpha_v);
    (void)k;
    switch (p->variant) {
    case 0: return lobe / sqrt(v->cos_i * v->cos_o);
    case 1: return lobe / (v->cos_i * v->cos_o);
    default: return lobe / (v->cos_d * v->cos_d * pow(v->cos_h, 4));
    }
}

static double schlick(const struct view *v, const struct model_parameters *p, int k) {
    const double r = p->alpha_u * p->alpha_u, t2 = v->cos_h * v->cos_h, a = p->isotropy;
    const double Z = r / pow(r * t2 + v->sin2_h, 2); // 1 - t^2 as a square of the sine
    const double A = sqrt(a / (a * a - a * a * v->x2 + v->x2));
    const double G = v->cos_i / (r - r * v->cos_i + v->cos_i) * v->cos_o /
                     (r - r * v->cos_o + v->cos_o);
    return schlick_f(v->cos_d, p->r0[k]) *
           (G * Z * A / (4 * M_PI * v->cos_i * v->cos_o) + (1 - G) / M_PI);
}

static double orennayar(const struct view *v, const struct model_parameters *p, int k) {
    const double s2 = p->alpha_u * p->alpha_u / 2;
    const double ti = acos(v->cos_i), to = acos(v->cos_o);
    const double c = cos(atan2(v->i[1], v->i[0]) - atan2(v->o[1], v->o[0]));
    (void)k;
    return (1 - 0.5 * s2 / (s2 + 0.33) +
            0.45 * s2 / (s2 + 0.09) * fmax(0, c) * sin(fmax(ti, to)) * tan(fmin(ti, to))) / M_PI;
}

// (h.k)+ of p = cos^n integrated over the azimuth, times sin(theta_h).
static double ring(double theta_h, double cos_k, double n) {
    const double c = cos(theta_h), s = sin(theta_h);
    const double a = c * cos_k, b = s * sqrt((1 - cos_k) * (1 + cos_k));
    const double phi = b > a ? acos(-a / b) : M_PI;
    return pow(c, n) * s * 2 * (a * phi + b * sin(phi));
}

// Integral over theta_h by the tanh-sinh rule, which minds neither peaks nor roots at the ends.
static double ring_integral(double lo, double hi, double cos_k, double n) {
    const double step = 1.0 / 64;
    double sum = 0;
    for (int j = -240; j <= 240; j++) {
        const double u = M_PI / 2 * sinh(j * step), x = 1 / (1 + exp(-2 * u));
        const double w = M_PI / 2 * cosh(j * step) * 2 * x / (1 + exp(2 * u));
        sum += w * ring(lo + (hi - lo) * x, cos_k, n);
    }
    return sum * (hi - lo) * step;
}

static double projected(double cos_k, double n) {
    const double bend = asin(cos_k);
    return ring_integral(0, bend, cos_k, n) + ring_integral(bend, M_PI / 2, cos_k, n);
}

static double microfacet(const struct view *v, const struct model_parameters *p, int k) {
    return pow(v->cos_h, p->exponent_u) * fresnel(v->cos_d, p->eta[k], p->k[k]) *
           projected(1, p->exponent_u) /
           (4 * projected(v->cos_i, p->exponent_u) * projected(v->cos_o, p->exponent_u));
}

// Curves from tables: 33 nodes, lines between them.
enum { NODES = 33 };

static double nodes[3][CURVE_CHANNELS][NODES]; // f_o, f_A, f_B

static double line(int slot, int k, double gamma) {
    const double x = gamma / (M_PI / 2) * (NODES - 1);
    const int i = x < NODES - 1 ? (int)x : NODES - 2;
    return nodes[slot][k][i] + (x - i) * (nodes[slot][k][i + 1] - nodes[slot][k][i]);
}

static double theta(const double w[3]) {
    return atan2(hypot(w[0], w[1]), w[2]);
}

static double homomorphic(const struct view *v, const struct model_parameters *p, int k) {
    (void)p;
    return line(SLOT_B, k, theta(v->i)) * line(SLOT_B, k, theta(v->o)) *
           line(SLOT_A, k, atan2(sqrt(v->sin2_h), v->cos_h));
}

// Half the angle between both directions; from its cosine alone it would lack digits near 0.
static double theta_d(const struct view *v) {
    double sum = 0, difference = 0;
    for (int k = 0; k < 3; k++) {
        sum += (v->o[k] + v->i[k]) * (v->o[k] + v->i[k]);
        difference += (v->o[k] - v->i[k]) * (v->o[k] - v->i[k]);
    }
    return atan2(sqrt(difference), sqrt(sum));
}

static double halfdifference(const struct view *v, const struct model_parameters *p, int k) {
    (void)p;
    return line(SLOT_A, k, atan2(sqrt(v->sin2_h), v->cos_h)) * line(SLOT_B, k, theta_d(v));
}

static double freehand(const struct view *v, const struct model_parameters *p, int k) {
    const double u = v->i[0] + v->o[0], w = v->i[2] + v->o[2];
    (void)p;
    return line(SLOT_A, k, atan2(fabs(u), w)) * line(SLOT_O, k, theta(v->o)) *
           line(SLOT_B, k, atan2(sqrt(v->y2), sqrt(v->x2))) / (v->cos_i * v->cos_o);
}

static double lambert(const struct view *v, const struct model_parameters *p, int k) {
    (void)v;
    (void)p;
    (void)k;
    return 1 / M_PI;
}

typedef double (*closed_form)(const struct view *v, const struct model_parameters *p, int k);

struct subject {
    const struct model *model;
    closed_form f;
    int slower; // evaluate this many times fewer
    int tables; // of the slots f_o, f_A and f_B: bits 0 to 2
};

static const struct subject subjects[] = {
    {&model_phong, phong, 1, 0},
    {&model_blinnphong, blinnphong, 1, 0},
    {&model_cooktorrance, cooktorrance, 1, 0},
    {&model_ashikhminshirley, ashikhmin, 1, 0},
    {&model_ashikhminfresnel, ashikhmin, 1, 0},
    {&model_ashikhminratio, ashikhmin, 1, 0},
    {&model_ashikhminratiofresnel, ashikhmin, 1, 0},
    {&model_ward, ward, 1, 0},
    {&model_schlick, schlick, 1, 0},
    {&model_orennayar, orennayar, 1, 0},
    {&model_lightview, lambert, 1, 0},
    {&model_microfacet, microfacet, 100, 0},
    {&model_homomorphic, homomorphic, 1, 6},
    {&model_halfdifference, halfdifference, 1, 6},
    {&model_freehand, freehand, 1, 7},
};

enum { SUBJECTS = sizeof subjects / sizeof *subjects };

static struct model_parameters random_parameters(struct rng *r) {
    struct model_parameters p = model_defaults;
    p.exponent_u = decades(r, 1e-3, 1e3);
    p.exponent_v = decades(r, 1e-3, 1e3);
    p.alpha_u = decades(r, 0.03, 1);
    p.alpha_v = uniform(r) < 0.3 ? p.alpha_u : decades(r, 0.03, 1);
    p.isotropy = between(r, 0.05, 1);
    p.gamma[SLOT_O] = GAMMA_THETA_O;
    p.gamma[SLOT_A] = GAMMA_SLOPE_U;
    p.gamma[SLOT_B] = GAMMA_PHI_H;
    p.quotient = QUOTIENT_WARD_DUER;
    p.variant = (int)between(r, 0, 2.999);
    p.literal = uniform(r) < 0.5;
    p.fixed_fresnel = uniform(r) < 0.5;
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        p.reflectance[k] = between(r, 0.1, 1);
        p.diffuse[k] = uniform(r) < 0.5 ? 0 : between(r, 0, 1);
        p.eta[k] = between(r, 0.1, 4);
        p.k[k] = uniform(r) < 0.3 && p.eta[k] > 1.02 ? 0 : between(r, 0.1, 5);
        p.r0[k] = uniform(r);
    }
    return p;
}

// ---- the form itself ------------------------------------------------------------------------

struct worst {
    double in_double, in_float;
};

// Relative to the value, or to 1e-12 of the lobe's scale.
static double relative(double a, double b, double scale) {
    return fabs(a - b) / fmax(fabs(b), 1e-12 * scale);
}

// The cosine of an angle loses its digits near pi/2, where this lobe ends with a vertical slope.
static bool is_end_of_lobe(const struct subject *s, const struct view *v) {
    const double c = v->cos_o * v->cos_i - v->o[0] * v->i[0] - v->o[1] * v->i[1];
    return s->model == &model_phong && fabs(c) < 1e-3;
}

static double worst_of_channels(const struct subject *s, const struct model_parameters *p,
                                const struct form *form, const struct view *v, bool round) {
    double worst = 0, d[CURVE_CHANNELS], scale = 0;
    form_eval(form, v->o, v->i, d);
    for (uint32_t t = 0; t < form->terms; t++)
        scale = fmax(scale, form->term[t].scale[0]);
    for (int k = 0; k < CURVE_CHANNELS; k++) {
        const double e = v->cos_i * (p->reflectance[k] * s->f(v, p, k) + p->diffuse[k] / M_PI);
        worst = fmax(worst, relative(round ? (double)(float)d[k] : d[k], e, scale));
    }
    return worst;
}

// Single precision: directions and values are what a renderer in single precision has of them.
static void compare(const struct subject *s, const struct model_parameters *p,
                    const struct form *form, struct rng *rng, struct worst *worst) {
    struct view v = random_view(rng);
    if (is_end_of_lobe(s, &v))
        return;
    worst->in_double = fmax(worst->in_double, worst_of_channels(s, p, form, &v, false));
    for (int k = 0; k < 3; k++) {
        v.o[k] = (double)(float)v.o[k];
        v.i[k] = (double)(float)v.i[k];
    }
    finish_view(&v);
    worst->in_float = fmax(worst->in_float, worst_of_channels(s, p, form, &v, true));
}

// The nodes of a slot, drawn anew, as a table.
static void draw_table(int slot, struct rng *r, struct arena *arena, struct curve *c) {
    const struct basis b = basis_make(arena, BASIS_HAT, NODES, SPACING_UNIFORM);
    *c = curve_make(arena, &b, CURVE_CHANNELS);
    for (int k = 0; k < CURVE_CHANNELS; k++)
        for (int i = 0; i < NODES; i++)
            c->values[k * NODES + i] = nodes[slot][k][i] = between(r, 0.1, 2);
}

static void form_equals_the_closed_form(const struct subject *s) {
    const int full = getenv("RELUME_TEST_FULL") ? 10 : 1;
    const int sets = 500 * full / s->slower, views = 100;
    struct rng rng = {(uint64_t)(s - subjects) + 1};
    struct worst worst = {0, 0};
    for (int i = 0; i < sets; i++) {
        struct arena arena = {0};
        struct form form;
        struct model_parameters p = random_parameters(&rng);
        struct curve tables[SLOTS];
        for (int k = 0; k < SLOTS; k++)
            if (s->tables >> k & 1) {
                draw_table(k, &rng, &arena, &tables[k]);
                p.curve[k] = &tables[k];
            }
        CHECK(model_make(s->model, &p, &arena, &form, "test"));
        for (int j = 0; j < views; j++)
            compare(s, &p, &form, &rng, &worst);
        arena_finish(&arena);
    }
    printf("%-18s %8d evaluations: double %.1e, float %.1e\n", s->model->name, sets * views,
           worst.in_double, worst.in_float);
    CHECK(worst.in_double <= 1e-12);
    CHECK(worst.in_float <= 1e-5);
}

int main(void) {
    for (int i = 0; i < SUBJECTS; i++)
        form_equals_the_closed_form(&subjects[i]);
    return check_result();
}
