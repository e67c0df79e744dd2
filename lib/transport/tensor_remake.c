// SPDX-License-Identifier: Apache-2.0
#include "transport/tensor_remake.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "transport/sample_ranges.h"
#include "transport/tensor_meaning.h"
#include "transport/tensor_parts.h"

enum { ABSENT = UINT32_MAX };

struct source {
    struct tensor_file *file;
    const struct tensor *tensor;
    double share;   // of all samples; 1 where lights are summed
    uint32_t *lane; // by pixel of the old picture, of the block that is worked on
    struct tensor_block block; // that one, of no rows
    float *unpacked[2];        // its values and halves, if it has rows
};

struct remake {
    const struct tensor_remake *options;
    struct source *sources;
    const struct tensor **tensors; // of the sources
    struct tensor tensor; // the new one
    struct tensor_block *blocks;
    struct json *meta;
    struct arena arena;
    uint32_t crop[4];
    bool exact;  // ranges of samples of one seed, by their sums
    bool summed; // ranges of lights
    struct tensor_remade *result;
    double largest;
};

// ---- sources ------------------------------------------------------------------------------------

static bool fail(const struct remake *r, size_t source, const char *what) {
    log_error("%s: %s", r->options->paths[source], what);
    return false;
}

static bool same_shape(const struct remake *r, size_t source) {
    const struct tensor *a = r->sources[0].tensor, *b = r->sources[source].tensor;
    const char *other = tensor_other_meaning(a->meta, b->meta);
    if (other) {
        log_error("%s: is not of the same scene, objects and size as the first tensor: another \"%s\"",
                  r->options->paths[source], other);
        return false;
    }
    if (a->width != b->width || a->height != b->height || a->block_count != b->block_count ||
        !a->fixed != !b->fixed)
        return fail(r, source, "is not of the same scene, objects and size as the first tensor");
    for (uint32_t i = 0; i < a->block_count; i++)
        if (!tensor_same_block(&a->blocks[i], &b->blocks[i]) ||
            (!r->summed && !a->blocks[i].halves != !b->blocks[i].halves))
            return fail(r, source, "has other blocks than the first tensor");
    return true;
}

// Ranges of samples of one seed that kept their sums unite to the bits of one run.
static bool are_ranges(const struct remake *r) {
    bool are = r->options->count > 1;
    for (size_t s = 0; s < r->options->count && are; s++) {
        const struct tensor *t = r->sources[s].tensor;
        are = tensor_has_sums(t) &&
              tensor_same_value(json_get(t->meta, "seed"), json_get(r->sources[0].tensor->meta, "seed"));
    }
    return are;
}

static bool unite_ranges(struct remake *r) {
    struct sample_ranges ranges = {0};
    bool good = true;
    for (size_t s = 0; s < r->options->count && good; s++)
        good = sample_ranges_add(&ranges, r->sources[s].tensor->meta) ||
               fail(r, s, "has samples that are among the others'");
    if (good)
        sample_ranges_describe(&ranges, r->meta);
    sample_ranges_finish(&ranges);
    return good;
}

static bool open_sources(struct remake *r) {
    double all = 0;
    for (size_t s = 0; s < r->options->count; s++) {
        struct source *source = &r->sources[s];
        source->file = tensor_open(r->options->paths[s]);
        if (!source->file)
            return false;
        r->tensors[s] = source->tensor = tensor_get(source->file);
    }
    r->summed = tensor_are_ranges(r->tensors, r->options->count);
    for (size_t s = 0; s < r->options->count; s++) {
        struct source *source = &r->sources[s];
        if (s > 0 && !same_shape(r, s))
            return false;
        source->share = (double)tensor_samples(source->tensor);
        if (r->options->count > 1 && !(source->share > 0))
            return fail(r, s, "does not tell its samples");
        all += source->share;
    }
    for (size_t s = 0; s < r->options->count; s++)
        r->sources[s].share =
            r->options->count > 1 && !r->summed ? r->sources[s].share / all : 1;
    r->result->samples = (uint64_t)(r->summed ? all / (double)r->options->count : all);
    return true;
}

// ---- lists --------------------------------------------------------------------------------------

static bool is_inside(const struct remake *r, uint32_t pixel) {
    const uint32_t x = pixel % r->sources[0].tensor->width, y = pixel / r->sources[0].tensor->width;
    return x >= r->crop[0] && x < r->crop[2] && y >= r->crop[1] && y < r->crop[3];
}

