// SPDX-License-Identifier: Apache-2.0
#include "driver/precompute_edit.h"

#include <stdatomic.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "driver/edit_fixed.h"
#include "driver/edit_pixels.h"
#include "driver/edit_sky.h"
#include "driver/origin.h"

enum { DEFAULT_POSITIONS = 16, TRIAL_REGIONS = 6, DRY_REGIONS = 24 };

struct worker {
    struct light_loop *loop;
    double *sums, *halves;   // of a pixel
    float *values, *noise;   // of a block: [16][coefficient][3]
    uint64_t rays;
    double shadow_seconds, sum_seconds;
};

struct precompute {
    const struct edit_options *options;
    struct job job;
    struct edit_plan plan;
    struct light_triangles lights;
    struct light_loop_object *objects;
    struct light_loop_scene *scene;
    struct edit_pixels pixels;
    struct worker *workers;
    int threads;
    struct tensor tensor;
    struct tensor_writer *writer; // NULL: a trial, nothing is kept
    unsigned char *marks;         // of what is done: the fixed picture, then regions; NULL: not kept
    uint32_t *first_block;        // by object
    bool noisy;
    const uint32_t *regions;      // that are worked on
    atomic_uint done;
    uint32_t work;
    struct edit_report *report;
};

// ---- the scene ----------------------------------------------------------------------------------

struct conversion {
    const struct edit_options *options;
    bool failed;
};

// Coefficients are the product of both curves' bins, and a second one, Fresnel's, is smooth.
enum { CONVERTED_BINS_B = 32 };

static void edit_scene(struct scene *s, void *user) {
    struct conversion *c = user;
    const struct param *samples = param_find(s->integrator->type, "shading_samples");
    const int count = (int)c->options->light_samples;
    if (samples)
        memcpy((char *)s->integrator->data + samples->offset, &count, sizeof count);
    c->failed = !edit_convert(s, c->options->edit, c->options->edit_count, CONVERTED_BINS_B);
}

static bool open_scene(struct precompute *p) {
    const struct edit_options *o = p->options;
    struct conversion c = {o, false};
    struct job_options job = o->job;
    job.reading.integrator = "direct";
    job.spp = job.spp ? job.spp : DEFAULT_POSITIONS;
    job.edit_scene = edit_scene;
    job.edit_user = &c;
    if (!job_open(&p->job, &job))
        return false;
    if (p->job.world->links)
        log_error("%s: has lights that light some shapes only, which --direct does not do; leave out "
                  "their `include` and `exclude`, or --direct", p->job.scene->path);
    else if (!c.failed && edit_plan_init(&p->plan, p->job.scene))
        return true;
    job_close(&p->job);
    return false;
}

static void make_loop(struct precompute *p) {
    const struct tracer_options *t = &p->job.render.tracer;
    p->objects = mem_array(p->plan.count, sizeof *p->objects);
    for (uint32_t i = 0; i < p->plan.count; i++)
        p->objects[i] = (struct light_loop_object){p->plan.objects[i].material->data,
                                                   p->plan.objects[i].form};
    p->scene = light_loop_scene_create(&(struct light_loop_options){
        .world = t->world, .sensor = t->sensor, .filter = t->filter, .sampler = t->sampler,
        .seed = t->seed, .positions = t->spp, .lights = &p->lights,
        .refines = p->options->first > 0, .unshadowed = p->options->unshadowed,
        .as_points = p->options->as_points, .tolerance = p->options->tolerance,
        .light_samples = (p->options->light_samples + 1) / 2 * 2, .objects = p->objects,
        .object_count = p->plan.count});
    p->noisy = light_loop_has_noise(p->scene);
}

// ---- blocks of the tensor -----------------------------------------------------------------------

