// SPDX-License-Identifier: Apache-2.0
// Plots: what is drawn and where, what is left out; and parameters from words.
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "base/param_text.h"
#include "image/plot.h"

static char *draw(const struct plot *p) {
    char *text = NULL;
    size_t size;
    FILE *f = open_memstream(&text, &size);
    plot_svg(p, f);
    fclose(f);
    return text;
}

static int occurrences(const char *text, const char *word) {
    int count = 0;
    for (const char *at = text; (at = strstr(at, word)); at += strlen(word))
        count++;
    return count;
}

static void plot_draws_points_fits_and_front(void) {
    const struct plot_point points[] = {{1, 1e-2, 0.8e-2, 1.2e-2, true, "a < b"},
                                        {10, 1e-3, -1, 2e-3, true, NULL},
                                        {100, 1e-4, NAN, NAN, false, NULL}};
    const struct plot_series series[] = {{"one & two", points, 3, true, -1, -2}};
    const struct plot p = {.title = "T", .x_label = "x", .y_label = "y", .series = series,
                           .series_count = 1, .rule = 1e-3, .rule_label = "target",
                           .width = 600, .height = 400};
    char *svg = draw(&p);
    CHECK(occurrences(svg, "r=\"4\"") == 4); // points, and the legend's
    CHECK(occurrences(svg, "r=\"8\"") == 2); // marked
    CHECK(occurrences(svg, "one &amp; two") == 1 && occurrences(svg, "a &lt; b") == 1);
    CHECK(occurrences(svg, "stroke-dasharray=\"6 4\"") == 1);
    CHECK(occurrences(svg, "stroke-dasharray=\"2 3\"") == 1);
    CHECK(occurrences(svg, "stroke-width=\"1.5\"") == 1);
    CHECK(strstr(svg, ">0.001<") && strstr(svg, ">1e-4<") && strstr(svg, ">100<"));
    CHECK(!strstr(svg, "nan") && !strstr(svg, "inf"));
    free(svg);
}

static void plot_leaves_out_what_has_no_logarithm(void) {
    const struct plot_point points[] = {{0, 1, NAN, NAN, true, NULL}, {1, -1, -2, 1, true, NULL},
                                        {1, NAN, NAN, NAN, true, NULL}, {INFINITY, 1, 0, 1, true, NULL}};
    const struct plot_series series[] = {{"s", points, 4, true, -1, 0}};
    const struct plot p = {.title = "T", .x_label = "x", .y_label = "y", .series = series,
                           .series_count = 1, .width = 600, .height = 400};
    char *svg = draw(&p);
    CHECK(occurrences(svg, "r=\"4\"") == 1); // the legend's
    CHECK(!strstr(svg, "nan") && !strstr(svg, "inf"));
    free(svg);
    const struct plot empty = {.title = "T", .x_label = "x", .y_label = "y", .width = 600, .height = 400};
    svg = draw(&empty);
    CHECK(strstr(svg, "</svg>") && !strstr(svg, "nan"));
    free(svg);
}

static void param_parse_reads_what_the_table_allows(void) {
    static const char *const choices[] = {"low", "high", NULL};
    const struct param flag = {"f", PARAM_BOOL, 0}, whole = {"i", PARAM_INT, 0, .min = -1, .max = 9};
    const struct param any = {"a", PARAM_INT, 0}, real = {"r", PARAM_FLOAT, 0, .min = 0, .max = 1};
    const struct param choice = {"c", PARAM_CHOICE, 0, .choices = choices}, text = {"t", PARAM_STRING, 0};
    const struct param colour = {"k", PARAM_REFLECTANCE, 0};
    const char *word;
    bool b;
    int i;
    float f;
    CHECK(param_parse(&flag, "true", &b) && b && param_parse(&flag, "false", &b) && !b);
    CHECK(param_parse(&whole, "-1", &i) && i == -1 && param_parse(&any, "2147483647", &i));
    CHECK(i == 2147483647);
    CHECK(param_parse(&real, "0.25", &f) && f == 0.25f);
    CHECK(param_parse(&choice, "high", &i) && i == 1);
    CHECK(param_parse(&text, "box.safetensors", &word) && strcmp(word, "box.safetensors") == 0);
    CHECK(param_takes_text(&text) && param_takes_text(&flag) && !param_takes_text(&colour));
    static const char *const bad[] = {"", "x", "10", "1.5", "1 ", "nan", "99999999999999999999"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        CHECK(!param_parse(&whole, bad[k], &i));
    CHECK(!param_parse(&any, "2147483648", &i) && !param_parse(&any, "1e300", &i));
    CHECK(!param_parse(&real, "1.01", &f) && !param_parse(&choice, "middle", &i));
    CHECK(!param_parse(&flag, "yes", &b));
}

int main(void) {
    plot_draws_points_fits_and_front();
    plot_leaves_out_what_has_no_logarithm();
    param_parse_reads_what_the_table_allows();
    return check_result();
}
