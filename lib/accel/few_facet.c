// SPDX-License-Identifier: Apache-2.0
#include "accel/few_facet.h"

#include <math.h>
#include <string.h>

// In double: a difference of products of positions would lose the digits of short edges.
static void cross_double(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static double dot_double(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static void load(const struct mesh *m, uint32_t triangle, uint32_t corner, double p[3]) {
    for (int i = 0; i < 3; i++)
        p[i] = m->positions[m->indices[triangle][corner % 3]][i];
}

static void set_edge(struct few_facet *f, int k, const double a[3], const double b[3]) {
    double e[3], moment[3];
    subtract(b, a, e);
    cross_double(a, b, moment);
    for (int i = 0; i < 3; i++) {
        f->edge[k][i] = (float)e[i];
        f->moment[k][i] = (float)moment[i];
    }
}

static void normal_of(double q[4][3], double n[3]) {
    double x[3], y[3];
    subtract(q[1], q[0], x);
    subtract(q[2], q[0], y);
    cross_double(x, y, n);
    const double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    for (int i = 0; i < 3; i++)
        n[i] = most > 0 ? n[i] / most : 0;
}

// Whether the corners lie in a plane, to the rounding of positions, and turn one way.
static bool flat_and_convex(double q[4][3]) {
    double n[3], out[3], extent = 0;
    normal_of(q, n);
    subtract(q[3], q[0], out);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++)
            extent = fmax(extent, fabs(q[k][i]));
    if (!(fabs(dot_double(n, out)) <= 0x1p-23 * extent))
        return false;
    for (int k = 0; k < 4; k++) {
        double a[3], b[3], turn[3];
        subtract(q[(k + 1) % 4], q[k], a);
        subtract(q[(k + 2) % 4], q[(k + 1) % 4], b);
        cross_double(a, b, turn);
        if (!(dot_double(turn, n) > 0))
            return false;
    }
    return true;
}

// Whether the next triangle completes a quadrilateral; where q0 is in both.
static bool find_pair(const struct mesh *m, uint32_t triangle, double q[4][3], uint32_t first[2]) {
    if (triangle + 1 >= m->triangle_count)
        return false;
    for (first[0] = 0; first[0] < 3; first[0]++)
        for (first[1] = 0; first[1] < 3; first[1]++) {
            double p0[3], p2[3];
            for (uint32_t k = 0; k < 3; k++)
                load(m, triangle, first[0] + k, q[k]);
            load(m, triangle + 1, first[1], p0);
            load(m, triangle + 1, first[1] + 1, p2);
            load(m, triangle + 1, first[1] + 2, q[3]);
            if (memcmp(p0, q[0], sizeof p0) == 0 && memcmp(p2, q[2], sizeof p2) == 0 &&
                flat_and_convex(q))
                return true;
        }
    return false;
}

void few_facet_of(const struct mesh *m, uint32_t shape, uint32_t triangle, struct few_facet *f) {
    double q[4][3], n[3];
    *f = (struct few_facet){.count = 2, .shape = shape, .primitive = {triangle, triangle + 1}};
    if (!find_pair(m, triangle, q, f->first)) {
        f->count = 1;
        f->first[0] = 0;
        for (uint32_t k = 0; k < 3; k++)
            load(m, triangle, k, q[k]);
    }
    const int corners = f->count == 2 ? 4 : 3;
    for (int k = 0; k < corners; k++)
        set_edge(f, k, q[k], q[(k + 1) % corners]);
    if (f->count == 2)
        set_edge(f, FACET_DIAGONAL, q[0], q[2]);
    normal_of(q, n);
    for (int i = 0; i < 3; i++) {
        f->normal[i] = (float)n[i];
        f->corner[i] = (float)q[0][i];
    }
}

uint32_t few_facets_of(const struct mesh *m, uint32_t shape, struct few_facet *facets) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < m->triangle_count; t += facets[count++].count)
        few_facet_of(m, shape, t, &facets[count]);
    return count;
}
