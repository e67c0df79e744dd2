// SPDX-License-Identifier: Apache-2.0
// Colours and spectra of a scene file as linear Rec.709, with the meaning that Mitsuba 3's RGB
// variants give them (math/colour.h).
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "math/colour.h"
#include "scene/language.h"
#include "scene/reader.h"

enum { MOST_SAMPLES = 1 << 20 };

struct samples {
    double *x, *y; // wavelengths in nm, values
    size_t count, x_capacity, y_capacity;
};

static void samples_add(struct samples *s, double x, double y) {
    mem_grow(&s->x, &s->x_capacity, s->count + 1, sizeof *s->x);
    mem_grow(&s->y, &s->y_capacity, s->count + 1, sizeof *s->y);
    s->x[s->count] = x;
    s->y[s->count++] = y;
}

static void samples_finish(struct samples *s) {
    mem_free(s->x);
    mem_free(s->y);
}

static bool is_separator(char c) {
    return isspace((unsigned char)c) || c == ',';
}

// ---- spectra that are sampled ---------------------------------------------------------------

static bool samples_check(const struct samples *s, struct where at) {
    for (size_t i = 1; i < s->count; i++)
        if (!(s->x[i] >= s->x[i - 1])) {
            log_error_at(at, "wavelength %g nm stands after %g nm, expected ascending ones",
                         s->x[i], s->x[i - 1]);
            return false;
        }
    if (s->count >= 2 && s->count <= MOST_SAMPLES)
        return true;
    log_error_at(at, "a spectrum of %zu samples, expected 2 to %d", s->count, MOST_SAMPLES);
    return false;
}

static bool samples_convert(const struct samples *s, enum param_type use, struct where at,
                            spectrum *out) {
    if (!samples_check(s, at))
        return false;
    const spectrum rgb = colour_from_samples(s->x, s->y, s->count, use != PARAM_EMISSION);
    if (!spectrum_is_finite(rgb)) {
        log_error_at(at, "a spectrum that exceeds the range of numbers");
        return false;
    }
    // outside the gamut: as near as Rec.709 can show
    *out = spectrum_clamp(rgb, 0, use == PARAM_REFLECTANCE ? 1 : INFINITY);
    const spectrum change = rgb - *out;
    if (spectrum_max(change) > 0.02f || spectrum_min(change) < -0.02f)
        log_info("%s:%d: a spectrum outside the gamut of Rec.709 is clamped from %g %g %g", at.file,
                 at.line, rgb[0], rgb[1], rgb[2]);
    return true;
}

// "400:0.1, 500:0.2"
static bool parse_pairs(const char *text, struct samples *s) {
    for (const char *c = text;;) {
        while (is_separator(*c))
            c++;
        if (*c == '\0')
            return true;
        char *end;
        const double x = strtod(c, &end);
        if (end == c || *end != ':')
            return false;
        c = end + 1;
        const double y = strtod(c, &end);
        if (end == c || (*end && !is_separator(*end)) || !isfinite(x) || !isfinite(y))
            return false;
        samples_add(s, x, y);
        c = end;
    }
}

// Numbers in a line of at most 127 characters, '#' beginning a comment; -1: something else.
static int line_numbers(const char *line, double v[2]) {
    char copy[128];
    const size_t n = strcspn(line, "#\r\n");
    if (n >= sizeof copy)
        return -1;
    memcpy(copy, line, n);
    copy[n] = '\0';
    return value_numbers(copy, v, 2);
}

// Lines of "wavelength value".
static bool parse_file(const char *text, const char *path, struct samples *s) {
    int line = 1;
    for (const char *c = text; *c; line++) {
        double v[2];
        const int count = line_numbers(c, v);
        if (count != 0 && count != 2) {
            log_error("%s:%d: expected a wavelength in nm and a value", path, line);
            return false;
        }
        if (count == 2 && s->count > 0 && v[0] < s->x[s->count - 1]) {
            log_error("%s:%d: wavelength %g nm stands after %g nm, expected ascending ones", path,
                      line, v[0], s->x[s->count - 1]);
            return false;
        }
        if (count == 2)
            samples_add(s, v[0], v[1]);
        c += strcspn(c, "\n");
        c += *c == '\n';
    }
    return true;
}

static bool read_file(struct reader *r, const struct xml_node *node, struct samples *s) {
    const char *path = load_find_file(r, xml_get(node, "filename"), node->at);
    size_t size;
    char *text = path && load_hash_file(r, path) ? file_read(path, 16u << 20, &size) : NULL;
    const bool ok = text && parse_file(text, path, s);
    mem_free(text);
    return ok;
}

// ---- single numbers -------------------------------------------------------------------------

