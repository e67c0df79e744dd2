// SPDX-License-Identifier: Apache-2.0
#include "curve/operators.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"

const char *const operator_names[] = {"translate-x", "translate-y", "amplify-x", "amplify-y", NULL};

static bool is_along_x(const struct curve_operator *o) {
    return o->kind == OPERATOR_TRANSLATE_X || o->kind == OPERATOR_AMPLIFY_X;
}

// ---- shape ----------------------------------------------------------------------------------

static double fade(double t) {
    if (!(t > 0))
        return 0;
    if (!(t < 1))
        return 1;
    return 1 / (1 + exp(1 / (t * t) - 1 / ((1 - t) * (1 - t))));
}

static double fade_slope(double t) {
    if (!(t > 0 && t < 1))
        return 0;
    const double s = fade(t), r = 1 - t;
    return s > 0 && s < 1 ? s * (1 - s) * (2 / (t * t * t) + 2 / (r * r * r)) : 0;
}

double operator_window(const struct curve_operator *o, double x) {
    if (x < o->a || x > o->d)
        return 0;
    if (x < o->b)
        return fade((x - o->a) / (o->b - o->a));
    return x > o->c ? fade((o->d - x) / (o->d - o->c)) : 1;
}

static double window_slope(const struct curve_operator *o, double x) {
    if (x > o->a && x < o->b)
        return fade_slope((x - o->a) / (o->b - o->a)) / (o->b - o->a);
    if (x > o->c && x < o->d)
        return -fade_slope((o->d - x) / (o->d - o->c)) / (o->d - o->c);
    return 0;
}

// x as the function is asked for it.
static double map_x(const struct curve_operator *o, double x) {
    const double w = operator_window(o, x);
    if (o->kind == OPERATOR_TRANSLATE_X)
        return x - o->magnitude * w;
    return x + (o->base - x) * (1 - 1 / o->magnitude) * w;
}

static double map_slope(const struct curve_operator *o, double x) {
    const double w = operator_window(o, x), slope = window_slope(o, x);
    if (o->kind == OPERATOR_TRANSLATE_X)
        return 1 - o->magnitude * slope;
    return 1 + ((o->base - x) * slope - w) * (1 - 1 / o->magnitude);
}

double operator_least_slope(const struct curve_operator *o) {
    enum { STEPS = 4096 };
    double least = 1;
    for (int i = 0; i <= STEPS && is_along_x(o); i++) {
        const double t = (double)i / STEPS;
        const double rising = map_slope(o, o->a + t * (o->b - o->a));
        const double falling = map_slope(o, o->c + t * (o->d - o->c));
        least = fmin(least, fmin(map_slope(o, o->b), fmin(rising, falling)));
    }
    return least;
}

static double map_y(const struct curve_operator *o, double x, double f) {
    const double w = operator_window(o, x);
    if (o->kind == OPERATOR_TRANSLATE_Y)
        return f + o->magnitude * w;
    return o->base + (f - o->base) * (1 + (o->magnitude - 1) * w);
}

// ---- checks ---------------------------------------------------------------------------------

static bool refuse(const char *at, const struct curve_operator *o, const char *what) {
    log_error("%s: %s %s", at, operator_names[o->kind], what);
    return false;
}

bool operator_check(const struct curve_operator *o, const char *at) {
    const double all[] = {o->a, o->b, o->c, o->d, o->magnitude, o->base};
    for (int i = 0; i < 6; i++)
        if (!isfinite(all[i]))
            return refuse(at, o, "has a number that is not finite");
    if (!(0 <= o->a && o->a <= o->b && o->b <= o->c && o->c <= o->d && o->d <= CURVE_END))
        return refuse(at, o, "needs 0 <= a <= b <= c <= d <= 90 degrees");
    if ((o->a == o->b && o->a > 0) || (o->c == o->d && o->d < CURVE_END))
        return refuse(at, o, "would tear the curve: a < b and c < d are needed inside the domain");
    if (o->kind == OPERATOR_AMPLIFY_X && !(o->magnitude > 0))
        return refuse(at, o, "needs a factor above 0");
    if (o->kind == OPERATOR_AMPLIFY_Y && !(o->magnitude >= 0))
        return refuse(at, o, "needs a factor of at least 0");
    if (operator_least_slope(o) > 0)
        return true;
    if (o->kind == OPERATOR_AMPLIFY_X)
        return refuse(at, o, "would fold the curve: the fades are too narrow for this factor");
    const double width = o->magnitude > 0 ? o->b - o->a : o->d - o->c;
    log_error("%s: translate-x by %g would fold the curve; a fade of %g degrees allows less than "
              "%g", at, o->magnitude * 90 / CURVE_END, width * 90 / CURVE_END,
              width / 8 * 90 / CURVE_END);
    return false;
}

