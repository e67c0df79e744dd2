// SPDX-License-Identifier: Apache-2.0
#include "image/primaries.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const image_space_names[] = {"rec709", "rec2020", "acescg", "aces2065-1", NULL};

static const char *const long_names[] = {"linear Rec.709", "linear Rec.2020", "ACEScg",
                                         "ACES2065-1"};

const struct primaries image_spaces[] = {
    {{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}}},
    {{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}}},
    {{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}}},
    {{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}}},
};

static void multiply(double a[3][3], double b[3][3], double out[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

static bool invert(double m[3][3], double out[3][3]) {
    double determinant = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int i = 0; i < 3; i++)
        determinant += m[0][i] * out[i][0];
    for (int i = 0; i < 9; i++)
        out[i / 3][i % 3] /= determinant;
    return isfinite(1 / determinant);
}

static void xyz_of(const double xy[2], double out[3]) {
    out[0] = xy[0] / xy[1];
    out[1] = 1;
    out[2] = (1 - xy[0] - xy[1]) / xy[1];
}

// Columns are the primaries, scaled so that (1, 1, 1) is the white of luminance 1.
static bool to_xyz(const struct primaries *p, double m[3][3]) {
    double inverse[3][3], white[3], column[3];
    for (int i = 0; i < 3; i++) {
        xyz_of(p->xy[i], column);
        for (int k = 0; k < 3; k++)
            m[k][i] = column[k];
    }
    xyz_of(p->xy[3], white);
    if (!invert(m, inverse))
        return false;
    for (int i = 0; i < 3; i++) {
        const double scale =
            inverse[i][0] * white[0] + inverse[i][1] * white[1] + inverse[i][2] * white[2];
        for (int k = 0; k < 3; k++)
            m[k][i] *= scale;
    }
    return true;
}

static bool adapt(const double from[2], const double to[2], double m[3][3]) {
    double cone[3][3] = {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}};
    double inverse[3][3], scaled[3][3], a[3], b[3];
    xyz_of(from, a);
    xyz_of(to, b);
    for (int i = 0; i < 3; i++) {
        const double source = cone[i][0] * a[0] + cone[i][1] * a[1] + cone[i][2] * a[2];
        const double target = cone[i][0] * b[0] + cone[i][1] * b[1] + cone[i][2] * b[2];
        for (int k = 0; k < 3; k++)
            scaled[i][k] = target / source * cone[i][k];
    }
    if (!invert(cone, inverse))
        return false;
    multiply(inverse, scaled, m);
    return true;
}

bool primaries_matrix(const struct primaries *from, const struct primaries *to, double m[3][3]) {
    double source[3][3], target[3][3], inverse[3][3], white[3][3], xyz[3][3];
    if (!to_xyz(from, source) || !to_xyz(to, target) || !invert(target, inverse) ||
        !adapt(from->xy[3], to->xy[3], white))
        return false;
    multiply(white, source, xyz);
    multiply(inverse, xyz, m);
    for (int i = 0; i < 9; i++)
        if (!isfinite(m[i / 3][i % 3]))
            return false;
    return true;
}

static void convert(struct image *im, const int channel[3], double m[3][3]) {
    const size_t pixels = (size_t)im->width * (size_t)im->height;
    for (size_t i = 0; i < pixels; i++) {
        float *p = im->pixels + i * (size_t)im->channels;
        double v[3];
        for (int c = 0; c < 3; c++)
            v[c] = (double)p[channel[c]];
        for (int c = 0; c < 3; c++)
            p[channel[c]] = (float)(m[c][0] * v[0] + m[c][1] * v[1] + m[c][2] * v[2]);
    }
}

// The channels of the layer whose red one is channel `red`; false: it is none, or of numbers that are
// no colours.
static bool find_layer(const struct image *im, int red, int channel[3]) {
    char name[IMAGE_NAME_SIZE];
    const size_t n = strlen(im->channel_names[red]);
    snprintf(name, sizeof name, "%s", im->channel_names[red]);
    if (name[n - 1] != 'R' || (n > 1 && name[n - 2] != '.') || strncmp(name, "Crypto", 6) == 0 ||
        strncmp(name, "m2.", 3) == 0 || strncmp(name, "variance.", 9) == 0)
        return false;
    for (int c = 0; c < 3; c++) {
        name[n - 1] = "RGB"[c];
        channel[c] = image_find_channel(im, name);
        if (channel[c] < 0)
            return false;
    }
    return true;
}

void image_from_rec709(struct image *im, enum image_space space) {
    double m[3][3];
    char text[256];
    int channel[3];
    const struct primaries *to = &image_spaces[space];
    image_set_text(im, "relume.colourSpace", long_names[space]);
    if (space == SPACE_REC709 || !primaries_matrix(&image_spaces[SPACE_REC709], to, m))
        return;
    for (int c = 0; c < im->channels; c++)
        if (find_layer(im, c, channel))
            convert(im, channel, m);
    snprintf(text, sizeof text, "%g %g %g %g %g %g %g %g", to->xy[0][0], to->xy[0][1], to->xy[1][0],
             to->xy[1][1], to->xy[2][0], to->xy[2][1], to->xy[3][0], to->xy[3][1]);
    image_set_text(im, "chromaticities", text);
}

void image_rgb_to_rec709(struct image *rgb, const struct image *of) {
    static const int channel[3] = {0, 1, 2};
    const struct image_attribute *a = image_find_attribute(of, "chromaticities");
    struct primaries p;
    double m[3][3];
    if (a && a->text && rgb->channels >= 3 &&
        sscanf(a->text, "%lf %lf %lf %lf %lf %lf %lf %lf", &p.xy[0][0], &p.xy[0][1], &p.xy[1][0],
               &p.xy[1][1], &p.xy[2][0], &p.xy[2][1], &p.xy[3][0], &p.xy[3][1]) == 8 &&
        primaries_matrix(&p, &image_spaces[SPACE_REC709], m))
        convert(rgb, channel, m);
}
