// SPDX-License-Identifier: Apache-2.0
// The sum over pixels of E / n is least, for a given sum of n, when n follows sqrt(E), where E is the
// squared relative error of a single sample (Neyman 1934). E is known badly from a few samples: it is
// pooled over three by three packets, and no part gets less than half of the mean.
#include "driver/pilot.h"

#include "math/hash.h"

enum { PILOT_SAMPLES = 32, LEAST_QUARTERS = 2, PILOT_SEED = 0x9e3779b9 };

// Per packet of the picture: the sum of squared errors of a sample, of radiances, and of pixels.
struct packets {
    int width, height;
    double *error, *radiance, *pixels;
};

static void gather(const struct image *im, const struct film_options *o, struct packets *p) {
    const int variance = image_find_channel(im, "variance.R");
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            const float *c = im->pixels + ((size_t)y * (size_t)im->width + (size_t)x) *
                                              (size_t)im->channels;
            const size_t i = (size_t)((o->y0 + y) / SAMPLE_MAP_PACKET * p->width +
                                      (o->x0 + x) / SAMPLE_MAP_PACKET);
            for (int k = 0; k < 3; k++) {
                p->error[i] += (double)c[variance + k] * PILOT_SAMPLES / 3;
                p->radiance[i] += (double)c[k] / 3;
            }
            p->pixels[i]++;
        }
}

// Pooled over the packets around (x, y).
static double wish(const struct packets *p, int x, int y, double mean) {
    double error = 0, radiance = 0, pixels = 0;
    if (p->pixels[y * p->width + x] == 0)
        return -1;
    for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < p->height; j++)
        for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < p->width; i++) {
            error += p->error[j * p->width + i];
            radiance += p->radiance[j * p->width + i];
            pixels += p->pixels[j * p->width + i];
        }
    const double b = radiance / pixels, scale = b * b + 1e-3 * mean * mean;
    return scale > 0 ? sqrt(error / pixels / scale) : 0;
}

static void make_map(const struct image *im, const struct film_options *o, struct packets *p,
                     struct sample_map *map) {
    const size_t n = (size_t)p->width * (size_t)p->height;
    double *wishes = mem_array(n, sizeof *wishes);
    double sum = 0, pixels = 0;
    gather(im, o, p);
    for (size_t i = 0; i < n; i++) {
        sum += p->radiance[i];
        pixels += p->pixels[i];
    }
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++)
            wishes[y * p->width + x] = wish(p, x, y, sum / pixels);
    sample_map_fill(map, wishes, LEAST_QUARTERS);
    mem_free(wishes);
}

// Renders PILOT_SAMPLES with numbers that the picture does not use.
static bool render_pilot(const struct job *job, struct image *im) {
    struct film_options options = job->film;
    struct render_options r = job->render;
    struct render_result result;
    options.variance = true;
    options.aovs = 0;
    options.group_count = 0;
    options.paths = options.moments = false;
    options.first = 0;
    r.tracer.seed = hash_combine(r.tracer.seed, PILOT_SEED);
    r.tracer.replicates = FILM_REPLICATES;
    r.tracer.spp = PILOT_SAMPLES;
    r.end = PILOT_SAMPLES;
    r.seconds = r.noise = 0;
    r.progress = NULL;
    struct film *film = film_create(&options);
    render(film, &r, &result);
    const bool whole = film_samples(film) == PILOT_SAMPLES && film_image(film, im);
    film_destroy(film);
    if (!whole)
        log_error("stopped before the pilot of adaptive sampling was whole");
    return whole;
}

bool pilot_run(const struct job *job, struct arena *arena, struct sample_map *map) {
    const struct film_settings *s = &job->scene->film;
    struct packets p = {.width = sample_map_packets(s->width),
                        .height = sample_map_packets(s->height)};
    const size_t n = (size_t)p.width * (size_t)p.height;
    struct image im;
    if (job->render.tracer.sampler->counted) {
        log_error("--adaptive: sampler %s lays its points out for one number of samples; "
                  "take --sampler sobol or independent", job->scene->sampler->type->name);
        return false;
    }
    if (!render_pilot(job, &im))
        return false;
    p.error = mem_array(3 * n, sizeof *p.error);
    p.radiance = p.error + n;
    p.pixels = p.radiance + n;
    *map = (struct sample_map){p.width, p.height, arena_alloc(arena, n)};
    make_map(&im, &job->film, &p, map);
    mem_free(p.error);
    image_finish(&im);
    return true;
}
