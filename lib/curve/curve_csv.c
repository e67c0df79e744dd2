// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/text.h"
#include "curve/curve.h"

static const double DEGREES = 90 / CURVE_END;
static const double NARROWEST = 1e-9; // degrees between knots

// ---- reading --------------------------------------------------------------------------------

enum { COLUMNS = 5 };

struct table {
    const char *p;
    struct where at;
    bool boxes;
    uint32_t places, channels; // columns of angles and of values
    double (*rows)[COLUMNS];
    size_t count, capacity;
};

static bool refuse(const struct table *t, const char *expected) {
    char found[40];
    log_error_at(t->at, "found \"%s\", expected %s", text_excerpt(t->p, found, sizeof found),
                 expected);
    return false;
}

static void skip_blanks(struct table *t) {
    while (text_is_blank(*t->p))
        t->p++;
}

// Goes to the next line that holds something. false: there is none.
static bool next_line(struct table *t) {
    for (;; t->p++) {
        skip_blanks(t);
        if (*t->p == '#')
            t->p += strcspn(t->p, "\n");
        if (*t->p == '\0')
            return false;
        if (*t->p == '\n')
            t->at.line++;
        else if (*t->p != '\r')
            return true;
    }
}

static bool line_ends(struct table *t) {
    skip_blanks(t);
    if (*t->p == '\r')
        t->p++;
    return *t->p == '\n' || *t->p == '\0';
}

static bool read_header(struct table *t) {
    static const char *const headers[] = {"from,to,value", "from,to,r,g,b", "at,value", "at,r,g,b"};
    t->at.line = 1;
    if (!next_line(t))
        return refuse(t, "a line with the names of columns");
    for (int i = 0; i < 4; i++) {
        const size_t n = strlen(headers[i]);
        if (strncmp(t->p, headers[i], n) != 0)
            continue;
        struct table rest = *t;
        rest.p += n;
        if (!line_ends(&rest))
            continue;
        t->p = rest.p;
        t->boxes = i < 2;
        t->places = t->boxes ? 2 : 1;
        t->channels = i % 2 ? CURVE_CHANNELS : 1;
        return true;
    }
    return refuse(t, "\"from,to,value\", \"from,to,r,g,b\", \"at,value\" or \"at,r,g,b\"");
}

static bool read_number(struct table *t, double *out) {
    char *end;
    skip_blanks(t);
    *out = strtod(t->p, &end);
    if (end == t->p || !isfinite(*out))
        return refuse(t, "a finite number");
    if (*out < 0)
        return refuse(t, "no negative number");
    t->p = end;
    return true;
}

static bool read_row(struct table *t) {
    mem_grow(&t->rows, &t->capacity, t->count + 1, sizeof *t->rows);
    double *row = t->rows[t->count++];
    for (uint32_t i = 0; i < t->places + t->channels; i++) {
        if (i > 0) {
            skip_blanks(t);
            if (*t->p != ',')
                return refuse(t, "a comma");
            t->p++;
        }
        if (!read_number(t, &row[i]))
            return false;
    }
    return line_ends(t) || refuse(t, "the end of the line");
}

// Bins follow each other, nodes ascend.
static bool check_order(struct table *t) {
    const double *row = t->rows[t->count - 1], *before = t->count > 1 ? row - COLUMNS : NULL;
    const double last = before ? before[t->places - 1] : 0;
    const bool follows = t->boxes || !before ? row[0] == last : row[0] - last >= NARROWEST;
    if (follows && (!t->boxes || row[1] - row[0] >= NARROWEST))
        return true;
    log_error_at(t->at, "%s %g follows %g, expected %s", t->boxes ? "the bin from" : "the node at",
                 row[0], last, t->boxes ? "bins in order without gaps, from 0" :
                 "nodes that ascend from 0");
    return false;
}

static bool read_rows(struct table *t) {
    while (next_line(t)) {
        if (!read_row(t) || !check_order(t))
            return false;
        if (t->count > BASIS_MOST) {
            log_error_at(t->at, "more than %d lines", BASIS_MOST);
            return false;
        }
    }
    const double end = t->count ? t->rows[t->count - 1][t->boxes ? 1 : 0] : 0;
    if (end == 90 && t->count >= (t->boxes ? 1 : 2))
        return true;
    log_error_at(t->at, "the curve ends at %g degrees, expected 90", end);
    return false;
}

// Knots of the even spacings come back as they were before they were written in degrees.
static struct basis make_basis(const struct table *t, struct arena *arena) {
    const enum basis_kind kind = t->boxes ? BASIS_BOX : BASIS_HAT;
    const uint32_t n = (uint32_t)t->count;
    double *knots = arena_alloc(arena, sizeof *knots * (n + 1));
    for (uint32_t i = 0; i < n; i++)
        knots[i] = t->rows[i][0] / DEGREES;
    knots[t->boxes ? n : n - 1] = CURVE_END;
    for (int s = SPACING_UNIFORM; s <= SPACING_QUADRATIC; s++) {
        const struct basis even = basis_make(arena, kind, n, (enum basis_spacing)s);
        bool same = true;
        for (uint32_t i = 0; i < basis_knots(&even); i++)
            same = same && fabs(knots[i] - even.knots[i]) <= 1e-14 + 1e-12 * even.knots[i];
        if (same)
            return even;
    }
    return (struct basis){kind, SPACING_ANY, n, knots};
}

bool curve_parse(struct curve *c, struct arena *arena, const char *text, const char *path) {
    struct table t = {.p = text, .at = {path, 1}};
    const bool ok = read_header(&t) && read_rows(&t);
    if (ok) {
        const struct basis b = make_basis(&t, arena);
        *c = curve_make(arena, &b, t.channels);
        for (uint32_t k = 0; k < t.channels; k++)
            for (uint32_t j = 0; j < b.count; j++)
                c->values[k * b.count + j] = t.rows[j][t.places + k];
    }
    mem_free(t.rows);
    return ok;
}

bool curve_read(struct curve *c, struct arena *arena, const char *path) {
    size_t size;
    char *text = file_read(path, 64u << 20, &size);
    const bool ok = text && curve_parse(c, arena, text, path);
    mem_free(text);
    return ok;
}

// ---- writing --------------------------------------------------------------------------------

bool curve_write(const struct curve *c, const char *path) {
    struct file_text t;
    if (!file_text_begin(&t, path))
        return false;
    FILE *f = t.f;
    const struct basis *b = &c->basis;
    const bool boxes = b->kind == BASIS_BOX;
    fprintf(f, "%s,%s\n", boxes ? "from,to" : "at", c->channels > 1 ? "r,g,b" : "value");
    for (uint32_t j = 0; j < b->count; j++) {
        fprintf(f, "%.17g", b->knots[j] * DEGREES);
        if (boxes)
            fprintf(f, ",%.17g", b->knots[j + 1] * DEGREES);
        for (uint32_t k = 0; k < c->channels; k++)
            fprintf(f, ",%.17g", curve_values(c, k)[j]);
        fputc('\n', f);
    }
    return file_text_end(&t);
}
