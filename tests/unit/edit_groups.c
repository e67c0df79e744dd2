// SPDX-License-Identifier: Apache-2.0
// Groups of factors: as many as there are multisets, none twice, and steps that do not care for order.
#include "driver/edit_groups.h"

#include "bsdf/equivalent_albedo.h"
#include "bsdf/bin_sampler.h"
#include "check.h"
#include "curve/model.h"

static double choose(uint32_t n, uint32_t k) {
    double c = 1;
    for (uint32_t i = 1; i <= k; i++)
        c = c * (n - k + i) / i;
    return c;
}

static void groups_are_multisets(uint32_t objects, uint32_t bounces) {
    const struct edit_plan plan = {.count = objects};
    const uint32_t series[EDIT_MOST_BOUNCES] = {64, 1, 1, 1, 1, 1, 1, 1};
    struct edit_groups g;
    CHECK(edit_groups_init(&g, &plan, NULL, NULL, series, bounces));
    CHECK(g.count == choose(bounces - 1 + objects, objects));
    CHECK(g.count == edit_groups_count(objects, bounces, 0));
    uint32_t wrong = 0, longest = 0;
    for (uint32_t i = 0; i < g.count; i++) {
        uint32_t list[EDIT_MOST_BOUNCES], next[EDIT_MOST_BOUNCES];
        const uint32_t n = edit_group_factors(&g, i, list);
        longest = n > longest ? n : longest;
        for (uint32_t k = 1; k < n; k++)
            wrong += list[k] < list[k - 1];
        for (uint32_t o = 0; o < objects; o++) {
            const uint32_t to = g.next[i * objects + o];
            if (n + 1 == bounces) {
                wrong += to != UINT32_MAX;
                continue;
            }
            // the same factors and one more
            uint32_t m = edit_group_factors(&g, to, next), k = 0;
            wrong += m != n + 1;
            for (uint32_t j = 0; j < m; j++)
                if (k < n && next[j] == list[k])
                    k++;
                else
                    wrong += next[j] != o;
            wrong += k != n;
        }
    }
    CHECK(wrong == 0 && longest == bounces - 1);
    edit_groups_finish(&g);
}

static struct form form_of(struct arena *arena, const char *model, double exponent, double alpha,
                           uint32_t bins, enum basis_kind kind) {
    struct model_parameters p = model_defaults;
    struct form f;
    p.exponent_u = p.exponent_v = exponent;
    p.alpha_u = p.alpha_v = fmax(alpha, 0.1);
    p.fixed_fresnel = true;
    CHECK(model_make(model_find(model), &p, arena, &f, model));
    for (uint32_t c = 0; c < f.curves; c++) {
        const struct basis b = basis_make(arena, kind, bins, SPACING_UNIFORM);
        form_tabulate(&f, c, &b, form_filter(&f, c), arena);
    }
    return f;
}

// sum_j c_j e_j of the first term, times f_q.
static double albedo_of(const struct form *f, uint32_t term) {
    const struct form_term *t = &f->term[term];
    static double e[3 * 4096];
    const struct form_slot *a = &t->slots[SLOT_A], *b = &t->slots[SLOT_B];
    const struct curve *x = a->gamma.kind ? f->curve[a->curve].f[0].table : NULL;
    const struct curve *y = b->gamma.kind ? f->curve[b->curve].f[0].table : NULL;
    const uint32_t m = x ? x->basis.count : 1, n = y ? y->basis.count : 1;
    double sum = 0;
    equivalent_albedo(f, term, e);
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < n; j++)
            sum += (x ? x->values[i] : 1) * (y ? y->values[j] : 1) * e[3 * (i * n + j)];
    return t->scale[0] * sum;
}

