// SPDX-License-Identifier: Apache-2.0
#include "image/plot.h"

#include <math.h>
#include <string.h>

enum { LEFT = 68, RIGHT = 16, TOP = 34, BELOW = 54, LEGEND_LINE = 18, MOST_TICKS = 400 };

// Okabe and Ito 2008: told apart by colour-blind eyes, too. Shapes repeat with another period.
static const char *const palette[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                      "#7a5200", "#56b4e9", "#000000", "#e69f00"};
enum { COLOURS = 8, SHAPES = 5 };

struct axis {
    double low, high;  // log10
    double from, to;   // where they are on the picture
};

static bool shows(double v) {
    return v > 0 && isfinite(v);
}

static double at(const struct axis *a, double log_value) {
    return a->from + (log_value - a->low) / (a->high - a->low) * (a->to - a->from);
}

void plot_escape(const char *text, FILE *out) {
    for (const char *c = text; *c; c++) {
        const char *entity = *c == '&' ? "&amp;" : *c == '<' ? "&lt;" : *c == '>' ? "&gt;"
                           : *c == '"' ? "&quot;" : NULL;
        if (entity)
            fputs(entity, out);
        else
            fputc(*c, out);
    }
}

// ---- axes -----------------------------------------------------------------------------------

static void widen(struct axis *a, double v) {
    if (!shows(v))
        return;
    a->low = fmin(a->low, log10(v));
    a->high = fmax(a->high, log10(v));
}

static void finish_axis(struct axis *a) {
    if (a->low > a->high)
        a->low = a->high = 0;
    const double span = a->high - a->low; // less than a decade would make much of small differences
    const double margin = fmax(fmax(0.06 * span, 0.12), 0.5 * (1 - span));
    a->low -= margin;
    a->high += margin;
}

static void find_axes(const struct plot *p, struct axis *x, struct axis *y) {
    *x = *y = (struct axis){INFINITY, -INFINITY, 0, 0};
    for (size_t s = 0; s < p->series_count; s++)
        for (size_t i = 0; i < p->series[s].count; i++) {
            const struct plot_point *q = &p->series[s].points[i];
            if (!shows(q->x) || !shows(q->y))
                continue;
            widen(x, q->x);
            widen(y, q->y);
            widen(y, fmin(q->high, 10 * q->y));
        }
    widen(y, p->rule);
    finish_axis(x);
    finish_axis(y);
    x->from = LEFT;
    x->to = p->width - RIGHT;
    y->from = p->height - BELOW - LEGEND_LINE * (int)p->series_count;
    y->to = TOP;
}

static void print_value(double v, FILE *out) {
    const int exponent = (int)floor(log10(v) + 1e-9);
    if (exponent >= -3 && exponent < 5)
        fprintf(out, "%.10g", v);
    else
        fprintf(out, "%.0fe%d", v / pow(10, exponent), exponent);
}

static void draw_tick(const struct axis *a, bool is_x, const struct axis *other, double v,
                      bool labelled, FILE *out) {
    const double c = at(a, log10(v));
    const char *colour = labelled ? "#d0d0d0" : "#eeeeee";
    if (is_x)
        fprintf(out, "<path stroke=\"%s\" d=\"M%.1f %.1fV%.1f\"/>", colour, c, other->from, other->to);
    else
        fprintf(out, "<path stroke=\"%s\" d=\"M%.1f %.1fH%.1f\"/>", colour, other->from, c, other->to);
    if (!labelled)
        return;
    if (is_x)
        fprintf(out, "<text text-anchor=\"middle\" x=\"%.1f\" y=\"%.1f\">", c, other->from + 16);
    else
        fprintf(out, "<text text-anchor=\"end\" x=\"%.1f\" y=\"%.1f\">", other->from - 6, c + 4);
    print_value(v, out);
    fprintf(out, "</text>\n");
}

