// SPDX-License-Identifier: Apache-2.0
#include "math/transform.h"

#include <math.h>
#include <string.h>

const struct transform transform_identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

struct transform transform_multiply(const struct transform *a, const struct transform *b) {
    struct transform c;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] +
                        a->m[i][2] * b->m[2][j] + a->m[i][3] * b->m[3][j];
    return c;
}

static void swap_rows(double a[4][8], int i, int j) {
    double row[8];
    memcpy(row, a[i], sizeof row);
    memcpy(a[i], a[j], sizeof row);
    memcpy(a[j], row, sizeof row);
}

// Gauss-Jordan with partial pivoting.
bool transform_invert(const struct transform *in, struct transform *inverse) {
    double a[4][8] = {0};
    for (int i = 0; i < 4; i++) {
        memcpy(a[i], in->m[i], sizeof in->m[i]);
        a[i][4 + i] = 1;
    }
    for (int c = 0; c < 4; c++) {
        int pivot = c;
        for (int r = c + 1; r < 4; r++)
            if (fabs(a[r][c]) > fabs(a[pivot][c]))
                pivot = r;
        if (!(fabs(a[pivot][c]) > 0))
            return false;
        swap_rows(a, c, pivot);
        const double scale = 1 / a[c][c];
        for (int k = 0; k < 8; k++)
            a[c][k] *= scale;
        for (int r = 0; r < 4; r++) {
            const double factor = a[r][c];
            for (int k = 0; r != c && k < 8; k++)
                a[r][k] -= factor * a[c][k];
        }
    }
    for (int i = 0; i < 4; i++)
        memcpy(inverse->m[i], a[i] + 4, sizeof inverse->m[i]);
    return transform_is_finite(inverse);
}

double transform_determinant3(const struct transform *t) {
    const double(*a)[4] = t->m;
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
           a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

struct transform transform_translate(double x, double y, double z) {
    return (struct transform){{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}};
}

struct transform transform_scale(double x, double y, double z) {
    return (struct transform){{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}, {0, 0, 0, 1}}};
}

static double normalize3(double v[3]) {
    const double l = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= l;
    return l;
}

static void cross3(const double a[3], const double b[3], double c[3]) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// Rodrigues. Multiples of 90 degrees are exact.
struct transform transform_rotate(const double axis[3], double degrees) {
    double u[3] = {axis[0], axis[1], axis[2]};
    normalize3(u);
    const double quarter = fmod(degrees, 360) / 90;
    static const double exact_cos[4] = {1, 0, -1, 0};
    double c = cos(degrees * (M_PI / 180)), s = sin(degrees * (M_PI / 180));
    if (quarter == floor(quarter)) {
        const int q = ((int)quarter + 4) % 4;
        c = exact_cos[q];
        s = exact_cos[(q + 3) % 4];
    }
    struct transform r = transform_identity;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r.m[i][j] = u[i] * u[j] * (1 - c) + (i == j ? c : 0);
    r.m[0][1] -= u[2] * s;
    r.m[0][2] += u[1] * s;
    r.m[1][0] += u[2] * s;
    r.m[1][2] -= u[0] * s;
    r.m[2][0] -= u[1] * s;
    r.m[2][1] += u[0] * s;
    return r;
}

bool transform_look_at(const double origin[3], const double target[3], const double up[3],
                       struct transform *out) {
    double dir[3], left[3], new_up[3];
    for (int i = 0; i < 3; i++)
        dir[i] = target[i] - origin[i];
    if (!(normalize3(dir) > 0))
        return false;
    cross3(up, dir, left);
    if (!(normalize3(left) > 0))
        return false;
    cross3(dir, left, new_up);
    *out = transform_identity;
    for (int i = 0; i < 3; i++) {
        out->m[i][0] = left[i];
        out->m[i][1] = new_up[i];
        out->m[i][2] = dir[i];
        out->m[i][3] = origin[i];
    }
    return transform_is_finite(out);
}

void transform_point(const struct transform *t, const double p[3], double q[3]) {
    const double(*a)[4] = t->m;
    const double w = a[3][0] * p[0] + a[3][1] * p[1] + a[3][2] * p[2] + a[3][3];
    double r[3];
    for (int i = 0; i < 3; i++)
        r[i] = a[i][0] * p[0] + a[i][1] * p[1] + a[i][2] * p[2] + a[i][3];
    for (int i = 0; i < 3; i++)
        q[i] = w == 1 ? r[i] : r[i] / w;
}

void transform_vector(const struct transform *t, const double v[3], double w[3]) {
    const double(*a)[4] = t->m;
    double r[3];
    for (int i = 0; i < 3; i++)
        r[i] = a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2];
    memcpy(w, r, sizeof r);
}

void transform_normal(const struct transform *inverse, const double n[3], double m[3]) {
    const double(*a)[4] = inverse->m;
    double r[3];
    for (int i = 0; i < 3; i++)
        r[i] = a[0][i] * n[0] + a[1][i] * n[1] + a[2][i] * n[2];
    memcpy(m, r, sizeof r);
}

bool transform_is_identity(const struct transform *a) {
    return memcmp(a, &transform_identity, sizeof *a) == 0;
}

bool transform_is_finite(const struct transform *a) {
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            if (!isfinite(a->m[i][j]))
                return false;
    return true;
}

bool transform_make_affine(struct transform *a) {
    const double w = a->m[3][3];
    for (int j = 0; j < 3; j++)
        if (!(fabs(a->m[3][j]) <= 1e-6 * fabs(w)))
            return false;
    if (w == 0)
        return false;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            a->m[i][j] = i < 3 ? a->m[i][j] / w : j == 3;
    return true;
}

struct affine affine_from(const struct transform *t) {
    const double(*a)[4] = t->m;
    return (struct affine){
        v3((float)a[0][0], (float)a[1][0], (float)a[2][0]),
        v3((float)a[0][1], (float)a[1][1], (float)a[2][1]),
        v3((float)a[0][2], (float)a[1][2], (float)a[2][2]),
        v3((float)a[0][3], (float)a[1][3], (float)a[2][3]),
    };
}
