// SPDX-License-Identifier: Apache-2.0
// What --noise tells is true: the error of a picture as it says itself is that of independent pictures
// from each other, and stopping by it does not change their mean.
//
// A picture's deviation from the mean of all is divided by what a long reference and the other pictures
// say of b, as relMSE is: by the mean of all, a rare bright sample hides itself (on veach-mis at 64
// samples, 0.10 was measured so for 0.24). The squares of what is told are averaged, since only they
// can be right in the mean. The spread has an error of its own, which is printed.
//
// By default one small picture; long (RELUME_TEST_FULL=1) three scenes at three levels, 32 pictures
// each, against a long reference. A picture that has reached a level goes on to the next one, which is
// what it had been if nothing had been asked before. `noise DATA/scenes [SCENE]`.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

enum { COLUMNS = 4, ROWS = 3, BLOCKS = COLUMNS * ROWS, MOST_RENDERS = 32, LEVELS = 3 };

struct scene_case {
    const char *name, *path;
    bool shared;            // below RELUME_SHARED_DATA
    double levels[LEVELS]; // falling
    int reference_spp;
};

static const struct scene_case cases[] = {
    {"cornell-box", "cornell-box/scene.xml", false, {0.16, 0.11, 0.075}, 4096},
    {"veach-mis", "veach-mis/scene.xml", false, {0.15, 0.1, 0.07}, 4096},
    {"classroom", "bitterli/classroom/scene.xml", true, {0.7, 0.6, 0.5}, 1024},
};

// Pictures of one level.
struct gathering {
    int renders, width, height;
    double *values;                         // luminance, picture by picture
    double blocks[BLOCKS], block_squares[BLOCKS];
    double told_squares, samples;
};

// Pictures of other seeds that together are a long one.
struct reference {
    double samples, means[BLOCKS], errors[BLOCKS];
    double *values;
};

static double grey(const float *pixel) {
    return ((double)pixel[0] + (double)pixel[1] + (double)pixel[2]) / 3; // as film_noise
}

static void add_greys(const struct image *im, double weight, double *values) {
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++)
            values[y * im->width + x] += weight * grey(pixel_at(im, x, y));
}

static void block_means(const struct image *im, double means[BLOCKS]) {
    double count[BLOCKS] = {0};
    memset(means, 0, BLOCKS * sizeof *means);
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            const int b = y * ROWS / im->height * COLUMNS + x * COLUMNS / im->width;
            means[b] += grey(pixel_at(im, x, y));
            count[b]++;
        }
    for (int b = 0; b < BLOCKS; b++)
        means[b] /= count[b];
}

static void gather(struct gathering *g, const struct image *im, const struct render_result *r) {
    double means[BLOCKS];
    block_means(im, means);
    for (int b = 0; b < BLOCKS; b++) {
        g->blocks[b] += means[b];
        g->block_squares[b] += means[b] * means[b];
    }
    const size_t pixels = (size_t)(g->width * g->height);
    add_greys(im, 1, g->values + (size_t)g->renders * pixels);
    g->told_squares += r->noise * r->noise;
    g->samples += (double)r->samples;
    g->renders++;
}

static void render_one(struct job *job, uint32_t seed, struct image *im, struct render_result *r) {
    job->film.seed = job->render.tracer.seed = seed;
    struct film *film = job_render(job, r);
    CHECK(job_image(job, film, r, im));
    film_destroy(film);
}

// Squared noise of picture k, from its deviation from the mean `sums` / renders of all.
static double deviation(const struct gathering *g, const struct reference *r, const double *sums,
                        int k) {
    const int pixels = g->width * g->height, n = g->renders;
    const double *picture = g->values + (size_t)k * (size_t)pixels, spp = g->samples / n;
    double mean = 0, noise = 0;
    for (int i = 0; i < pixels; i++)
        mean += sums[i] / n / pixels;
    for (int i = 0; i < pixels; i++) {
        const double b = (r->values[i] * r->samples + (sums[i] - picture[i]) * spp) /
                         (r->samples + (n - 1) * spp);
        const double d = picture[i] - sums[i] / n;
        noise += d * d * n / (n - 1) / (b * b + 1e-3 * mean * mean) / pixels;
    }
    return noise;
}

// The squared noise of one picture, from the spread of all, and its standard error.
static struct measured spread(const struct gathering *g, const struct reference *r) {
    const int pixels = g->width * g->height, n = g->renders;
    double *sums = mem_array((size_t)pixels, sizeof *sums), sum = 0, squares = 0;
    for (int i = 0; i < pixels * n; i++)
        sums[i % pixels] += g->values[i];
    for (int k = 0; k < n; k++) {
        const double e = deviation(g, r, sums, k);
        sum += e;
        squares += e * e;
    }
    mem_free(sums);
    return (struct measured){sum / n, sqrt(fmax(squares / n - sum / n * sum / n, 0) / (n - 1))};
}

