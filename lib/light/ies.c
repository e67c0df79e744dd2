// SPDX-License-Identifier: Apache-2.0
// A point light with the measured distribution of a luminaire (ies_profile.h): shines along its +z
// axis, as a spot does, that being straight down in the laboratory.
#include <float.h>

#include "light/ies_profile.h"
#include "light/light.h"

struct ies {
    struct transform to_world;
    const char *filename;
    spectrum intensity;
    int unit;
    float tilt;
    // made by prepare
    struct ies_profile profile;
    vec3 p;
    struct affine world, local; // rotations
    float scale;                // W/sr (or what `unit` says) per candela
    float strongest;            // candela
    float flux;                 // candela sr
};

enum unit { UNIT_WATT, UNIT_CANDELA };

static const char *const units[] = {"W/sr", "cd", NULL};

static const struct param params[] = {
    {"to_world", PARAM_TRANSFORM, offsetof(struct ies, to_world), .def = "", .unit = "",
     .help = "light to world: a rotation and where it stands; shines along +z"},
    {"filename", PARAM_FILE, offsetof(struct ies, filename), .unit = "",
     .help = "photometric file, LM-63-1986 to -2019"},
    {"intensity", PARAM_EMISSION, offsetof(struct ies, intensity), .def = "1", .min = 0,
     .max = 1e30, .unit = "", .help = "colour and factor of what the file says"},
    {"unit", PARAM_CHOICE, offsetof(struct ies, unit), .def = "W/sr", .unit = "",
     .help = "the picture's: W/sr divides candela by 683 lm/W, cd takes them as they are",
     .choices = units},
    {"tilt", PARAM_FLOAT, offsetof(struct ies, tilt), .def = "0", .min = -360, .max = 360,
     .unit = "degrees", .help = "of the lamp from where it was measured: dims by the file's table"},
    LIGHT_PARAMS,
    PARAM_END,
};

static bool prepare(struct object *self, const struct light_scene *scene, struct arena *arena) {
    struct ies *d = self->data;
    (void)arena;
    if (!light_rotation(self, &d->to_world, &d->world, &d->local) ||
        !ies_profile_read(d->filename, d->tilt, &d->profile))
        return false;
    const struct ies_profile *profile = &d->profile;
    if (profile->negative)
        log_warn_at(self->at, "ies: %s has %u candela values below zero; they count as zero",
                    d->filename, profile->negative);
    d->p = light_position(&d->to_world, v3(0, 0, 0), scene);
    // 683 lumen a watt: the luminous efficacy of 540 THz, which defines the candela
    d->scale = d->unit == UNIT_WATT ? 1 / 683.0f : 1;
    for (size_t i = 0; i < (size_t)profile->vertical_count * profile->horizontal_count; i++)
        d->strongest = maxf(d->strongest, profile->candela[i]);
    d->flux = ies_profile_flux(profile);
    return true;
}

static bool sample(const void *data, vec3 p, struct vec2 u, struct light_sample *s) {
    const struct ies *d = data;
    (void)u;
    const vec3 w = affine_vector(&d->local, normalize(p - d->p));
    const float candela = ies_profile_eval(&d->profile, w);
    return candela > 0 && light_sample_point(d->p, p, d->intensity * (candela * d->scale), s);
}

static float power(const void *data) {
    const struct ies *d = data;
    return minf(d->flux * d->scale * spectrum_luminance(d->intensity), FLT_MAX);
}

static void bounds(const void *data, uint32_t part, struct light_bounds *b) {
    const struct ies *d = data;
    (void)part;
    *b = light_bounds_of_point(d->p, d->intensity * (d->strongest * d->scale));
    b->axis = d->world.z;
    b->cos_o = ies_profile_cone(&d->profile);
    b->cos_e = b->cos_o > -1 ? 0.99f : 0;
}

static void finish(void *data) {
    ies_profile_finish(&((struct ies *)data)->profile);
}

static const char *const aliases[] = {"goniometric", NULL};

const struct light_type light_ies = {
    .entry = {.name = "ies", .help = "luminaire as measured, from a photometric file (LM-63)",
              .aliases = aliases, .params = params, .size = sizeof(struct ies)},
    .delta = true,
    .prepare = prepare, .sample = sample, .power = power, .bounds = bounds, .finish = finish,
};
