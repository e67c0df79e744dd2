// SPDX-License-Identifier: Apache-2.0
#include "driver/polynomial_resume.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"

enum { PILOT_TILES = 64, QUANTUM_BITS = 30 };

static struct sink *make_sink(void *film) {
    return film_sink(film);
}

// Mean over some tiles of one sample a pixel of the picture as it is.
static double mean_radiance(const struct polynomial *p) {
    struct film_options options = {.x0 = p->job.film.x0, .y0 = p->job.film.y0, .x1 = p->job.film.x1,
                                   .y1 = p->job.film.y1};
    struct tracer_options o = p->job.render.tracer;
    struct image im;
    double sum = 0;
    o.replicates = 1;
    struct film *film = film_create(&options);
    struct tracer *t = tracer_create(&o, make_sink, film);
    const uint32_t tiles = film_tile_count(film), step = (tiles + PILOT_TILES - 1) / PILOT_TILES;
    for (uint32_t i = 0; i < tiles; i += step)
        tracer_run(t, i, 1, 0, 1);
    tracer_destroy(t);
    film_commit(film, 1);
    if (film_image(film, &im)) {
        const size_t n = (size_t)im.width * (size_t)im.height * (size_t)im.channels;
        for (size_t i = 0; i < n; i++)
            sum += fabs((double)im.pixels[i]) * step / (double)n;
        image_finish(&im);
    }
    film_destroy(film);
    return sum;
}

double polynomial_quantum(const struct polynomial *p) {
    const double mean = mean_radiance(p);
    return mean > 1e-30 && mean < 1e30 ? exp2(floor(log2(mean)) - QUANTUM_BITS) : 0x1p-60;
}

void polynomial_resume_describe(struct json *meta, const struct polynomial *p, uint32_t first,
                                uint32_t end, double quantum) {
    struct json *range = json_append_array(json_add_array(meta, "ranges"));
    json_append_count(range, first);
    json_append_count(range, end);
    json_add_number(meta, "quantum", quantum);
    if (p->tracer.sampler->counted)
        json_add_count(meta, "sampler points", p->tracer.spp);
}

static bool refuse(const struct polynomial_options *o, const char *what) {
    log_error("%s: cannot be gone on with: %s", o->output, what);
    return false;
}

static bool has_count(const struct json *meta, const char *key, int64_t value) {
    int64_t v;
    return json_read_integer(json_get(meta, key), &v) && v == value;
}

static bool has_text(const struct json *meta, const char *key, const char *value) {
    const char *text = json_text(json_get(meta, key));
    return text && strcmp(text, value) == 0;
}

// Whether the options that the coefficients depend on are the same.
static bool same_options(const struct json *meta, const struct polynomial *p,
                         const struct polynomial_options *o, double quantum) {
    char hash[32];
    double number = 0;
    snprintf(hash, sizeof hash, "%016" PRIx64, p->job.scene->hash);
    json_read_number(json_get(meta, "quantum"), &number);
    bool same = has_text(meta, "scene hash", hash) && number == quantum &&
                has_count(meta, "seed", o->job.seed) && has_count(meta, "bounces", o->bounces) &&
                has_text(meta, "tail", polynomial_tails[o->tail]) &&
                has_text(meta, "later", polynomial_laters[o->later]) &&
                (!p->tracer.sampler->counted || has_count(meta, "sampler points", p->tracer.spp));
    const struct json *series = json_get(meta, "series");
    for (uint32_t i = 0; i < o->bounces && same; i++) {
        int64_t bins;
        same = json_read_integer(json_at(series, i), &bins) && bins == o->series[i];
    }
    return same;
}

bool polynomial_resume(const struct polynomial *p, const struct polynomial_options *o,
                       uint32_t first, double quantum, struct tensor_file **base, uint32_t *next) {
    int64_t from, to;
    if (!file_exists(o->output))
        return true;
    *base = tensor_open(o->output);
    if (!*base)
        return false;
    const struct tensor *t = tensor_get(*base);
    const struct json *ranges = json_get(t->meta, "ranges"), *range = json_at(ranges, 0);
    bool fits = false;
    if (!tensor_has_sums(t))
        refuse(o, "it has not kept its sums");
    else if (!same_options(t->meta, p, o, quantum))
        refuse(o, "it is of another scene, or was made with other options");
    else if (json_count(ranges) != 1 || !json_read_integer(json_at(range, 0), &from) ||
             !json_read_integer(json_at(range, 1), &to) || from != (int64_t)first || to < from ||
             to > INT32_MAX)
        refuse(o, "its samples begin elsewhere, or have gaps");
    else
        fits = true;
    if (fits) {
        *next = (uint32_t)to;
        return true;
    }
    tensor_close(*base);
    *base = NULL;
    return false;
}