static void compare_means(const struct gathering *g, const struct reference *r, const char *name) {
    char row[96];
    for (int b = 0; b < BLOCKS; b++) {
        const double n = g->renders, mean = g->blocks[b] / n;
        const double variance = (g->block_squares[b] / n - mean * mean) / (n - 1);
        snprintf(row, sizeof row, "%s, block %d", name, b);
        ztable_add(row, r->means[b],
                   (struct measured){mean, sqrt(variance + r->errors[b] * r->errors[b])},
                   ulp_floor(mean, 4));
    }
}

static void render_reference(struct job *job, int spp, struct reference *r) {
    enum { PARTS = 8 };
    const struct film_options *f = &job->film;
    double squares[BLOCKS] = {0};
    *r = (struct reference){.samples = spp};
    r->values = mem_array((size_t)((f->x1 - f->x0) * (f->y1 - f->y0)), sizeof *r->values);
    job->render.noise = 0;
    job->render.end = (uint64_t)spp / PARTS;
    for (uint32_t k = 0; k < PARTS; k++) {
        struct render_result result;
        struct image im;
        double m[BLOCKS];
        render_one(job, 1000 + k, &im, &result);
        add_greys(&im, 1.0 / PARTS, r->values);
        block_means(&im, m);
        for (int b = 0; b < BLOCKS; b++) {
            r->means[b] += m[b] / PARTS;
            squares[b] += m[b] * m[b] / PARTS;
        }
        image_finish(&im);
    }
    for (int b = 0; b < BLOCKS; b++)
        r->errors[b] = sqrt(fmax(squares[b] - r->means[b] * r->means[b], 0) / (PARTS - 1));
}

// What the pictures of a level told, and how far they lie apart.
static void test_level(const struct gathering *g, double level, const struct reference *reference,
                       const char *name) {
    char row[64];
    const double told = sqrt(g->told_squares / g->renders);
    const struct measured squared = spread(g, reference);
    const double noise = sqrt(squared.mean);
    printf("%s --noise %g: told %.4f, spread of %d pictures %.4f +- %.4f, ratio %.3f, %.0f samples\n",
           name, level, told, g->renders, noise, squared.error / (2 * noise), told / noise,
           g->samples / g->renders);
    fflush(stdout);
    CHECK(told > 0.8 * noise && told < 1.2 * noise);
    snprintf(row, sizeof row, "%s --noise %g", name, level);
    compare_means(g, reference, row);
}

// One picture, looked at wherever it reaches a level.
static void render_levels(struct job *job, const struct scene_case *c, int levels, uint32_t seed,
                          struct gathering *g) {
    job->film.seed = job->render.tracer.seed = seed;
    job->render.end = 1 << 20;
    struct film *film = job_film(job);
    for (int i = 0; i < levels; i++) {
        struct render_result r;
        struct image im;
        job->render.noise = c->levels[i];
        job_trace(job, film, &r);
        CHECK(!r.stopped && r.noise <= c->levels[i] && r.samples % FILM_BLOCK == 0);
        CHECK(job_image(job, film, &r, &im));
        gather(&g[i], &im, &r);
        image_finish(&im);
    }
    film_destroy(film);
}

static void test_levels(struct job *job, const struct scene_case *c, const struct reference *r) {
    const struct film_options *f = &job->film;
    const int levels = full_mode() ? LEVELS : 1, renders = full_mode() ? MOST_RENDERS : 12;
    struct gathering g[LEVELS] = {{0}};
    for (int i = 0; i < levels; i++) {
        g[i].width = f->x1 - f->x0;
        g[i].height = f->y1 - f->y0;
        g[i].values = mem_array((size_t)(renders * g[i].width * g[i].height), sizeof(double));
    }
    for (int k = 1; k <= renders; k++)
        render_levels(job, c, levels, (uint32_t)k, g);
    for (int i = 0; i < levels; i++) {
        test_level(&g[i], c->levels[i], r, c->name);
        mem_free(g[i].values);
    }
}

static void test_scene(const struct scene_case *c, const char *folder) {
    const bool full = full_mode();
    struct job_options o = {.noise = c->levels[0], .variance = true,
                            .reading = {.width = full ? 160 : 48, .height = full ? 90 : 27,
                                        .sampler = "sobol"}};
    struct reference reference;
    char path[4608];
    struct job job;
    snprintf(path, sizeof path, "%s/%s", folder, c->path);
    o.scene = path;
    if (!job_open(&job, &o))
        exit(1);
    render_reference(&job, full ? c->reference_spp : 1024, &reference);
    test_levels(&job, c, &reference);
    mem_free(reference.values);
    job_close(&job);
}

int main(int argc, char **argv) {
    const char *shared = getenv("RELUME_SHARED_DATA");
    char folder[4096];
    for (size_t i = 0; i < (full_mode() ? sizeof cases / sizeof *cases : 1); i++) {
        const struct scene_case *c = &cases[i];
        if (argc < 2 || (argc > 2 && strcmp(argv[2], c->name) != 0) || (c->shared && !shared))
            continue;
        snprintf(folder, sizeof folder, "%s/scenes", shared ? shared : "");
        test_scene(c, c->shared ? folder : argv[1]);
    }
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
