// SPDX-License-Identifier: Apache-2.0
// Numbers and units on a picture.
//
// A table of dots: OpenImageIO's own text needs a font file, which a machine that renders often lacks.
#pragma once

#include "image/image.h"

enum { LETTERING_WIDTH = 8, LETTERING_HEIGHT = 10 }; // pixels of a character with its gap; of a line

// Characters 0123456789.-+/ and those of the units W, M, k, m, e, s, r, l, u, x, c, d; others are gaps.
// (x, y) is the upper left corner; what lies outside the picture is left out. The picture has three
// channels.
void lettering_draw(struct image *im, int x, int y, const char *text, const float colour[3]);
