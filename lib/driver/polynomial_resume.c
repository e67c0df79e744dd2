// SPDX-License-Identifier: Apache-2.0
#include "driver/polynomial_resume.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "replay/edit.h"
#include "replay/measure.h"
#include "transport/tensor_meaning.h"

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

static bool refuse(const struct polynomial_options *o, const char *what) {
    log_error("%s: cannot be gone on with: %s", o->output, what);
    return false;
}

// As it is when it has been written and read, but for the size, which polynomial_describe tells, too.
static struct json *as_read(const struct json *meta, const struct json *old) {
    static const char *const added[] = {"version", "width", "height", NULL}; // by the writer
    char *text = json_to_text(meta);
    struct json *read = json_parse(text, strlen(text), "metadata");
    for (int i = 0; added[i]; i++) {
        int64_t value = 0;
        json_read_integer(json_get(old, added[i]), &value);
        json_add_count(read, added[i], value);
    }
    mem_free(text);
    return read;
}

// Whether these options make a tensor of the same samples.
static bool same_options(const struct polynomial_options *o, const struct json *old,
                         const struct json *meta) {
    struct json *own = as_read(meta, old);
    const char *other = tensor_other_meaning(old, own);
    if (!other && !tensor_same_value(json_get(old, "seed"), json_get(own, "seed")))
        other = "seed";
    if (other)
        log_error("%s: cannot be gone on with: it was made of another scene or with other options: "
                  "\"%s\" differs", o->output, other);
    json_destroy(own);
    return !other;
}

bool polynomial_resume(const struct polynomial_options *o, const struct json *meta, uint32_t first,
                       struct tensor_file **base, uint32_t *next) {
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
    else if (!same_options(o, t->meta, meta))
        fits = false;
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

bool polynomial_noise(const char *path, int threads, double *noise) {
    const struct edit_settings settings = {.no_device = true, .threads = threads};
    struct tensor_file *file = tensor_open(path);
    const struct tensor *t = file ? tensor_get(file) : NULL;
    struct edit *e = t ? edit_create(t, path, &settings) : NULL;
    const size_t plane = t ? (size_t)t->width * t->height : 0;
    float *frame = mem_array(3 * plane + 1, sizeof *frame), *variance = mem_array(plane + 1, sizeof *frame);
    const bool done = e && edit_settle(e, frame);
    if (done) {
        edit_variance(e, variance);
        *noise = measure_noise(t, frame, variance);
    }
    edit_destroy(e);
    tensor_close(file);
    mem_free(frame);
    mem_free(variance);
    return done;
}
