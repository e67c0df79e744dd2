// SPDX-License-Identifier: Apache-2.0
// Goniometer measurements of Cornell's Program of Computer Graphics, as pbrt-v2 distributes them:
// '#' begins a comment; the number of wavelengths, the wavelengths in nm, then for each sample
// theta_i phi_i theta_s phi_s in radians and f at each wavelength. Materials are isotropic; the
// azimuth of the mirror direction is that of the light plus pi.
#include <string.h>

#include "base/log.h"
#include "base/text.h"
#include "math/colour.h"
#include "table/goniometer_reader.h"

enum { MOST_WAVELENGTHS = 512 };

static void skip(const char **p) {
    while (text_is_space(**p) || **p == '#') {
        if (**p == '#')
            *p += strcspn(*p, "\n");
        else
            ++*p;
    }
}

static bool number(const char **p, double *v) {
    skip(p);
    return text_number(p, v);
}

// Colours of the hats at the wavelengths; the first and last value go on beyond them.
static void colour_weights(const double *wavelengths, int count, float (*w)[3]) {
    double x[MOST_WAVELENGTHS + 2], y[MOST_WAVELENGTHS + 2] = {0};
    memcpy(x + 1, wavelengths, (size_t)count * sizeof *x);
    x[0] = wavelengths[0] - 1e4;
    x[count + 1] = wavelengths[count - 1] + 1e4;
    for (int i = 0; i < count; i++) {
        y[i + 1] = 1;
        y[0] = i == 0;
        y[count + 1] = i == count - 1;
        const spectrum c = colour_from_samples(x, y, (size_t)count + 2, true);
        y[i + 1] = y[0] = y[count + 1] = 0;
        for (int k = 0; k < 3; k++)
            w[i][k] = c[k];
    }
}

static bool read_wavelengths(const char **p, double *wavelengths, int *count) {
    double n;
    if (!number(p, &n) || !(n >= 2) || n > MOST_WAVELENGTHS || n != floor(n))
        return false;
    *count = (int)n;
    for (int i = 0; i < *count; i++)
        if (!number(p, &wavelengths[i]) || !(wavelengths[i] > 0) || wavelengths[i] > 1e5 ||
            (i > 0 && !(wavelengths[i] > wavelengths[i - 1])))
            return false;
    return true;
}

static vec3 direction(double theta, double phi) {
    return v3((float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta));
}

// One sample; a word that is no number counts as a value that is missing.
static bool read_sample(const char **p, int count, const float (*w)[3], struct gonio_sample *s) {
    double angle[4], v, sum = 0;
    float rgb[3] = {0};
    for (int i = 0; i < 4; i++)
        if (!number(p, &angle[i]))
            return false;
    for (int i = 0; i < count; i++) {
        skip(p);
        if (**p == '\0')
            return false;
        if (!text_number(p, &v)) {
            *p += strcspn(*p, " \t\r\n");
            v = NAN;
        }
        sum += v;
        for (int c = 0; c < 3; c++)
            rgb[c] += w[i][c] * (float)v;
    }
    *s = (struct gonio_sample){(float)angle[0], 0, direction(angle[2], angle[3] - angle[1]), {0}};
    for (int c = 0; c < 3; c++) // colours may lie outside of the gamut; light is not negative
        s->rgb[c] = sum >= 0 ? (rgb[c] < 0 ? 0 : rgb[c]) : -1;
    return true;
}

bool cornell_read(const char *path, char *text, struct goniometer_table *t, struct arena *arena) {
    const char *p = text;
    double wavelengths[MOST_WAVELENGTHS];
    static const char *const expected = "expected the number of wavelengths, ascending wavelengths "
                                        "in nm and samples of four angles and as many values";
    float weights[MOST_WAVELENGTHS][3];
    struct gonio_samples samples = {0};
    struct gonio_sample s;
    int count;
    if (!read_wavelengths(&p, wavelengths, &count)) {
        log_error("%s: %s", path, expected);
        return false;
    }
    colour_weights(wavelengths, count, weights);
    bool good = true;
    for (skip(&p); good && *p; skip(&p)) {
        good = read_sample(&p, count, weights, &s);
        if (good)
            gonio_add(&samples, &s);
    }
    if (!good)
        log_error("%s: a sample is cut off or has an angle that is no number; %s", path, expected);
    good = good && gonio_resample(path, &samples, t, arena);
    mem_free(samples.items);
    return good;
}
