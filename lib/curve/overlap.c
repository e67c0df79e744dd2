// SPDX-License-Identifier: Apache-2.0
#include "curve/overlap.h"

#include <math.h>
#include <string.h>

#include "curve/joint.h"

static const double FLAT = 1e-9; // radians: gammas closer than this count as equal

void overlap_init(struct overlap *o, const struct gamma *const gamma[OVERLAP_AXES],
                  const struct basis *const basis[OVERLAP_AXES], uint32_t axes,
                  struct arena *arena) {
    *o = (struct overlap){.axes = axes, .channels = OVERLAP_CHANNELS, .tolerance = 1e-3, .depth = 6, .splits = 1,
                          .to_local = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (uint32_t i = 0; i < axes; i++) {
        const struct basis *b = basis[i];
        o->axis[i] = (struct overlap_axis){*gamma[i], *b, 0};
        if (b->spacing == SPACING_UNIFORM)
            o->axis[i].per_step = basis_intervals(b) / b->knots[basis_intervals(b)];
        o->share[i] = arena_alloc(arena, b->count * sizeof *o->share[i]);
        o->margin[i] = arena_alloc(arena, b->count * sizeof *o->margin[i]);
    }
    if (axes == OVERLAP_AXES) {
        o->joint = arena_alloc(arena, (size_t)basis[0]->count * basis[1]->count * sizeof *o->joint);
        o->missing = arena_alloc(arena, (basis[0]->count + basis[1]->count) * sizeof *o->missing);
    }
}

static inline double larger(double a, double b) {
    return a > b ? a : b;
}

static inline double smaller(double a, double b) {
    return a < b ? a : b;
}

// ---- gammas -------------------------------------------------------------------------------------

static double signed_like(double gamma, double x) {
    return x < 0 ? -gamma : gamma;
}

double overlap_gamma(const struct gamma *g, struct angles *a) {
    switch (g->kind) {
    case GAMMA_THETA_H: return atan2(a->sin_h, a->cos_h);
    case GAMMA_THETA_I: return atan2(sqrt(a->wi[0] * a->wi[0] + a->wi[1] * a->wi[1]), a->wi[2]);
    case GAMMA_POWER_U: return signed_like(gamma_at(g, a), a->h[0]);
    case GAMMA_POWER_V:
    case GAMMA_RATIO: return signed_like(gamma_at(g, a), a->h[1]);
    case GAMMA_SLOPE_U: return atan2(a->h[0], a->h[2]);
    case GAMMA_SLOPE_V: return atan2(a->h[1], a->h[2]);
    default: return gamma_at(g, a);
    }
}

// ---- a part over which gamma is linear ----------------------------------------------------------

// Gammas in order.
struct slope {
    double g[3], rise, fall; // 1 / ((g1 - g0)(g2 - g0)), 1 / ((g2 - g1)(g2 - g0)); 0 where infinite
};

static struct slope slope_of(const double g[3]) {
    double a = g[0], b = g[1], c = g[2], t;
    if (a > b)
        t = a, a = b, b = t;
    if (b > c)
        t = b, b = c, c = t;
    if (a > b)
        t = a, a = b, b = t;
    struct slope s = {{a, b, c}, 0, 0};
    if (b > a)
        s.rise = 1 / ((b - a) * (c - a));
    if (c > b)
        s.fall = 1 / ((c - b) * (c - a));
    return s;
}

static struct slope mirrored(const struct slope *s) {
    return (struct slope){{-s->g[2], -s->g[1], -s->g[0]}, s->fall, s->rise};
}

// Share of the area below t.
static double below(const struct slope *s, double t) {
    if (t <= s->g[0])
        return 0;
    if (t >= s->g[2])
        return 1;
    if (t <= s->g[1])
        return (t - s->g[0]) * (t - s->g[0]) * s->rise;
    return 1 - (s->g[2] - t) * (s->g[2] - t) * s->fall;
}

// Integral of gamma - g0 over that share.
static double moment_below(const struct slope *s, double t, double F) {
    const double width = s->g[2] - s->g[0], x = t - s->g[0], y = s->g[2] - t;
    const double all = (s->g[1] - s->g[0] + width) / 3;
    if (t <= s->g[0])
        return 0;
    if (t >= s->g[2])
        return all;
    if (t <= s->g[1])
        return 2.0 / 3 * x * x * x * s->rise;
    return all - (width * (1 - F) - 2.0 / 3 * y * y * y * s->fall);
}

static bool ends(const struct overlap_axis *a) {
    return a->gamma.kind == GAMMA_THETA_R;
}

// Makes room up to `end`, in zeros.
static void widen(struct overlap_range *r, double *share, uint32_t first, uint32_t end) {
    if (r->first == r->end)
        r->first = r->end = first;
    while (r->first > first)
        share[--r->first] = 0;
    while (r->end < end)
        share[r->end++] = 0;
}

static void add_at(const struct overlap_axis *a, double gamma, double part, double *share,
                   struct overlap_range *r) {
    const struct basis *b = &a->basis;
    const double *k = b->knots, last = k[basis_intervals(b)];
    const uint32_t i = overlap_interval(a, gamma);
    const bool hat = b->kind == BASIS_HAT;
    if (gamma > last && ends(a))
        return;
    widen(r, share, i, i + 1 + hat);
    if (!hat) {
        share[i] += part;
        return;
    }
    const double t = smaller(larger((gamma - k[i]) / (k[i + 1] - k[i]), 0), 1);
    share[i] += part * (1 - t);
    share[i + 1] += part * t;
}

// What of the part has gamma >= 0.
static void add_upper(const struct overlap_axis *a, const struct slope *s, double part,
                      double *share, struct overlap_range *r) {
    const struct basis *b = &a->basis;
    const uint32_t n = basis_intervals(b);
    const bool hat = b->kind == BASIS_HAT;
    uint32_t i = overlap_interval(a, s->g[0]);
    double from = larger(s->g[0], 0), F = below(s, from), M = hat ? moment_below(s, from, F) : 0;
    for (; i < n && F < 1; i++) {
        const double low = b->knots[i], high = b->knots[i + 1];
        const double F1 = below(s, high), p = F1 - F;
        const double beyond = i + 1 == n && !ends(a) ? 1 - F1 : 0;
        widen(r, share, i, i + 1 + hat);
        if (!hat) {
            share[i] += part * (p + beyond);
        } else {
            const double M1 = moment_below(s, high, F1);
            const double up = smaller(larger((M1 - M + (s->g[0] - low) * p) / (high - low), 0), p);
            share[i] += part * (p - up);
            share[i + 1] += part * (up + beyond);
            M = M1;
        }
        F = F1;
    }
}

// The shares of a part of the triangle with gammas g at its corners.
static struct overlap_range deal(const struct overlap_axis *a, const double g[3], double part,
                         double *share) {
    struct overlap_range r = {0, 0};
    const struct slope s = slope_of(g);
    if (s.g[2] - s.g[0] < FLAT) {
        add_at(a, fabs(s.g[1]), part, share, &r);
        return r;
    }
    if (s.g[2] > 0)
        add_upper(a, &s, part, share, &r);
    if (s.g[0] < 0) {
        const struct slope m = mirrored(&s);
        add_upper(a, &m, part, share, &r);
    }
    return r;
}

void overlap_touch(struct overlap *o, uint32_t axis, uint32_t first, uint32_t end) {
    struct overlap_range *r = &o->touched[axis];
    if (first == end)
        return;
    const bool none = r->first == r->end;
    r->first = none || first < r->first ? first : r->first;
    r->end = none || end > r->end ? end : r->end;
}

static void add_part(struct overlap *o, double g[OVERLAP_AXES][3], double part,
                     const double light[OVERLAP_CHANNELS]) {
    static const struct overlap_range one = {0, 1};
    struct overlap_range a = one, b = one;
    if (o->axes > 0)
        a = deal(&o->axis[0], g[0], part, o->share[0]);
    if (o->axes > 1)
        b = deal(&o->axis[1], g[1], 1, o->share[1]);
    const size_t columns = o->axes > 1 ? o->axis[1].basis.count : 1;
    for (uint32_t j = a.first; j < a.end; j++)
        for (uint32_t k = b.first; k < b.end; k++) {
            const double share = (o->axes > 0 ? o->share[0][j] : part) *
                                 (o->axes > 1 ? o->share[1][k] : 1);
            double *sum = o->sums + (j * columns + k) * (size_t)o->channels;
            for (int c = 0; c < o->channels; c++)
                sum[c] += light[c] * share;
        }
    overlap_touch(o, 0, a.first, a.end);
    overlap_touch(o, 1, b.first, b.end);
}

void overlap_add_point(struct overlap *o, const double gamma[OVERLAP_AXES],
                       const double light[OVERLAP_CHANNELS]) {
    double g[OVERLAP_AXES][3];
    for (uint32_t i = 0; i < o->axes; i++)
        g[i][0] = g[i][1] = g[i][2] = gamma[i];
    add_part(o, g, 1, light);
}

// ---- splitting ----------------------------------------------------------------------------------

// Corners of the parts of a split triangle, as nodes of the whole.
static const int parts[4][3] = {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}};

