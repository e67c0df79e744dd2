// SPDX-License-Identifier: Apache-2.0
// The sum over pixels of E / n is least, for a given sum of n, when n follows sqrt(E), where E is the
// squared relative error of a single sample (Neyman 1934). E is known badly from a few samples, so
// roots are averaged over three by three packets: relative errors change less from place to place than
// errors and radiances do, and the root keeps one bright sample from counting for much. And E is not
// known at all where a pilot met none of the rare bright samples that may make most of the error: half
// of the samples are spread evenly, which bounds what a wrong map can cost.
#include "driver/pilot.h"

#include "math/hash.h"

enum { PILOT_SAMPLES = 16, LEAST_QUARTERS = 2, PILOT_SEED = 0x9e3779b9 };

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

// Root of the squared relative error of a sample in packet i; negative: not in the picture.
static double root_error(const struct packets *p, size_t i, double mean) {
    if (p->pixels[i] == 0)
        return -1;
    const double b = p->radiance[i] / p->pixels[i], scale = b * b + 1e-3 * mean * mean;
    return scale > 0 ? sqrt(p->error[i] / p->pixels[i] / scale) : 0;
}

// Mean over the packets around (x, y); negative: not in the picture.
static double wish(const struct packets *p, const double *roots, int x, int y) {
    double sum = 0, count = 0;
    if (roots[y * p->width + x] < 0)
        return -1;
    for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < p->height; j++)
        for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < p->width; i++) {
            const double root = roots[j * p->width + i];
            sum += fmax(root, 0);
            count += root >= 0;
        }
    return sum / count;
}

static void make_map(const struct image *im, const struct film_options *o, struct packets *p,
                     struct sample_map *map) {
    const size_t n = (size_t)p->width * (size_t)p->height;
    double *roots = mem_array(2 * n, sizeof *roots), *wishes = roots + n;
    double radiance = 0, pixels = 0, wished = 0, packets = 0;
    gather(im, o, p);
    for (size_t i = 0; i < n; i++) {
        radiance += p->radiance[i];
        pixels += p->pixels[i];
    }
    for (size_t i = 0; i < n; i++)
        roots[i] = root_error(p, i, radiance / pixels);
    for (size_t i = 0; i < n; i++) {
        wishes[i] = wish(p, roots, (int)i % p->width, (int)i / p->width);
        wished += fmax(wishes[i], 0);
        packets += wishes[i] >= 0;
    }
    for (size_t i = 0; i < n; i++)
        wishes[i] += wishes[i] >= 0 ? wished / packets : 0;
    sample_map_fill(map, wishes, LEAST_QUARTERS);
    mem_free(roots);
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