static double value_at(const struct tensor_block *b, const void *values, size_t i) {
    return b->storage == TENSOR_BF16 ? (double)bf16_to_float(((const uint16_t *)values)[i])
                                     : (double)((const float *)values)[i];
}

static size_t place_of(const struct tensor_block *b, uint32_t lane, size_t row) {
    return (lane / TENSOR_LANES * (size_t)b->coefficients * b->channels + row) * TENSOR_LANES +
           lane % TENSOR_LANES;
}

static bool is_zero(const struct tensor_block *b, uint32_t lane) {
    for (size_t row = 0; row < (size_t)b->coefficients * b->channels; row++)
        if (value_at(b, b->values, place_of(b, lane, row)) != 0)
            return false;
    return true;
}

// Begins a block: where each pixel stands in its lists.
static void find_lanes(struct remake *r, uint32_t block) {
    for (size_t s = 0; s < r->options->count; s++) {
        struct source *source = &r->sources[s];
        const struct tensor_block *b = &source->block;
        source->block = tensor_unpack(&source->tensor->blocks[block], source->unpacked);
        const size_t plane = (size_t)source->tensor->width * source->tensor->height;
        if (!source->lane)
            source->lane = mem_array(plane, sizeof *source->lane);
        memset(source->lane, 0xff, plane * sizeof *source->lane);
        for (uint32_t i = 0; i < b->pixel_count; i++)
            source->lane[b->pixels[i]] = i;
    }
}

static bool is_kept(const struct remake *r, uint32_t pixel) {
    bool listed = false, zero = true;
    for (size_t s = 0; s < r->options->count; s++) {
        const uint32_t lane = r->sources[s].lane[pixel];
        listed = listed || lane != ABSENT;
        if (lane != ABSENT && zero && r->options->drop_zeros)
            zero = is_zero(&r->sources[s].block, lane);
    }
    if (listed && zero && r->options->drop_zeros)
        r->result->dropped++;
    return listed && !(zero && r->options->drop_zeros);
}

// The new list, as pixels of the old picture.
static uint32_t *list_pixels(struct remake *r, uint64_t *count) {
    const struct tensor *t = r->sources[0].tensor;
    const size_t plane = (size_t)t->width * t->height;
    uint32_t *list = mem_array(plane, sizeof *list);
    *count = 0;
    for (uint32_t p = 0; p < plane; p++)
        if (is_inside(r, p) && is_kept(r, p))
            list[(*count)++] = p;
    return list;
}

// Sum of the angles of a pixel, or the number of samples, over all ranges.
static double views_at(const struct remake *r, uint32_t block, uint32_t pixel, uint32_t which) {
    double sum = 0;
    for (size_t s = 0; s < r->options->count; s++) {
        const struct tensor_block *b = &r->sources[s].tensor->blocks[block];
        const uint32_t lane = r->sources[s].lane[pixel];
        if (lane != ABSENT)
            sum += b->views[which * tensor_tiles(b) * TENSOR_LANES + lane];
    }
    return sum;
}

static float view_at(const struct remake *r, uint32_t block, uint32_t pixel) {
    double sum = 0, all = 0;
    if (r->exact) {
        all = views_at(r, block, pixel, 1);
        return all > 0 ? (float)(views_at(r, block, pixel, 0) / all) : 0;
    }
    for (size_t s = 0; s < r->options->count; s++) {
        const uint32_t lane = r->sources[s].lane[pixel];
        if (lane == ABSENT)
            continue;
        sum += r->sources[s].share * (double)r->sources[s].tensor->blocks[block].view[lane];
        all += r->sources[s].share;
    }
    return (float)(sum / all);
}

static const double *views_of(struct remake *r, uint32_t block, const uint32_t *list) {
    const struct tensor_block *b = &r->blocks[block];
    const uint64_t lanes = tensor_tiles(b) * TENSOR_LANES;
    double *views = arena_alloc(&r->arena, (2 * lanes + 1) * sizeof *views);
    for (uint32_t which = 0; which < 2; which++)
        for (uint64_t i = 0; i < b->pixel_count; i++)
            views[which * lanes + i] = views_at(r, block, list[i], which);
    return views;
}