// Lines at 1, 2, ... 9 of each decade. Labels at 1; at 2 and 5, or at all, where decades are few; at
// every second or third decade where they are many.
static void draw_ticks(const struct axis *a, bool is_x, const struct axis *other, FILE *out) {
    const double decades = a->high - a->low;
    const int step = decades > 8 ? (int)(decades / 6) + 1 : 1;
    for (int e = (int)floor(a->low); e <= (int)floor(a->high) && decades < MOST_TICKS; e++)
        for (int m = 1; m <= 9; m++) {
            const double v = m * pow(10, e);
            const bool labelled = (m == 1 && e % step == 0) || (decades < 2 && (m == 2 || m == 5));
            if (log10(v) >= a->low && log10(v) <= a->high && (labelled || m == 1 || decades < 8))
                draw_tick(a, is_x, other, v, labelled, out);
        }
}

// ---- data -----------------------------------------------------------------------------------

static void draw_symbol(size_t series, double x, double y, FILE *out) {
    const char *colour = palette[series % COLOURS];
    switch (series % SHAPES) {
    case 0:
        fprintf(out, "<circle fill=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>", colour, x, y);
        break;
    case 1:
        fprintf(out, "<rect fill=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"7\" height=\"7\"/>", colour,
                x - 3.5, y - 3.5);
        break;
    case 2:
        fprintf(out, "<path fill=\"%s\" d=\"M%.1f %.1fl4.5 8h-9z\"/>", colour, x, y - 5);
        break;
    case 3:
        fprintf(out, "<path fill=\"%s\" d=\"M%.1f %.1fl5 5l-5 5l-5 -5z\"/>", colour, x, y - 5);
        break;
    default:
        fprintf(out, "<path fill=\"%s\" d=\"M%.1f %.1fl4.5 -8h-9z\"/>", colour, x, y + 5);
    }
}

static void draw_interval(const struct axis *y, const struct plot_point *q, double px,
                          size_t series, FILE *out) {
    if (!(q->high > q->low) || !shows(q->high))
        return;
    const double low = q->low > 0 ? fmax(log10(q->low), y->low) : y->low;
    fprintf(out, "<path stroke=\"%s\" d=\"M%.1f %.1fV%.1f\"/>", palette[series % COLOURS], px,
            at(y, low), at(y, fmin(log10(q->high), y->high)));
}

static void draw_points(const struct plot *p, const struct axis *x, const struct axis *y, FILE *out) {
    for (size_t s = 0; s < p->series_count; s++)
        for (size_t i = 0; i < p->series[s].count; i++) {
            const struct plot_point *q = &p->series[s].points[i];
            if (!shows(q->x) || !shows(q->y))
                continue;
            const double px = at(x, log10(q->x)), py = at(y, log10(q->y));
            fprintf(out, "<g>");
            if (q->tip) {
                fprintf(out, "<title>");
                plot_escape(q->tip, out);
                fprintf(out, "</title>");
            }
            draw_interval(y, q, px, s, out);
            draw_symbol(s, px, py, out);
            if (q->marked)
                fprintf(out, "<circle fill=\"none\" stroke=\"#444\" cx=\"%.1f\" cy=\"%.1f\" r=\"8\"/>",
                        px, py);
            fprintf(out, "</g>\n");
        }
}

static void draw_fits(const struct plot *p, const struct axis *x, const struct axis *y, FILE *out) {
    for (size_t s = 0; s < p->series_count; s++) {
        const struct plot_series *l = &p->series[s];
        struct axis range = {INFINITY, -INFINITY, 0, 0};
        for (size_t i = 0; i < l->count; i++)
            widen(&range, l->points[i].x);
        if (l->fitted && range.high > range.low)
            fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" "
                         "d=\"M%.1f %.1fL%.1f %.1f\"/>\n", palette[s % COLOURS], at(x, range.low),
                    at(y, l->intercept + l->slope * range.low), at(x, range.high),
                    at(y, l->intercept + l->slope * range.high));
    }
}

// The next marked point to the right of x, or NULL.
static const struct plot_point *next_marked(const struct plot *p, double x) {
    const struct plot_point *best = NULL;
    for (size_t s = 0; s < p->series_count; s++)
        for (size_t i = 0; i < p->series[s].count; i++) {
            const struct plot_point *q = &p->series[s].points[i];
            if (q->marked && shows(q->x) && shows(q->y) && q->x > x && (!best || q->x < best->x))
                best = q;
        }
    return best;
}

