// SPDX-License-Identifier: Apache-2.0
// Scattered samples to a regular table.
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "table/goniometer_reader.h"

enum { MOST_ANGLES = 64, FEWEST_SAMPLES = 6, NEIGHBOURS = 6, OUT_THETAS = 46, OUT_PHIS = 120,
       MOST_SAMPLES = 1 << 20 };

static const float LARGEST = 1e12f;    // what lies beyond is damage
static const float SAME_ANGLE = 1e-3f; // radians

void gonio_add(struct gonio_samples *s, const struct gonio_sample *sample) {
    bool good = isfinite(sample->theta_i) && isfinite(sample->out[0]) && isfinite(sample->out[1]) &&
                sample->out[2] >= 0 && sample->theta_i >= 0 && sample->theta_i < PI / 2;
    for (int c = 0; c < 3; c++)
        good = good && sample->rgb[c] >= 0 && sample->rgb[c] <= LARGEST;
    if (!good) {
        s->invalid++;
        return;
    }
    mem_grow(&s->items, &s->capacity, s->count + 1, sizeof *s->items);
    s->items[s->count++] = *sample;
}

static int by_angle(const void *a, const void *b) {
    const struct gonio_sample *x = a, *y = b;
    return (x->theta_i > y->theta_i) - (x->theta_i < y->theta_i);
}

// Weighted mean of the samples nearest to a direction.
static void interpolate(const struct gonio_sample *s, size_t count, vec3 out, float rgb[3]) {
    float distance[NEIGHBOURS + 1];
    const float *value[NEIGHBOURS + 1];
    int n = 0;
    for (size_t i = 0; i < 2 * count; i++) { // and the mirror images of the samples at y = 0
        const struct gonio_sample *from = &s[i / 2];
        const vec3 at = v3(from->out[0], i & 1 ? -from->out[1] : from->out[1], from->out[2]);
        const float d = length(at - out);
        if (n == NEIGHBOURS + 1 && d >= distance[n - 1])
            continue;
        int k = n < NEIGHBOURS + 1 ? n++ : n - 1;
        for (; k > 0 && distance[k - 1] > d; k--) {
            distance[k] = distance[k - 1];
            value[k] = value[k - 1];
        }
        distance[k] = d;
        value[k] = from->rgb;
    }
    const float radius = maxf(distance[n - 1], 1e-6f);
    double sum[3] = {0}, weights = 0;
    for (int k = 0; k < n; k++) {
        const double w = 1 / maxf(distance[k], 1e-5f) - 1 / radius;
        const double weight = k == 0 ? fmax(w * w, 1e-6) : w > 0 ? w * w : 0;
        weights += weight;
        for (int c = 0; c < 3; c++)
            sum[c] += weight * (double)value[k][c];
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)(sum[c] / weights);
}

static void resample_angle(const struct gonio_sample *s, size_t count, float (*f)[3]) {
    for (int i = 0; i < OUT_THETAS; i++)
        for (int j = 0; j < OUT_PHIS; j++) {
            const float theta = (float)i * (0.5f * PI / (OUT_THETAS - 1));
            const float phi = (float)j * (TWO_PI / OUT_PHIS);
            const vec3 out = v3(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
            interpolate(s, count, out, f[i * OUT_PHIS + j]);
        }
}

// Where each incident angle's samples begin in the sorted list; 0: too many angles.
static int group(const struct gonio_samples *s, size_t first[MOST_ANGLES + 1]) {
    int n = 0;
    for (size_t i = 0; i < s->count; i++)
        if (i == 0 || s->items[i].theta_i - s->items[first[n - 1]].theta_i > SAME_ANGLE) {
            if (n == MOST_ANGLES)
                return 0;
            first[n++] = i;
        }
    first[n] = s->count;
    return n;
}

bool gonio_resample(const char *path, const struct gonio_samples *s, struct goniometer_table *t,
                    struct arena *arena) {
    size_t first[MOST_ANGLES + 1];
    if (s->count < FEWEST_SAMPLES || s->count > MOST_SAMPLES) {
        log_error("%s: has %zu samples that are valid, expected %d to %d", path, s->count,
                  FEWEST_SAMPLES, MOST_SAMPLES);
        return false;
    }
    qsort(s->items, s->count, sizeof *s->items, by_angle);
    const int n = group(s, first);
    if (n == 0) {
        log_error("%s: has more than %d incident angles: it is not a list of them", path,
                  MOST_ANGLES);
        return false;
    }
    *t = (struct goniometer_table){.theta_count = n, .phi_count = 1, .symmetry = 1,
                                   .out_thetas = OUT_THETAS, .out_phis = OUT_PHIS,
                                   .invalid = s->invalid};
    t->theta = arena_alloc(arena, (size_t)n * sizeof *t->theta);
    t->phi = arena_alloc(arena, sizeof *t->phi);
    t->f[0] = gonio_alloc(t, arena);
    for (int k = 0; k < n; k++) {
        t->theta[k] = s->items[first[k]].theta_i;
        resample_angle(s->items + first[k], first[k + 1] - first[k],
                       t->f[0] + (size_t)k * goniometer_slice(t));
    }
    return true;
}
