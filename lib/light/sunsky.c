// SPDX-License-Identifier: Apache-2.0
// Clear sky with the sun's disk (sunsky_model.h). Nothing shines from below the horizon.
//
// The sky is sampled from a table of its luminance in cells of equal solid angle, the sun from its
// cone; the density is the mixture of both wherever a direction comes from.
#include "light/sunsky.h"

#include "light/sun_position.h"
#include "light/turn.h"
#include "math/elementary.h"

enum { ROWS = SUNSKY_ROWS, COLUMNS = SUNSKY_COLUMNS };

static const char *const ups[] = {"z", "y", NULL};
static const char *const models[] = {"hosek", "preetham", NULL};

#define NUMBER(member, default_, min_, max_, unit_, help_)                                         \
    {#member, PARAM_FLOAT, offsetof(struct sunsky, member), .def = default_, .min = min_,          \
     .max = max_, .unit = unit_, .help = help_}
#define INTEGER(member, default_, min_, max_, help_)                                               \
    {#member, PARAM_INT, offsetof(struct sunsky, member), .def = default_, .min = min_,            \
     .max = max_, .unit = "", .help = help_}

static const struct param params[] = {
    NUMBER(turbidity, "3", 1, 10, "", "haze: 2 very clear, 10 hazy"),
    {"albedo", PARAM_REFLECTANCE, offsetof(struct sunsky, albedo), .def = "0.3", .max = 1,
     .unit = "", .help = "of the ground"},
    {"sun_direction", PARAM_VECTOR, offsetof(struct sunsky, sun_direction), .unit = "",
     .help = "towards the sun, in the world; not given: by place and time", .optional = true},
    NUMBER(latitude, "35.6894", -90, 90, "degrees", "north"),
    NUMBER(longitude, "139.6917", -180, 180, "degrees", "east"),
    NUMBER(timezone, "9", -14, 14, "h", "ahead of universal time"),
    INTEGER(year, "2010", 1, 9999, "of the date"),
    INTEGER(month, "7", 1, 12, "of the date"),
    INTEGER(day, "10", 1, 31, "of the date"),
    NUMBER(hour, "15", 0, 24, "h", "local time"),
    NUMBER(minute, "0", 0, 60, "min", "local time"),
    NUMBER(second, "0", 0, 60, "s", "local time"),
    NUMBER(sun_scale, "1", 0, 1e30, "", "factor of the sun's radiance"),
    NUMBER(sky_scale, "1", 0, 1e30, "", "factor of the sky's radiance"),
    NUMBER(scale, "1", 0, 1e30, "", "factor of both"),
    NUMBER(sun_aperture, "0.5358", 1e-2, 179, "degrees", "of the disk; keeps its power"),
    NUMBER(sun_radius_scale, "1", 1e-2, 300, "", "factor of sun_aperture (version 0.5)"),
    {"up", PARAM_CHOICE, offsetof(struct sunsky, up), .def = "z", .unit = "",
     .help = "axis of the zenith before to_world: z as in version 3, y as in 0.5",
     .choices = ups},
    {"model", PARAM_CHOICE, offsetof(struct sunsky, model), .def = "hosek", .unit = "",
     .help = "of the sky: Hosek, Wilkie 2012 or Preetham et al. 1999 (which has no albedo)",
     .choices = models},
    {"to_world", PARAM_TRANSFORM, offsetof(struct sunsky, to_world), .def = "", .unit = "",
     .help = "rotates the sky"},
    {"resolution", PARAM_IGNORED, .unit = "", .help = "the model is evaluated exactly"},
    LIGHT_PARAMS,
    PARAM_END,
};

// ---- radiance, in local directions

// 1 - cos of an angle, from the chord: exact also for the small angles of the disk.
static float height_from_sun(const struct sunsky *s, vec3 w) {
    return 0.5f * length2(w - s->sun.n);
}

static spectrum sun_radiance(const struct sunsky *s, vec3 w, float gamma) {
    const float sine = sinf(gamma) / s->sin_aperture;
    return s->sun_factor *
           sun_model_eval(&s->disk, asinf(clampf(w[2], -1, 1)), safe_sqrt(1 - sine * sine));
}

static spectrum sky_radiance(const struct sunsky *s, vec3 w, float height, float gamma) {
    return s->model ? preetham_sky_eval(&s->preetham, w[2], 1 - height, gamma)
                    : sky_model_eval(&s->sky, w[2], 1 - height, gamma);
}

