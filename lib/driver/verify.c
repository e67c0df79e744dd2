// SPDX-License-Identifier: Apache-2.0
#include "driver/verify.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/thread.h"
#include "driver/edit_plan.h"
#include "driver/origin.h"
#include "math/balanced_sample.h"
#include "replay/edit_script.h"

// Two traces in two halves each: four tell their noise as well. At least LEAST blocks are drawn: where a
// third of the error is in two of 64 blocks, intervals from 32 held it in 86 to 92 of 100 trials.
enum { SIDE = 4, DEFAULT_SAMPLES = 256, TRACES = 4, LEAST = 128 };

struct verify {
    const struct verify_options *options;
    const struct tensor *tensor;
    struct edit *edit;
    struct job job;
    bool opened;
    float *frame, *variance;
    double floor; // 1e-3 mean(p)^2
    uint32_t across, down, wanted; // blocks
    int half_spp;
    struct balanced_sample drawn;
    double *relmse, *variance_of_it; // of the drawn blocks, sums over their pixels
    double bias;                     // the sum of p - u that they tell of
    struct verify_result *result;
};

// ---- the tensor ---------------------------------------------------------------------------------

static bool change(struct verify *v) {
    struct edit_script s;
    const struct verify_options *o = v->options;
    if (!o->edits)
        return true;
    if (!edit_script_read(&s, o->edits))
        return false;
    const bool good = edit_script_apply(&s, edit_objects(v->edit), o->edits);
    edit_script_finish(&s);
    return good;
}

static bool make_picture(struct verify *v) {
    const size_t plane = (size_t)v->tensor->width * v->tensor->height;
    double mean = 0;
    v->edit = edit_create(v->tensor, v->options->tensor, &(struct edit_settings){
        .no_device = v->options->no_device, .threads = v->options->job.threads});
    if (!v->edit || !change(v))
        return false;
    v->frame = mem_array(3 * plane, sizeof *v->frame);
    v->variance = mem_array(plane, sizeof *v->variance);
    if (!edit_frame(v->edit, v->frame))
        return false;
    edit_variance(v->edit, v->variance);
    for (size_t i = 0; i < 3 * plane; i++)
        mean += (double)v->frame[i] / (3 * (double)plane);
    v->floor = 1e-3 * mean * mean;
    v->result->mean = mean;
    return true;
}

// ---- the scene ----------------------------------------------------------------------------------

struct conversion {
    const struct edit_tensor *objects;
    bool failed;
};

// Objects whose names are not given by counting are made editable, as they were for the tensor.
static void convert(struct scene *s, void *user) {
    struct conversion *c = user;
    for (uint32_t i = 0; i < c->objects->object_count && !c->failed; i++) {
        const char *name = c->objects->objects[i].name;
        if (strncmp(name, "object ", 7) != 0)
            c->failed = !edit_convert(s, &name, 1, 0);
    }
}

// The edited forms go into the scene's materials.
static bool edit_materials(struct verify *v) {
    const struct edit_tensor *e = edit_objects(v->edit);
    struct edit_plan plan;
    if (!edit_plan_init(&plan, v->job.scene))
        return false;
    bool good = true;
    for (uint32_t i = 0; i < e->object_count && good; i++) {
        uint32_t k = 0;
        while (k < plan.count && strcmp(plan.objects[k].name, e->objects[i].name) != 0)
            k++;
        if (k == plan.count) {
            log_error("%s: has no object %s", v->options->job.scene, e->objects[i].name);
            good = false;
        } else {
            struct object *material = (struct object *)(uintptr_t)plan.objects[k].material;
            good = editable_set_form(material, &e->objects[i].form, &v->job.scene->arena,
                                     e->objects[i].name);
        }
    }
    edit_plan_finish(&plan);
    return good;
}

static int tensor_bounces(const struct verify *v) {
    const char *tail = json_text(json_get(v->tensor->meta, "tail"));
    int64_t bounces = 0;
    json_read_integer(json_get(v->tensor->meta, "bounces"), &bounces);
    const bool all = v->options->all_bounces || (tail && strcmp(tail, "none") != 0);
    return all || bounces < 1 || bounces > 1000 ? 0 : (int)bounces;
}

