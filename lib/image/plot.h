// SPDX-License-Identifier: Apache-2.0
// Plots with two logarithmic axes, as SVG: points with intervals, power laws, a front, a legend.
//
// A pure function of its data. What is not positive and finite is not drawn. The text stands alone as
// a file, and in a page.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct plot_point {
    double x, y;
    double low, high; // interval of y; low <= 0 reaches the axis; NaN: none
    bool marked;      // on the front: ringed, and joined to its neighbours there
    const char *tip;  // shown when the mouse rests on it; or NULL
};

struct plot_series {
    const char *name; // in the legend
    const struct plot_point *points;
    size_t count;
    bool fitted;              // draw y = 10^intercept x^slope over the points
    double slope, intercept;
};

struct plot {
    const char *title, *x_label, *y_label;
    const struct plot_series *series;
    size_t series_count;
    const double *x_ticks;  // where to label the x axis; NULL: at round numbers
    size_t x_tick_count;
    double rule;            // a horizontal line there; 0: none
    const char *rule_label;
    int width, height;      // of the whole picture, legend included
};

void plot_svg(const struct plot *p, FILE *out);

// Text with &, <, > and quotes as SVG and HTML want them.
void plot_escape(const char *text, FILE *out);
