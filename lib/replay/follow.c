// SPDX-License-Identifier: Apache-2.0
#include "replay/follow.h"

#include <string.h>

#include "base/mem.h"
#include "curve/incremental.h"
#include "replay/importance.h"

enum { CHANNELS = 3, MOST_BANDS = 17 };

struct follow {
    struct follow_options options;
    struct replay *replay;
    struct incremental state;
    struct incremental_bands bands;
    uint8_t *band;
    double *wanted, *importance, *difference;
    uint32_t *index, *order;
    uint32_t *terms; // of one band
    float *change;
};

struct follow *follow_create(const struct tensor *t, const struct follow_options *o) {
    struct follow *f = mem_array(1, sizeof *f);
    const uint32_t n = t->blocks[0].coefficients;
    f->options = *o;
    f->band = mem_array(n, sizeof *f->band);
    f->bands = (struct incremental_bands){1, f->band};
    if (!o->one_band && o->rows * o->columns == n)
        f->bands.count = incremental_bands_of(o->rows, o->columns, f->band);
    f->wanted = mem_array(CHANNELS * (size_t)n, sizeof *f->wanted);
    f->importance = mem_array(n, sizeof *f->importance);
    f->difference = mem_array(CHANNELS * (size_t)o->terms, sizeof *f->difference);
    f->index = mem_array(o->terms, sizeof *f->index);
    f->order = mem_array(n, sizeof *f->order);
    f->terms = mem_array(o->terms, sizeof *f->terms);
    f->change = mem_array(CHANNELS * (size_t)o->terms, sizeof *f->change);
    importance_of(&t->blocks[0], o->threads, f->importance);
    f->state = (struct incremental){n, CHANNELS, mem_array(CHANNELS * (size_t)n, sizeof(double)),
                                    f->importance};
    f->replay = replay_create(t, &(struct replay_options){.no_device = o->no_device,
                                                          .threads = o->threads,
                                                          .layers = f->bands.count});
    if (f->replay)
        return f;
    follow_destroy(f);
    return NULL;
}

void follow_destroy(struct follow *f) {
    if (!f)
        return;
    replay_destroy(f->replay);
    mem_free(f->state.effective);
    mem_free(f->band);
    mem_free(f->wanted);
    mem_free(f->importance);
    mem_free(f->difference);
    mem_free(f->index);
    mem_free(f->order);
    mem_free(f->terms);
    mem_free(f->change);
    mem_free(f);
}

// Adds the terms of the frame that belong to a band.
static bool update_band(struct follow *f, uint32_t band, size_t count) {
    uint32_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (f->band[f->index[i]] == band) {
            for (int k = 0; k < CHANNELS; k++)
                f->change[CHANNELS * n + (uint32_t)k] = (float)f->difference[CHANNELS * i + (size_t)k];
            f->terms[n++] = f->index[i];
        }
    return replay_update_layer(f->replay, 0, band, f->terms, f->change, n);
}

bool follow_frame(struct follow *f, const float *weights, float *frame, bool *exact) {
    const size_t n = CHANNELS * f->state.count;
    bool rebuilt[MOST_BANDS] = {false}, good = true;
    for (size_t i = 0; i < n; i++)
        f->wanted[i] = (double)weights[i];
    if (!f->options.one_band)
        incremental_rebuild(&f->state, &f->bands, f->wanted, f->options.terms, rebuilt);
    const size_t count = incremental_step(&f->state, f->wanted, f->options.terms, f->index,
                                          f->difference, f->order);
    for (uint32_t b = 0; b < f->bands.count && good; b++)
        good = (!rebuilt[b] || replay_clear_layer(f->replay, 0, b)) && update_band(f, b, count);
    *exact = true;
    for (size_t i = 0; i < n; i++)
        *exact = *exact && f->wanted[i] == f->state.effective[i];
    return good && replay_frame(f->replay, NULL, frame);
}
