// SPDX-License-Identifier: Apache-2.0
#include "sink/film.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "sink/film_layout.h"
#include "sink/tile_grid.h"

struct film {
    struct film_options options;
    struct film_layout layout;
    struct tile_grid grid;
    size_t tile_values; // doubles a tile takes
    double *open[2];    // sums of the unfinished block: committed (unset without samples), running
    int committed;
    struct sums sums;            // of finished blocks
    uint64_t block;              // the unfinished one
    uint32_t open_samples;       // its committed samples
    atomic_ullong rejected;
};

struct film_view {
    struct sink sink; // first, so that a sink is its view
    struct film *film;
    double *sums; // of the open tile
    uint32_t tile;
    struct sink_area wanted;
    struct view_lane {
        double *pixel;    // NULL: outside the crop
        uint32_t replicate;
        float alpha;
        struct sink_surface first;
        bool has_first, is_first_sample;
    } lanes[SINK_MOST_LANES];
    spectrum *slots; // [lane][slot]: what the sample has gathered
};

// ---- film ---------------------------------------------------------------------------------------

size_t film_values(const struct film *f) {
    return f->tile_values * film_tile_count(f);
}

struct film *film_create(const struct film_options *options) {
    struct film *f = mem_array(1, sizeof *f);
    f->options = *options;
    film_layout_init(&f->layout, options);
    f->grid = tile_grid_over((struct sink_area){options->x0, options->y0, options->x1, options->y1});
    f->tile_values = (size_t)SINK_TILE * SINK_TILE * f->layout.channels;
    f->open[0] = mem_array_unset(film_values(f), sizeof *f->open[0]);
    f->open[1] = mem_array(film_values(f), sizeof *f->open[1]);
    sums_init(&f->sums, film_values(f));
    assert(options->first % FILM_BLOCK == 0);
    f->block = options->first / FILM_BLOCK;
    return f;
}

struct film *film_create_like(const struct film *f) {
    return film_create(&f->options);
}

void film_destroy(struct film *f) {
    if (!f)
        return;
    sums_finish(&f->sums);
    mem_free(f->open[0]);
    mem_free(f->open[1]);
    mem_free(f);
}

size_t film_bytes(const struct film_options *options, uint64_t samples) {
    struct film_layout layout;
    film_layout_init(&layout, options);
    size_t buffers = 2;
    for (uint64_t blocks = samples / FILM_BLOCK; blocks; blocks >>= 1)
        buffers++;
    const size_t pixels = (size_t)(options->x1 - options->x0) * (size_t)(options->y1 - options->y0);
    return buffers * pixels * layout.channels * sizeof(double);
}

uint32_t film_tile_count(const struct film *f) {
    return tile_grid_count(&f->grid);
}

uint64_t film_samples(const struct film *f) {
    return sums_samples(&f->sums) + f->open_samples;
}

uint64_t film_first(const struct film *f) {
    return f->options.first;
}

uint64_t film_next(const struct film *f) {
    return f->block * FILM_BLOCK + f->open_samples;
}

uint64_t film_rejected(const struct film *f) {
    return atomic_load(&f->rejected);
}

// Moves the finished block to the sums and begins the next.
static void finish_block(struct film *f) {
    double **open = &f->open[f->committed];
    sums_add(&f->sums, (struct sums_node){f->options.seed, 0, f->block, 0, *open});
    *open = mem_array_unset(film_values(f), sizeof **open);
    f->open_samples = 0;
    f->block++;
}

static void open_block(struct film *f, double *values, uint32_t samples) {
    mem_free(f->open[f->committed]);
    f->open[f->committed] = values;
    f->open_samples = samples;
}

// Takes a short block back from the sums, to go on with it.
static void reopen_block(struct film *f) {
    struct sums_node node;
    f->block = sums_next(&f->sums, f->options.seed, f->options.first) / FILM_BLOCK;
    if (sums_take_short(&f->sums, f->options.seed, &node))
        open_block(f, node.values, FILM_BLOCK - node.missing);
}

void film_commit(struct film *f, uint32_t samples) {
    f->committed ^= 1;
    f->open_samples += samples;
    assert(f->open_samples <= FILM_BLOCK);
    if (f->open_samples == FILM_BLOCK)
        finish_block(f);
}

size_t film_tile_values(const struct film *f) {
    return f->tile_values;
}

const double *film_running(const struct film *f, uint32_t tile) {
    return f->open[f->committed ^ 1] + tile * f->tile_values;
}

void film_add_block(struct film *f, double *values, uint32_t samples) {
    assert(f->open_samples == 0);
    if (samples == FILM_BLOCK)
        sums_add(&f->sums, (struct sums_node){f->options.seed, 0, f->block++, 0, values});
    else
        open_block(f, values, samples);
}