static spectrum radiance(const struct sunsky *s, vec3 w) {
    if (s->dark || !(w[2] >= 0))
        return spectrum_grey(0);
    const float height = height_from_sun(s, w);
    const float gamma = 2 * asinf(minf(sqrtf(0.5f * height), 1));
    spectrum sum = s->sky_factor * sky_radiance(s, w, height, gamma);
    if (height <= s->cone_height)
        sum += sun_radiance(s, w, gamma);
    return sum;
}

// ---- preparation

static vec3 cell_direction(float row, float column) {
    const float z = row / ROWS, r = safe_sqrt(1 - z * z);
    float sine, cosine;
    sincos_turn(column / COLUMNS, &sine, &cosine);
    return v3(r * cosine, r * sine, z);
}

// The sky alone. Every cell keeps some weight, so that none is out of reach. Returns the integral
// of the luminance.
static double init_table(struct sunsky *s) {
    float weights[ROWS][COLUMNS], sums[ROWS] = {0};
    double total = 0;
    for (int y = 0; y < ROWS; y++)
        for (int x = 0; x < COLUMNS; x++) {
            weights[y][x] = 0;
            for (int i = 0; i < 4; i++) {
                const vec3 w = cell_direction((float)y + 0.25f + 0.5f * (float)(i / 2),
                                              (float)x + 0.25f + 0.5f * (float)(i % 2));
                const float height = height_from_sun(s, w);
                const float gamma = 2 * asinf(minf(sqrtf(0.5f * height), 1));
                weights[y][x] += 0.25f * spectrum_luminance(sky_radiance(s, w, height, gamma));
            }
            total += (double)weights[y][x];
        }
    const float least = (float)(1e-2 * total / (ROWS * COLUMNS));
    for (int y = 0; y < ROWS; y++) {
        for (int x = 0; x < COLUMNS; x++)
            sums[y] += weights[y][x] += least;
        distribution_init(&s->columns[y], weights[y], COLUMNS);
    }
    distribution_init(&s->rows, sums, ROWS);
    for (uint32_t y = 0; y < ROWS; y++)
        for (uint32_t x = 0; x < COLUMNS; x++)
            s->density[y][x] = distribution_pmf(&s->rows, y) * distribution_pmf(&s->columns[y], x) *
                               (ROWS * COLUMNS / TWO_PI);
    return (double)s->sky_factor * total * (2 * M_PI / (ROWS * COLUMNS));
}

static vec3 cone_direction(const struct sunsky *s, struct vec2 u) {
    const float height = u.x * s->cone_height;
    const float r = safe_sqrt(height * (2 - height));
    float sine, cosine;
    sincos_turn(u.y, &sine, &cosine);
    return to_world(&s->sun, v3(r * cosine, r * sine, 1 - height));
}

static double sun_integral(const struct sunsky *s) {
    enum { STEPS = 32 };
    double sum = 0;
    for (int i = 0; i < STEPS * STEPS; i++) {
        const struct vec2 u = {((float)(i / STEPS) + 0.5f) / STEPS,
                               ((float)(i % STEPS) + 0.5f) / STEPS};
        const vec3 w = cone_direction(s, u);
        const float gamma = 2 * asinf(sqrtf(0.5f * u.x * s->cone_height));
        if (w[2] >= 0)
            sum += (double)spectrum_luminance(sun_radiance(s, w, gamma));
    }
    return sum / (STEPS * STEPS) * (2 * M_PI) * (double)s->cone_height;
}

static vec3 local_sun_direction(const struct sunsky *s) {
    if (length2(s->sun_direction) > 0)
        return normalize(affine_vector(&s->local, normalize(s->sun_direction)));
    const struct sun_time t = {.year = s->year, .month = s->month, .day = s->day,
                               .hour = (double)s->hour, .minute = (double)s->minute,
                               .second = (double)s->second, .latitude = (double)s->latitude,
                               .longitude = (double)s->longitude, .timezone = (double)s->timezone};
    return sun_position(&t);
}