static bool within_one_interval(const struct overlap_axis *a, double least, double most) {
    if (ends(a) && most > a->basis.knots[basis_intervals(&a->basis)])
        return false;
    return least >= 0 ? overlap_interval(a, least) == overlap_interval(a, most)
                      : most <= 0 && overlap_interval(a, -least) == overlap_interval(a, -most);
}

// How the shares of an axis will be wrong when gamma counts as linear over the triangle: the shift
// of its iso-lines by the bend, relative to the width they are spread over.
static double error_of(const struct overlap_axis *a, const double g[OVERLAP_NODES], bool *single) {
    double bend = 0, least = g[0], most = g[0];
    for (int i = 0; i < 3; i++)
        bend = larger(bend, fabs(g[3 + i] - 0.5 * (g[i] + g[(i + 1) % 3])));
    for (int i = 1; i < OVERLAP_NODES; i++) {
        least = smaller(least, g[i]);
        most = larger(most, g[i]);
    }
    // Between nodes it may go on by half of the bend.
    *single = within_one_interval(a, least < 0 ? least : larger(least - 0.5 * bend, 0), most + 0.5 * bend);
    if (*single && a->basis.kind == BASIS_BOX)
        return 0;
    const uint32_t i = overlap_interval(a, fabs(least));
    const double step = a->basis.knots[i + 1] - a->basis.knots[i];
    return bend / larger(most - least, a->basis.kind == BASIS_HAT ? step : FLAT);
}