// How many blocks are drawn, and how many samples of a pixel each half trace then has: as many in all as
// were asked for, at least one.
static void set_extent(struct verify *v) {
    const uint32_t asked = (v->options->pixels + SIDE * SIDE - 1) / (SIDE * SIDE);
    const uint32_t least = asked > LEAST ? asked : LEAST;
    const uint64_t spp = v->options->job.spp ? (uint64_t)v->options->job.spp : DEFAULT_SAMPLES;
    v->across = (v->tensor->width + SIDE - 1) / SIDE;
    v->down = (v->tensor->height + SIDE - 1) / SIDE;
    v->wanted = least < v->across * v->down ? least : v->across * v->down;
    const uint64_t paths = spp * (asked < v->wanted ? asked : v->wanted), halves = 2 * v->wanted;
    v->half_spp = (int)((paths + halves - 1) / halves);
}

static bool open_scene(struct verify *v) {
    struct conversion c = {edit_objects(v->edit), false};
    struct job_options o = v->options->job;
    const int bounces = tensor_bounces(v);
    set_extent(v);
    o.reading.width = (int)v->tensor->width;
    o.reading.height = (int)v->tensor->height;
    o.reading.integrator = "path";
    o.spp = v->half_spp;
    o.max_depth = bounces ? bounces + 1 : -1;
    o.light = json_text(json_get(v->tensor->meta, "light"));
    o.edit_scene = convert;
    o.edit_user = &c;
    v->opened = job_open(&v->job, &o);
    v->result->bounces = (uint32_t)bounces;
    return v->opened && !c.failed &&
           origin_agrees(v->tensor->meta, v->options->tensor, &v->job, &v->options->job) &&
           edit_materials(v);
}

// ---- blocks -------------------------------------------------------------------------------------

static size_t block_area(const struct verify *v, uint32_t block, int area[4]) {
    const int w = (int)v->tensor->width, h = (int)v->tensor->height;
    const int x = (int)(block % v->across) * SIDE, y = (int)(block / v->across) * SIDE;
    area[0] = x;
    area[1] = y;
    area[2] = x + SIDE < w ? x + SIDE : w;
    area[3] = y + SIDE < h ? y + SIDE : h;
    return (size_t)(area[2] - x) * (size_t)(area[3] - y);
}

// Where the pixel of an area stands in the picture.
static size_t pixel_of(const struct verify *v, const int area[4], size_t i) {
    const size_t across = (size_t)(area[2] - area[0]);
    return ((size_t)area[1] + i / across) * v->tensor->width + (size_t)area[0] + i % across;
}

// relMSE of a pixel as the half-sums tell of it: a variance of all channels together against a coloured
// pixel's power, not its darkest channel.
static double pixel_noise(const struct verify *v, size_t at) {
    const size_t plane = (size_t)v->tensor->width * v->tensor->height;
    double power = v->floor;
    for (size_t k = 0; k < 3; k++)
        power += (double)v->frame[k * plane + at] * (double)v->frame[k * plane + at] / 3;
    return power > 0 ? (double)v->variance[at] / power : 0;
}

// Draws blocks with probabilities proportional to the noise that is told of there and half as much
// everywhere, since other errors are told of nowhere: none counts more than three times what it does in
// an even draw.
static void draw_blocks(struct verify *v) {
    const double pixels = (double)v->tensor->width * v->tensor->height;
    const uint32_t all = v->across * v->down;
    double *size = mem_array(all, sizeof *size);
    struct rng rng = {v->options->job.seed};
    int area[4];
    for (uint32_t i = 0; i < all; i++) {
        const size_t n = block_area(v, i, area);
        for (size_t k = 0; k < n; k++)
            size[i] += pixel_noise(v, pixel_of(v, area, k));
        v->result->noise += size[i] / pixels;
    }
    for (uint32_t i = 0; i < all; i++)
        size[i] += (v->result->noise > 0 ? v->result->noise / 2 : 1) * (double)block_area(v, i, area);
    balanced_sample_draw(&v->drawn, v->across, v->down, size, v->wanted, &rng);
    v->relmse = mem_array(v->drawn.count, sizeof *v->relmse);
    v->variance_of_it = mem_array(v->drawn.count, sizeof *v->variance_of_it);
    mem_free(size);
}

static bool trace(struct verify *v, const int area[4], uint32_t seed, struct image *im) {
    struct render_result result;
    v->job.film.x0 = area[0];
    v->job.film.y0 = area[1];
    v->job.film.x1 = area[2];
    v->job.film.y1 = area[3];
    v->job.render.tracer.seed = seed;
    struct film *film = job_render(&v->job, &result);
    const bool good = !result.stopped && film_image(film, im);
    film_destroy(film);
    return good;
}