static void init_models(struct sunsky *s) {
    static const double true_half = 0.5 * 0.5358 * (M_PI / 180); // of the data
    const double half = fmin(0.5 * (double)s->sun_aperture * (double)s->sun_radius_scale, 89) *
                        (M_PI / 180);
    const double elevation = asin(fmin((double)s->sun.n[2], 1));
    const double height = 2 * sin(half / 2) * sin(half / 2);
    s->half_aperture = (float)half;
    s->sin_aperture = (float)sin(half);
    s->cone_height = (float)height;
    s->sky_factor = s->scale * s->sky_scale;
    s->sun_factor = s->scale * s->sun_scale *
                    (float)(2 * sin(true_half / 2) * sin(true_half / 2) / height);
    if (s->model)
        preetham_sky_init(&s->preetham, (double)s->turbidity, elevation);
    else
        sky_model_init(&s->sky, (double)s->turbidity, s->albedo, elevation);
    sun_model_init(&s->disk, (double)s->turbidity, elevation, half);
}

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct sunsky *s = self->data;
    (void)arena;
    struct transform m = s->to_world;
    if (s->up == 1) {
        const struct transform z_to_y = transform_rotate((const double[3]){1, 0, 0}, -90);
        m = transform_multiply(&m, &z_to_y);
    }
    if (!light_rotation(self, &m, &s->world, &s->local))
        return false;
    s->radius = scene->radius;
    s->sun = frame_from_normal(local_sun_direction(s));
    s->dark = !(s->sun.n[2] >= 0);
    if (s->dark) {
        log_warn_at(self->at, "sunsky: the sun is below the horizon; the sky is black");
        return true;
    }
    init_models(s);
    const double sky = init_table(s), sun = sun_integral(s);
    s->mean = (float)((sky + sun) / (4 * M_PI));
    s->dark = !(sky + sun > 0);
    s->sky_share = sun > 0 ? clampf((float)(sky / (sky + sun)), 0.1f, 0.9f) : 1;
    if (!(sky > 0))
        s->sky_share = 0;
    return true;
}

// ---- sampling

static float sky_pdf(const struct sunsky *s, vec3 w) {
    const int row = (int)(w[2] * ROWS), column = (int)(turn_of(w[1], w[0]) * COLUMNS);
    return s->density[row < ROWS ? row : ROWS - 1][column < COLUMNS ? column : COLUMNS - 1];
}

// w above the horizon; sky: the sky's density there
static float mixture_pdf(const struct sunsky *s, vec3 w, float sky) {
    const float pdf = s->sky_share * sky;
    if (height_from_sun(s, w) > s->cone_height)
        return pdf;
    return pdf + (1 - s->sky_share) / (TWO_PI * s->cone_height);
}

static vec3 sample_sky(const struct sunsky *s, struct vec2 u, float *pdf) {
    float pmf, y, x;
    const uint32_t row = distribution_sample(&s->rows, u.y, &pmf, &y);
    const uint32_t column = distribution_sample(&s->columns[row], u.x, &pmf, &x);
    *pdf = s->density[row][column];
    return cell_direction((float)row + y, (float)column + x);
}

static bool aim(const void *data, struct vec2 u, struct light_sample *out) {
    const struct sunsky *s = data;
    if (s->dark)
        return false;
    const bool sky = u.x < s->sky_share;
    u.x = minf(sky ? u.x / s->sky_share : (u.x - s->sky_share) / (1 - s->sky_share),
               0x1.fffffep-1f);
    float sky_density = 0;
    const vec3 w = normalize(sky ? sample_sky(s, u, &sky_density) : cone_direction(s, u));
    if (!(w[2] >= 0))
        return false;
    if (!sky && s->sky_share > 0)
        sky_density = sky_pdf(s, w);
    *out = (struct light_sample){.wi = affine_vector(&s->world, w), .distance = INFINITY,
                                 .pdf_sa = mixture_pdf(s, w, sky_density)};
    return out->pdf_sa > 0;
}

static spectrum emission(const void *data, const struct light_hit *hit) {
    const struct sunsky *s = data;
    return radiance(s, affine_vector(&s->local, hit->wi));
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *out) {
    (void)p;
    if (!aim(data, u, out))
        return false;
    out->emission = emission(data, &(struct light_hit){.wi = out->wi});
    return true;
}

static float pdf_sa(const void *data, vec3 p, const struct light_hit *hit) {
    const struct sunsky *s = data;
    (void)p;
    const vec3 w = affine_vector(&s->local, hit->wi);
    if (s->dark || !(w[2] >= 0))
        return 0;
    return mixture_pdf(s, w, s->sky_share > 0 ? sky_pdf(s, w) : 0);
}

static float power(const void *data) {
    const struct sunsky *s = data;
    return light_power_infinite(s->mean, s->radius);
}

static float detail(const void *data) {
    return ((const struct sunsky *)data)->half_aperture;
}

static void finish(void *data) {
    struct sunsky *s = data;
    distribution_finish(&s->rows);
    for (int i = 0; i < ROWS; i++)
        distribution_finish(&s->columns[i]);
}

const struct light_type light_sunsky = {
    .entry = {.name = "sunsky", .help = "clear sky and sun (Hosek, Wilkie 2012, 2013)",
              .params = params, .size = sizeof(struct sunsky)},
    .infinite = true,
    .prepare = prepare, .sample = sample, .aim = aim,
    .sample_wide = sunsky_aim_wide, .emission = emission, .pdf_sa = pdf_sa, .power = power,
    .detail = detail, .finish = finish,
};
