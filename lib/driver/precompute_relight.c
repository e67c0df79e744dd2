// SPDX-License-Identifier: Apache-2.0
// For the environment's bases the scene's infinite lights give way to one of radiance 1 that comes
// from everywhere, so that every direction is sampled whatever the old ones looked like.
#include "driver/precompute_relight.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "curve/wavelet.h"
#include "driver/origin.h"
#include "sink/lighting.h"
#include "sink/tensor_sums.h"

enum { HALVES = 2, DRY_TILES = 4 };

struct basis {
    struct source_basis source;
    char type[16]; // as in the metadata
    struct light_groups groups;
    float *weights; // of the scene as it is, [coefficient][3]
};

// ---- the basis ----------------------------------------------------------------------------------

static bool grid_fits(const struct basis *b) {
    const int w = b->source.width, h = b->source.height;
    return w >= 1 && h >= 1 && (int64_t)w * h <= 1 << 16 &&
           (!b->source.transformed || (wavelet_fits((size_t)w) && wavelet_fits((size_t)h)));
}

static bool parse_basis(const char *text, struct basis *b) {
    struct source_basis *s = &b->source;
    char rest;
    if (strcmp(text, "lights") == 0) {
        s->kind = SOURCE_LIGHTS;
        strcpy(b->type, "lights");
        return true;
    }
    if (sscanf(text, "sh:%d%c", &s->order, &rest) == 1 && s->order >= 0 &&
        s->order <= SOURCE_MOST_ORDER) {
        s->kind = SOURCE_SH;
        s->count = (uint32_t)((s->order + 1) * (s->order + 1));
        strcpy(b->type, "sh");
        return true;
    }
    if (sscanf(text, "%15[a-z0-9]:%dx%d%c", b->type, &s->width, &s->height, &rest) == 3) {
        const bool haar = strcmp(b->type, "haar") == 0, daub4 = strcmp(b->type, "daub4") == 0;
        s->kind = SOURCE_PIXELS;
        s->count = (uint32_t)(s->width * s->height);
        s->transformed = haar || daub4;
        s->wavelet = daub4 ? WAVELET_DAUB4 : WAVELET_HAAR;
        if ((haar || daub4 || strcmp(b->type, "pixels") == 0) && grid_fits(b))
            return true;
    }
    log_error("--basis %s: expected lights, sh:N with N up to %d, pixels:WxH, or haar:WxH or daub4:WxH "
              "with powers of two, of at most 65536 cells", text, SOURCE_MOST_ORDER);
    return false;
}

static bool set_weights(struct basis *b, const struct job *job) {
    struct source_basis *s = &b->source;
    if (s->kind == SOURCE_LIGHTS) {
        if (!light_groups_init(&b->groups, job->scene))
            return false;
        s->count = b->groups.count;
        s->group_of_light = b->groups.of_light;
        s->light_count = job->scene->light_count;
    }
    b->weights = mem_array(3 * (size_t)s->count, sizeof *b->weights);
    if (s->kind == SOURCE_LIGHTS)
        for (uint32_t i = 0; i < 3 * s->count; i++)
            b->weights[i] = 1;
    else
        lighting_project(s, &(struct sky){world_environment, job->world, 0}, b->weights);
    return true;
}

// ---- the scene ----------------------------------------------------------------------------------

// One environment of radiance 1 in place of all infinite lights; *user is its index.
static void replace_environment(struct scene *s, void *user) {
    const struct param *radiance = param_find(&light_constant.entry, "radiance");
    struct object *o = arena_alloc(&s->arena, sizeof *o);
    struct scene_light *left = arena_alloc(&s->arena, (s->light_count + 1) * sizeof *left);
    const spectrum one = spectrum_grey(1);
    uint32_t kept = 0, at = UINT32_MAX;
    for (uint32_t i = 0; i < s->light_count; i++) {
        const struct light_type *type = light_type_of(s->lights[i].object);
        if (type->infinite && !type->delta) {
            if (at == UINT32_MAX)
                at = kept++;
            continue;
        }
        if (s->lights[i].shape != SCENE_NONE)
            s->shapes[s->lights[i].shape].light = kept;
        left[kept++] = s->lights[i];
    }
    if (at == UINT32_MAX)
        at = kept++;
    o->type = &light_constant.entry;
    o->data = arena_alloc(&s->arena, light_constant.entry.size);
    memcpy((char *)o->data + radiance->offset, &one, sizeof one);
    left[at] = (struct scene_light){.object = o, .shape = SCENE_NONE, .name = "environment"};
    s->lights = left;
    s->light_count = kept;
    *(uint32_t *)user = at;
}