// A light of one number has equal energy at all wavelengths; version 0.6 in RGB has grey.
static bool uniform(const struct xml_node *node, double v, enum param_type use, spectrum *out) {
    *out = spectrum_grey((float)v);
    if (use == PARAM_EMISSION && strcmp(node->tag, "spectrum") == 0 && !node->old)
        *out = (float)v * colour_equal_energy();
    if (spectrum_is_finite(*out))
        return true;
    log_error_at(node->at, "<%s> has the value %g, which exceeds the range of numbers", node->tag, v);
    return false;
}

static bool bad_colour(const struct xml_node *node, const char *expected) {
    const char *value = xml_get(node, "value");
    log_error_at(node->at, "<%s> has the value \"%s\", expected %s", node->tag, value ? value : "",
                 expected);
    return false;
}

// "#rrggbb" is coded by sRGB's transfer function in <srgb>, linear in <rgb> as in Mitsuba 0.5.
static bool read_rgb(const struct xml_node *node, spectrum *out) {
    const char *text = xml_get(node, "value");
    double v[3];
    if (text[0] == '#') {
        char *end;
        const unsigned long hex = strtoul(text + 1, &end, 16);
        if (end != text + 7 || *end)
            return bad_colour(node, "#rrggbb");
        for (int c = 0; c < 3; c++)
            v[c] = (double)(hex >> (16 - 8 * c) & 255) / 255;
    } else {
        const int n = value_numbers(text, v, 3);
        if (n == 1)
            v[1] = v[2] = v[0];
        else if (n != 3)
            return bad_colour(node, "one or three numbers");
    }
    float rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = strcmp(node->tag, "srgb") == 0 ? colour_srgb_to_linear((float)v[c]) : (float)v[c];
    *out = spectrum_rgb(rgb[0], rgb[1], rgb[2]);
    return spectrum_is_finite(*out) || bad_colour(node, "numbers within the range of float");
}

static bool read_plain_spectrum(struct reader *r, const struct xml_node *node, enum param_type use,
                                spectrum *out) {
    const char *value = xml_get(node, "value");
    if (!value == !xml_get(node, "filename")) {
        log_error_at(node->at, "<spectrum> needs either value or filename");
        return false;
    }
    double single;
    if (value && value_numbers(value, &single, 1) == 1)
        return uniform(node, single, use, out);
    struct samples s = {0};
    const bool parsed =
        value ? parse_pairs(value, &s) || bad_colour(node, "a number or pairs wavelength:value")
              : read_file(r, node, &s);
    const bool ok = parsed && samples_convert(&s, use, node->at, out);
    samples_finish(&s);
    return ok;
}

static bool blackbody(double kelvin, double scale, struct where at, spectrum *out) {
    if (!(kelvin >= 100 && kelvin <= 1e6)) {
        log_error_at(at, "a temperature of %g K, expected 100 to 1e6", kelvin);
        return false;
    }
    const spectrum rgb = colour_blackbody(kelvin) * (float)scale;
    *out = spectrum_clamp(rgb, 0, INFINITY);
    if (spectrum_is_finite(rgb))
        return true;
    log_error_at(at, "a scale of %g, which exceeds the range of numbers", scale);
    return false;
}

// <blackbody temperature="5000K" scale="1"/> of Mitsuba 0.5
static bool read_blackbody(const struct xml_node *node, spectrum *out) {
    char *end;
    const char *scale_text = xml_get(node, "scale");
    double scale = 1;
    const double kelvin = strtod(xml_get(node, "temperature"), &end);
    if ((strcmp(end, "K") != 0 && strcmp(end, "k") != 0 && *end) ||
        (scale_text && value_numbers(scale_text, &scale, 1) != 1)) {
        log_error_at(node->at, "<blackbody>: expected temperature=\"...K\" and a number as scale");
        return false;
    }
    return blackbody(kelvin, scale, node->at, out);
}

// ---- spectra with a type --------------------------------------------------------------------

struct typed {
    float scale, value, temperature, wavelength_min, wavelength_max;
    const char *values, *wavelengths;
    spectrum color;
};