// 1/pi integrals of rho cos_i cos_o, both directions by their cosine: a lattice of 2^20 points.
static double brute_force(const struct form *f) {
    enum { N = 1 << 20 };
    double sum = 0;
    for (int i = 0; i < N; i++) {
        const double g = 1.2207440846057596; // x^4 = x + 1
        const double u = fmod(0.5 + i / g, 1), v = fmod(0.5 + i / (g * g), 1);
        const double w = fmod(0.5 + i / (g * g * g), 1), z = (i + 0.5) / N;
        const double so = sqrt(u), si = sqrt(v), po = 2 * M_PI * w, pi = 2 * M_PI * z;
        const double wo[3] = {so * cos(po), so * sin(po), sqrt(1 - u)};
        const double wi[3] = {si * cos(pi), si * sin(pi), sqrt(1 - v)};
        double out[CURVE_CHANNELS];
        form_eval(f, wo, wi, out);
        sum += wi[2] > 0 && wo[2] > 0 ? out[0] / wi[2] * M_PI / N : 0;
    }
    return sum;
}

struct exponents {
    double u, v; // along the tangent and across
};

// Ashikhmin and Shirley's density of half vectors, and where it is drawn (2000, eq. 4 and 9).
static double half_density(struct exponents n, double cosine, double phi) {
    const double c = cos(phi), s = sin(phi);
    return sqrt((n.u + 1) * (n.v + 1)) / (2 * M_PI) * pow(cosine, n.u * c * c + n.v * s * s);
}

static void draw_half(struct exponents n, double x, double y, double *cosine, double *phi) {
    *phi = atan2(sqrt(n.u + 1) * sin(2 * M_PI * x), sqrt(n.v + 1) * cos(2 * M_PI * x));
    const double c = cos(*phi), s = sin(*phi);
    *cosine = pow(1 - y, 1 / (n.u * c * c + n.v * s * s + 1));
}

// The same integral for narrow lobes: half vectors drawn by the lobe and by a broad one, balanced.
static double by_half_vectors(const struct form *f, double nu, double nv) {
    enum { N = 1 << 17 };
    const double g = 1.1673039782614187; // x^5 = x + 1
    const struct exponents lobes[2] = {{nu, nv}, {nu / 20, nv / 20}};
    double sum = 0;
    for (int i = 0; i < 2 * N; i++) {
        const double at = i / 2, u = fmod(0.5 + at / g, 1), v = fmod(0.5 + at / (g * g), 1);
        const double x = fmod(0.5 + at / (g * g * g), 1), y = fmod(0.5 + at / (g * g * g * g), 1);
        const double s = sqrt(u), p = 2 * M_PI * v, wo[3] = {s * cos(p), s * sin(p), sqrt(1 - u)};
        double cosine, phi, out[CURVE_CHANNELS];
        draw_half(lobes[i % 2], x, y, &cosine, &phi);
        const double sine = sqrt(1 - cosine * cosine);
        const double h[3] = {sine * cos(phi), sine * sin(phi), cosine};
        const double d = wo[0] * h[0] + wo[1] * h[1] + wo[2] * h[2];
        const double wi[3] = {2 * d * h[0] - wo[0], 2 * d * h[1] - wo[1], 2 * d * h[2] - wo[2]};
        if (!(d > 0 && wi[2] > 0))
            continue;
        form_eval(f, wo, wi, out);
        sum += out[0] * 4 * d /
               (half_density(lobes[0], cosine, phi) + half_density(lobes[1], cosine, phi)) / N;
    }
    return sum;
}

// Two curves, whose bins are many and narrow.
static void two_curves(void) {
    static const double exponents[][2] = {{100, 200}, {150, 20}};
    struct arena arena = {0};
    for (int i = 0; i < 2; i++)
        for (uint32_t bins = 8; bins <= 64; bins += 56) {
            const double nu = exponents[i][0], nv = exponents[i][1];
            struct model_parameters p = model_defaults;
            struct form f;
            p.exponent_u = nu;
            p.exponent_v = nv;
            CHECK(model_make(model_find("ashikhminshirley"), &p, &arena, &f, "test"));
            for (uint32_t c = 0; c < f.curves; c++) {
                const struct basis b = basis_make(&arena, BASIS_HAT, c ? bins : 64, SPACING_UNIFORM);
                form_tabulate(&f, c, &b, form_filter(&f, c), &arena);
            }
            const double sum = albedo_of(&f, 0), truth = by_half_vectors(&f, nu, nv);
            printf("Ashikhmin-Shirley of %g, %g, 64 x %u nodes: %.5f, by half vectors %.5f\n", nu, nv,
                   bins, sum, truth);
            CHECK_NEAR(sum / truth, 1, 0.005);
        }
    arena_finish(&arena);
}

