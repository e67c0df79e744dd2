// SPDX-License-Identifier: Apache-2.0
// FLIP against numbers of the authors' flip-evaluator 1.7 (printed by tests/tool/flip_peer.py), and
// what it must do whatever its constants are.
#include "check.h"

#include <string.h>

#include "image/flip.h"
#include "picture_pairs.h"

static void means_are_those_of_flip_evaluator(void) {
    struct image ref, test;
    make_ldr_pair(&ref, &test);
    CHECK_NEAR(flip_ldr(&ref, &test, FLIP_PIXELS_PER_DEGREE, 1, NULL), 0.32642583512, 1e-5);
    image_finish(&ref);
    image_finish(&test);
    make_hdr_pair(&ref, &test);
    const struct flip_exposures e = flip_find_exposures(&ref);
    CHECK_NEAR(e.start, -3.579150915, 1e-5);
    CHECK_NEAR(e.stop, 1.408918738, 1e-5);
    CHECK(e.count == 5);
    CHECK_NEAR(flip_hdr(&ref, &test, &e, FLIP_PIXELS_PER_DEGREE, 2, NULL), 0.08675953372, 1e-5);
    image_finish(&ref);
    image_finish(&test);
}

static void equal_pictures_differ_by_nothing(void) {
    struct image ref, test;
    make_hdr_pair(&ref, &test);
    const struct flip_exposures e = flip_find_exposures(&ref);
    CHECK(flip_ldr(&ref, &ref, FLIP_PIXELS_PER_DEGREE, 2, NULL) == 0);
    CHECK(flip_hdr(&ref, &ref, &e, FLIP_PIXELS_PER_DEGREE, 2, NULL) == 0);
    image_finish(&ref);
    image_finish(&test);
}

static void threads_do_not_change_bits(void) {
    struct image ref, test, one, five;
    make_ldr_pair(&ref, &test);
    const double a = flip_ldr(&ref, &test, FLIP_PIXELS_PER_DEGREE, 1, &one);
    const double b = flip_ldr(&ref, &test, FLIP_PIXELS_PER_DEGREE, 5, &five);
    CHECK(a == b);
    CHECK(memcmp(one.pixels, five.pixels, PAIR_WIDTH * PAIR_HEIGHT * sizeof(float)) == 0);
    image_finish(&ref);
    image_finish(&test);
    image_finish(&one);
    image_finish(&five);
}

// The largest difference there is, green against blue, is 1 by construction; black against white
// is a difference of lightness alone.
static void flat_pictures_have_known_differences(int width, int height) {
    static const float colours[][2][3] = {{{0, 1, 0}, {0, 0, 1}}, {{0, 0, 0}, {1, 1, 1}}};
    static const double expected[] = {1, 0.9664}; // .95 + .05 (100^.7 - .4 m) / (.6 m), m = 41.21
    for (int k = 0; k < 2; k++) {
        struct image pictures[2];
        for (int i = 0; i < 2; i++) {
            CHECK(image_init(&pictures[i], width, height, 3));
            for (int p = 0; p < width * height; p++)
                memcpy(pictures[i].pixels + 3 * p, colours[k][i], sizeof colours[k][i]);
        }
        const double v = flip_ldr(&pictures[0], &pictures[1], FLIP_PIXELS_PER_DEGREE, 1, NULL);
        CHECK_NEAR(v, expected[k], 1e-3);
        image_finish(&pictures[0]);
        image_finish(&pictures[1]);
    }
}

static void odd_values_give_numbers(void) {
    static const float odd[] = {NAN, INFINITY, -INFINITY, -1, 0, 1e30f, 1e-40f, 3.4e38f};
    struct image ref, test;
    make_hdr_pair(&ref, &test);
    for (int i = 0; i < 3 * PAIR_WIDTH * PAIR_HEIGHT; i++) {
        ref.pixels[i] = i % 11 == 0 ? odd[i / 11 % 8] : ref.pixels[i];
        test.pixels[i] = i % 7 == 0 ? odd[i / 7 % 8] : test.pixels[i];
    }
    const struct flip_exposures e = flip_find_exposures(&ref);
    const double hdr = flip_hdr(&ref, &test, &e, FLIP_PIXELS_PER_DEGREE, 2, NULL);
    const double ldr = flip_ldr(&ref, &test, 3700, 2, NULL);
    CHECK(hdr > 0 && hdr <= 1 && ldr > 0 && ldr <= 1);
    memset(ref.pixels, 0, 3 * PAIR_WIDTH * PAIR_HEIGHT * sizeof(float)); // a black reference
    const struct flip_exposures black = flip_find_exposures(&ref);
    const double v = flip_hdr(&ref, &test, &black, FLIP_PIXELS_PER_DEGREE, 2, NULL);
    CHECK(black.count == 2 && v > 0 && v <= 1);
    image_finish(&ref);
    image_finish(&test);
}

static void magma_goes_from_black_to_pale_yellow(void) {
    float rgb[3];
    flip_magma(0, rgb);
    CHECK(rgb[0] < 0.02f && rgb[1] < 0.02f && rgb[2] < 0.03f);
    flip_magma(0.5f, rgb); // matplotlib's magma(128): 0.7164 0.2150 0.4753
    CHECK_NEAR(rgb[0], 0.7164, 0.02);
    CHECK_NEAR(rgb[1], 0.2150, 0.02);
    CHECK_NEAR(rgb[2], 0.4753, 0.02);
    flip_magma(1, rgb); // 0.9871 0.9914 0.7495
    CHECK_NEAR(rgb[0], 0.9871, 0.02);
    CHECK_NEAR(rgb[2], 0.7495, 0.02);
}

int main(void) {
    means_are_those_of_flip_evaluator();
    equal_pictures_differ_by_nothing();
    threads_do_not_change_bits();
    flat_pictures_have_known_differences(1, 1);
    flat_pictures_have_known_differences(3, 40);
    odd_values_give_numbers();
    magma_goes_from_black_to_pale_yellow();
    return check_result();
}