static void draw_front(const struct plot *p, const struct axis *x, const struct axis *y, FILE *out) {
    const struct plot_point *q = next_marked(p, 0);
    if (!q)
        return;
    fprintf(out, "<path fill=\"none\" stroke=\"#888\" stroke-dasharray=\"2 3\" d=\"M%.1f %.1f",
            at(x, log10(q->x)), at(y, log10(q->y)));
    while ((q = next_marked(p, q->x)))
        fprintf(out, "H%.1fV%.1f", at(x, log10(q->x)), at(y, log10(q->y)));
    fprintf(out, "\"/>\n");
}

static void draw_rule(const struct plot *p, const struct axis *x, const struct axis *y, FILE *out) {
    if (!shows(p->rule))
        return;
    const double c = at(y, log10(p->rule));
    fprintf(out, "<path stroke=\"#b00020\" stroke-dasharray=\"6 4\" d=\"M%.1f %.1fH%.1f\"/>"
                 "<text fill=\"#b00020\" x=\"%.1f\" y=\"%.1f\">", x->from, c, x->to, x->from + 6, c - 5);
    plot_escape(p->rule_label ? p->rule_label : "", out);
    fprintf(out, "</text>\n");
}

static void draw_frame(const struct plot *p, const struct axis *x, const struct axis *y, FILE *out) {
    fprintf(out, "<rect fill=\"none\" stroke=\"#666\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" "
                 "height=\"%.1f\"/>\n", x->from, y->to, x->to - x->from, y->from - y->to);
    fprintf(out, "<text font-size=\"14\" font-weight=\"bold\" text-anchor=\"middle\" x=\"%.1f\" "
                 "y=\"20\">", (x->from + x->to) / 2);
    plot_escape(p->title, out);
    fprintf(out, "</text>\n<text text-anchor=\"middle\" x=\"%.1f\" y=\"%.1f\">", (x->from + x->to) / 2,
            y->from + 34);
    plot_escape(p->x_label, out);
    fprintf(out, "</text>\n<text text-anchor=\"middle\" transform=\"translate(14 %.1f) rotate(-90)\">",
            (y->from + y->to) / 2);
    plot_escape(p->y_label, out);
    fprintf(out, "</text>\n");
}

// Lettering that fits: characters of sans-serif are up to 0.6 of its size wide in the mean.
static double fitting_size(const char *text, double room) {
    const double fits = room / (0.6 * (double)strlen(text));
    return fits < 12 ? fits : 12;
}

static void draw_legend(const struct plot *p, const struct axis *x, const struct axis *y, FILE *out) {
    for (size_t s = 0; s < p->series_count; s++) {
        const double top = y->from + BELOW + (double)LEGEND_LINE * (double)s;
        draw_symbol(s, x->from + 6, top - 4, out);
        const char *name = p->series[s].name;
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" font-size=\"%.3g\">", x->from + 18, top,
                fitting_size(name, p->width - x->from - 18));
        plot_escape(name, out);
        fprintf(out, "</text>\n");
    }
}

void plot_svg(const struct plot *p, FILE *out) {
    struct axis x, y;
    find_axes(p, &x, &y);
    fprintf(out, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" "
                 "viewBox=\"0 0 %d %d\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n"
                 "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n", p->width, p->height,
            p->width, p->height);
    if (!p->x_ticks)
        draw_ticks(&x, true, &y, out);
    for (size_t i = 0; p->x_ticks && i < p->x_tick_count; i++)
        draw_tick(&x, true, &y, p->x_ticks[i], true, out);
    draw_ticks(&y, false, &x, out);
    draw_frame(p, &x, &y, out);
    draw_rule(p, &x, &y, out);
    draw_front(p, &x, &y, out);
    draw_fits(p, &x, &y, out);
    draw_points(p, &x, &y, out);
    draw_legend(p, &x, &y, out);
    fprintf(out, "</svg>\n");
}
