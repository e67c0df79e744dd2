// SPDX-License-Identifier: Apache-2.0
#include "math/repeats.h"

#include <math.h>
#include <stdbool.h>

#include "math/student.h"

static struct measured with_error(double value, double variance, double reference_error, int runs) {
    struct measured m = {value, NAN, -INFINITY, INFINITY};
    if (runs >= 3) {
        m.error = sqrt(fmax(variance, 0) + reference_error * reference_error);
        m.low = value - student_95(runs - 1) * m.error;
        m.high = value + student_95(runs - 1) * m.error;
    }
    return m;
}

struct pairs {
    const double *gram;
    int runs;
    bool differences; // h_ij = |a_i - a_j|^2 / 2, else (a_i - r)(a_j - r)
};

static double pair(const struct pairs *p, int i, int j) {
    const double *g = p->gram;
    const int n = p->runs;
    return p->differences ? 0.5 * (g[i * n + i] + g[j * n + j] - 2 * g[i * n + j]) : g[i * n + j];
}

// Mean over pairs i < j of h_ij = theta + A_i + A_j + E_ij (Hoeffding's decomposition, all parts
// uncorrelated), and its variance 4 var A / n + 2 var E / (n (n - 1)). With row sums R_i, expectations
// are, of sum (R_i - mean R)^2, (n-1)(n-2) var E + (n-1)(n-2)^2 var A, and of the squares that are
// left when the A_i are fitted, n (n-3) / 2 var E. With n = 3 nothing is left, and all of it counts
// as var A, which is the larger.
static double mean_of_pairs(const struct pairs *p, double *variance) {
    const int n = p->runs;
    const double count = 0.5 * n * (n - 1);
    double sum = 0, squares = 0, rows = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            sum += pair(p, i, j);
    const double mean = sum / count;
    for (int i = 0; i < n; i++) {
        double row = 0;
        for (int j = 0; j < n; j++) {
            const double d = i == j ? 0 : pair(p, i, j) - mean;
            row += d;
            squares += 0.5 * d * d;
        }
        rows += row * row;
    }
    const double var_e = n > 3 ? fmax(squares - rows / (n - 2), 0) / (0.5 * n * (n - 3)) : 0;
    const double var_a = n > 2 ? (rows / ((n - 1.0) * (n - 2)) - var_e) / (n - 2) : 0;
    *variance = 4 * fmax(var_a, 0) / n + 2 * var_e / (n * (n - 1.0));
    return mean;
}

struct repeats repeats_measure(const double *gram, int runs, double reference_noise,
                               double reference_error) {
    struct repeats out;
    double mean = 0, squares = 0, variance;
    for (int i = 0; i < runs; i++)
        mean += gram[i * runs + i] / runs;
    for (int i = 0; i < runs; i++)
        squares += (gram[i * runs + i] - mean) * (gram[i * runs + i] - mean);
    out.mse = with_error(mean - reference_noise, squares / (runs * (runs - 1.0)), reference_error,
                         runs);
    const struct pairs products = {gram, runs, false}, differences = {gram, runs, true};
    const double bias2 = mean_of_pairs(&products, &variance);
    out.bias2 = with_error(bias2 - reference_noise, variance, reference_error, runs);
    const double spread = mean_of_pairs(&differences, &variance);
    out.variance = with_error(spread, variance, 0, runs);
    return out;
}
