// SPDX-License-Identifier: Apache-2.0
// The film: a sink that makes a picture, with its layers.
//
// Every sample belongs to one pixel, and is summed in the order of sums.h. A pass of the driver adds
// samples [a, b) of one block to every tile; it is committed as a whole, or never was, so all pixels
// always have equal counts, and where passes begin and end does not change a bit.
#pragma once

#include "image/image.h"
#include "sink/sample_map.h"
#include "sink/sink.h"
#include "sink/sums.h"

enum { FILM_BLOCK = SUMS_BLOCK, FILM_REPLICATES = 16, FILM_MOST_GROUPS = 64 };

enum film_aov {
    AOV_ALBEDO = 1,
    AOV_N = 2,
    AOV_NG = 4,
    AOV_Z = 8,
    AOV_P = 16,
    AOV_UV = 32,
    AOV_SHAPE = 64,
    AOV_INSTANCE = 128,
};

struct film_options {
    int x0, y0, x1, y1;   // pixels of the absolute grid to render, half-open
    uint32_t seed;        // that the samples to come are drawn with
    uint64_t first;       // the first of them: a multiple of FILM_BLOCK
    const struct sample_map *map; // NULL: all pixels get the same; else `samples` are its steps
    bool alpha;
    bool variance;        // squared standard errors of the pixels, from replicates
    bool moments;         // second moments of single samples, as layer "m2"
    float clamp;          // most that one piece of indirect light may bring, as the mean of R, G and
                          // B; what is cut off is kept as layer "clamped". 0: no limit
    bool paths;           // direct/indirect x diffuse/glossy/specular layers
    uint32_t aovs;        // enum film_aov
    uint32_t group_count; // light group layers; 0: none. The last one takes the rest
    const char *const *group_names;
    const uint32_t *group_of_light; // by light index, < group_count
};

struct film;

// Options are copied except what they point to, which must outlive the film.
struct film *film_create(const struct film_options *options);
struct film *film_create_like(const struct film *f); // empty, of the same options
void film_destroy(struct film *f);

// Bytes a film with these options takes when it holds `samples` samples a pixel.
size_t film_bytes(const struct film_options *options, uint64_t samples);

// Bits of enum film_aov from "albedo,N,Z"; false after an error message with the known names.
bool film_aovs_parse(const char *list, uint32_t *aovs);
// Whether a film may write a layer of that name, whatever its light groups are.
bool film_is_layer(const char *name);

// Tiles cover the crop; they lie on the absolute grid.
uint32_t film_tile_count(const struct film *f);
// A worker's view of the film; it must not outlive it.
struct sink *film_sink(struct film *f);

// The pass added `samples` samples to every tile; they must not cross a block.
void film_commit(struct film *f, uint32_t samples);
// What view after view stored in the running pass: doubles of a tile, and those of all tiles from
// `tile` on.
size_t film_tile_values(const struct film *f);
const double *film_running(const struct film *f, uint32_t tile);
// A block that was summed elsewhere comes next; takes over its values (from mem_array).
void film_add_block(struct film *f, double *values, uint32_t samples);
void film_add_rejected(struct film *f, uint64_t samples);
uint64_t film_samples(const struct film *f); // of every pixel
uint64_t film_first(const struct film *f);   // number of the first sample of this run
uint64_t film_next(const struct film *f);    // number of the sample that comes next

// Doubles of a node of this film's sums: tile by tile, pixel by pixel.
size_t film_values(const struct film *f);
// Adds a node's values of a film `part` to those of a film `whole` that covers it; the two differ in
// their crops only.
void film_add_part(const struct film *whole, double *values, const struct film *part,
                   const double *part_values);
// The film goes on from these sums, which it takes over and leaves empty.
void film_restore(struct film *f, struct sums *sums);
const struct sums *film_sums(const struct film *f); // of finished blocks
// The unfinished block as a node whose values stay the film's. false: it has no samples.
bool film_short_block(const struct film *f, struct sums_node *node);

// Samples whose value was NaN or infinite; they count as black.
uint64_t film_rejected(const struct film *f);
// Noise of the picture so far: sqrt of the mean over pixels of SE^2 / (b^2 + 1e-3 mean(b)^2) with
// b = (R + G + B) / 3; needs `variance` and two samples, else negative.
double film_noise(const struct film *f);

// Share of the picture's light (luminance) that the clamp has cut off; negative: there is no clamp.
double film_clamped(const struct film *f);

// The picture and its layers so far; its rows are made by several threads.
bool film_image(const struct film *f, struct image *im);
// The same in two steps. The first gives names without pixels.
bool film_image_head(const struct film *f, struct image *im);
void film_image_pixels(const struct film *f, struct image *im);
// Some rows of it, y from the top of the picture: struct image_rows of a film.
void film_rows(const void *film, int y, int rows, float *pixels);
