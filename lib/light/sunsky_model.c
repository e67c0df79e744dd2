// SPDX-License-Identifier: Apache-2.0
// The tables of sunsky_data.inc come from the authors' data sets:
//
// Copyright (c) 2012 - 2013, Lukas Hosek and Alexander Wilkie. All rights reserved.
//
// Redistribution and use in source and binary forms, with or without modification, are permitted
// provided that the following conditions are met:
//  * Redistributions of source code must retain the above copyright notice, this list of conditions
//    and the following disclaimer.
//  * Redistributions in binary form must reproduce the above copyright notice, this list of
//    conditions and the following disclaimer in the documentation and/or other materials provided
//    with the distribution.
//  * None of the names of the contributors may be used to endorse or promote products derived from
//    this software without specific prior written permission.
//
// THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS AND CONTRIBUTORS "AS IS" AND ANY EXPRESS OR
// IMPLIED WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE IMPLIED WARRANTIES OF MERCHANTABILITY AND
// FITNESS FOR A PARTICULAR PURPOSE ARE DISCLAIMED. IN NO EVENT SHALL THE COPYRIGHT HOLDERS BE
// LIABLE FOR ANY DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR CONSEQUENTIAL DAMAGES
// (INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF SUBSTITUTE GOODS OR SERVICES; LOSS OF USE, DATA,
// OR PROFITS; OR BUSINESS INTERRUPTION) HOWEVER CAUSED AND ON ANY THEORY OF LIABILITY, WHETHER IN
// CONTRACT, STRICT LIABILITY, OR TORT (INCLUDING NEGLIGENCE OR OTHERWISE) ARISING IN ANY WAY OUT OF
// THE USE OF THIS SOFTWARE, EVEN IF ADVISED OF THE POSSIBILITY OF SUCH DAMAGE.
#include "light/sunsky_model.h"

#include <float.h>

#include "math/elementary.h"

#include "light/sunsky_data.inc"

enum { ALBEDOS = 2, CONTROLS = 6, PARAMS = 9, WAVELENGTHS = 11, SEGMENTS = 45, ELEVATIONS = 136 };

// Integral of the CIE observer's y: the scale between the data set and Mitsuba's radiance.
static const double Y_INTEGRAL = 106.7502593994140625;

// From the sun's radiance at 320, 360, ... 720 nm to Rec.709, in the same scale: the least-squares
// solution (exact to 4e-15) of Mitsuba's RGB table against its spectral one.
static const float SUN_TO_RGB[3][WAVELENGTHS] = {
    {1.7934206e-9f, 4.4848956e-5f, 0.0047480208f, 0.088409428f, -0.12293101f, -0.36807069f,
     0.15713704f, 0.98313869f, 0.47030961f, 0.049889143f, 0.0030968745f},
    {-2.2381727e-8f, -3.7134379e-5f, -0.0040999318f, -0.088232367f, 0.080300949f, 0.50669706f,
     0.51332765f, 0.061350242f, -0.042095002f, -0.0053459785f, -3.3651479e-4f},
    {-1.9874723e-8f, 2.5745976e-4f, 0.028819243f, 0.74057655f, 0.33272405f, -0.023314666f,
     -0.065954969f, -0.027364199f, -0.0042805359f, -3.444885e-4f, -2.079931e-5f},
};

static double lerp_d(double t, double a, double b) {
    return (1 - t) * a + t * b;
}

// Turbidities 1 to 10 stand in tables of 10 blocks.
static double turbidity_place(double turbidity, int *block) {
    *block = turbidity < 9 ? (int)turbidity - 1 : 8;
    *block = *block > 0 ? *block : 0;
    return turbidity - 1 - *block;
}

// One number of the data set: quintic Bezier in the cube root of the elevation, linear between
// turbidities and albedos. table: [turbidity][albedo][control][channel][param].
static float sky_entry(const float *table, int params, int channel, int param, double turbidity,
                       double albedo, double elevation) {
    static const double binomial[CONTROLS] = {1, 5, 10, 10, 5, 1};
    const double x = cbrt(elevation / (M_PI / 2));
    int block;
    const double t = turbidity_place(turbidity, &block);
    double sum = 0;
    for (int k = 0; k < CONTROLS; k++) {
        double v[2][ALBEDOS];
        for (int i = 0; i < 2 * ALBEDOS; i++) {
            const int row = ((block + i / 2) * ALBEDOS + i % 2) * CONTROLS + k;
            v[i / 2][i % 2] = (double)table[(row * 3 + channel) * params + param];
        }
        const double value = lerp_d(t, lerp_d(albedo, v[0][0], v[0][1]),
                                    lerp_d(albedo, v[1][0], v[1][1]));
        sum += binomial[k] * pow(1 - x, CONTROLS - 1 - k) * pow(x, k) * value;
    }
    return (float)sum;
}

