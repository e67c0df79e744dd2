// SPDX-License-Identifier: Apache-2.0
// Every sampler of the registry:
//
//  - numbers in [0, 1); uniform in every dimension and in pairs of dimensions, over seeds
//    (chi-square);
//  - the mean of a discontinuous integrand is unbiased for any sample count, 1 and primes included
//    (z-tests over many seeds);
//  - replicates and dimensions are uncorrelated, pixels differ;
//  - every aligned block of 2^k Sobol points of every 2-D draw is a (0,2)-net (which is what makes a
//    sequence progressive multi-jittered), and so are those that zsobol deals to an aligned square
//    of pixels, whose mean is therefore better than that of pixels on their own;
//  - any 2^k lattice points from a multiple of 2^k on are one in each of 2^k intervals;
//  - an error against the number of samples, printed.
// All statistical tests together raise a false alarm with probability 1 % (Sidak), once per choice
// of seeds.
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "check.h"
#include "sampler/sampler.h"
#include "statistics.h"

enum { MOST_TESTS = 4096 };

static const double FALSE_ALARMS = 0.01;
static double tested[MOST_TESTS];
static char tested_name[MOST_TESTS][96];
static int tested_count;

static void add_p_value(const struct sampler_type *type, const char *what, int a, int b, double p) {
    snprintf(tested_name[tested_count], sizeof tested_name[0], "%s: %s %d %d", type->entry.name,
             what, a, b);
    tested[tested_count++] = p;
}

// Number `dimension` of the sample, where every third draw is a pair.
static float number(const struct sampler_type *type, uint32_t pixel, uint32_t sample, uint32_t spp,
                    uint32_t replicates, int dimension) {
    struct sampler s = sampler_start(type, pixel, 3, sample, spp, replicates, 1);
    for (;;) {
        for (int i = 0; i < 2; i++) {
            const float u = sampler_1d(&s);
            if (dimension-- == 0)
                return u;
        }
        const struct vec2 v = sampler_2d(&s);
        if (dimension-- == 0)
            return v.x;
        if (dimension-- == 0)
            return v.y;
    }
}

// One point of every pixel, so that the samples are independent whatever the sampler.
static void check_uniform(const struct sampler_type *type, uint32_t sample, uint32_t spp) {
    enum { DIMENSIONS = 8, BINS = 16, PIXELS = 40000 };
    static float u[PIXELS][DIMENSIONS];
    for (uint32_t p = 0; p < PIXELS; p++)
        for (int d = 0; d < DIMENSIONS; d++) {
            u[p][d] = number(type, p, sample, spp, 1, d);
            CHECK(u[p][d] >= 0 && u[p][d] < 1);
        }
    for (int a = 0; a < DIMENSIONS; a++)
        for (int b = a; b < DIMENSIONS; b++) {
            int count[BINS * BINS] = {0};
            for (int p = 0; p < PIXELS; p++) {
                const int y = a == b ? (int)(u[p][a] * BINS * BINS) % BINS : (int)(u[p][b] * BINS);
                count[(int)(u[p][a] * BINS) * BINS + y]++;
            }
            struct chi2_bins bins = {0};
            for (int i = 0; i < BINS * BINS; i++)
                chi2_add(&bins, count[i], PIXELS / (double)(BINS * BINS));
            add_p_value(type, "uniform", a, b, chi2_finish(&bins));
        }
}

// 1 inside a disk that is off the grid of any stratification: area known, edge discontinuous.
static double disk_mean(const struct sampler_type *type, uint32_t pixel, uint32_t spp,
                        uint32_t replicates) {
    int inside = 0;
    for (uint32_t i = 0; i < spp; i++) {
        struct sampler s = sampler_start(type, pixel, 9, i, spp, replicates, 2);
        sampler_1d(&s);
        const struct vec2 v = sampler_2d(&s);
        const float x = v.x - 0.45f, y = v.y - 0.53f;
        inside += x * x + y * y < 0.14f;
    }
    return inside / (double)spp;
}

static void check_unbiased(const struct sampler_type *type) {
    static const uint32_t counts[] = {1, 2, 3, 5, 7, 11, 13, 16, 17, 31, 64, 97, 100, 256};
    const double area = M_PI * (double)0.14f;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        const int pixels = counts[k] < 64 ? 20000 : 4000;
        double sum = 0, sum2 = 0;
        for (int p = 0; p < pixels; p++) {
            const double m = disk_mean(type, (uint32_t)p, counts[k], 1);
            sum += m / pixels;
            sum2 += m * m / pixels;
        }
        const double error = sqrt(fmax(sum2 - sum * sum, 0) / pixels);
        add_p_value(type, "unbiased mean of", (int)counts[k], 0, normal_p_value((sum - area) / error));
    }
}