// Squared error of a pixel from the products G_ij = <e + n_i, e + n_j> of four distances with error e and
// noise n: the mean of all six. Its variance is V + W / 6, with V that of <e, n> and W that of <n, n'>;
// differences in a pair of pairs (01 23, 02 13, 03 12) have 4 V + 2 W, those between sums of such pairs 4 W.
static double mean_of_products(double g[TRACES][TRACES], double *variance) {
    const double sums[3] = {g[1][0] + g[3][2], g[2][0] + g[3][1], g[3][0] + g[2][1]};
    const double differences[3] = {g[1][0] - g[3][2], g[2][0] - g[3][1], g[3][0] - g[2][1]};
    double within = 0, between = 0;
    for (int i = 0; i < 3; i++) {
        const double d = sums[i] - sums[(i + 1) % 3];
        within += differences[i] * differences[i];
        between += d * d;
    }
    *variance = within / 12 - between / 36;
    return (sums[0] + sums[1] + sums[2]) / 6;
}

// Adds what the traces tell of one pixel: relMSE, its variance, and p - u.
static void compare_pixel(const struct verify *v, size_t at, const struct image *traces, size_t pixel,
                          double sums[3]) {
    const size_t plane = (size_t)v->tensor->width * v->tensor->height;
    double products[TRACES][TRACES] = {{0}}, variance;
    for (size_t k = 0; k < 3; k++) {
        const double p = (double)v->frame[k * plane + at], scale = p * p + v->floor;
        double d[TRACES];
        for (int a = 0; a < TRACES; a++) {
            d[a] = p - (double)traces[a].pixels[pixel * (size_t)traces[a].channels + k];
            sums[2] += d[a] / TRACES;
            for (int b = 0; b < a && scale > 0; b++)
                products[a][b] += d[a] * d[b] / scale / 3;
        }
    }
    sums[0] += mean_of_products(products, &variance);
    sums[1] += variance;
}

// The noise of pixels is independent.
static void compare(struct verify *v, uint32_t drawn, const int area[4], size_t n,
                    const struct image *traces) {
    double sums[3] = {0};
    for (size_t i = 0; i < n; i++)
        compare_pixel(v, pixel_of(v, area, i), traces, i, sums);
    v->relmse[drawn] = sums[0];
    v->variance_of_it[drawn] = fmax(0, sums[1]);
    v->bias += sums[2] / v->drawn.probability[drawn];
    v->result->pixels += (uint32_t)n;
    v->result->blocks++;
}

static bool verify_block(struct verify *v, uint32_t drawn) {
    struct image traces[TRACES];
    int area[4], done = 0;
    const size_t n = block_area(v, v->drawn.cell[drawn], area);
    const uint32_t seed = TRACES * v->options->job.seed + 1000001;
    while (done < TRACES && trace(v, area, seed + (uint32_t)done, &traces[done]))
        done++;
    if (done == TRACES)
        compare(v, drawn, area, n, traces);
    for (int i = 0; i < done; i++)
        image_finish(&traces[i]);
    return done == TRACES;
}

static bool verify_blocks(struct verify *v) {
    draw_blocks(v);
    bool good = true;
    for (uint32_t i = 0; i < v->drawn.count && good; i++) {
        good = verify_block(v, i);
        if (v->options->job.progress)
            v->options->job.progress(v->options->job.user, (i + 1.0) / v->drawn.count, NULL);
    }
    return good;
}

static void summarize(struct verify *v) {
    struct verify_result *r = v->result;
    const double pixels = (double)v->tensor->width * v->tensor->height;
    const struct measured m = balanced_sample_total(&v->drawn, v->relmse, v->variance_of_it);
    r->relmse = m.value / pixels;
    r->relmse_error = (m.high - m.value) / pixels;
    r->bias = r->mean > 0 ? v->bias / (3 * r->mean * pixels) : 0;
}

bool verify_edit(const struct verify_options *o, struct verify_result *r) {
    const double start = time_seconds();
    struct verify v = {.options = o, .result = r};
    struct tensor_file *f = tensor_open(o->tensor);
    *r = (struct verify_result){0};
    v.tensor = f ? tensor_get(f) : NULL;
    const bool good = f && make_picture(&v) && open_scene(&v) && verify_blocks(&v);
    if (good)
        summarize(&v);
    r->seconds = time_seconds() - start;
    if (v.opened)
        job_close(&v.job);
    edit_destroy(v.edit);
    balanced_sample_finish(&v.drawn);
    mem_free(v.relmse);
    mem_free(v.variance_of_it);
    mem_free(v.frame);
    mem_free(v.variance);
    tensor_close(f);
    return good;
}
