// SPDX-License-Identifier: Apache-2.0
#include "driver/verify.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/thread.h"
#include "driver/edit_plan.h"
#include "driver/origin.h"
#include "math/hash.h"
#include "math/repeats.h"
#include "replay/edit_script.h"

enum { SIDE = 4, DEFAULT_SAMPLES = 256 };

struct verify {
    const struct verify_options *options;
    const struct tensor *tensor;
    struct edit *edit;
    struct job job;
    bool opened;
    float *frame, *variance;
    double floor; // 1e-3 mean(p)^2
    struct verify_result *result;
    double sums[4]; // over blocks: of the block means of relMSE, its square, noise, bias
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

static bool open_scene(struct verify *v) {
    struct conversion c = {edit_objects(v->edit), false};
    struct job_options o = v->options->job;
    const int bounces = tensor_bounces(v);
    o.reading.width = (int)v->tensor->width;
    o.reading.height = (int)v->tensor->height;
    o.reading.integrator = "path";
    o.spp = o.spp ? o.spp : DEFAULT_SAMPLES;
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

static void compare(struct verify *v, const int area[4], const struct image *a,
                    const struct image *b) {
    const size_t w = v->tensor->width, plane = w * v->tensor->height;
    const size_t n = (size_t)(area[2] - area[0]) * (size_t)(area[3] - area[1]);
    double relmse = 0, noise = 0, bias = 0;
    for (size_t i = 0; i < n; i++) {
        const size_t row = i / (size_t)(area[2] - area[0]), column = i % (size_t)(area[2] - area[0]);
        const size_t at = ((size_t)area[1] + row) * w + (size_t)area[0] + column;
        double power = v->floor;
        for (size_t k = 0; k < 3; k++) {
            const double p = (double)v->frame[k * plane + at], scale = p * p + v->floor;
            const double x = p - (double)a->pixels[i * (size_t)a->channels + k];
            const double y = p - (double)b->pixels[i * (size_t)b->channels + k];
            relmse += scale > 0 ? x * y / scale : 0;
            power += p * p / 3;
            bias += 0.5 * (x + y);
            v->result->mean += p;
        }
        // A variance of all channels together, against a coloured pixel's power: not its darkest channel.
        noise += power > 0 ? 3 * (double)v->variance[at] / power : 0;
    }
    relmse /= 3 * (double)n;
    v->sums[0] += relmse;
    v->sums[1] += relmse * relmse;
    v->sums[2] += noise / (3 * (double)n);
    v->sums[3] += bias;
    v->result->pixels += (uint32_t)n;
    v->result->blocks++;
}

static bool verify_block(struct verify *v, uint32_t block, uint32_t across) {
    const int w = (int)v->tensor->width, h = (int)v->tensor->height;
    const int x = (int)(block % across) * SIDE, y = (int)(block / across) * SIDE;
    const int area[4] = {x, y, x + SIDE < w ? x + SIDE : w, y + SIDE < h ? y + SIDE : h};
    const uint32_t seed = v->options->job.seed;
    struct image a, b;
    if (!trace(v, area, 2 * seed + 1000001, &a))
        return false;
    const bool good = trace(v, area, 2 * seed + 1000002, &b);
    if (good) {
        compare(v, area, &a, &b);
        image_finish(&b);
    }
    image_finish(&a);
    return good;
}

// Of 150 intervals from 16 blocks 28 missed the true error of an edit: where errors lie in few places, few
// blocks hold none of those and tell too little.
static void warn_of_few(uint32_t blocks, uint32_t all) {
    enum { FEW = 32 };
    if (blocks < FEW && blocks < all)
        log_warn("%u blocks of %u are few: the true error may well be outside of this interval; expected "
                 "--pixels %d or more", blocks, all, FEW * SIDE * SIDE);
}

// Draws distinct blocks: the first of a random permutation (Fisher and Yates).
static bool verify_blocks(struct verify *v) {
    const uint32_t across = (v->tensor->width + SIDE - 1) / SIDE;
    const uint32_t all = across * ((v->tensor->height + SIDE - 1) / SIDE);
    const uint32_t wanted = (v->options->pixels + SIDE * SIDE - 1) / (SIDE * SIDE);
    struct rng rng = {v->options->job.seed};
    uint32_t *order = mem_array(all, sizeof *order);
    bool good = true;
    for (uint32_t i = 0; i < all; i++)
        order[i] = i;
    for (uint32_t i = 0; i < all && i < wanted && good; i++) {
        const uint32_t k = i + rng_u32(&rng) % (all - i), swap = order[i];
        order[i] = order[k];
        order[k] = swap;
        good = verify_block(v, order[i], across);
        if (v->options->job.progress)
            v->options->job.progress(v->options->job.user, (i + 1.0) / (all < wanted ? all : wanted),
                                     NULL);
    }
    if (good)
        warn_of_few(v->result->blocks, all);
    mem_free(order);
    return good;
}

static void summarize(struct verify *v) {
    struct verify_result *r = v->result;
    const double n = r->blocks;
    const double variance = n > 1 ? (v->sums[1] - v->sums[0] * v->sums[0] / n) / (n - 1) : INFINITY;
    r->relmse = v->sums[0] / n;
    r->relmse_error = n > 1 ? student_95((int)n - 1) * sqrt(fmax(variance, 0) / n) : INFINITY;
    r->noise = v->sums[2] / n;
    r->bias = r->mean > 0 ? v->sums[3] / r->mean : 0;
    r->mean /= 3.0 * r->pixels;
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
    mem_free(v.frame);
    mem_free(v.variance);
    tensor_close(f);
    return good;
}
