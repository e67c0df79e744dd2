// SPDX-License-Identifier: Apache-2.0
#include "light/ies_profile.h"

#include <stdlib.h>

#include "base/mem.h"

// Index i and weight t of x between sorted angles[i] and angles[i + 1]. false: outside of them.
static bool bracket(const float *angles, uint32_t count, float x, uint32_t *i, float *t) {
    uint32_t lo = 0, hi = count - 1;
    *i = 0;
    *t = 0;
    const float slack = 1e-3f; // degrees; angles of directions are rounded
    if (!(x >= angles[0] - slack) || !(x <= angles[hi] + slack))
        return false;
    if (hi == 0)
        return true;
    while (hi - lo > 1) {
        const uint32_t middle = (lo + hi) / 2;
        if (angles[middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    *i = lo;
    *t = clampf((x - angles[lo]) / (angles[hi] - angles[lo]), 0, 1);
    return true;
}

static float degrees(float y, float x) {
    return atan2f(y, x) * (180 / PI);
}

// The measured half or quarter stands for the whole (LM-63-2002, 5.12: by the last angle; 90 to 270
// in files of 1986 and later that are symmetric about the other plane).
static float fold_horizontal(const struct ies_profile *p, float h) {
    const float first = p->horizontal[0], last = p->horizontal[p->horizontal_count - 1];
    if (p->type != IES_TYPE_C)
        return first >= 0 ? fabsf(h) : h;
    if (p->horizontal_count == 1)
        return first;
    h = h < 0 ? h + 360 : h;
    if (first >= 89.5f && last <= 270.5f) // about the plane 90-270
        return h < 90 ? 180 - h : h > 270 ? 540 - h : h;
    if (last <= 90.5f)
        return h <= 90 ? h : h <= 180 ? 180 - h : h <= 270 ? h - 180 : 360 - h;
    if (last <= 180.5f)
        return h <= 180 ? h : 360 - h;
    return h;
}

static void angles_of(const struct ies_profile *p, vec3 w, float *vertical, float *horizontal) {
    float h, v;
    if (p->type == IES_TYPE_C) {
        v = degrees(sqrtf(w[0] * w[0] + w[1] * w[1]), w[2]);
        h = degrees(-w[1], w[0]);
    } else if (p->type == IES_TYPE_B) {
        v = degrees(w[0], w[2]);
        h = degrees(w[1], sqrtf(w[0] * w[0] + w[2] * w[2]));
    } else {
        v = degrees(-w[2], sqrtf(w[0] * w[0] + w[1] * w[1]));
        h = degrees(w[1], w[0]);
    }
    *horizontal = fold_horizontal(p, h);
    *vertical = p->type != IES_TYPE_C && p->vertical[0] >= 0 ? fabsf(v) : v;
}

float ies_profile_eval(const struct ies_profile *p, vec3 w) {
    uint32_t i, j;
    float v, h, t, s;
    angles_of(p, w, &v, &h);
    const uint32_t n = p->horizontal_count;
    if (!bracket(p->vertical, p->vertical_count, v, &i, &t))
        return 0;
    uint32_t next = 1;
    if (!bracket(p->horizontal, n, h, &j, &s)) {
        // A full turn whose last plane, 360 degrees, is left out closes with the first.
        const float gap = p->horizontal[0] + 360 - p->horizontal[n - 1];
        if (p->type != IES_TYPE_C || !(p->horizontal[n - 1] > 180.5f) ||
            p->horizontal[0] > 0 || gap > 180)
            return 0;
        j = n - 1;
        next = 1 - n; // modulo 2^32: back to plane 0
        s = clampf((h - p->horizontal[n - 1]) / gap, 0, 1);
    }
    const float *a = p->candela + (size_t)j * p->vertical_count + i;
    const float *b = n > 1 ? p->candela + (size_t)(j + next) * p->vertical_count + i : a;
    const uint32_t up = p->vertical_count > 1;
    return lerpf(s, lerpf(t, a[0], a[up]), lerpf(t, b[0], b[up]));
}

// Midpoints, fine enough for the 2.5 degrees of usual files; an estimate for choosing lights.
float ies_profile_flux(const struct ies_profile *p) {
    enum { ROWS = 180, COLUMNS = 360 };
    double sum = 0;
    for (int y = 0; y < ROWS; y++) {
        const float theta = ((float)y + 0.5f) / ROWS * PI;
        for (int x = 0; x < COLUMNS; x++) {
            const float phi = ((float)x + 0.5f) / COLUMNS * TWO_PI;
            const vec3 w = v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
            sum += (double)(ies_profile_eval(p, w) * sinf(theta));
        }
    }
    return (float)(sum * (M_PI / ROWS) * (2 * M_PI / COLUMNS));
}

float ies_profile_cone(const struct ies_profile *p) {
    uint32_t last = 0;
    if (p->type != IES_TYPE_C)
        return -1;
    for (uint32_t j = 0; j < p->horizontal_count; j++)
        for (uint32_t i = 0; i < p->vertical_count; i++)
            if (p->candela[(size_t)j * p->vertical_count + i] > 0 && i + 1 > last)
                last = i + 1; // what is interpolated towards the next angle shines too
    last = last < p->vertical_count ? last : p->vertical_count - 1;
    const float angle = p->vertical[last] + 0.01f;
    return angle < 180 ? cosf(angle * (PI / 180)) : -1;
}

void ies_profile_finish(struct ies_profile *p) {
    mem_free(p->vertical);
    mem_free(p->horizontal);
    mem_free(p->candela);
    *p = (struct ies_profile){0};
}