static spectrum sky_entries(const float *table, int params, int param, double turbidity,
                            spectrum albedo, double elevation) {
    float rgb[3];
    for (int c = 0; c < 3; c++)
        rgb[c] = sky_entry(table, params, c, param, turbidity, (double)albedo[c], elevation);
    return spectrum_rgb(rgb[0], rgb[1], rgb[2]);
}

void sky_model_init(struct sky_model *m, double turbidity, spectrum albedo, double elevation) {
    for (int i = 0; i < PARAMS; i++)
        m->p[i] = sky_entries(SKY_PARAMS, PARAMS, i, turbidity, albedo, elevation);
    m->radiance = sky_entries(SKY_RADIANCE, 1, 0, turbidity, albedo, elevation) *
                  (float)(1 / Y_INTEGRAL);
}

static float power_three_halves(float x) {
    return x * sqrtf(x);
}

spectrum sky_model_eval(const struct sky_model *m, float cos_theta, float cos_gamma, float gamma) {
    const float c = cos_gamma, c2 = c * c;
    const spectrum one = spectrum_grey(1), *p = m->p;
    const spectrum horizon = one + p[0] * spectrum_map(fast_exp, p[1] / (cos_theta + 0.01f));
    const spectrum chi = spectrum_divide(
        spectrum_grey(1 + c2), spectrum_map(power_three_halves, one + p[8] * p[8] - 2 * c * p[8]));
    const spectrum glow = p[2] + p[3] * spectrum_map(fast_exp, p[4] * gamma) + p[5] * c2 + p[6] * chi +
                          p[7] * safe_sqrt(cos_theta);
    return spectrum_clamp(horizon * glow * m->radiance, 0, FLT_MAX);
}

// ---- sun

// Cubic in the elevation through four values that stand at thirds of a segment.
static double cubic(const float v[4], double t) {
    const double a = 3 * t, b = a - 1, c = a - 2, d = a - 3;
    return (double)v[0] * (b * c * d / -6) + (double)v[1] * (a * c * d / 2) +
           (double)v[2] * (a * b * d / -2) + (double)v[3] * (a * b * c / 6);
}

// Spectral radiance of the disk's centre, before limb darkening.
static double sun_radiance(double turbidity, int wavelength, double elevation) {
    const double place = cbrt(fmax(elevation, 0) / (M_PI / 2)) * SEGMENTS;
    const int segment = place < SEGMENTS ? (int)place : SEGMENTS - 1;
    const double lo = M_PI / 2 * pow((double)segment / SEGMENTS, 3);
    const double hi = M_PI / 2 * pow((segment + 1.0) / SEGMENTS, 3);
    const double t = fmin(fmax((elevation - lo) / (hi - lo), 0), 1);
    int block;
    const double between = turbidity_place(turbidity, &block);
    const float *v = SUN_RADIANCE + (block * WAVELENGTHS + wavelength) * ELEVATIONS + 3 * segment;
    return lerp_d(between, cubic(v, t), cubic(v + WAVELENGTHS * ELEVATIONS, t));
}

static void sun_knot(double turbidity, double elevation, spectrum limb[6]) {
    double rgb[6][3] = {{0}};
    for (int w = 0; w < WAVELENGTHS; w++) {
        const double radiance = sun_radiance(turbidity, w, elevation);
        for (int i = 0; i < 18; i++)
            rgb[i / 3][i % 3] += radiance * (double)SUN_LIMB[w * 6 + i / 3] *
                                 (double)SUN_TO_RGB[i % 3][w];
    }
    for (int i = 0; i < 6; i++)
        limb[i] = spectrum_rgb((float)rgb[i][0], (float)rgb[i][1], (float)rgb[i][2]);
}

void sun_model_init(struct sun_model *m, double turbidity, double elevation,
                    double half_aperture) {
    const double lowest = fmax(elevation - half_aperture, 0);
    const double highest = fmin(elevation + half_aperture, M_PI / 2);
    m->lowest = (float)lowest;
    m->step = (float)(fmax(highest - lowest, 1e-6) / (SUN_KNOTS - 1));
    for (int i = 0; i < SUN_KNOTS; i++)
        sun_knot(turbidity, lowest + i * (double)m->step, m->limb[i]);
}

spectrum sun_model_eval(const struct sun_model *m, float elevation, float cos_psi) {
    const float place = clampf((elevation - m->lowest) / m->step, 0, SUN_KNOTS - 1);
    const int i = place < SUN_KNOTS - 1 ? (int)place : SUN_KNOTS - 2;
    const float t = place - (float)i;
    spectrum sum = spectrum_grey(0);
    for (int k = 5; k >= 0; k--)
        sum = sum * cos_psi + (1 - t) * m->limb[i][k] + t * m->limb[i + 1][k];
    return spectrum_clamp(sum, 0, FLT_MAX);
}