static void add_block(struct precompute *p, uint32_t object, uint32_t term) {
    static const float some;
    struct tensor_block *b = &p->tensor.blocks[p->tensor.block_count];
    const struct edit_pixels_list *list = &p->pixels.lists[object];
    const struct form *f = p->plan.objects[object].form;
    float *weights;
    p->tensor.block_count++;
    edit_plan_block(&p->plan, object, term, b);
    b->pixel_count = list->count;
    b->pixels = list->pixels;
    b->storage = p->options->storage;
    b->halves = p->noisy ? &some : NULL;
    b->view = edit_term_has(&f->term[term], SLOT_O) ? list->view : NULL;
    b->weights = weights = arena_alloc(&p->plan.arena, sizeof(float) * b->coefficients * 3);
    edit_plan_weights(&p->plan, object, term, weights);
    p->report->coefficients += list->count * b->coefficients;
    p->report->file_bytes += tensor_bytes(b) * (p->noisy ? 2 : 1) + list->count * 4;
}

static void make_blocks(struct precompute *p) {
    static const float some;
    const struct film_settings *f = &p->job.scene->film;
    p->tensor = (struct tensor){.width = (uint32_t)f->width, .height = (uint32_t)f->height,
                                .fixed = &some};
    p->tensor.blocks = mem_array((size_t)p->plan.count * FORM_TERMS, sizeof *p->tensor.blocks);
    p->first_block = mem_array(p->plan.count, sizeof *p->first_block);
    for (uint32_t i = 0; i < p->plan.count; i++) {
        p->first_block[i] = p->tensor.block_count;
        if (p->pixels.lists[i].count == 0)
            log_warn("%s: no pixel shows it", p->plan.objects[i].name);
        for (uint32_t t = 0; t < p->plan.objects[i].form->terms && p->pixels.lists[i].count > 0; t++)
            add_block(p, i, t);
        p->report->pixels += p->pixels.lists[i].count;
    }
    p->report->file_bytes += (uint64_t)f->width * (uint64_t)f->height * 12;
    p->report->blocks = p->tensor.block_count;
}

// ---- workers ------------------------------------------------------------------------------------

static size_t most_coefficients(const struct precompute *p) {
    size_t most = 0;
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const size_t n = light_loop_coefficients(p->scene, i);
        most = p->pixels.lists[i].count > 0 && n > most ? n : most;
    }
    return most;
}

static bool make_workers(struct precompute *p) {
    const size_t n = most_coefficients(p) * CURVE_CHANNELS, halves = p->noisy ? 2 : 1;
    const double most = p->options->most_memory > 0 ? p->options->most_memory : (double)mem_of_machine() / 2;
    p->report->sums_bytes = (uint64_t)p->threads * halves *
                            (n * sizeof(double) + n * LIGHT_LOOP_PIXELS * sizeof(float));
    if ((double)p->report->sums_bytes > most) {
        log_error("the sums of %d pixels at once take %.3g GB, more than the %.3g GB of --memory; "
                  "take fewer --threads or fewer bins", p->threads,
                  (double)p->report->sums_bytes * 1e-9, most * 1e-9);
        return false;
    }
    for (int i = 0; i < p->threads; i++) {
        struct worker *w = &p->workers[i];
        w->sums = mem_array(n + LIGHT_LOOP_SPARE, sizeof *w->sums);
        w->values = mem_array(n * LIGHT_LOOP_PIXELS, sizeof *w->values);
        w->halves = p->noisy ? mem_array(n, sizeof *w->halves) : NULL;
        w->noise = p->noisy ? mem_array(n * LIGHT_LOOP_PIXELS, sizeof *w->noise) : NULL;
    }
    return true;
}

// ---- the loop -----------------------------------------------------------------------------------