void film_add_rejected(struct film *f, uint64_t samples) {
    atomic_fetch_add(&f->rejected, samples);
}

const struct sums *film_sums(const struct film *f) {
    return &f->sums;
}

bool film_short_block(const struct film *f, struct sums_node *node) {
    *node = (struct sums_node){f->options.seed, 0, f->block, FILM_BLOCK - f->open_samples,
                               f->open[f->committed]};
    return f->open_samples > 0;
}

void film_restore(struct film *f, struct sums *sums) {
    assert(sums->values == film_values(f));
    sums_finish(&f->sums);
    f->sums = *sums;
    sums_init(sums, film_values(f));
    reopen_block(f);
}

// Where the values of pixel (x, y) of the absolute grid begin in a node.
static size_t pixel_values(const struct film *f, int x, int y) {
    return tile_grid_find(&f->grid, x, y) * f->tile_values +
           tile_grid_inside(x, y) * f->layout.channels;
}

void film_add_part(const struct film *whole, double *values, const struct film *part,
                   const double *part_values) {
    const struct film_options *o = &part->options;
    const size_t row = (size_t)part->layout.channels;
    assert(whole->layout.channels == part->layout.channels);
    for (int y = o->y0; y < o->y1; y++)
        for (int x = o->x0; x < o->x1; x++) {
            double *to = values + pixel_values(whole, x, y);
            const double *from = part_values + pixel_values(part, x, y);
            for (size_t c = 0; c < row; c++)
                to[c] += from[c];
        }
}

static void total(const struct film *f, size_t first, uint32_t count, double *sums) {
    sums_total(&f->sums, first, count, f->open_samples ? f->open[f->committed] + first : NULL, sums);
}

void film_pixel(const struct film *f, int x, int y, double *sums) {
    total(f, pixel_values(f, x, y), f->layout.channels, sums);
}

void film_pixel_replicates(const struct film *f, int x, int y, double *sums) {
    total(f, pixel_values(f, x, y) + f->layout.replicate_channel, 3 * FILM_REPLICATES, sums);
}

// Adds what a pixel takes in steps [first, first + steps).
static void count_steps(uint32_t quarters, uint64_t first, uint64_t steps, struct film_counts *n) {
    const uint64_t low = sample_map_taken(quarters, first);
    const uint64_t high = sample_map_taken(quarters, first + steps);
    n->all += high - low;
    for (uint32_t r = 0; r < FILM_REPLICATES; r++)
        n->replicate[r] += (high + FILM_REPLICATES - 1 - r) / FILM_REPLICATES -
                           (low + FILM_REPLICATES - 1 - r) / FILM_REPLICATES;
}

void film_pixel_counts(const struct film *f, int x, int y, struct film_counts *n) {
    const uint32_t quarters = sample_map_at(f->options.map, x, y);
    *n = (struct film_counts){0};
    for (size_t i = 0; i < f->sums.count; i++) {
        const struct sums_node *node = &f->sums.nodes[i];
        count_steps(quarters, sums_node_first(node), sums_node_samples(node), n);
    }
    count_steps(quarters, f->block * FILM_BLOCK, f->open_samples, n);
}

const struct film_layout *film_get_layout(const struct film *f) {
    return &f->layout;
}

const struct film_options *film_get_options(const struct film *f) {
    return &f->options;
}

// ---- view ---------------------------------------------------------------------------------------

static void view_begin(struct sink *s, int lane) {
    struct film_view *v = (void *)s;
    const uint32_t n = v->film->layout.slots;
    memset(v->slots + (size_t)lane * n, 0, n * sizeof *v->slots);
    v->lanes[lane].alpha = 0;
    v->lanes[lane].has_first = false;
}

static uint32_t path_slot(const struct contribution *c) {
    if (c->depth == 0)
        return PATH_EMISSION;
    const uint32_t kind = c->lobe & LOBE_DIFFUSE ? 0 : c->lobe & LOBE_GLOSSY ? 1 : 2;
    return (c->depth == 1 ? PATH_DIRECT : PATH_INDIRECT) + kind;
}

// Cuts indirect light that is above the clamp; returns what it loses.
static spectrum cut(const struct film *f, spectrum *value) {
    const float grey = ((*value)[0] + (*value)[1] + (*value)[2]) / 3;
    const spectrum whole = *value;
    if (!(grey > f->options.clamp))
        return (spectrum){0};
    *value *= f->options.clamp / grey;
    return whole - *value;
}