static void middle_of(const double a[3], const double b[3], double out[3]) {
    double l = 0;
    for (int i = 0; i < 3; i++) {
        out[i] = a[i] + b[i];
        l += out[i] * out[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] /= sqrt(l);
}

// Twice the area between three points of the unit sphere, as of a plane triangle.
static double area_of(const double a[3], const double b[3], const double c[3]) {
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = b[i] - a[i];
        v[i] = c[i] - a[i];
    }
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
                 z = u[0] * v[1] - u[1] * v[0];
    return sqrt(x * x + y * y + z * z);
}

static void finish_triangle(struct overlap_triangle *t) {
    double sum = 0;
    for (int i = 0; i < 3; i++)
        middle_of(t->node[i], t->node[(i + 1) % 3], t->node[3 + i]);
    for (int i = 0; i < 4; i++)
        sum += t->part[i] = area_of(t->node[parts[i][0]], t->node[parts[i][1]], t->node[parts[i][2]]);
    for (int i = 0; i < 4; i++)
        t->part[i] /= sum;
}

void overlap_triangle_make(struct overlap_triangle *t, const double corner[OVERLAP_CORNERS][3]) {
    for (int i = 0; i < OVERLAP_CORNERS; i++)
        for (int k = 0; k < 3; k++)
            t->node[i][k] = corner[i][k];
    finish_triangle(t);
}