// Lists of the places of a block's pixels that show an object, and what they got.
static void store(const struct precompute *p, uint32_t object, const uint32_t *places,
                  const uint32_t *lanes, uint32_t count, const float *from, bool noise) {
    const size_t all = (size_t)light_loop_coefficients(p->scene, object) * CURVE_CHANNELS;
    size_t at = 0;
    for (uint32_t t = 0; t < p->plan.objects[object].form->terms; t++) {
        const uint32_t block = p->first_block[object] + t;
        const struct tensor_block *b = &p->tensor.blocks[block];
        void *to = noise ? tensor_halves(p->writer, block) : tensor_values(p->writer, block);
        const size_t n = (size_t)b->coefficients * CURVE_CHANNELS;
        for (size_t i = 0; i < n; i++)
            for (uint32_t k = 0; k < count; k++) {
                const size_t tile = places[k] / TENSOR_LANES, lane = places[k] % TENSOR_LANES;
                const size_t place = (tile * n + i) * TENSOR_LANES + lane;
                const float v = from[lanes[k] * all + at + i];
                if (b->storage == TENSOR_BF16)
                    ((uint16_t *)to)[place] = bf16_from_float(v);
                else
                    ((float *)to)[place] = v;
            }
        at += n;
    }
}

static float bounded(double v) {
    return v > 3e38 ? 3e38f : v < -3e38 ? -3e38f : (float)v; // NaN cannot occur: no infinity comes in
}

static void sum_object(const struct precompute *p, struct worker *w, int x0, int y0,
                       uint32_t object) {
    const size_t n = (size_t)light_loop_coefficients(p->scene, object) * CURVE_CHANNELS;
    uint32_t places[LIGHT_LOOP_PIXELS], lanes[LIGHT_LOOP_PIXELS], count = 0;
    for (uint32_t i = 0; i < LIGHT_LOOP_PIXELS; i++) {
        const uint32_t place = edit_pixels_place(&p->pixels, object, x0 + (int)(i % LIGHT_LOOP_SIDE),
                                                 y0 + (int)(i / LIGHT_LOOP_SIDE));
        if (place == EDIT_NONE)
            continue;
        light_loop_sum(w->loop, i, object, w->sums, w->halves);
        for (size_t k = 0; k < n; k++)
            w->values[i * n + k] = bounded(w->sums[k]);
        for (size_t k = 0; k < n && p->noisy; k++)
            w->noise[i * n + k] = bounded(w->halves[k]);
        lanes[count] = i;
        places[count++] = place;
    }
    if (!p->writer)
        return;
    store(p, object, places, lanes, count, w->values, false);
    if (p->noisy)
        store(p, object, places, lanes, count, w->noise, true);
}

static void work_on_block(const struct precompute *p, struct worker *w, int x, int y) {
    if (!edit_pixels_any(&p->pixels, x, y))
        return;
    light_loop_see(w->loop, x, y);
    const double start = time_seconds();
    w->rays += light_loop_shadow(w->loop);
    const double middle = time_seconds();
    for (uint32_t i = 0; i < p->plan.count; i++)
        if (p->pixels.lists[i].count > 0)
            sum_object(p, w, x, y, i);
    w->shadow_seconds += middle - start;
    w->sum_seconds += time_seconds() - middle;
}

static bool stopped(const struct precompute *p) {
    return p->options->job.stop && *p->options->job.stop;
}

static void work_on_region(void *ctx, size_t item, int worker) {
    struct precompute *p = ctx;
    const int first_x = p->pixels.area.x0 / EDIT_REGION, first_y = p->pixels.area.y0 / EDIT_REGION;
    const uint32_t region = p->regions ? p->regions[item] : (uint32_t)item;
    const int x = (first_x + (int)region % p->pixels.regions_x) * EDIT_REGION;
    const int y = (first_y + (int)region / p->pixels.regions_x) * EDIT_REGION;
    unsigned char *mark = p->marks && p->writer ? &p->marks[region + 1] : NULL;
    accel_thread_init();
    for (int i = 0; i < 4 && !stopped(p) && !(mark && *mark); i++)
        work_on_block(p, &p->workers[worker], x + i % 2 * LIGHT_LOOP_SIDE,
                      y + i / 2 * LIGHT_LOOP_SIDE);
    if (mark && !stopped(p))
        *mark = 1;
    const uint32_t done = atomic_fetch_add(&p->done, 1) + 1;
    if (p->options->progress && p->writer && worker == 0)
        p->options->progress(p->options->user, (double)done / p->work);
}

