// SPDX-License-Identifier: Apache-2.0
// Line drawings: lines and labels in a coordinate system of their own, as SVG, or as PNG (whose
// labels are digits only).
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct chart_line {
    float *points; // x, y
    size_t count, capacity;
    unsigned colour; // 0xrrggbb
    float width;
};

struct chart_label {
    float x, y;
    char text[32];
};

// Coordinates in pixels, y downwards.
struct chart {
    int width, height;
    struct chart_line *lines; // owned
    size_t line_count, line_capacity;
    struct chart_label *labels; // owned
    size_t label_count, label_capacity;
};

void chart_begin_line(struct chart *c, unsigned colour, float width);
void chart_add_point(struct chart *c, double x, double y); // to the line begun last
void chart_add_label(struct chart *c, double x, double y, const char *text);
// By the extension of the path; atomic. false after an error message.
bool chart_write(const struct chart *c, const char *path);
void chart_finish(struct chart *c);
