// SPDX-License-Identifier: Apache-2.0
// Transfer probabilities as text (.transfer), relume's own format for tables of a goniometer (after
// Muehlbacher 2012, Real-time Rendering of Measured Materials, section 2.4: p = f |cos theta_o|).
//
//     transfer 1
//     # a comment
//     channels 1                  1 (grey) or 3 (linear Rec.709)
//     quantity p                  p: density per sr of light that leaves; f: p / |cos theta_o|
//     incident_theta 0 20 40 60   degrees, ascending, below 90
//     incident_phi 0 30 60 90     degrees; without this line the material is isotropic
//     symmetry 4                  1: azimuths cover a turn, 2: half a turn (the sample looks the
//                                 same mirrored at y = 0), 4: a quarter (at x = 0 too)
//     outgoing 46 72              angles from 0 to 90 degrees inclusive, azimuths (even) from 0
//     reflection                  numbers: for each incident_phi, incident_theta, outgoing angle,
//     ...                         outgoing azimuth, channel; the last runs fastest
//     transmission                the same for directions below the surface; may be left out
//     ...
//
// '-' stands for a value that is missing, and so does a negative one. At 90 degrees p says nothing:
// those rows are made from the rows above them.
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/text.h"
#include "table/goniometer_reader.h"

enum { MOST_LIST = 1024, MOST_GRID = 4096 };

static const float LARGEST = 1e12f;     // what lies beyond is damage
static const double GRAZING_COS = 1e-3; // below: p tells nothing about f

struct parse {
    const char *path, *p, *end;
    int line;
    struct goniometer_table *t;
    struct arena *arena;
    int channels;
    bool probability, good;
};

static bool fail(struct parse *s, const char *expected) {
    char found[32];
    if (s->good)
        log_error("%s:%d: found \"%s\", expected %s", s->path, s->line,
                  text_excerpt(s->p, found, sizeof found), expected);
    return s->good = false;
}

// To the next word, over lines and comments.
static void skip(struct parse *s) {
    while (text_is_space(*s->p) || *s->p == '#') {
        if (*s->p == '#')
            s->p += strcspn(s->p, "\n");
        s->line += *s->p == '\n';
        s->p += *s->p != '\0';
    }
}

static bool accept(struct parse *s, const char *word) {
    const size_t n = strlen(word);
    skip(s);
    if (strncmp(s->p, word, n) != 0 || !(text_is_space(s->p[n]) || s->p[n] == '\0'))
        return false;
    s->p += n;
    return true;
}

static int read_int(struct parse *s, int lo, int hi, const char *expected) {
    int64_t v = 0;
    skip(s);
    const char *before = s->p;
    if (text_integer(&s->p, &v) && v >= lo && v <= hi)
        return (int)v;
    s->p = before;
    fail(s, expected);
    return lo;
}

// Ascending angles up to the end of the line, in radians.
static int read_angles(struct parse *s, double most, float *out) {
    int n = 0;
    double v;
    for (;;) {
        while (text_is_blank(*s->p))
            s->p++;
        if (!text_number(&s->p, &v))
            break;
        out[n++] = (float)(v * M_PI / 180);
        if (n == MOST_LIST || !(v >= 0) || !(v <= most) || (n > 1 && !(out[n - 1] > out[n - 2]))) {
            fail(s, "a list of ascending angles in degrees within range");
            return 1;
        }
    }
    if (n == 0)
        fail(s, "angles in degrees");
    return n ? n : 1;
}

static float *keep(struct arena *arena, const float *angles, int count) {
    return memcpy(arena_alloc(arena, ((size_t)count + 1) * sizeof *angles), angles,
                  (size_t)count * sizeof *angles);
}

static bool read_entry(struct parse *s) {
    float angles[MOST_LIST];
    struct goniometer_table *t = s->t;
    if (accept(s, "channels")) {
        s->channels = read_int(s, 1, 3, "1 or 3 channels");
        if (s->channels == 2)
            fail(s, "1 or 3 channels");
    } else if (accept(s, "quantity")) {
        s->probability = accept(s, "p");
        if (!s->probability && !accept(s, "f"))
            fail(s, "p or f");
    } else if (accept(s, "symmetry")) {
        t->symmetry = read_int(s, 1, 4, "1, 2 or 4");
        if (t->symmetry == 3)
            fail(s, "1, 2 or 4");
    } else if (accept(s, "incident_theta")) {
        t->theta_count = read_angles(s, 89.99, angles);
        t->theta = keep(s->arena, angles, t->theta_count);
    } else if (accept(s, "incident_phi")) {
        t->phi_count = read_angles(s, 360, angles);
        t->phi = keep(s->arena, angles, t->phi_count);
    } else if (accept(s, "outgoing")) {
        t->out_thetas = read_int(s, 2, MOST_GRID, "a number of angles from 2");
        t->out_phis = read_int(s, 2, MOST_GRID, "an even number of azimuths");
        if (t->out_phis % 2)
            fail(s, "an even number of azimuths");
    } else {
        return false;
    }
    return s->good;
}

static bool read_value(struct parse *s, double *v) {
    skip(s);
    if (*s->p == '-' && (text_is_space(s->p[1]) || s->p[1] == '\0')) {
        s->p++;
        *v = -1;
        return true;
    }
    return text_number(&s->p, v) || fail(s, "a number or -");
}

