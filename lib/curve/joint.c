// SPDX-License-Identifier: Apache-2.0
#include "curve/joint.h"

struct joint {
    double *share;
    size_t step[2]; // to the next row, column
    uint32_t count[2];
};

static double sum_of_line(const struct joint *j, uint32_t axis, uint32_t i) {
    double sum = 0;
    for (uint32_t k = 0; k < j->count[1 - axis]; k++)
        sum += j->share[i * j->step[axis] + k * j->step[1 - axis]];
    return sum;
}

static void scale_down(const struct joint *j, uint32_t axis, const double *wanted) {
    for (uint32_t i = 0; i < j->count[axis]; i++) {
        const double found = sum_of_line(j, axis, i), most = wanted[i] > 0 ? wanted[i] : 0;
        for (uint32_t k = 0; k < j->count[1 - axis] && found > most; k++)
            j->share[i * j->step[axis] + k * j->step[1 - axis]] *= most / found;
    }
}

// What lines miss, or, where nothing is wanted of them, what they have. Its sum.
static double find_missing(const struct joint *j, uint32_t axis, const double *wanted, double *missing) {
    double sum = 0;
    for (uint32_t i = 0; i < j->count[axis]; i++) {
        const double found = sum_of_line(j, axis, i);
        missing[i] = !wanted ? found : wanted[i] > found ? wanted[i] - found : 0;
        sum += missing[i];
    }
    return sum;
}

void joint_fit(double *share, uint32_t stride, const uint32_t first[2], const uint32_t end[2],
               const double *const sum[2], double *scratch) {
    const struct joint j = {share + (size_t)first[0] * stride + first[1], {stride, 1},
                            {end[0] - first[0], end[1] - first[1]}};
    double *const missing[2] = {scratch, scratch + j.count[0]}, total[2];
    for (uint32_t axis = 0; axis < 2; axis++)
        if (sum[axis])
            scale_down(&j, axis, sum[axis] + first[axis]);
    for (uint32_t axis = 0; axis < 2; axis++)
        total[axis] = find_missing(&j, axis, sum[axis] ? sum[axis] + first[axis] : NULL, missing[axis]);
    // Both totals are the same where both are fitted; the other is a distribution where one is.
    const double all = sum[0] ? total[1] : total[0];
    for (uint32_t i = 0; i < j.count[0] && all > 0; i++)
        for (uint32_t k = 0; k < j.count[1] && (sum[0] || sum[1]); k++)
            j.share[i * stride + k] += missing[0][i] * missing[1][k] / all;
}
