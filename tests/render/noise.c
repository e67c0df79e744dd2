// SPDX-License-Identifier: Apache-2.0
// What --noise tells is true: the error of a picture as it says itself is that of independent pictures
// from each other, and stopping by it does not change their mean.
//
// By default one small picture; long (RELUME_TEST_FULL=1) three scenes at three levels, 32 pictures
// each, against a long reference. `noise DATA/scenes [SCENE]`.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

enum { COLUMNS = 4, ROWS = 3, BLOCKS = COLUMNS * ROWS, MOST_RENDERS = 32 };

struct scene_case {
    const char *name, *path;
    bool shared;            // below RELUME_SHARED_DATA
    double levels[3];
    int reference_spp;
};

static const struct scene_case cases[] = {
    {"cornell-box", "cornell-box/scene.xml", false, {0.16, 0.11, 0.075}, 4096},
    {"veach-mis", "veach-mis/scene.xml", false, {0.15, 0.1, 0.07}, 4096},
    {"classroom", "bitterli/classroom/scene.xml", true, {0.4, 0.28, 0.2}, 1024},
};

// Sums over pictures.
struct gathering {
    int renders, width, height;
    double *sum, *squares;                  // of the luminance of each pixel
    double blocks[BLOCKS], block_squares[BLOCKS];
    double told, samples;
};

static double grey(const float *pixel) {
    return ((double)pixel[0] + (double)pixel[1] + (double)pixel[2]) / 3; // as film_noise
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
    for (int y = 0; y < im->height; y++)
        for (int x = 0; x < im->width; x++) {
            const double v = grey(pixel_at(im, x, y));
            g->sum[y * im->width + x] += v;
            g->squares[y * im->width + x] += v * v;
        }
    g->told += r->noise;
    g->samples += (double)r->samples;
    g->renders++;
}

static void render_one(struct job *job, uint32_t seed, struct image *im, struct render_result *r) {
    job->film.seed = job->render.tracer.seed = seed;
    struct film *film = job_render(job, r);
    CHECK(job_image(job, film, r, im));
    film_destroy(film);
}

// The noise of one picture, from the spread of all.
static double spread(const struct gathering *g) {
    const int pixels = g->width * g->height, n = g->renders;
    double mean = 0, noise = 0;
    for (int i = 0; i < pixels; i++)
        mean += g->sum[i] / n / pixels;
    for (int i = 0; i < pixels; i++) {
        const double b = g->sum[i] / n;
        const double variance = (g->squares[i] / n - b * b) * n / (n - 1);
        noise += variance / (b * b + 1e-3 * mean * mean) / pixels;
    }
    return sqrt(noise);
}

static void compare_means(const struct gathering *g, const double reference[BLOCKS],
                          const double reference_error[BLOCKS], const char *name) {
    char row[96];
    for (int b = 0; b < BLOCKS; b++) {
        const double n = g->renders, mean = g->blocks[b] / n;
        const double variance = (g->block_squares[b] / n - mean * mean) / (n - 1);
        snprintf(row, sizeof row, "%s, block %d", name, b);
        ztable_add(row, reference[b],
                   (struct measured){mean, sqrt(variance + reference_error[b] * reference_error[b])},
                   ulp_floor(mean, 4));
    }
}

// Means of blocks over a few long pictures of other seeds, and their standard errors.
static void render_reference(struct job *job, int spp, double means[BLOCKS], double errors[BLOCKS]) {
    enum { PARTS = 8 };
    double squares[BLOCKS] = {0};
    memset(means, 0, BLOCKS * sizeof *means);
    job->render.noise = 0;
    job->render.end = (uint64_t)spp / PARTS;
    for (uint32_t k = 0; k < PARTS; k++) {
        struct render_result r;
        struct image im;
        double m[BLOCKS];
        render_one(job, 1000 + k, &im, &r);
        block_means(&im, m);
        for (int b = 0; b < BLOCKS; b++) {
            means[b] += m[b] / PARTS;
            squares[b] += m[b] * m[b] / PARTS;
        }
        image_finish(&im);
    }
    for (int b = 0; b < BLOCKS; b++)
        errors[b] = sqrt(fmax(squares[b] - means[b] * means[b], 0) / (PARTS - 1));
}

static void test_level(struct job *job, double level, int renders, const double reference[BLOCKS],
                       const double reference_error[BLOCKS], const char *name) {
    const struct film_options *f = &job->film;
    struct gathering g = {.width = f->x1 - f->x0, .height = f->y1 - f->y0};
    char row[64];
    g.sum = mem_array((size_t)(g.width * g.height), sizeof *g.sum);
    g.squares = mem_array((size_t)(g.width * g.height), sizeof *g.squares);
    job->render.noise = level;
    job->render.end = 1 << 20;
    for (int i = 0; i < renders; i++) {
        struct render_result r;
        struct image im;
        render_one(job, 1 + (uint32_t)i, &im, &r);
        CHECK(!r.stopped && r.noise <= level && r.samples % FILM_BLOCK == 0);
        gather(&g, &im, &r);
        image_finish(&im);
    }
    const double told = g.told / renders, true_noise = spread(&g);
    printf("%s --noise %g: told %.4f, spread of %d pictures %.4f, ratio %.3f, %.0f samples\n", name,
           level, told, renders, true_noise, told / true_noise, g.samples / renders);
    CHECK(told > 0.8 * true_noise && told < 1.2 * true_noise);
    snprintf(row, sizeof row, "%s --noise %g", name, level);
    compare_means(&g, reference, reference_error, row);
    mem_free(g.sum);
    mem_free(g.squares);
}

static void test_scene(const struct scene_case *c, const char *folder) {
    const bool full = full_mode();
    struct job_options o = {.noise = c->levels[0], .variance = true,
                            .reading = {.width = full ? 160 : 48, .height = full ? 90 : 27,
                                        .sampler = "sobol"}};
    double reference[BLOCKS], error[BLOCKS];
    char path[4608];
    struct job job;
    snprintf(path, sizeof path, "%s/%s", folder, c->path);
    o.scene = path;
    if (!job_open(&job, &o))
        exit(1);
    render_reference(&job, full ? c->reference_spp : 1024, reference, error);
    for (int i = 0; i < (full ? 3 : 1); i++)
        test_level(&job, c->levels[i], full ? MOST_RENDERS : 12, reference, error, c->name);
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