static const struct param uniform_params[] = {
    {"value", PARAM_FLOAT, offsetof(struct typed, value), .def = "1", .help = "at all wavelengths"},
    PARAM_END,
};
static const struct param d65_params[] = {
    {"scale", PARAM_FLOAT, offsetof(struct typed, scale), .def = "1", .help = "factor"},
    {"color", PARAM_INDEX, offsetof(struct typed, color), .def = "1", .help = "its colour",
     .aka = "value"},
    PARAM_END,
};
static const struct param srgb_params[] = {
    {"color", PARAM_INDEX, offsetof(struct typed, color), .def = "1", .help = "its colour",
     .aka = "value"},
    {"unbounded", PARAM_IGNORED},
    PARAM_END,
};
static const struct param blackbody_params[] = {
    {"temperature", PARAM_FLOAT, offsetof(struct typed, temperature), .min = 100,
     .max = 1e6, .unit = "K", .help = "of the black body"},
    {"scale", PARAM_FLOAT, offsetof(struct typed, scale), .def = "1", .help = "factor"},
    PARAM_END,
};
static const struct param regular_params[] = {
    {"wavelength_min", PARAM_FLOAT, offsetof(struct typed, wavelength_min), .unit = "nm",
     .help = "of the first value", .aka = "lambda_min"},
    {"wavelength_max", PARAM_FLOAT, offsetof(struct typed, wavelength_max), .unit = "nm",
     .help = "of the last value", .aka = "lambda_max"},
    {"values", PARAM_STRING, offsetof(struct typed, values),
     .help = "numbers, separated by blanks or commas"},
    PARAM_END,
};
static const struct param irregular_params[] = {
    {"wavelengths", PARAM_STRING, offsetof(struct typed, wavelengths), .unit = "nm",
     .help = "as many numbers as values"},
    {"values", PARAM_STRING, offsetof(struct typed, values),
     .help = "numbers, separated by blanks or commas"},
    PARAM_END,
};

static const struct entry types[] = {
    {"uniform", "the same at all wavelengths", NULL, uniform_params, sizeof(struct typed)},
    {"d65", "daylight: white", NULL, d65_params, sizeof(struct typed)},
    {"srgb", "a colour", NULL, srgb_params, sizeof(struct typed)},
    {"blackbody", "Planck's law", NULL, blackbody_params, sizeof(struct typed)},
    {"regular", "samples at equal distances", NULL, regular_params, sizeof(struct typed)},
    {"irregular", "samples anywhere", NULL, irregular_params, sizeof(struct typed)},
};

static const struct entry *const entries[] = {&types[0], &types[1], &types[2], &types[3],
                                              &types[4], &types[5], NULL};
const struct registry scene_spectra = {"spectrum", entries};

bool spectrum_is_type(const char *type) {
    return registry_find(&scene_spectra, type) != NULL;
}

static int number_list(const char *text, double **out) {
    double ignored;
    const int n = value_numbers(text, &ignored, 1);
    *out = mem_array(n > 0 ? (size_t)n : 1, sizeof **out);
    return value_numbers(text, *out, n);
}

static bool read_lists(const struct typed *t, bool regular, enum param_type use, struct where at,
                       spectrum *out) {
    struct samples s = {0};
    const int n = number_list(t->values, &s.y);
    int m = n;
    if (regular) {
        s.x = mem_array(n > 0 ? (size_t)n : 1, sizeof *s.x);
        for (int i = 0; i < n; i++)
            s.x[i] = t->wavelength_min +
                     (t->wavelength_max - t->wavelength_min) * (double)i / (n > 1 ? n - 1 : 1);
    } else {
        m = number_list(t->wavelengths, &s.x);
    }
    bool ok = n > 0 && n == m;
    if (!ok)
        log_error_at(at, "expected as many wavelengths as values, all of them numbers");
    s.count = ok ? (size_t)n : 0;
    ok = ok && samples_convert(&s, use, at, out);
    samples_finish(&s);
    return ok;
}

static bool read_typed(struct reader *r, const struct xml_node *node, enum param_type use,
                       spectrum *out) {
    const struct entry *e = object_entry(&scene_spectra, node);
    struct typed t = {0};
    if (!e || !object_fill(r, node, e, &t, false, NULL, NULL))
        return false;
    if (e == &types[0])
        *out = spectrum_grey(t.value);
    else if (e == &types[1] || e == &types[2])
        *out = (e == &types[1] ? t.scale : 1) * t.color;
    else if (e == &types[3])
        return blackbody(t.temperature, t.scale, node->at, out);
    else
        return read_lists(&t, e == &types[4], use, node->at, out);
    return true;
}

bool spectrum_read(struct reader *r, const struct xml_node *node, enum param_type use,
                   spectrum *out) {
    double v;
    if (tag_kind(node) == TAG_OBJECT)
        return read_typed(r, node, use, out);
    if (strcmp(node->tag, "rgb") == 0 || strcmp(node->tag, "srgb") == 0)
        return read_rgb(node, out);
    if (strcmp(node->tag, "spectrum") == 0)
        return read_plain_spectrum(r, node, use, out);
    if (strcmp(node->tag, "blackbody") == 0)
        return read_blackbody(node, out);
    if (strcmp(node->tag, "float") == 0 || strcmp(node->tag, "integer") == 0)
        return value_number(node, &v) && uniform(node, v, use, out);
    log_error_at(node->at, "<%s> stands where a colour was expected: rgb, spectrum or float",
                 node->tag);
    return false;
}