// How many functions of the eye's hop each coarse bin of a form's first term has.
static void coarse_widths(struct form *f, uint32_t fine, uint32_t coarse, uint32_t *widths) {
    struct edit_object object = {.form = f};
    const struct edit_plan plan = {.objects = &object, .count = 1};
    const uint32_t series[2] = {fine, coarse};
    struct edit_groups g;
    CHECK(edit_groups_init(&g, &plan, NULL, NULL, series, 2));
    uint32_t before = 0;
    for (uint32_t j = 0; j < fine; j++) {
        const uint32_t bin = g.factors[g.last[g.second[0][j]]].bin;
        CHECK(bin < coarse && bin >= before);
        widths[before = bin]++;
    }
    edit_groups_finish(&g);
}

// Bins of the second hop widen with the distance from a highlight, and none is empty.
static void coarse_bins_widen(void) {
    struct arena arena = {0};
    const uint32_t wanted[8] = {2, 6, 10, 14, 18, 22, 26, 30};
    struct form lobe = form_of(&arena, "blinnphong", 20, 0, 128, BASIS_BOX);
    uint32_t widths[8] = {0};
    coarse_widths(&lobe, 128, 8, widths);
    for (int k = 0; k < 8; k++)
        CHECK(widths[k] == wanted[k]);
    for (uint32_t coarse = 2; coarse <= 16; coarse++) {
        struct form narrow = form_of(&arena, "phong", 20, 0, 16, BASIS_HAT);
        uint32_t n[16] = {0};
        coarse_widths(&narrow, 16, coarse, n);
        for (uint32_t k = 0; k < coarse; k++)
            CHECK(n[k] > 0);
    }
    struct form even = form_of(&arena, "lightview", 0, 0, 64, BASIS_BOX);
    uint32_t equal[8] = {0};
    coarse_widths(&even, 64, 8, equal);
    CHECK(equal[0] == 8 && equal[7] == 8);
    arena_finish(&arena);
}

static void albedos_are_integrals(void) {
    struct arena arena = {0};
    const struct {
        const char *model;
        double exponent, alpha;
    } cases[] = {{"blinnphong", 20, 0}, {"cooktorrance", 0, 0.3}, {"phong", 15, 0},
                 {"ward", 0, 0.3}, {"schlick", 0, 0.5}};
    for (int k = 0; k < 2; k++) {
        const enum basis_kind kind = k ? BASIS_HAT : BASIS_BOX;
        struct form even = form_of(&arena, "lightview", 0, 0, 16, kind);
        CHECK_NEAR(albedo_of(&even, 0), 1, 1e-12); // rho = 1 / pi
        struct form blinn = form_of(&arena, "blinnphong", 0, 0, 64, kind);
        printf("Blinn of exponent 0: %.5f\n", albedo_of(&blinn, 0));
        CHECK_NEAR(albedo_of(&blinn, 0), 0.5523, 0.001);
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct form f = form_of(&arena, cases[i].model, cases[i].exponent, cases[i].alpha, 64,
                                BASIS_HAT);
        double sum = 0;
        for (uint32_t t = 0; t < f.terms; t++)
            sum += albedo_of(&f, t);
        const double truth = brute_force(&f);
        printf("%-16s albedo %.5f, by brute force %.5f\n", cases[i].model, sum, truth);
        CHECK_NEAR(sum / truth, 1, 0.005);
    }
    arena_finish(&arena);
}

int main(void) {
    for (uint32_t objects = 1; objects <= 5; objects++)
        for (uint32_t bounces = 1; bounces <= 6; bounces++)
            groups_are_multisets(objects, bounces);
    groups_are_multisets(32, 3);
    CHECK(edit_groups_count(6, 4, 0) == 84 && edit_groups_count(3, 4, 24) == 241);
    coarse_bins_widen();
    albedos_are_integrals();
    two_curves();
    return check_result();
}
