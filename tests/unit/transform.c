// SPDX-License-Identifier: Apache-2.0
#include "check.h"
#include "math/transform.h"

static void rotation_by_quarter_turns_is_exact(void) {
    const double z[3] = {0, 0, 1}, x[3] = {1, 0, 0};
    double y[3];
    const struct transform r = transform_rotate(z, 90);
    transform_vector(&r, x, y);
    CHECK(y[0] == 0 && y[1] == 1 && y[2] == 0);
    const struct transform back = transform_rotate(z, -90);
    transform_vector(&back, x, y);
    CHECK(y[0] == 0 && y[1] == -1 && y[2] == 0);
}

static void inverse_times_transform_is_identity(void) {
    const double axis[3] = {1, 2, 3};
    struct transform a = transform_rotate(axis, 37), scale = transform_scale(2, -3, 0.5), inverse;
    a = transform_multiply(&a, &scale);
    CHECK(transform_invert(&a, &inverse));
    const struct transform one = transform_multiply(&a, &inverse);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            CHECK_NEAR(one.m[i][j], i == j, 1e-14);
    const struct transform flat = transform_scale(1, 0, 1);
    CHECK(!transform_invert(&flat, &inverse));
}

static void look_at_maps_z_to_the_target(void) {
    const double o[3] = {1, 2, 3}, t[3] = {1, 2, 8}, up[3] = {0, 1, 0}, z[3] = {0, 0, 5};
    struct transform m;
    double p[3];
    CHECK(transform_look_at(o, t, up, &m));
    transform_point(&m, z, p);
    CHECK(p[0] == 1 && p[1] == 2 && p[2] == 8);
    CHECK(!transform_look_at(o, o, up, &m));
}

int main(void) {
    rotation_by_quarter_turns_is_exact();
    inverse_times_transform_is_identity();
    look_at_maps_z_to_the_target();
    return check_result();
}
