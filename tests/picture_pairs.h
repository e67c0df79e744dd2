// SPDX-License-Identifier: Apache-2.0
// The generated pairs of pictures that golden numbers were made for (tests/tool/flip_peer.py makes
// the same ones).
#pragma once

#include <math.h>

#include "image/image.h"

enum { PAIR_WIDTH = 64, PAIR_HEIGHT = 48 };

static inline void make_ldr_pair(struct image *ref, struct image *test) {
    image_init(ref, PAIR_WIDTH, PAIR_HEIGHT, 3);
    image_init(test, PAIR_WIDTH, PAIR_HEIGHT, 3);
    for (int y = 0, i = 0; y < PAIR_HEIGHT; y++)
        for (int x = 0; x < PAIR_WIDTH; x++)
            for (int c = 0; c < 3; c++, i++) {
                const double v = (x * 7 + y * 13 + c * 29) % 64 / 63.0;
                ref->pixels[i] = (float)v;
                test->pixels[i] = (float)((x * y + c) % 5 == 0 ? 1 - v : v);
            }
}

static inline void make_hdr_pair(struct image *ref, struct image *test) {
    make_ldr_pair(ref, test);
    for (int y = 0, i = 0; y < PAIR_HEIGHT; y++)
        for (int x = 0; x < PAIR_WIDTH; x++)
            for (int c = 0; c < 3; c++, i++) {
                const double v = (x * 7 + y * 13 + c * 29) % 64 / 63.0;
                const double hdr = v * v * exp2(x / 8 - 2);
                ref->pixels[i] = (float)hdr;
                test->pixels[i] = (float)(hdr * (1 + ((x + 3 * y) % 7 - 3) / 10.0));
            }
}
