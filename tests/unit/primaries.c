// SPDX-License-Identifier: Apache-2.0
// Conversions between RGB spaces against published matrices, and pictures that say their space.
#include "check.h"
#include "image/primaries.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void check_matrix(enum image_space from, enum image_space to, const double expected[3][3],
                         double tolerance) {
    double m[3][3];
    CHECK(primaries_matrix(&image_spaces[from], &image_spaces[to], m));
    for (int i = 0; i < 9; i++)
        CHECK_NEAR(m[i / 3][i % 3], expected[i / 3][i % 3], tolerance);
}

int main(void) {
    // ITU-R BT.2087-0, M2; and the ACES 1.0 utilities (colour-science gives the same, Bradford).
    static const double to_2020[3][3] = {
        {0.6274, 0.3293, 0.0433}, {0.0691, 0.9195, 0.0114}, {0.0164, 0.0880, 0.8956}};
    static const double to_ap1[3][3] = {{0.6130974, 0.3395231, 0.0473795},
                                        {0.0701937, 0.9163540, 0.0134524},
                                        {0.0206156, 0.1095698, 0.8698146}};
    check_matrix(SPACE_REC709, SPACE_REC2020, to_2020, 1e-4);
    check_matrix(SPACE_REC709, SPACE_ACESCG, to_ap1, 3e-5);
    struct image im, back, rgb;
    char path[] = "/tmp/relume-primaries-XXXXXX";
    const int file = mkstemp(path);
    CHECK(image_init(&im, 2, 1, 3));
    const float values[6] = {0.25f, 0.5f, 1, 1, 1, 1};
    memcpy(im.pixels, values, sizeof values);
    image_from_rec709(&im, SPACE_ACESCG);
    for (int c = 0; c < 3; c++)
        CHECK_NEAR(im.pixels[3 + c], 1, 1e-6); // white stays white
    CHECK_NEAR(im.pixels[0], 0.6130974 * 0.25 + 0.3395231 * 0.5 + 0.0473795, 1e-4);
    CHECK(image_write_exr(path, &im, NULL) && image_read(path, &back));
    CHECK(image_to_rgb(&back, &rgb));
    for (int c = 0; c < 6; c++)
        CHECK_NEAR(rgb.pixels[c], values[c], 2e-6);
    image_finish(&im);
    image_finish(&back);
    image_finish(&rgb);
    close(file);
    unlink(path);
    return check_result();
}