static void view_add(struct sink *s, int lane, const struct contribution *c) {
    struct film_view *v = (void *)s;
    const struct film_layout *l = &v->film->layout;
    spectrum value = c->weight * c->emission;
    spectrum *slots = v->slots + (size_t)lane * l->slots;
    if (l->clamp_slot != LAYOUT_NONE && c->depth > 1)
        slots[l->clamp_slot] += cut(v->film, &value);
    if (l->beauty_slot != LAYOUT_NONE)
        slots[l->beauty_slot] += value;
    if (l->group_slot != LAYOUT_NONE)
        slots[l->group_slot + v->film->options.group_of_light[c->source]] += value;
    if (l->path_slot != LAYOUT_NONE)
        slots[l->path_slot + path_slot(c)] += value;
}

static void view_surface(struct sink *s, int lane, const struct sink_surface *first) {
    struct film_view *v = (void *)s;
    v->lanes[lane].first = *first;
    v->lanes[lane].has_first = true;
}

static void view_covered(struct sink *s, int lane) {
    ((struct film_view *)(void *)s)->lanes[lane].alpha = 1;
}

// Adds slot values to doubles, three channels each.
static void add_slots(double *out, const spectrum *slots, uint32_t count, float weight) {
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            out[3 * i + (uint32_t)k] += (double)(weight * slots[i][k]);
}

static void view_end(struct sink *s, int lane, float weight) {
    struct film_view *v = (void *)s;
    const struct view_lane *at = &v->lanes[lane];
    const struct film_layout *l = &v->film->layout;
    spectrum *slots = v->slots + (size_t)lane * l->slots;
    if (!at->pixel)
        return;
    for (uint32_t i = 0; i < l->slots; i++)
        if (!spectrum_is_finite(slots[i])) {
            atomic_fetch_add(&v->film->rejected, 1);
            memset(slots, 0, l->slots * sizeof *slots);
            break;
        }
    add_slots(at->pixel, slots, l->slots, weight);
    if (l->replicate_channel != LAYOUT_NONE)
        add_slots(at->pixel + l->replicate_channel + 3 * at->replicate, slots + l->beauty_slot, 1,
                  weight);
    if (l->moment_channel != LAYOUT_NONE) {
        const spectrum x = weight * slots[l->beauty_slot];
        add_slots(at->pixel + l->moment_channel, &(spectrum){x[0] * x[0], x[1] * x[1], x[2] * x[2], 0},
                  1, 1);
    }
    if (l->alpha_channel != LAYOUT_NONE)
        at->pixel[l->alpha_channel] += (double)(weight * at->alpha);
    if (l->aov_channel != LAYOUT_NONE && at->has_first)
        film_layout_add_aovs(l, at->pixel, &at->first, at->is_first_sample);
}

static void view_open(struct sink *s, uint32_t tile, struct sink_area *wanted) {
    struct film_view *v = (void *)s;
    const struct film *f = v->film;
    v->tile = tile;
    v->wanted = *wanted = tile_grid_area(&f->grid, tile);
    memset(v->sums, 0, f->tile_values * sizeof *v->sums);
    if (f->open_samples)
        memcpy(v->sums, f->open[f->committed] + tile * f->tile_values,
               f->tile_values * sizeof *v->sums);
}

static void view_place(struct sink *s, int lane, int x, int y, uint32_t sample) {
    struct film_view *v = (void *)s;
    struct view_lane *l = &v->lanes[lane];
    l->pixel = sink_area_has(&v->wanted, x, y)
                   ? v->sums + tile_grid_inside(x, y) * v->film->layout.channels
                   : NULL;
    l->replicate = sample % FILM_REPLICATES;
    l->is_first_sample = sample == 0;
}

static void view_close(struct sink *s) {
    struct film_view *v = (void *)s;
    struct film *f = v->film;
    memcpy(f->open[f->committed ^ 1] + v->tile * f->tile_values, v->sums,
           f->tile_values * sizeof *v->sums);
}

static void view_destroy(struct sink *s) {
    struct film_view *v = (void *)s;
    mem_free(v->sums);
    mem_free(v->slots);
    mem_free(v);
}

static const struct sink_type view_type = {
    .open = view_open, .close = view_close, .place = view_place, .begin = view_begin, .add = view_add,
    .surface = view_surface, .covered = view_covered, .end = view_end, .destroy = view_destroy};

struct sink *film_sink(struct film *f) {
    struct film_view *v = mem_array(1, sizeof *v);
    v->sink = (struct sink){
        .type = &view_type, .wants_surface = f->options.aovs != 0, .sums = true};
    v->film = f;
    v->sums = mem_array(f->tile_values, sizeof *v->sums);
    v->slots = mem_array((size_t)SINK_MOST_LANES * f->layout.slots, sizeof *v->slots);
    return &v->sink;
}
