// SPDX-License-Identifier: Apache-2.0
// The sum over pixels of E / n is least, for a given sum of n, when n follows sqrt(E), where E is the
// squared relative error of a single sample (Neyman 1934). E is known badly from a few samples, so
// roots are averaged over three by three packets: relative errors change less from place to place than
// errors and radiances do, and the root keeps one bright sample from counting for much.
//
// How far such a map is to be believed, the pilot tells as well: each packet is left out in turn, its
// error foretold from those around it, and a share of the samples is spread evenly so that the sum of
// what was found there, E / n, is least (cross-validation: Stone 1974). Where rare bright samples make
// most of the error, they fall where nothing foretold them, and nearly all is spread evenly; where noise
// has its places, little is.
#include "driver/pilot.h"

#include "math/hash.h"

enum { PILOT_SAMPLES = 16, LEAST_QUARTERS = 1, PILOT_SEED = 0x9e3779b9 };

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

// Mean over the packets around (x, y), and that packet itself where `own` is set; negative: not in the
// picture.
static double wish(const struct packets *p, const double *roots, int x, int y, bool own) {
    double sum = 0, count = 0;
    const double self = roots[y * p->width + x];
    if (self < 0)
        return -1;
    for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < p->height; j++)
        for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < p->width; i++) {
            const double root = own || i != x || j != y ? roots[j * p->width + i] : -1;
            sum += fmax(root, 0);
            count += root >= 0;
        }
    return count > 0 ? sum / count : self;
}

// Wishes of all packets; returns their mean.
static double wish_all(const struct packets *p, const double *roots, bool own, double *wishes) {
    double sum = 0, count = 0;
    for (int i = 0; i < p->width * p->height; i++) {
        wishes[i] = wish(p, roots, i % p->width, i / p->width, own);
        sum += fmax(wishes[i], 0);
        count += wishes[i] >= 0;
    }
    return sum / count;
}

// The share of samples that is best spread evenly.
static double even_share(const struct packets *p, const double *roots, double *foretold) {
    enum { STEPS = 16 };
    const double least_share = (double)LEAST_QUARTERS / SAMPLE_MAP_ONE;
    const double mean = wish_all(p, roots, false, foretold);
    double best = 1, least = INFINITY;
    for (int step = 0; mean > 0 && step <= STEPS; step++) {
        const double share = least_share + (1 - least_share) * step / STEPS;
        double error = 0;
        for (int i = 0; i < p->width * p->height; i++)
            if (roots[i] > 0)
                error += p->pixels[i] * roots[i] * roots[i] /
                         (share + (1 - share) * foretold[i] / mean);
        best = error < least ? share : best;
        least = fmin(error, least);
    }
    return best;
}

static void make_map(const struct image *im, const struct film_options *o, struct packets *p,
                     struct sample_map *map) {
    const size_t n = (size_t)p->width * (size_t)p->height;
    double *roots = mem_array(2 * n, sizeof *roots), *wishes = roots + n;
    double radiance = 0, pixels = 0;
    gather(im, o, p);
    for (size_t i = 0; i < n; i++) {
        radiance += p->radiance[i];
        pixels += p->pixels[i];
    }
    for (size_t i = 0; i < n; i++)
        roots[i] = root_error(p, i, radiance / pixels);
    const double even = even_share(p, roots, wishes), mean = wish_all(p, roots, true, wishes);
    log_info("adaptive sampling: the pilot has %.0f %% of the samples spread evenly", 100 * even);
    for (size_t i = 0; i < n; i++)
        wishes[i] = wishes[i] < 0 ? -1 : even * mean + (1 - even) * wishes[i];
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
