// SPDX-License-Identifier: Apache-2.0
// The nine harmonics of an environment, as `relume relight` projects it, against sums written out, and
// those of Grace Cathedral against the published ones (Ramamoorthi and Hanrahan, "An Efficient
// Representation for Irradiance Environment Maps", 2001, figure 2).
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "image/image.h"
#include "math/vec.h"
#include "replay/relight.h"

enum { TERMS = 9 };

// Of the published ones, "light probe" axes; ours have x the other way round, and another exposure.
static const double published[TERMS][3] = {
    {0.79, 0.44, 0.54},    {0.39, 0.35, 0.60},    {-0.34, -0.18, -0.27},
    {-0.29, -0.06, 0.01},  {-0.11, -0.05, -0.12}, {-0.26, -0.22, -0.47},
    {-0.16, -0.09, -0.15}, {0.56, 0.21, 0.14},    {0.21, -0.05, -0.30}};
static const int mirrored[TERMS] = {0, 0, 0, 1, 1, 0, 0, 1, 0}; // odd in x
static const double EXPOSURE = 6.4;

// Y_lm of the paper's equation 3: constants times 1, y, z, x, xy, yz, 3zz - 1, xz, xx - yy.
static void polynomials(double x, double y, double z, double out[TERMS]) {
    const double Y[TERMS] = {0.5, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y};
    for (int i = 0; i < TERMS; i++) {
        const double k = i == 0 ? 1 : i < 4 ? 3.0 / 4 : i == 6 ? 5.0 / 16 : i == 8 ? 15.0 / 16 : 15.0 / 4;
        out[i] = Y[i] * sqrt(k / M_PI);
    }
}

// Midpoints of texels, where the program takes their exact solid angles: off by (pi / height)^2 / 24 of
// what is summed. Row 0 at +y, the middle column at +z, +x to the left of it.
static void sum_up(const struct image *im, double out[TERMS][3]) {
    for (int row = 0; row < im->height; row++)
        for (int column = 0; column < im->width; column++) {
            const double theta = (row + 0.5) * M_PI / im->height;
            const double phi = (column + 0.5) * 2 * M_PI / im->width - M_PI;
            const double area = sin(theta) * M_PI / im->height * 2 * M_PI / im->width;
            const float *rgb = im->pixels + 3 * (row * im->width + column);
            double Y[TERMS];
            polynomials(-sin(phi) * sin(theta), cos(theta), cos(phi) * sin(theta), Y);
            for (int i = 0; i < TERMS; i++)
                for (int k = 0; k < 3; k++)
                    out[i][k] += Y[i] * area * (double)rgb[k];
        }
}

static void project(const char *path, float weights[TERMS][3]) {
    struct json *meta = json_new_object(), *basis = json_add_object(meta, "basis");
    json_add_text(basis, "type", "sh");
    json_add_count(basis, "order", 2);
    struct tensor_block block = {.coefficients = TERMS};
    const struct tensor t = {.meta = meta, .block_count = 1, .blocks = &block};
    const struct relight_lighting l = {.environment = path};
    CHECK(relight_weights(&t, "test", &l, &weights[0][0]));
    json_destroy(meta);
}

static void agrees_with_sums(const char *path, double expected[TERMS][3]) {
    float weights[TERMS][3];
    struct image file, rgb;
    double worst = 0;
    CHECK(image_read(path, &file) && image_to_rgb(&file, &rgb));
    memset(expected, 0, TERMS * sizeof *expected);
    sum_up(&rgb, expected);
    project(path, weights);
    for (int i = 0; i < TERMS; i++)
        for (int k = 0; k < 3; k++)
            worst = fmax(worst, fabs((double)weights[i][k] - expected[i][k]));
    worst /= expected[0][1];
    printf("%s: off by %.1e of its mean\n", path, worst);
    CHECK(worst < pow(M_PI / rgb.height, 2) / 12);
    image_finish(&file);
    image_finish(&rgb);
}

int main(int argc, char **argv) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    double sums[TERMS][3], worst = 0;
    char path[4096];
    CHECK(argc == 2);
    agrees_with_sums(argv[argc - 1], sums);
    snprintf(path, sizeof path, "%s/env/debevec/grace_probe_latlong.hdr", shared ? shared : "");
    if (!shared)
        return check_result();
    agrees_with_sums(path, sums);
    for (int i = 0; i < TERMS; i++)
        for (int k = 0; k < 3; k++)
            worst = fmax(worst, fabs((mirrored[i] ? -1 : 1) * sums[i][k] / EXPOSURE - published[i][k]));
    printf("by %.4f from the published two digits\n", worst);
    CHECK(worst < 0.01);
    return check_result();
}
