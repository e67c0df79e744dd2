// SPDX-License-Identifier: Apache-2.0
#include "light/preetham.h"

// Per quantity (Y, x, y) and coefficient A to E: slope and offset in the turbidity.
static const double PEREZ[3][5][2] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}},
    {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}},
};

// Zenith chromaticities x and y: [turbidity^2, turbidity, 1][theta_s^3, theta_s^2, theta_s, 1].
static const double ZENITH[2][3][4] = {
    {{0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394},
     {0.11693, -0.21196, 0.06052, 0.25886}},
    {{0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516},
     {0.15346, -0.26756, 0.06670, 0.26688}},
};

// From kcd/m^2 to the radiance of sunsky_model.h: over 683 lm/W and the integral of the observer's y.
static const double UNIT = 1000 / (683.002 * 106.7502593994140625);

// Equation 3. The first bracket has a pole at the horizon: the paper's B is negative, so it tends to 1.
static float perez(const float c[5], float cos_theta, float cos_gamma, float gamma) {
    return (1 + c[0] * expf(c[1] / maxf(cos_theta, 1e-3f))) *
           (1 + c[2] * expf(c[3] * gamma) + c[4] * cos_gamma * cos_gamma);
}

static double zenith_colour(int k, double t, double s) {
    const double powers[4] = {s * s * s, s * s, s, 1}, turbidity[3] = {t * t, t, 1};
    double sum = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            sum += turbidity[i] * ZENITH[k][i][j] * powers[j];
    return sum;
}

void preetham_sky_init(struct preetham_sky *s, double turbidity, double elevation) {
    const double t = fmax(turbidity, 1.7), theta_s = M_PI / 2 - elevation;
    const double chi = (4.0 / 9 - t / 120) * (M_PI - 2 * theta_s);
    const double y = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
    const double zenith[3] = {fmax(y, 0) * UNIT, zenith_colour(0, t, theta_s),
                              zenith_colour(1, t, theta_s)};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 5; i++)
            s->perez[k][i] = (float)(PEREZ[k][i][0] * t + PEREZ[k][i][1]);
        s->zenith[k] = (float)(zenith[k] / (double)perez(s->perez[k], 1, (float)cos(theta_s),
                                                         (float)theta_s));
    }
}

spectrum preetham_sky_eval(const struct preetham_sky *s, float cos_theta, float cos_gamma,
                           float gamma) {
    float v[3];
    for (int k = 0; k < 3; k++)
        v[k] = s->zenith[k] * perez(s->perez[k], cos_theta, cos_gamma, gamma);
    const float y = maxf(v[2], 1e-3f);
    const float X = v[1] / y, Z = (1 - v[1] - y) / y; // over Y
    const spectrum rgb = spectrum_rgb(3.240479f * X - 1.537150f - 0.498535f * Z,
                                      -0.969256f * X + 1.875991f + 0.041556f * Z,
                                      0.055648f * X - 0.204043f + 1.057311f * Z);
    return spectrum_clamp(rgb * maxf(v[0], 0), 0, 1e30f);
}