// ---- reading --------------------------------------------------------------------------------

static bool parse_one(const char *text, size_t length, struct curve_operator *o, const char *at) {
    double v[6] = {0};
    int n = 0, kind = 0;
    const char *p = text + strcspn(text, ",;");
    const size_t name = (size_t)(p - text);
    while (operator_names[kind] && (strlen(operator_names[kind]) != name ||
                                    strncmp(operator_names[kind], text, name) != 0))
        kind++;
    while (*p == ',' && n < 6 && operator_names[kind]) {
        char *end;
        v[n++] = strtod(p + 1, &end);
        p = end > p + 1 ? end : text;
    }
    const bool shift = kind == OPERATOR_TRANSLATE_X || kind == OPERATOR_TRANSLATE_Y;
    if (p != text + length || n < 5 || (shift && n > 5)) {
        log_error("%s: \"%.*s\" is no operator, expected translate-x|translate-y,a,b,c,d,way or "
                  "amplify-x|amplify-y,a,b,c,d,factor[,base]", at, (int)length, text);
        return false;
    }
    o->kind = (enum operator_kind)kind;
    o->a = v[0] / 90 * CURVE_END; // 90 is the end exactly
    o->b = v[1] / 90 * CURVE_END;
    o->c = v[2] / 90 * CURVE_END;
    o->d = v[3] / 90 * CURVE_END;
    o->magnitude = kind == OPERATOR_TRANSLATE_X ? v[4] / 90 * CURVE_END : v[4];
    o->base = kind == OPERATOR_AMPLIFY_X ? v[5] / 90 * CURVE_END : v[5];
    return operator_check(o, at);
}

bool operators_parse(const char *text, struct curve_operator *out, uint32_t most, uint32_t *count,
                     const char *at) {
    *count = 0;
    while (*text) {
        const size_t n = strcspn(text, ";");
        if (*count == most) {
            log_error("%s: more than %u operators", at, most);
            return false;
        }
        if (n > 0 && !parse_one(text, n, &out[(*count)++], at))
            return false;
        text += n + (text[n] == ';');
    }
    return true;
}

// ---- layers ---------------------------------------------------------------------------------

double edited_curve_at(const void *edited, double gamma) {
    const struct edited_curve *e = edited;
    double x = gamma;
    for (uint32_t i = e->count; i-- > 0;)
        if (is_along_x(&e->operators[i]))
            x = fmin(fmax(map_x(&e->operators[i], x), 0), CURVE_END);
    double f = e->f(e->ctx, x);
    for (uint32_t i = 0; i < e->count; i++)
        if (!is_along_x(&e->operators[i]))
            f = map_y(&e->operators[i], x, f);
    return fmax(f, 0);
}

// Whether basis function j meets the region of an operator.
static bool is_touched(const struct basis *b, uint32_t j, const struct curve_operator *o,
                       uint32_t count) {
    const uint32_t last = basis_intervals(b);
    const uint32_t from = b->kind == BASIS_HAT && j > 0 ? j - 1 : j;
    const double lo = b->knots[from], hi = b->knots[j + 1 <= last ? j + 1 : last];
    for (uint32_t i = 0; i < count; i++)
        if (hi > o[i].a && lo < o[i].d)
            return true;
    return false;
}

void curve_edit(struct curve *c, uint32_t channels, const struct curve_operator *operators,
                uint32_t count) {
    const enum curve_filter filter = c->basis.kind == BASIS_BOX ? FILTER_MEAN : FILTER_POINT;
    const uint32_t n = c->basis.count;
    double *before = mem_array((size_t)n * c->channels, sizeof *before);
    memcpy(before, c->values, sizeof *before * n * c->channels);
    const struct curve source = {c->basis, c->channels, before};
    for (uint32_t k = 0; k < c->channels; k++) {
        if (c->channels > 1 && !(channels >> k & 1))
            continue;
        const struct curve_channel from = {&source, k};
        const struct edited_curve e = {curve_channel_at, &from, operators, count};
        curve_project(c, k, edited_curve_at, &e, filter, NULL, 0);
        for (uint32_t j = 0; j < n; j++)
            if (!is_touched(&c->basis, j, operators, count))
                c->values[k * n + j] = before[k * n + j];
    }
    mem_free(before);
}
