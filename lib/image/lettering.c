// SPDX-License-Identifier: Apache-2.0
#include "image/lettering.h"

#include <string.h>

enum { COLUMNS = 3, ROWS = 5, SCALE = 2 };

static const char known[] = "0123456789.-+/WMkmesrluxcd";
// A row three bits, the upper one first.
static const unsigned glyphs[] = {
    075557, 026227, 071747, 071717, 055711, 074717, 074757, 071111, 075757, 075717, // digits
    000002, 000700, 002720, 011244, 055575, 057755, 045655, 007755, 007747, 034216, // .-+/WMkmes
    007444, 022223, 005557, 005225, 007447, 011757,                                 // rluxcd
};
_Static_assert(sizeof glyphs / sizeof *glyphs == sizeof known - 1, "a glyph is missing");

static void draw_glyph(struct image *im, int left, int top, unsigned glyph, const float colour[3]) {
    for (int y = 0; y < ROWS * SCALE; y++)
        for (int x = 0; x < COLUMNS * SCALE; x++) {
            const int bit = COLUMNS * ROWS - 1 - COLUMNS * (y / SCALE) - x / SCALE;
            const int px = left + x, py = top + y;
            if (glyph >> bit & 1 && px >= 0 && py >= 0 && px < im->width && py < im->height)
                memcpy(im->pixels + 3 * ((size_t)py * (size_t)im->width + (size_t)px), colour,
                       3 * sizeof *colour);
        }
}

void lettering_draw(struct image *im, int x, int y, const char *text, const float colour[3]) {
    for (; *text; text++, x += LETTERING_WIDTH) {
        const char *at = strchr(known, *text);
        if (at)
            draw_glyph(im, x, y, glyphs[at - known], colour);
    }
}