// What takes its place lights everything and is seen.
static bool environment_is_plain(const struct relight_options *o, const struct world *w) {
    for (uint32_t i = 0; i < w->infinite_count; i++) {
        const struct world_light *l = &w->lights[w->infinite[i]];
        if (!l->dark && !l->hidden)
            continue;
        log_error("--basis %s: the scene's environment is hidden from the camera or lights some shapes "
                  "only, which --basis lights keeps and this one cannot", o->basis);
        return false;
    }
    return true;
}

static bool light_is_traced(const struct scene *s) {
    if (integrator_lights(s->integrator))
        return true;
    log_error("%s: integrator \"%s\" traces no light that a tensor could keep; expected one that does, as "
              "path", s->path, s->integrator->type->name);
    return false;
}

static bool open_jobs(const struct relight_options *o, struct basis *b, struct job *job) {
    if (!parse_basis(o->basis, b) || !job_open(job, &o->job))
        return false;
    if (!light_is_traced(job->scene) ||
        (b->source.kind != SOURCE_LIGHTS && !environment_is_plain(o, job->world)) ||
        !set_weights(b, job)) {
        job_close(job);
        return false;
    }
    if (b->source.kind == SOURCE_LIGHTS)
        return true;
    struct job_options unlit = o->job;
    unlit.edit_scene = replace_environment;
    unlit.edit_user = &b->source.environment;
    job_close(job);
    return job_open(job, &unlit);
}

// ---- the file -----------------------------------------------------------------------------------

static struct json *describe(const struct relight_options *o, const struct basis *b,
                             const struct job *job, uint32_t samples) {
    struct json *meta = json_new_object(), *basis;
    const struct receiver *receiver = &o->job.receiver;
    json_add_text(meta, "kind", "relight");
    json_add_text(meta, "command", o->command);
    json_add_text(meta, "program", o->version);
    origin_add(meta, job, &o->job);
    json_add_text(meta, "integrator", job->scene->integrator->type->name);
    json_add_count(meta, "max depth", o->job.max_depth); // 0: the scene's
    if (receiver->texels || receiver->vertices)
        json_add_text(meta, receiver->texels ? "texels" : "vertices",
                      receiver->texels ? receiver->texels : receiver->vertices);
    json_add_count(meta, "samples", samples);
    json_add_count(meta, "seed", o->job.seed);
    json_add_text(meta, "colour space", "linear Rec.709");
    basis = json_add_object(meta, "basis");
    json_add_text(basis, "type", b->type);
    if (b->source.kind == SOURCE_PIXELS) {
        json_add_count(basis, "width", b->source.width);
        json_add_count(basis, "height", b->source.height);
    } else if (b->source.kind == SOURCE_SH) {
        json_add_count(basis, "order", b->source.order);
    } else {
        struct json *names = json_add_array(basis, "lights");
        for (uint32_t i = 0; i < b->groups.count; i++)
            json_append_text(names, b->groups.names[i]);
    }
    return meta;
}

struct plan {
    const struct relight_options *options;
    struct basis *basis;
    struct job *job;
    uint32_t samples; // even
    struct tensor_sums_options sums;
    struct tensor_block block;
    struct tensor tensor;
};

static void make_plan(struct plan *p, uint32_t *pixels) {
    static const float some;
    const struct film_options *f = &p->job->film;
    const struct source_basis *s = &p->basis->source;
    p->sums = (struct tensor_sums_options){
        .area = {f->x0, f->y0, f->x1, f->y1}, .width = p->job->scene->film.width,
        .height = p->job->scene->film.height, .samples = p->samples, .basis = *s,
        .storage = p->options->storage};
    tensor_sums_pixels(&p->sums, pixels);
    p->block = (struct tensor_block){
        .object = "lighting", .term = p->basis->type, .axis_count = 1,
        .axes = {{p->basis->type, TENSOR_BOX, s->count, NULL}}, .groups = 1, .coefficients = s->count,
        .channels = 3, .pixels = pixels, .storage = p->options->storage, .halves = &some,
        .pixel_count = (uint64_t)(f->x1 - f->x0) * (uint64_t)(f->y1 - f->y0),
        .weights = p->basis->weights};
    p->tensor = (struct tensor){.width = (uint32_t)p->sums.width, .height = (uint32_t)p->sums.height,
                                .block_count = 1, .blocks = &p->block, .fixed = &some};
}

// ---- tracing ------------------------------------------------------------------------------------

static int threads_of(const struct plan *p) {
    return p->options->job.threads > 0 ? p->options->job.threads : thread_default_count();
}

struct tracing {
    const struct plan *plan;
    uint32_t tiles;
};

