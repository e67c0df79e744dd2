// SPDX-License-Identifier: Apache-2.0
#include "driver/study.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/file.h"
#include "base/resident.h"
#include "base/thread.h"

enum { LEAST_REFERENCE_SPP = 1024, REFERENCE_FACTOR = 16, DEFAULT_SPP = 64 };

// A study in progress. Work is counted in samples a pixel, or what would take as long.
struct progress_state {
    const struct study_options *options;
    double done, current, all;
    char note[96];
};

static void tell(void *user, double share, const struct film *film) {
    const struct progress_state *p = user;
    (void)film;
    if (p->options->progress)
        p->options->progress(p->options->user, (p->done + share * p->current) / p->all, p->note);
}

static bool is_stopped(const struct study_options *o) {
    return o->job.stop && *o->job.stop;
}

static void path_in(const struct study_options *o, const char *name, char *path, size_t size) {
    snprintf(path, size, "%s/%s", o->directory, name);
}

static double processor_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// ---- reference --------------------------------------------------------------------------------

static bool read_reference(const struct study_options *o, const struct job *job,
                           struct study_reference *ref) {
    struct image im;
    if (!image_read(o->reference, &im))
        return false;
    bool good = study_reference_take(ref, &im, o->reference);
    image_finish(&im);
    const int width = job->film.x1 - job->film.x0, height = job->film.y1 - job->film.y0;
    if (good && (ref->rgb.width != width || ref->rgb.height != height)) {
        log_error("%s: is %d x %d pixels, but the scene renders to %d x %d (see --size)", o->reference,
                  ref->rgb.width, ref->rgb.height, width, height);
        good = false;
    }
    if (good && !ref->variance.pixels)
        log_warn("%s: has no layer `variance` (render --variance): its own noise counts as bias",
                 o->reference);
    return good;
}

static bool render_reference(const struct study_options *o, struct progress_state *p,
                             struct study_reference *ref) {
    struct job_options options = o->job;
    struct render_result result;
    struct image im = {0};
    struct job job;
    char path[4096];
    options.spp = (int)p->current;
    options.variance = true;
    options.progress = tell;
    options.user = p;
    if (!job_open(&job, &options))
        return false;
    struct film *film = job_render(&job, &result);
    path_in(o, "reference.exr", path, sizeof path);
    bool good = !result.stopped;
    if (!good)
        log_error("stopped before the reference was done: there is nothing to compare with");
    good = good && job_image(&job, film, &result, &im);
    if (good) {
        image_set_text(&im, "relume.command", o->command);
        good = image_write_exr(path, &im, NULL) && study_reference_take(ref, &im, path);
    }
    image_finish(&im);
    film_destroy(film);
    job_close(&job);
    return good;
}

// ---- runs -------------------------------------------------------------------------------------

// Seeds differ between all runs of a study and from those that people give by hand: errors of
// different points are independent of each other, and of the reference.
static uint32_t seed_of(const struct study_options *o, size_t point, int run) {
    const uint32_t index = (uint32_t)(point * 4096 + (size_t)run) + 1;
    return hash_combine(hash_u32(o->job.seed), index) & 0x7fffffffu;
}

