// SPDX-License-Identifier: Apache-2.0
#include "accel/few_largest.h"

#include <math.h>
#include <string.h>

// Of the area of all that are not larger: below it the test of a ray costs as much as it saves.
static const double least_share = 0.01;

struct ranking {
    struct few_facet facet[FEW_LARGEST];
    double area[FEW_LARGEST]; // descending
    uint32_t count;
};

static double area_of(const struct mesh *m, uint32_t triangle) {
    const float *p[3];
    double e[2][3], sum = 0;
    for (int k = 0; k < 3; k++)
        p[k] = m->positions[m->indices[triangle][k]];
    for (int i = 0; i < 3; i++) {
        e[0][i] = (double)p[1][i] - (double)p[0][i];
        e[1][i] = (double)p[2][i] - (double)p[0][i];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double n = e[0][j] * e[1][k] - e[0][k] * e[1][j];
        sum += n * n;
    }
    return 0.5 * sqrt(sum);
}

static void enter(struct ranking *r, const struct few_facet *f, double area) {
    uint32_t at = r->count < FEW_LARGEST ? r->count++ : FEW_LARGEST - 1;
    for (; at > 0 && r->area[at - 1] < area; at--) {
        r->area[at] = r->area[at - 1];
        r->facet[at] = r->facet[at - 1];
    }
    r->area[at] = area;
    r->facet[at] = *f;
}

// The area of a mesh. A triangle is looked at closely only where it may be one of the largest, by
// itself or as half of a pair.
static double rank(const struct mesh *m, uint32_t shape, struct ranking *r) {
    double total = 0;
    for (uint32_t t = 0, step; t < m->triangle_count; t += step) {
        double area = area_of(m, t);
        const double least = r->count < FEW_LARGEST ? 0 : r->area[FEW_LARGEST - 1];
        step = 1;
        if (2 * area > least) {
            struct few_facet f;
            few_facet_of(m, shape, t, &f);
            step = f.count;
            area += step == 2 ? area_of(m, t + 1) : 0;
            if (area > least)
                enter(r, &f, area);
        }
        total += area;
    }
    return total;
}

uint32_t few_largest_of(const struct scene *s, struct few_facet largest[FEW_LARGEST]) {
    struct ranking r = {.count = 0};
    double left = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->shape_count; i++)
        if (s->shapes[i].kind == SHAPE_MESH && s->shapes[i].group == SCENE_NONE)
            left += rank(&s->shapes[i].mesh, i, &r);
    while (count < r.count && r.area[count] > least_share * left)
        left -= r.area[count++];
    memcpy(largest, r.facet, count * sizeof *largest);
    return count;
}