static void work_on_regions(struct precompute *p, const uint32_t *regions, uint32_t count,
                            int threads) {
    p->regions = regions;
    p->work = count;
    atomic_store(&p->done, 0);
    for (int i = 0; i < p->threads; i++) {
        struct worker *w = &p->workers[i];
        w->rays = 0;
        w->shadow_seconds = w->sum_seconds = 0;
    }
    thread_for(threads, count, work_on_region, p);
}

static void take_counts(struct precompute *p) {
    struct edit_report *r = p->report;
    for (int i = 0; i < p->threads; i++) {
        r->rays += p->workers[i].rays;
        r->shadow_seconds += p->workers[i].shadow_seconds;
        r->sum_seconds += p->workers[i].sum_seconds;
    }
}

// Tries both arrangements of shadow rays on a few regions of this scene.
static void choose_packets(struct precompute *p) {
    const char *asked = p->options->packets ? p->options->packets : "auto";
    enum light_packets best = strcmp(asked, "lights") == 0 ? PACKETS_OF_LIGHTS : PACKETS_OF_PIXELS;
    if (strcmp(asked, "auto") == 0 && !p->options->resume) { // a second run may measure otherwise
        uint32_t regions[TRIAL_REGIONS];
        const uint32_t count = edit_pixels_spread(&p->pixels, regions, TRIAL_REGIONS);
        double seconds[2];
        for (int i = 0; i < 2; i++) {
            light_loop_set_packets(p->scene, (enum light_packets)i);
            work_on_regions(p, regions, count, 1);
            seconds[i] = p->workers[0].shadow_seconds;
        }
        best = seconds[PACKETS_OF_LIGHTS] < seconds[PACKETS_OF_PIXELS] ? PACKETS_OF_LIGHTS
                                                                       : PACKETS_OF_PIXELS;
    }
    light_loop_set_packets(p->scene, best);
    p->report->packets = best == PACKETS_OF_LIGHTS ? "lights" : "pixels";
}

// ---- the file -----------------------------------------------------------------------------------

static struct json *describe(const struct precompute *p) {
    const struct edit_options *o = p->options;
    struct json *meta = json_new_object();
    uint32_t most = 1;
    json_add_text(meta, "kind", "edit");
    json_add_text(meta, "command", o->command);
    json_add_text(meta, "program", o->version);
    origin_add(meta, &p->job, &o->job);
    json_add_text(meta, "colour space", "linear Rec.709");
    json_add_count(meta, "samples", p->job.render.tracer.spp);
    json_add_count(meta, "seed", o->job.seed);
    json_add_count(meta, "light samples", o->light_samples);
    json_add_count(meta, "lights", p->lights.count);
    struct json *range = json_add_array(meta, "range");
    json_append_count(range, o->first);
    json_append_count(range, o->lights);
    json_add_text(meta, "packets", p->report->packets);
    json_add_count(meta, "bounces", 1);
    for (uint32_t i = 0; i < p->tensor.block_count; i++)
        for (uint32_t k = 0; k < p->tensor.blocks[i].axis_count; k++)
            if (p->tensor.blocks[i].axes[k].bins > most)
                most = p->tensor.blocks[i].axes[k].bins;
    json_append_count(json_add_array(meta, "series"), most);
    json_add_text(meta, "tail", "none");
    edit_plan_describe(&p->plan, meta, NULL);
    return meta;
}

// The first part of the work. What no light of a later range changes is in the first range.
static bool make_fixed(struct precompute *p) {
    const double start = time_seconds();
    if (p->options->first > 0 || (p->marks && p->marks[0]))
        return true;
    const bool made = edit_fixed_render(&p->job, &p->plan, tensor_fixed(p->writer));
    p->report->fixed_seconds = time_seconds() - start;
    if (made && p->marks)
        p->marks[0] = 1;
    return made;
}