static void shape_block(struct remake *r, uint32_t block) {
    static const float some;
    static const double some_sums;
    struct tensor_block *b = &r->blocks[block];
    uint64_t count;
    find_lanes(r, block);
    uint32_t *list = list_pixels(r, &count);
    uint32_t *pixels = arena_alloc(&r->arena, (count + 1) * sizeof *pixels);
    *b = r->sources[0].block;
    b->pixel_count = count;
    b->storage = r->options->new_storage ? r->options->storage : b->storage;
    b->halves = NULL;
    for (size_t s = 0; s < r->options->count; s++)
        if (r->sources[s].tensor->blocks[block].halves)
            b->halves = &some;
    b->sums = r->exact ? &some_sums : NULL;
    b->pixels = pixels;
    float *view = b->view ? arena_alloc(&r->arena, (tensor_tiles(b) + 1) * TENSOR_LANES * 4) : NULL;
    for (uint64_t i = 0; i < count; i++) {
        const uint32_t w = r->sources[0].tensor->width;
        pixels[i] = (list[i] / w - r->crop[1]) * r->tensor.width + list[i] % w - r->crop[0];
        if (view)
            view[i] = view_at(r, block, list[i]);
    }
    b->view = view;
    b->views = view && r->exact ? views_of(r, block, list) : NULL;
    r->result->pixels += count;
    r->result->bytes += tensor_bytes(b) * (b->halves ? 2 : 1);
    mem_free(list);
}

// ---- values -------------------------------------------------------------------------------------

static void put(struct remake *r, const struct tensor_block *b, void *out, size_t at, double v) {
    double stored;
    if (b->storage == TENSOR_BF16) {
        const uint16_t h = bf16_from_float((float)v);
        ((uint16_t *)out)[at] = h;
        stored = (double)bf16_to_float(h);
    } else {
        ((float *)out)[at] = (float)v;
        stored = (double)(float)v;
    }
    r->result->worst = fmax(r->result->worst, fabs(stored - v));
    r->largest = fmax(r->largest, fabs(v));
}

static uint32_t old_pixel(const struct remake *r, uint32_t p) {
    return (p / r->tensor.width + r->crop[1]) * r->sources[0].tensor->width + p % r->tensor.width +
           r->crop[0];
}

// The sum over all ranges of what a pixel's half has of one channel of a coefficient.
static double sum_of(const struct remake *r, uint32_t block, uint32_t pixel, uint32_t coefficient,
                     uint32_t half, uint32_t channel) {
    double sum = 0;
    for (size_t s = 0; s < r->options->count; s++) {
        const struct tensor_block *from = &r->sources[s].tensor->blocks[block];
        const uint32_t lane = r->sources[s].lane[pixel];
        if (lane != ABSENT)
            sum += from->sums[tensor_sum_at(from, lane, coefficient, half, channel)];
    }
    return sum;
}

static void fill_exactly(struct remake *r, uint32_t block, void *values, void *halves,
                         double *sums) {
    const struct tensor_block *b = &r->blocks[block];
    const double scale = 1.0 / (double)r->result->samples;
    for (uint32_t i = 0; i < b->pixel_count; i++)
        for (uint32_t c = 0; c < b->coefficients; c++)
            for (uint32_t k = 0; k < b->channels; k++) {
                const uint32_t pixel = old_pixel(r, b->pixels[i]);
                const size_t at = place_of(b, i, (size_t)c * b->channels + k);
                const double even = sum_of(r, block, pixel, c, 0, k);
                const double odd = sum_of(r, block, pixel, c, 1, k);
                put(r, b, values, at, scale * (even + odd));
                put(r, b, halves, at, scale * (even - odd));
                sums[tensor_sum_at(b, i, c, 0, k)] = even;
                sums[tensor_sum_at(b, i, c, 1, k)] = odd;
            }
}

static void fill(struct remake *r, uint32_t block, bool halves, void *out) {
    const struct tensor_block *b = &r->blocks[block];
    const size_t rows = (size_t)b->coefficients * b->channels;
    for (uint32_t i = 0; i < b->pixel_count; i++) {
        const uint32_t old = old_pixel(r, b->pixels[i]);
        for (size_t row = 0; row < rows; row++) {
            double sum = 0;
            for (size_t s = 0; s < r->options->count; s++) {
                const struct tensor_block *from = &r->sources[s].block;
                const uint32_t lane = r->sources[s].lane[old];
                const void *values = halves ? from->halves : from->values;
                if (lane != ABSENT && values)
                    sum += r->sources[s].share * value_at(from, values, place_of(from, lane, row));
            }
            put(r, b, out, place_of(b, i, row), sum);
        }
    }
}

