// SPDX-License-Identifier: Apache-2.0
// ALTA's text files (Belcour, Barla, Pacanowski 2014, ALTA: A BRDF Analysis Library): lines
// "#NAME VALUE" tell the dimensions (#DIM inputs outputs) and what the inputs and outputs mean
// (#PARAM_IN, #PARAM_OUT); every other line is one sample. What follows the outputs (confidence
// intervals, #VS) is not used. Materials are taken as isotropic.
#include <string.h>

#include "base/log.h"
#include "base/text.h"
#include "table/goniometer_reader.h"

struct directions {
    double out[3], in[3]; // view, light
};

static void polar(double theta, double phi, double w[3]) {
    w[0] = sin(theta) * cos(phi);
    w[1] = sin(theta) * sin(phi);
    w[2] = cos(theta);
}

// Angle to the normal as a length, azimuth as a direction in the plane.
static void light_and_projected_view(const double *x, struct directions *d) {
    polar(x[0], 0, d->in);
    polar(hypot(x[1], x[2]), atan2(x[2], x[1]), d->out);
}

static void view_light_azimuth(const double *x, struct directions *d) {
    polar(x[0], 0, d->out);
    polar(x[1], x[2], d->in);
}

static void spherical(const double *x, struct directions *d) {
    polar(x[0], x[1], d->in);
    polar(x[2], x[3], d->out);
}

static void cartesian(const double *x, struct directions *d) {
    memcpy(d->out, x, sizeof d->out);
    memcpy(d->in, x + 3, sizeof d->in);
}

// View in polar coordinates about the light.
static void about_light(const double *x, struct directions *d) {
    double w[3];
    polar(x[0], 0, d->in);
    polar(hypot(x[1], x[2]), atan2(x[2], x[1]), w);
    d->out[0] = w[2] * d->in[0] - w[0] * d->in[2];
    d->out[1] = w[1];
    d->out[2] = w[2] * d->in[2] + w[0] * d->in[0];
}

static const struct parametrisation {
    const char *name;
    int inputs;
    void (*convert)(const double *x, struct directions *d);
} parametrisations[] = {
    {"ISOTROPIC_TL_TV_PROJ_DPHI", 3, light_and_projected_view},
    {"ISOTROPIC_TV_TL_DPHI", 3, view_light_azimuth},
    {"RETRO_TL_TVL_PROJ_DPHI", 3, about_light},
    {"SPHERICAL_TL_PL_TV_PV", 4, spherical},
    {"CARTESIAN", 6, cartesian},
};

enum { KINDS = sizeof parametrisations / sizeof *parametrisations, MOST_COLUMNS = 6 + 3 };

struct header {
    int inputs, outputs;
    const struct parametrisation *in;
    bool cosine; // outputs are f cos of the light
};

static bool read_param_in(const char *path, const char *word, struct header *h) {
    char name[64];
    text_excerpt(word, name, sizeof name);
    for (int i = 0; i < KINDS; i++)
        if (strcmp(parametrisations[i].name, name) == 0)
            h->in = &parametrisations[i];
    if (!h->in)
        log_error("%s: #PARAM_IN is \"%s\", expected one of ISOTROPIC_TL_TV_PROJ_DPHI, "
                  "ISOTROPIC_TV_TL_DPHI, RETRO_TL_TVL_PROJ_DPHI, SPHERICAL_TL_PL_TV_PV, CARTESIAN",
                  path, name);
    return h->in != NULL;
}

static const char *after_word(const char *p) {
    while (*p && !text_is_space(*p))
        p++;
    while (text_is_blank(*p))
        p++;
    return p;
}

static bool read_header_line(const char *path, const char *p, struct header *h) {
    const char *value = after_word(p);
    int64_t n;
    if (strncmp(p, "#PARAM_IN", 9) == 0)
        return read_param_in(path, value, h);
    if (strncmp(p, "#PARAM_OUT", 10) == 0)
        h->cosine = strncmp(value, "INV_STERADIAN_COSINE_FACTOR", 27) == 0;
    if (strncmp(p, "#DIM", 4) == 0) {
        h->inputs = text_integer(&value, &n) && n > 0 && n <= 6 ? (int)n : 0;
        while (text_is_blank(*value))
            value++;
        h->outputs = text_integer(&value, &n) && n > 0 && n <= 3 ? (int)n : 0;
    }
    return true;
}

static bool check_header(const char *path, const struct header *h) {
    if (h->in && h->inputs == h->in->inputs && (h->outputs == 1 || h->outputs == 3))
        return true;
    log_error("%s: expected lines #DIM and #PARAM_IN that agree, with 1 or 3 outputs, before the "
              "samples", path);
    return false;
}

// false: the line does not hold that many columns.
static bool read_row(const char **p, int columns, double *x) {
    for (int i = 0; i < columns; i++) {
        while (text_is_blank(**p) || **p == ',')
            ++*p;
        if (!text_number(p, &x[i])) {
            if (**p == '\0' || **p == '\n' || **p == '\r')
                return false;
            x[i] = NAN;
            *p += strcspn(*p, " \t\r\n,");
        }
    }
    return true;
}

static void add_sample(const struct header *h, const double *x, struct gonio_samples *samples) {
    struct directions d;
    h->in->convert(x, &d);
    const double turn = atan2(d.in[1], d.in[0]), c = cos(turn), s = sin(turn);
    struct gonio_sample out = {(float)acos(fmax(-1, fmin(d.in[2], 1))), 0, v3(0, 0, 0), {0}};
    out.out = v3((float)(d.out[0] * c + d.out[1] * s), (float)(d.out[1] * c - d.out[0] * s),
                 (float)d.out[2]);
    for (int k = 0; k < 3; k++)
        out.rgb[k] = (float)(x[h->inputs + (h->outputs == 3 ? k : 0)] / (h->cosine ? d.in[2] : 1));
    gonio_add(samples, &out);
}

static bool read_samples(const char *path, const char *p, struct gonio_samples *samples) {
    struct header h = {0};
    bool good = true, checked = false;
    for (int line = 1; good && *p; line++) {
        double x[MOST_COLUMNS];
        while (text_is_blank(*p))
            p++;
        if (*p == '#') {
            good = read_header_line(path, p, &h);
        } else if (*p != '\n' && *p != '\r' && *p) {
            good = checked = checked || check_header(path, &h);
            if (good && !read_row(&p, h.inputs + h.outputs, x)) {
                log_error("%s:%d: expected %d numbers", path, line, h.inputs + h.outputs);
                good = false;
            }
            if (good)
                add_sample(&h, x, samples);
        }
        p += strcspn(p, "\n");
        p += *p == '\n';
    }
    return good;
}

bool alta_read(const char *path, char *text, struct goniometer_table *t, struct arena *arena) {
    struct gonio_samples samples = {0};
    const bool good = read_samples(path, text, &samples) && gonio_resample(path, &samples, t, arena);
    mem_free(samples.items);
    return good;
}