// Correlation of the errors of two replicates over pixels; of a number and the next dimension's.
static void check_replicates(const struct sampler_type *type) {
    enum { PIXELS = 4000, SPP = 64 };
    const double area = M_PI * (double)0.14f;
    double ab = 0, aa = 0, bb = 0;
    for (uint32_t p = 0; p < PIXELS; p++) {
        double mean[2] = {0, 0};
        for (uint32_t i = 0; i < SPP; i++) {
            if (i % 16 > 1)
                continue;
            struct sampler s = sampler_start(type, p, 4, i, SPP, 16, 3);
            const struct vec2 v = sampler_2d(&s);
            const float x = v.x - 0.45f, y = v.y - 0.53f;
            mean[i % 16] += (x * x + y * y < 0.14f) / (SPP / 16.0);
        }
        ab += (mean[0] - area) * (mean[1] - area);
        aa += (mean[0] - area) * (mean[0] - area);
        bb += (mean[1] - area) * (mean[1] - area);
    }
    add_p_value(type, "replicates uncorrelated", 0, 1,
                normal_p_value(ab / sqrt(aa * bb) * sqrt(PIXELS)));
}

static void print_convergence(const struct sampler_type *type) {
    printf("%-12s rms error of a disk's area:", type->entry.name);
    double last = 0;
    for (uint32_t spp = 1; spp <= 4096; spp *= 8) {
        const double area = M_PI * (double)0.14f;
        double sum = 0;
        for (uint32_t p = 0; p < 64; p++)
            sum += pow(disk_mean(type, p, spp, 1) - area, 2) / 64;
        printf("  %u: %.2e", spp, sqrt(sum));
        last = sqrt(sum);
    }
    printf("\n");
    // The independent sampler's error at 4096 is 0.0078 (sqrt of a (1 - a) / n).
    CHECK(type->independent ? fabs(last / 0.00776 - 1) < 0.35 : last < 0.004);
}

static void check_ranges(const struct sampler_type *type) {
    for (uint32_t spp = 1; spp < 70; spp++)
        for (uint32_t i = 0; i < spp + 3; i++) { // a few more than were announced
            struct sampler s = sampler_start(type, 7, 8, i, spp, 1, 0);
            for (int d = 0; d < 20; d++) {
                const float u = sampler_1d(&s);
                const struct vec2 v = sampler_2d(&s);
                CHECK(u >= 0 && u < 1 && v.x >= 0 && v.x < 1 && v.y >= 0 && v.y < 1);
            }
        }
}

// Every elementary interval of area 2^-k holds one of 2^k points.
static void check_is_net(const struct vec2 *points, int k) {
    const uint32_t n = 1u << k;
    unsigned char *hit = malloc(n);
    for (int kx = 0; kx <= k; kx++) {
        memset(hit, 0, n);
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t x = (uint32_t)(points[i].x * (float)(1u << kx));
            const uint32_t y = (uint32_t)(points[i].y * (float)(1u << (k - kx)));
            hit[(x << (k - kx)) + y]++;
        }
        for (uint32_t i = 0; i < n; i++)
            CHECK(hit[i] == 1);
    }
    free(hit);
}

static struct vec2 draw_of(const struct sampler_type *type, uint32_t x, uint32_t y, uint32_t sample,
                           uint32_t spp, int draw) {
    struct sampler s = sampler_start(type, x, y, sample, spp, 1, 7);
    for (int d = 0; d < draw; d++)
        sampler_2d(&s);
    return sampler_2d(&s);
}

// The block of 2^k points that has this number.
static void check_net(int k, int draw, uint32_t block) {
    const uint32_t n = 1u << k;
    struct vec2 *points = malloc(n * sizeof *points);
    for (uint32_t i = 0; i < n; i++)
        points[i] = draw_of(&sampler_sobol, 5, 6, block * n + i, n, draw);
    check_is_net(points, k);
    free(points);
}

// All samples of the square of 2^n x 2^n pixels with this place, for 2^k samples a pixel.
static void check_shared_net(int n, int k, int draw, uint32_t column, uint32_t row) {
    const uint32_t side = 1u << n, spp = 1u << k;
    struct vec2 *points = malloc(sizeof *points * side * side * spp), *p = points;
    for (uint32_t i = 0; i < side * side * spp; i++)
        *p++ = draw_of(&sampler_zsobol, column * side + i / spp % side, row * side + i / spp / side,
                       i % spp, spp, draw);
    check_is_net(points, 2 * n + k);
    free(points);
}