static void store(struct parse *s, size_t node, const double v[3], float out[3]) {
    const size_t row = node / (size_t)s->t->out_phis % (size_t)s->t->out_thetas;
    const double cosine = cos((double)row * M_PI / 2 / (s->t->out_thetas - 1));
    const double scale = s->probability ? 1 / cosine : 1;
    bool good = true;
    for (int c = 0; c < 3; c++) {
        out[c] = (float)(v[s->channels == 3 ? c : 0] * scale);
        good = good && out[c] >= 0 && out[c] <= LARGEST;
    }
    const bool silent = s->probability && cosine < GRAZING_COS;
    s->t->invalid += !good && !silent;
    if (!good || silent)
        out[0] = out[1] = out[2] = -1;
}

// The numbers of one side. Their count is checked against the length of the file first.
static bool read_side(struct parse *s, int side) {
    const struct goniometer_table *t = s->t;
    const size_t nodes = (size_t)t->theta_count * (size_t)t->phi_count * goniometer_slice(t);
    const size_t most = (size_t)(s->end - s->p) / 2 + 1;
    if (!t->theta || !t->out_thetas)
        return fail(s, "incident_theta and outgoing before this");
    if (nodes > most / (size_t)s->channels)
        return fail(s, "as many numbers as the grid has nodes, but the file ends before");
    s->t->f[side] = gonio_alloc(t, s->arena);
    for (size_t i = 0; i < nodes; i++) {
        double v[3] = {0};
        for (int c = 0; c < s->channels; c++)
            if (!read_value(s, &v[c]))
                return false;
        store(s, i, v, s->t->f[side][i]);
    }
    return true;
}

// Azimuths of a whole turn end where they began.
static void close_turn(struct goniometer_table *t, struct arena *arena) {
    if (t->symmetry != 1 || t->phi_count == 1 || t->phi[t->phi_count - 1] > TWO_PI - 1e-4f)
        return;
    const size_t slice = (size_t)t->theta_count * goniometer_slice(t);
    t->phi[t->phi_count++] = t->phi[0] + TWO_PI;
    for (int side = 0; side < 2; side++) {
        if (!t->f[side])
            continue;
        float(*wider)[3] = gonio_alloc(t, arena);
        memcpy(wider, t->f[side], (size_t)(t->phi_count - 1) * slice * sizeof *wider);
        memcpy(wider + (size_t)(t->phi_count - 1) * slice, t->f[side], slice * sizeof *wider);
        t->f[side] = wider;
    }
}

bool transfer_read(const char *path, char *text, struct goniometer_table *t, struct arena *arena) {
    static const float no_azimuth[1] = {0};
    struct parse s = {path, text, text + strlen(text), 1, t, arena, 1, true, true};
    *t = (struct goniometer_table){.symmetry = 1, .phi_count = 1};
    t->phi = keep(arena, no_azimuth, 1);
    if (!accept(&s, "transfer") || read_int(&s, 1, 1, "version 1") != 1)
        return fail(&s, "\"transfer 1\"");
    while (s.good && !accept(&s, "reflection"))
        if (!read_entry(&s))
            return fail(&s, "channels, quantity, symmetry, incident_theta, incident_phi, outgoing "
                            "or reflection");
    if (!s.good || !read_side(&s, 0) || (accept(&s, "transmission") && !read_side(&s, 1)))
        return false;
    skip(&s);
    if (*s.p)
        return fail(&s, "the end of the file");
    close_turn(t, arena);
    return true;
}

// ---- writing --------------------------------------------------------------------------------

static void write_list(FILE *f, const char *name, const float *radians, int count) {
    fprintf(f, "%s", name);
    for (int i = 0; i < count; i++)
        fprintf(f, " %.7g", (double)radians[i] * 180 / M_PI);
    fprintf(f, "\n");
}

static void write_side(FILE *f, const char *name, const struct goniometer_table *t, int side) {
    const size_t rows = (size_t)t->theta_count * (size_t)t->phi_count * (size_t)t->out_thetas;
    const size_t columns = (size_t)t->out_phis;
    fprintf(f, "%s\n", name);
    for (size_t r = 0; r < rows; r++) {
        const double cosine = cos((double)(r % (size_t)t->out_thetas) * M_PI / 2 /
                                  (t->out_thetas - 1));
        for (size_t j = 0; j < columns; j++) {
            const size_t turned = t->retro && side == 0 ? (j + columns / 2) % columns : j;
            for (int c = 0; c < 3; c++)
                fprintf(f, "%.7g ", (double)t->f[side][r * columns + turned][c] * fmax(cosine, 0));
        }
        fprintf(f, "\n");
    }
}

bool transfer_write(const char *path, const struct goniometer_table *t) {
    struct file_text out;
    if (!file_text_begin(&out, path))
        return false;
    FILE *f = out.f;
    fprintf(f, "transfer 1\nchannels 3\nquantity p\nsymmetry %d\n", t->symmetry);
    write_list(f, "incident_theta", t->theta, t->theta_count);
    if (t->phi_count > 1)
        write_list(f, "incident_phi", t->phi, t->phi_count);
    fprintf(f, "outgoing %d %d\n", t->out_thetas, t->out_phis);
    write_side(f, "reflection", t, 0);
    if (t->f[1])
        write_side(f, "transmission", t, 1);
    return file_text_end(&out);
}