static bool run_once(const struct study_options *o, struct job *job, struct study_run *run,
                     struct image *rgb) {
    struct render_result result;
    struct image im = {0};
    job->render.tracer.seed = job->film.seed = run->seed;
    const double start = processor_seconds();
    struct film *film = job_render(job, &result);
    run->cpu_seconds = processor_seconds() - start;
    run->seconds = result.seconds;
    run->samples = result.samples;
    const bool good = !(result.stopped && is_stopped(o)) && job_image(job, film, &result, &im) &&
                      image_to_rgb(&im, rgb);
    image_finish(&im);
    film_destroy(film);
    return good;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// The median, since other work on the machine lengthens single runs.
static void finish_times(struct study_point *p) {
    const int n = p->run_count;
    double *seconds = mem_array((size_t)n, sizeof *seconds);
    for (int i = 0; i < n; i++) {
        seconds[i] = p->runs[i].seconds;
        p->cpu_seconds += p->runs[i].cpu_seconds / n;
        p->samples += (double)p->runs[i].samples / n;
    }
    qsort(seconds, (size_t)n, sizeof *seconds, by_size);
    p->seconds = 0.5 * (seconds[(n - 1) / 2] + seconds[n / 2]);
    p->fastest = seconds[0];
    p->slowest = seconds[n - 1];
    mem_free(seconds);
}

static bool measure(struct study *study, struct study_point *p, const struct image *pictures) {
    const struct study_options *o = study->options;
    char temp[4096];
    double *relmse = mem_array((size_t)p->run_count, sizeof *relmse);
    finish_times(p);
    p->error = study_errors(&study->reference, pictures, p->run_count, relmse);
    for (int i = 0; i < p->run_count; i++)
        p->runs[i].relmse = relmse[i];
    mem_free(relmse);
    path_in(o, "study.png.tmp", temp, sizeof temp);
    p->thumbnail = study_thumbnail(&study->reference, &pictures[0], temp);
    p->difference = study_difference(&study->reference, &pictures[0], temp);
    return p->thumbnail && p->difference;
}

// What the method keeps, where it says so; else the most that was in use.
static double bytes_of(const struct job *job, size_t before) {
    const struct object *method = job->scene->integrator;
    if (integrator_type_of(method)->bytes)
        return (double)integrator_type_of(method)->bytes(method->data);
    return resident_peak() > before ? (double)(resident_peak() - before) : 0;
}

// All runs of one setting. false after an error message.
static bool run_point(struct study *study, const struct study_combination *c, size_t index,
                      int repeat, struct progress_state *progress) {
    const struct study_options *o = study->options;
    struct study_point *p = &study->points[study->point_count];
    const struct study_setting setting = {o->factors, c};
    struct job_options options = o->job;
    struct job job;
    *p = (struct study_point){.runs = arena_alloc(&study->arena, (size_t)repeat * sizeof *p->runs)};
    memcpy(p->values, c->values, sizeof p->values);
    study_apply(&setting, &options);
    options.progress = tell;
    options.user = progress;
    const size_t before = resident_begin();
    if (!job_open(&job, &options))
        return false;
    p->load_seconds = job.load_seconds;
    struct image *pictures = mem_array((size_t)repeat, sizeof *pictures);
    bool good = true;
    for (int i = 0; good && !is_stopped(o) && i < repeat; i++) {
        p->runs[i].seed = seed_of(o, index, i);
        if (!(good = run_once(o, &job, &p->runs[i], &pictures[i])))
            break;
        p->run_count++;
        progress->done += progress->current;
        if (i == 0)
            p->bytes = bytes_of(&job, before);
    }
    job_close(&job);
    good = good || is_stopped(o);
    if (p->run_count >= 2)
        good = measure(study, p, pictures) && good;
    study->point_count += p->run_count >= 2;
    study->stopped |= p->run_count < repeat;
    for (int i = 0; i < repeat; i++)
        image_finish(&pictures[i]);
    mem_free(pictures);
    return good;
}

// ---- the whole --------------------------------------------------------------------------------

static double work_of(const struct study_options *o, const struct study_combination *c,
                      const struct scene *s) {
    struct job_options options = {.spp = o->job.spp};
    const struct study_setting setting = {o->factors, c};
    study_apply(&setting, &options);
    return options.spp ? options.spp : s->sample_count ? s->sample_count : DEFAULT_SPP;
}

static int runs_of(const struct study_options *o, double work, double most) {
    const double runs = o->even ? o->repeat * most / work : o->repeat;
    return runs < STUDY_MOST_RUNS ? (int)runs : STUDY_MOST_RUNS;
}

static bool run_all(struct study *study, const struct study_combination *all, size_t count,
                    const struct job *base, struct progress_state *progress) {
    const struct study_options *o = study->options;
    double most = 0;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, work_of(o, &all[i], base->scene));
    for (size_t i = 0; i < count; i++) {
        const double work = work_of(o, &all[i], base->scene);
        progress->all += runs_of(o, work, most) * work;
    }
    const double wished = o->reference_spp ? o->reference_spp
                                           : fmax(REFERENCE_FACTOR * most, LEAST_REFERENCE_SPP);
    progress->current = o->reference ? 0 : wished;
    progress->all += progress->current;
    snprintf(progress->note, sizeof progress->note, "reference");
    if (!(o->reference ? read_reference(o, base, &study->reference)
                       : render_reference(o, progress, &study->reference)))
        return false;
    progress->done = progress->current;
    study->points = arena_alloc(&study->arena, count * sizeof *study->points);
    const enum log_level level = log_get_level();
    log_set_level(level > LOG_WARN ? LOG_WARN : level); // what reading says was said once
    bool good = true;
    for (size_t i = 0; good && i < count && !is_stopped(o); i++) {
        progress->current = work_of(o, &all[i], base->scene);
        snprintf(progress->note, sizeof progress->note, "setting %zu of %zu", i + 1, count);
        good = run_point(study, &all[i], i, runs_of(o, progress->current, most), progress);
    }
    log_set_level(level);
    study->stopped |= is_stopped(o);
    return good;
}

static bool make_directory(const char *path) {
    struct stat st;
    char inside[4096], temp[4096];
    if (mkdir(path, 0777) == 0 || (errno == EEXIST && stat(path, &st) == 0 && S_ISDIR(st.st_mode))) {
        snprintf(inside, sizeof inside, "%s/study.html", path);
        return file_temp_name(inside, temp, sizeof temp); // known now, not after an hour
    }
    log_error("%s: cannot be made: %s", path, strerror(errno));
    return false;
}

static char *thumbnail_of_reference(const struct study *study) {
    char temp[4096];
    path_in(study->options, "study.png.tmp", temp, sizeof temp);
    return study_thumbnail(&study->reference, &study->reference.rgb, temp);
}

bool study_run(const struct study_options *options, struct study *study) {
    struct progress_state progress = {.options = options};
    struct job base;
    size_t count;
    *study = (struct study){.options = options};
    if (!make_directory(options->directory) || !job_open(&base, &options->job))
        return false;
    const struct study_combination *all =
        study_combine(options->factors, base.scene, &study->arena, &count);
    const bool good = all && run_all(study, all, count, &base, &progress) &&
                      (study->reference_thumbnail = thumbnail_of_reference(study));
    job_close(&base);
    if (good) {
        study_analyse(study);
    } else {
        study_finish(study);
        study->misused = !all;
    }
    return good;
}

void study_finish(struct study *study) {
    study_reference_finish(&study->reference);
    mem_free(study->reference_thumbnail);
    for (size_t i = 0; i < study->point_count; i++) {
        mem_free(study->points[i].thumbnail);
        mem_free(study->points[i].difference);
    }
    arena_finish(&study->arena);
    *study = (struct study){0};
}