static bool write_tensor(struct precompute *p) {
    struct json *meta = describe(p);
    p->tensor.meta = meta;
    const size_t parts = (size_t)edit_pixels_regions(&p->pixels) + 1;
    p->writer = p->options->resume
                    ? tensor_create_kept(p->options->output, &p->tensor, parts, &p->marks)
                    : tensor_create(p->options->output, &p->tensor);
    json_destroy(meta);
    if (!p->writer)
        return false;
    bool whole = make_fixed(p);
    if (whole) {
        work_on_regions(p, NULL, edit_pixels_regions(&p->pixels), p->threads);
        take_counts(p);
        whole = !stopped(p);
    }
    struct tensor_writer *w = p->writer;
    p->writer = NULL;
    p->report->stopped = !whole;
    if (whole)
        return tensor_finish(w);
    tensor_abandon(w);
    log_error("stopped before the tensor was whole: %s is not written%s", p->options->output,
              p->marks ? "; the same command goes on" : "");
    return false;
}

// Works on a few regions and throws them away, to tell how long all would take.
static void estimate(struct precompute *p) {
    uint32_t regions[DRY_REGIONS];
    const uint32_t count = edit_pixels_spread(&p->pixels, regions, DRY_REGIONS);
    const double start = time_seconds();
    work_on_regions(p, regions, count, p->threads);
    take_counts(p);
    if (count > 0)
        p->report->seconds = (time_seconds() - start) * edit_pixels_shown(&p->pixels) / count;
}

// ---- all of it ----------------------------------------------------------------------------------

static bool run(struct precompute *p) {
    const struct film_options *f = &p->job.film;
    struct light_loop **loops = mem_array((size_t)p->threads, sizeof(struct light_loop *));
    edit_sky_init(&p->lights, p->job.world, p->options->first, p->options->lights, p->threads);
    make_loop(p);
    p->workers = mem_array((size_t)p->threads, sizeof *p->workers);
    for (int i = 0; i < p->threads; i++)
        loops[i] = p->workers[i].loop = light_loop_create(p->scene);
    edit_pixels_init(&p->pixels, loops, p->threads, p->plan.count,
                     &(struct sink_area){f->x0, f->y0, f->x1, f->y1}, p->job.scene->film.width);
    mem_free(loops);
    make_blocks(p);
    p->report->objects = p->plan.count;
    p->report->lights = p->lights.count;
    p->report->positions = p->job.render.tracer.spp;
    if (!make_workers(p))
        return false;
    choose_packets(p);
    if (!p->options->dry_run)
        return write_tensor(p);
    estimate(p);
    return true;
}

static void finish(struct precompute *p) {
    for (int i = 0; i < p->threads && p->workers; i++) {
        struct worker *w = &p->workers[i];
        light_loop_destroy(w->loop);
        mem_free(w->sums);
        mem_free(w->halves);
        mem_free(w->values);
        mem_free(w->noise);
    }
    mem_free(p->workers);
    mem_free(p->tensor.blocks);
    mem_free(p->first_block);
    mem_free(p->objects);
    edit_pixels_finish(&p->pixels);
    light_loop_scene_destroy(p->scene);
    light_triangles_finish(&p->lights);
    edit_plan_finish(&p->plan);
    job_close(&p->job);
}

bool precompute_edit(const struct edit_options *o, struct edit_report *report) {
    struct precompute p = {.options = o, .report = report};
    const double start = time_seconds();
    *report = (struct edit_report){.packets = ""};
    p.threads = o->job.threads > 0 ? o->job.threads : thread_default_count();
    accel_thread_init(); // tiny numbers of curves are the same in a process's first run and later
    if (!open_scene(&p))
        return false;
    const bool done = run(&p);
    if (!o->dry_run)
        report->seconds = time_seconds() - start;
    finish(&p);
    return done;
}
