// SPDX-License-Identifier: Apache-2.0
#include "sink/meters.h"

#include <math.h>
#include <stdatomic.h>

#include "base/mem.h"
#include "sink/ignore.h"

struct view {
    struct sink sink; // first, so that a sink is its view
    struct meters *meters;
    struct meter *at;  // of the open tile
    struct meter open;
    spectrum sample[METER_REPLICATES]; // what it has gathered, by lane
};

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct view *v = (void *)s;
    int x, y;
    v->at = &v->meters->items[tile - v->meters->first];
    v->open = *v->at;
    v->meters->corner(tile, &x, &y);
    const int size = v->at->done ? 0 : 4;
    *wanted = (struct sink_area){x, y, x + size, y + size};
}

static void view_close(struct sink *s) {
    struct view *v = (void *)s;
    *v->at = v->open;
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    (void)s, (void)lane, (void)x, (void)y, (void)sample; // a lane is a pixel: one packet is traced
}

static void view_begin(struct sink *s, int lane) {
    ((struct view *)(void *)s)->sample[lane] = spectrum_grey(0);
}

static void view_add(struct sink *s, int lane, const struct contribution *c) {
    ((struct view *)(void *)s)->sample[lane] += c->weight * c->emission;
}

static void view_end(struct sink *s, int lane, float weight) {
    struct view *v = (void *)s;
    const spectrum value = weight * v->sample[lane];
    if (!spectrum_is_finite(value)) {
        atomic_fetch_add(&v->meters->rejected, 1);
        return;
    }
    for (int c = 0; c < 3; c++)
        v->open.sums[lane][c] += (double)value[c];
}

static void view_destroy(struct sink *s) {
    mem_free(s);
}

static const struct sink_type view_type = {
    .open = view_open, .close = view_close, .place = view_place, .begin = view_begin,
    .add = view_add, .covered = sink_ignore_lane, .end = view_end, .destroy = view_destroy};

struct sink *meters_sink(void *meters) {
    struct view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){.type = &view_type, .sums = true};
    v->meters = meters;
    return &v->sink;
}

// Mean of the replicates and its standard error, for one weighing of the channels.
static void read_channel(const struct meter *m, uint64_t samples, const double weights[3],
                         double *mean, double *error) {
    double values[METER_REPLICATES], spread = 0;
    *mean = 0;
    for (int r = 0; r < METER_REPLICATES; r++) {
        values[r] = 0;
        for (int c = 0; c < 3; c++)
            values[r] += weights[c] * m->sums[r][c] / (double)samples;
        *mean += values[r] / METER_REPLICATES;
    }
    for (int r = 0; r < METER_REPLICATES; r++)
        spread += (values[r] - *mean) * (values[r] - *mean);
    *error = sqrt(spread / (METER_REPLICATES * (METER_REPLICATES - 1)));
}

struct meter_reading meter_read(const struct meter *m, uint64_t samples) {
    static const double luminance[3] = {0.212671, 0.715160, 0.072169}; // as spectrum_luminance
    struct meter_reading r;
    for (int c = 0; c < 3; c++) {
        double only[3] = {0, 0, 0};
        only[c] = 1;
        read_channel(m, samples, only, &r.mean[c], &r.error[c]);
    }
    read_channel(m, samples, luminance, &r.luminance, &r.luminance_error);
    return r;
}