static void report_share(void *user, uint32_t tiles) {
    const struct tracing *t = user;
    const struct relight_options *o = t->plan->options;
    if (o->progress)
        o->progress(o->user, (double)tiles / t->tiles);
}

// Traces tiles [first, first + count) of the plan.
static bool trace(struct plan *p, struct tensor_sums *sums, uint32_t first, uint32_t count,
                  struct relight_report *report) {
    struct tracer_options o = p->job->render.tracer;
    o.spp = p->samples;
    o.replicates = HALVES;
    o.closed = report_share;
    o.closed_user = &(struct tracing){p, count};
    struct tracer *tracer = tracer_create(&o, tensor_sums_sink, sums);
    const bool whole = tracer_run(tracer, first, count, 0, p->samples) && !(o.stop && *o.stop);
    const struct tracer_counts n = tracer_count(tracer);
    report->paths = n.paths;
    report->rays = n.rays + n.shadow_rays;
    report->rejected = tensor_sums_rejected(sums);
    tracer_destroy(tracer);
    return whole;
}

static bool memory_suffices(const struct plan *p, struct relight_report *r) {
    const double most = p->options->most_memory > 0 ? p->options->most_memory : (double)mem_of_machine() / 2;
    r->sums_bytes = (uint64_t)threads_of(p) * tensor_sums_worker_bytes(&p->basis->source);
    if ((double)r->sums_bytes <= most)
        return true;
    log_error("the sums of %d tiles at once take %.3g GB, more than the %.3g GB of --memory; "
              "take fewer --threads or fewer coefficients", threads_of(p),
              (double)r->sums_bytes * 1e-9, most * 1e-9);
    return false;
}

static bool write_tensor(struct plan *p, struct relight_report *report) {
    struct tensor_writer *w = tensor_create(p->options->output, &p->tensor);
    if (!w)
        return false;
    const double start = time_seconds();
    p->sums.values = tensor_values(w, 0);
    p->sums.halves = tensor_halves(w, 0);
    p->sums.fixed = tensor_fixed(w);
    struct tensor_sums *sums = tensor_sums_create(&p->sums);
    const bool whole = trace(p, sums, 0, tensor_sums_tile_count(sums), report);
    tensor_sums_destroy(sums);
    report->seconds = time_seconds() - start;
    report->stopped = !whole;
    if (whole)
        return tensor_finish(w);
    tensor_abandon(w);
    log_error("stopped before the tensor was whole: %s is not written", p->options->output);
    return false;
}

// Traces a few tiles and throws them away, to tell how long all would take.
static void estimate(struct plan *p, struct relight_report *report) {
    struct tensor_sums *sums = tensor_sums_create(&p->sums); // has no memory to store in
    const uint32_t all = tensor_sums_tile_count(sums), n = all < DRY_TILES ? all : DRY_TILES;
    const double start = time_seconds();
    const uint32_t samples = p->samples;
    p->samples = samples < 16 ? samples : 16;
    trace(p, sums, (all - n) / 2, n, report);
    report->seconds = (time_seconds() - start) * all / n * samples / p->samples;
    tensor_sums_destroy(sums);
}

static bool run(const struct relight_options *o, struct basis *b, struct job *job,
                struct relight_report *report) {
    const struct film_options *f = &job->film;
    const size_t pixels = (size_t)(f->x1 - f->x0) * (size_t)(f->y1 - f->y0);
    uint32_t *list = mem_array(pixels, sizeof *list);
    struct plan p = {.options = o, .basis = b, .job = job,
                     .samples = (job->render.tracer.spp + 1) / 2 * 2};
    make_plan(&p, list);
    struct json *meta = describe(o, b, job, p.samples);
    p.tensor.meta = meta;
    report->coefficients = b->source.count;
    report->samples = p.samples;
    report->file_bytes = 2 * tensor_bytes(&p.block) + pixels * 4 +
                         (uint64_t)p.tensor.width * p.tensor.height * 12;
    bool done = memory_suffices(&p, report);
    if (done && o->dry_run)
        estimate(&p, report);
    else
        done = done && write_tensor(&p, report);
    json_destroy(meta);
    mem_free(list);
    return done;
}

bool precompute_relight(const struct relight_options *o, struct relight_report *report) {
    struct basis b = {.source = {.environment = UINT32_MAX}};
    struct job job;
    *report = (struct relight_report){0};
    bool done = open_jobs(o, &b, &job);
    if (done) {
        done = run(o, &b, &job, report);
        job_close(&job);
    }
    light_groups_finish(&b.groups);
    mem_free(b.weights);
    return done;
}