static void fill_fixed(const struct remake *r, float *out) {
    const struct tensor *t = &r->tensor, *old = r->sources[0].tensor;
    for (size_t k = 0; k < 3; k++)
        for (size_t y = 0; y < t->height; y++)
            for (size_t x = 0; x < t->width; x++) {
                double sum = 0;
                for (size_t s = 0; s < r->options->count; s++)
                    sum += r->sources[s].share *
                           (double)r->sources[s].tensor->fixed[(k * old->height + y + r->crop[1]) *
                                                                   old->width + x + r->crop[0]];
                out[(k * t->height + y) * t->width + x] = (float)sum;
            }
}

static void fill_fixed_exactly(const struct remake *r, float *out, double *sums) {
    const size_t n = 3 * (size_t)r->tensor.width * r->tensor.height; // there is no crop
    for (size_t i = 0; i < n; i++) {
        sums[i] = 0;
        for (size_t s = 0; s < r->options->count; s++)
            sums[i] += r->sources[s].tensor->fixed_sums[i];
        out[i] = (float)(sums[i] / (double)r->result->samples);
    }
}

static bool write_all(struct remake *r, const char *output) {
    struct tensor_writer *w = tensor_create(output, &r->tensor);
    if (!w)
        return false;
    for (uint32_t i = 0; i < r->tensor.block_count; i++) {
        find_lanes(r, i);
        if (r->exact) {
            fill_exactly(r, i, tensor_values(w, i), tensor_halves(w, i), tensor_sums(w, i));
            continue;
        }
        fill(r, i, false, tensor_values(w, i));
        if (r->blocks[i].halves)
            fill(r, i, true, tensor_halves(w, i));
    }
    if (r->exact)
        fill_fixed_exactly(r, tensor_fixed(w), tensor_fixed_sums(w));
    else if (r->tensor.fixed)
        fill_fixed(r, tensor_fixed(w));
    r->result->worst = r->largest > 0 ? r->result->worst / r->largest : 0;
    return tensor_finish(w);
}

// ---- all ----------------------------------------------------------------------------------------

static bool set_crop(struct remake *r) {
    const struct tensor *t = r->sources[0].tensor;
    const uint32_t *c = r->options->crop;
    const uint32_t all[4] = {0, 0, t->width, t->height};
    memcpy(r->crop, c[2] ? c : all, sizeof r->crop);
    if (r->crop[0] < r->crop[2] && r->crop[1] < r->crop[3] && r->crop[2] <= t->width &&
        r->crop[3] <= t->height)
        return true;
    log_error("crop %u,%u,%u,%u is not inside the picture of %ux%u", c[0], c[1], c[2], c[3], t->width,
              t->height);
    return false;
}

static bool remake(struct remake *r, const char *output) {
    static const float some;
    static const double some_sums;
    const struct tensor *first;
    if (!open_sources(r) || !set_crop(r))
        return false;
    first = r->sources[0].tensor;
    r->meta = json_clone(first->meta);
    r->exact = are_ranges(r);
    if (r->options->count > 1) {
        json_add_count(r->meta, "samples", (int64_t)r->result->samples);
        if (!(r->exact ? unite_ranges(r)
                       : (r->summed ? tensor_join_ranges : tensor_list_seeds)(
                             r->tensors, r->options->paths, r->options->count, r->meta)))
            return false;
    }
    json_add_text(r->meta, "command", r->options->command);
    r->blocks = arena_alloc(&r->arena, (first->block_count + 1) * sizeof *r->blocks);
    r->tensor = (struct tensor){r->crop[2] - r->crop[0], r->crop[3] - r->crop[1], r->meta,
                                first->block_count, r->blocks, first->fixed ? &some : NULL,
                                r->exact ? &some_sums : NULL};
    for (uint32_t i = 0; i < first->block_count; i++)
        shape_block(r, i);
    return write_all(r, output);
}

bool tensor_remake(const struct tensor_remake *o, const char *output, struct tensor_remade *result) {
    struct remake r = {.options = o, .result = result};
    *result = (struct tensor_remade){0};
    r.sources = mem_array(o->count, sizeof *r.sources);
    r.tensors = mem_array(o->count, sizeof(const struct tensor *));
    const bool done = remake(&r, output);
    for (size_t s = 0; s < o->count; s++) {
        tensor_close(r.sources[s].file);
        mem_free(r.sources[s].lane);
        mem_free(r.sources[s].unpacked[0]);
        mem_free(r.sources[s].unpacked[1]);
    }
    mem_free(r.sources);
    mem_free(r.tensors);
    json_destroy(r.meta);
    arena_finish(&r.arena);
    return done;
}