static void add_triangle(struct overlap *o, const struct overlap_triangle *t,
                         double gamma[OVERLAP_AXES][OVERLAP_NODES], double share, int depth,
                         const double light[OVERLAP_CHANNELS]);

static void add_child(struct overlap *o, const struct overlap_triangle *t,
                      double gamma[OVERLAP_AXES][OVERLAP_NODES], int which, double share, int depth,
                      const double light[OVERLAP_CHANNELS]) {
    struct overlap_triangle child;
    double g[OVERLAP_AXES][OVERLAP_NODES];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            child.node[i][k] = t->node[parts[which][i]][k];
    finish_triangle(&child);
    for (int i = 0; i < 3; i++) {
        const double *w = child.node[3 + i];
        double wi[3];
        for (int k = 0; k < 3; k++)
            wi[k] = o->to_local[k][0] * w[0] + o->to_local[k][1] * w[1] + o->to_local[k][2] * w[2];
        struct angles a = angles_make(o->wo, wi);
        for (uint32_t x = 0; x < o->axes; x++) {
            g[x][i] = gamma[x][parts[which][i]];
            g[x][3 + i] = overlap_gamma(&o->axis[x].gamma, &a);
        }
    }
    add_triangle(o, &child, g, share * t->part[which], depth, light);
}

static bool is_joint(const struct overlap *o, double g[OVERLAP_AXES][3]) {
    for (uint32_t x = 0; x < OVERLAP_AXES; x++)
        if (x >= o->axes || within_one_interval(&o->axis[x], smaller(smaller(g[x][0], g[x][1]), g[x][2]),
                                                larger(larger(g[x][0], g[x][1]), g[x][2])))
            return false;
    return true;
}

// A part over which gammas are linear, split further for the sake of two curves.
static void add_linear(struct overlap *o, double g[OVERLAP_AXES][3], double share, int splits,
                       const double light[OVERLAP_CHANNELS]) {
    if (splits == 0 || !is_joint(o, g)) {
        add_part(o, g, share, light);
        return;
    }
    for (int i = 0; i < 4; i++) {
        double child[OVERLAP_AXES][3];
        for (uint32_t x = 0; x < o->axes; x++) {
            const double nodes[OVERLAP_NODES] = {
                g[x][0], g[x][1], g[x][2], 0.5 * (g[x][0] + g[x][1]), 0.5 * (g[x][1] + g[x][2]),
                0.5 * (g[x][2] + g[x][0])};
            for (int k = 0; k < 3; k++)
                child[x][k] = nodes[parts[i][k]];
        }
        add_linear(o, child, share / 4, splits - 1, light);
    }
}

static void add_parts(struct overlap *o, const struct overlap_triangle *t,
                      double gamma[OVERLAP_AXES][OVERLAP_NODES], double share,
                      const double light[OVERLAP_CHANNELS]) {
    for (int i = 0; i < 4; i++) {
        double g[OVERLAP_AXES][3];
        for (uint32_t x = 0; x < o->axes; x++)
            for (int k = 0; k < 3; k++)
                g[x][k] = gamma[x][parts[i][k]];
        add_linear(o, g, share * t->part[i], o->splits, light);
    }
}