// Mean squared error of a square of 4x4 pixels over a sixteenth of a pixel's: 1 where pixels err
// independently. The figure's own error is some 6 %.
static double shared_error(const struct sampler_type *type, uint32_t spp) {
    enum { SIDE = 4, SQUARES = 600 };
    const double area = M_PI * (double)0.14f;
    double squares = 0, pixels = 0;
    for (uint32_t q = 0; q < SQUARES; q++) {
        double sum = 0;
        for (uint32_t i = 0; i < SIDE * SIDE; i++) {
            int inside = 0;
            for (uint32_t k = 0; k < spp; k++) {
                const struct vec2 v = draw_of(type, q * SIDE + i % SIDE, i / SIDE, k, spp, 1);
                const float x = v.x - 0.45f, y = v.y - 0.53f;
                inside += x * x + y * y < 0.14f;
            }
            const double error = inside / (double)spp - area;
            pixels += error * error / (SQUARES * SIDE * SIDE);
            sum += error / (SIDE * SIDE);
        }
        squares += sum * sum / SQUARES;
    }
    return squares / (pixels / (SIDE * SIDE));
}

static void check_shared_error(uint32_t spp) {
    const double alone = shared_error(&sampler_sobol, spp), z = shared_error(&sampler_zsobol, spp);
    printf("%u samples: squared error of 4x4 pixels, 1 where they err independently: sobol %.2f, "
           "zsobol %.2f\n", spp, alone, z);
    CHECK(fabs(alone - 1) < 0.35 && z < 0.75); // a net of 16 points alone has 0.5 of their error
}

static void check_lattice(int k, int draw, uint32_t block) {
    const uint32_t n = 1u << k;
    unsigned char *hit = calloc(n, 2);
    for (uint32_t i = 0; i < n; i++) {
        const struct vec2 v = draw_of(&sampler_lattice, 5, 6, block * n + i, n, draw);
        const struct vec2 from = draw_of(&sampler_lattice, 5, 6, block * n, n, draw);
        const float x = v.x - from.x, y = v.y - from.y; // multiples of 1/n, but for rounding
        hit[2 * ((uint32_t)lrintf((x < 0 ? x + 1 : x) * (float)n) % n)]++;
        hit[2 * ((uint32_t)lrintf((y < 0 ? y + 1 : y) * (float)n) % n) + 1]++;
    }
    for (uint32_t i = 0; i < 2 * n; i++)
        CHECK(hit[i] == 1);
    free(hit);
}

// Multi-jittered points are one in each row, column and cell; stratified ones one in each cell.
static void check_strata(const struct sampler_type *type, uint32_t m) {
    const uint32_t n = m * m;
    int cell[256] = {0}, row[256] = {0}, column[256] = {0};
    for (uint32_t i = 0; i < n; i++) {
        struct sampler s = sampler_start(type, 5, 6, i, n, 1, 7);
        const struct vec2 v = sampler_2d(&s);
        cell[(int)(v.x * (float)m) * (int)m + (int)(v.y * (float)m)]++;
        row[(int)(v.x * (float)n)]++;
        column[(int)(v.y * (float)n)]++;
    }
    for (uint32_t i = 0; i < n; i++)
        CHECK(cell[i] == 1 && (type == &sampler_stratified || (row[i] == 1 && column[i] == 1)));
}

static void print_speed(const struct sampler_type *type) {
    enum { DRAWS = 4000000 };
    float sum = 0;
    const clock_t start = clock();
    for (uint32_t i = 0; i < DRAWS / 8; i++) {
        struct sampler s = sampler_start(type, i & 255, i >> 8, i & 63, 64, 1, 0);
        for (int d = 0; d < 8; d++)
            sum += sampler_2d(&s).x;
    }
    const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    printf("%-12s %.1f ns a 2-D draw (mean %.4f)\n", type->entry.name, seconds / DRAWS * 1e9,
           (double)sum / DRAWS);
}

int main(void) {
    for (const struct entry *const *e = samplers.entries; *e; e++) {
        const struct sampler_type *type = (const struct sampler_type *)(const void *)*e;
        check_ranges(type);
        check_uniform(type, 0, 1);
        check_uniform(type, 3, 13);
        check_unbiased(type);
        check_replicates(type);
        print_convergence(type);
        print_speed(type);
    }
    for (int k = 0; k <= 12; k++)
        for (int draw = 0; draw < 4; draw++) {
            check_net(k, draw, (uint32_t)draw);
            check_lattice(k, draw * 21, (uint32_t)draw);
        }
    for (int k = 0; k <= 4; k++)
        for (int n = 0; n <= 3; n++)
            check_shared_net(n, k, k, 3, 1);
    check_shared_error(1);
    check_shared_error(4);
    for (uint32_t m = 1; m <= 16; m++) {
        check_strata(&sampler_stratified, m);
        check_strata(&sampler_multijitter, m);
    }
    const double least = sidak(FALSE_ALARMS, tested_count);
    double smallest = 1;
    for (int i = 0; i < tested_count; i++) {
        if (tested[i] < least)
            printf("%s: p = %.3g, expected at least %.3g\n", tested_name[i], tested[i], least);
        CHECK(tested[i] >= least);
        smallest = fmin(smallest, tested[i]);
    }
    printf("%d tests, smallest p %.3g, threshold %.3g\n", tested_count, smallest, least);
    return check_result();
}
