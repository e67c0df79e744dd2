// SPDX-License-Identifier: Apache-2.0
#include "sink/film_layout.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"

static const struct aov {
    const char *name;
    uint32_t bit;
    int channels;
} aov_table[] = {
    {"albedo", AOV_ALBEDO, 3}, {"N", AOV_N, 3},   {"Ng", AOV_NG, 3},       {"Z", AOV_Z, 1},
    {"P", AOV_P, 3},           {"uv", AOV_UV, 2}, {"shape", AOV_SHAPE, 1}, {"instance", AOV_INSTANCE, 1},
};

enum { AOVS = sizeof aov_table / sizeof *aov_table };

bool film_aovs_parse(const char *list, uint32_t *aovs) {
    *aovs = 0;
    for (const char *name = list; *name;) {
        const size_t n = strcspn(name, ",");
        int i = 0;
        while (i < AOVS &&
               (strlen(aov_table[i].name) != n || strncmp(aov_table[i].name, name, n) != 0))
            i++;
        if (i == AOVS) {
            log_error("--aov: '%.*s' is not a layer; known are albedo, N, Ng, Z, P, uv, shape, "
                      "instance", (int)n, name);
            return false;
        }
        *aovs |= aov_table[i].bit;
        name += n + (name[n] == ',');
    }
    return true;
}

bool film_is_layer(const char *name) {
    static const char *const others[] = {"variance", "m2", "clamped", "samples"};
    bool known = false;
    for (int i = 0; i < AOVS; i++)
        known |= strcmp(aov_table[i].name, name) == 0;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        known |= strcmp(others[i], name) == 0;
    for (int i = 0; i < PATH_SLOTS; i++)
        known |= strcmp(film_path_names[i], name) == 0;
    return known;
}

static uint32_t take(uint32_t *next, bool wanted, uint32_t count) {
    const uint32_t first = *next;
    *next += wanted ? count : 0;
    return wanted ? first : LAYOUT_NONE;
}

void film_layout_init(struct film_layout *l, const struct film_options *o) {
    uint32_t slots = 0;
    // With light groups the picture is the sum of its groups; replicates and moments need it too.
    l->beauty_slot = take(&slots, !o->group_count || o->variance || o->moments, 1);
    l->group_slot = take(&slots, o->group_count > 0, o->group_count);
    l->path_slot = take(&slots, o->paths, PATH_SLOTS);
    l->clamp_slot = take(&slots, o->clamp > 0, 1);
    l->slots = slots;
    uint32_t channels = 3 * slots;
    l->replicate_channel = take(&channels, o->variance, 3 * FILM_REPLICATES);
    l->moment_channel = take(&channels, o->moments, 3);
    l->alpha_channel = take(&channels, o->alpha, 1);
    uint32_t aov_channels = 1;
    for (int i = 0; i < AOVS; i++)
        aov_channels += o->aovs & aov_table[i].bit ? (uint32_t)aov_table[i].channels : 0;
    l->aov_channel = take(&channels, o->aovs != 0, aov_channels);
    l->aovs = o->aovs;
    l->channels = channels;
}

static double *add3(double *out, vec3 v) {
    for (int k = 0; k < 3; k++)
        out[k] += (double)v[k];
    return out + 3;
}

void film_layout_add_aovs(const struct film_layout *l, double *pixel, const struct sink_surface *s,
                          bool is_first_sample) {
    double *out = pixel + l->aov_channel;
    *out++ += 1;
    if (l->aovs & AOV_ALBEDO)
        out = add3(out, s->albedo);
    if (l->aovs & AOV_N)
        out = add3(out, s->n);
    if (l->aovs & AOV_NG)
        out = add3(out, s->ng);
    if (l->aovs & AOV_Z)
        *out++ += (double)s->z;
    if (l->aovs & AOV_P)
        out = add3(out, s->p);
    if (l->aovs & AOV_UV) {
        *out++ += (double)s->uv.x;
        *out++ += (double)s->uv.y;
    }
    if (l->aovs & AOV_SHAPE) // an index has no mean: it is the first sample's
        *out++ += is_first_sample ? s->shape : 0;
    if (l->aovs & AOV_INSTANCE)
        *out++ += is_first_sample ? s->instance : 0;
}