static void add_triangle(struct overlap *o, const struct overlap_triangle *t,
                         double gamma[OVERLAP_AXES][OVERLAP_NODES], double share, int depth,
                         const double light[OVERLAP_CHANNELS]) {
    bool single[OVERLAP_AXES] = {true, true};
    double error = 0;
    for (uint32_t x = 0; x < o->axes; x++)
        error = larger(error, 2 * share * error_of(&o->axis[x], gamma[x], &single[x]));
    if (error <= o->tolerance && (o->axes < 2 || single[0] || single[1])) {
        double g[OVERLAP_AXES][3];
        for (uint32_t x = 0; x < o->axes; x++)
            for (int k = 0; k < 3; k++)
                g[x][k] = gamma[x][k];
        add_part(o, g, share, light);
    } else if (error <= 4 * o->tolerance || depth == 0) {
        add_parts(o, t, gamma, share, light);
    } else {
        for (int i = 0; i < 4; i++)
            add_child(o, t, gamma, i, share, depth - 1, light);
    }
}

// ---- both curves ----------------------------------------------------------------------------------

static const double all[OVERLAP_CHANNELS] = {1};

void overlap_add_alone(struct overlap *o, uint32_t axis, const struct overlap_triangle *t,
                       double gamma[OVERLAP_AXES][OVERLAP_NODES]) {
    struct overlap one = *o;
    double own[OVERLAP_AXES][OVERLAP_NODES];
    one.axes = one.channels = 1;
    one.axis[0] = o->axis[axis];
    one.share[0] = o->share[axis];
    one.sums = o->margin[axis];
    one.touched[0] = o->touched[axis];
    memcpy(own[0], gamma[axis], sizeof own[0]);
    add_triangle(&one, t, own, 1, one.depth, all);
    o->touched[axis] = one.touched[0];
}

void overlap_add_joint(struct overlap *o, const struct overlap_triangle *t,
                       double gamma[OVERLAP_AXES][OVERLAP_NODES]) {
    struct overlap both = *o;
    both.channels = 1;
    both.sums = o->joint;
    add_triangle(&both, t, gamma, 1, o->depth, all);
    memcpy(o->touched, both.touched, sizeof o->touched);
}

// Sums that an axis which ends may have lost something of are not those of the other axis alone.
void overlap_finish_joint(struct overlap *o, const double light[OVERLAP_CHANNELS]) {
    const double *const sum[OVERLAP_AXES] = {ends(&o->axis[1]) ? NULL : o->margin[0],
                                             ends(&o->axis[0]) ? NULL : o->margin[1]};
    const uint32_t columns = o->axis[1].basis.count;
    const struct overlap_range *r = o->touched;
    joint_fit(o->joint, columns, (uint32_t[]){r[0].first, r[1].first}, (uint32_t[]){r[0].end, r[1].end},
              sum, o->missing);
    for (uint32_t j = r[0].first; j < r[0].end; j++)
        for (uint32_t k = r[1].first; k < r[1].end; k++) {
            double *share = &o->joint[(size_t)j * columns + k];
            for (int c = 0; c < OVERLAP_CHANNELS; c++)
                o->sums[((size_t)j * columns + k) * OVERLAP_CHANNELS + (size_t)c] += light[c] * *share;
            *share = 0;
        }
    for (uint32_t x = 0; x < OVERLAP_AXES; x++) {
        memset(o->margin[x] + r[x].first, 0, (r[x].end - r[x].first) * sizeof *o->margin[x]);
        o->touched[x] = (struct overlap_range){0, 0};
    }
}

void overlap_add(struct overlap *o, const struct overlap_triangle *t,
                 double gamma[OVERLAP_AXES][OVERLAP_NODES], const double light[OVERLAP_CHANNELS]) {
    if (o->axes < OVERLAP_AXES) {
        add_triangle(o, t, gamma, 1, o->depth, light);
        return;
    }
    for (uint32_t x = 0; x < OVERLAP_AXES; x++)
        overlap_add_alone(o, x, t, gamma);
    overlap_add_joint(o, t, gamma);
    overlap_finish_joint(o, light);
}
