// SPDX-License-Identifier: Apache-2.0
// relume precompute edit with all bounces.
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/progress.h"
#include "driver/precompute_polynomial.h"
#include "driver/ranks.h"
#include "precompute.h"
#include "subcommand.h"

static void show_progress(void *user, double done) {
    if (progress_is_due(user))
        progress_update(user, done, "");
}

// "64,16,1" for that many bounces; what is not given is 1.
static bool parse_series(const char *text, uint32_t bounces, uint32_t series[EDIT_MOST_BOUNCES]) {
    const char *at = text;
    uint32_t n = 0;
    for (uint32_t i = 0; i < EDIT_MOST_BOUNCES; i++)
        series[i] = 1;
    while (n < bounces) {
        char *end;
        const long value = strtol(at, &end, 10);
        if (end == at || value < 1 || value > 4096 || (*end != ',' && *end))
            break;
        series[n++] = (uint32_t)value;
        if (!*end)
            return true;
        at = end + 1;
    }
    log_error("--series %s: expected at most %u numbers from 1 to 4096, one for each of the --bounces",
              text, bounces);
    return false;
}

static bool parse_tail(const char *text, enum polynomial_tail *tail) {
    for (int i = 0; polynomial_tails[i]; i++)
        if (strcmp(text, polynomial_tails[i]) == 0) {
            *tail = (enum polynomial_tail)i;
            return true;
        }
    log_error("--tail %s: expected none, frozen or geometric", text);
    return false;
}

static bool parse_later(const char *text, enum polynomial_later *later) {
    for (int i = 0; polynomial_laters[i]; i++)
        if (strcmp(text, polynomial_laters[i]) == 0) {
            *later = (enum polynomial_later)i;
            return true;
        }
    log_error("--later %s: expected lambertian, kept or terms", text);
    return false;
}

static void report(const struct precompute_values *v, const struct polynomial_report *r) {
    char time[32];
    progress_format_seconds(r->seconds, time, sizeof time);
    if (r->rejected)
        log_warn("%llu samples were not finite and count as black", (unsigned long long)r->rejected);
    if (!v->quiet)
        log_info("%s: %u objects, %u products of later hops, %u coefficients, %.1f MB, %llu samples "
                 "per pixel %s %s (%.1f MB of sums)", v->output, r->objects, r->groups,
                 r->coefficients, (double)r->file_bytes * 1e-6, (unsigned long long)r->samples,
                 v->dry_run ? "would take" : "took", time, (double)r->sums_bytes * 1e-6);
    if (!v->quiet && r->noise >= 0)
        log_info("noise of the picture as it is: %.3g %%", 100 * r->noise);
    if (v->json) {
        struct json *j = json_new_object();
        json_add_text(j, "output", v->output);
        json_add_bool(j, "dry_run", v->dry_run);
        json_add_count(j, "objects", r->objects);
        json_add_count(j, "groups", r->groups);
        json_add_count(j, "coefficients", r->coefficients);
        json_add_count(j, "file_bytes", (int64_t)r->file_bytes);
        json_add_count(j, "sums_bytes", (int64_t)r->sums_bytes);
        json_add_count(j, "samples", (int64_t)r->samples);
        json_add_count(j, "paths", (int64_t)r->paths);
        json_add_count(j, "rays", (int64_t)r->rays);
        json_add_count(j, "rejected_samples", (int64_t)r->rejected);
        json_add_number(j, "seconds", r->seconds);
        if (r->noise >= 0)
            json_add_number(j, "noise", r->noise);
        json_print(j, false);
        json_destroy(j);
    }
}

int precompute_polynomial_run(const struct precompute_values *v, const char *command,
                              const struct scene_define *defines) {
    struct progress progress;
    struct polynomial_report result;
    const bool progressive = precompute_is_progressive(v);
    struct polynomial_options o = {
        .job = precompute_job(v, defines), .edit = v->edit.items, .edit_count = v->edit.count,
        .group = v->group.items, .group_count = v->group.count,
        .bounces = (uint32_t)v->bounces, .output = v->output,
        .storage = v->half ? TENSOR_BF16 : TENSOR_F32, .most_memory = v->memory * 1e9,
        .keep = progressive, .resume = v->resume, .checkpoint = v->checkpoint,
        .dry_run = v->dry_run, .command = command, .version = RELUME_VERSION,
        .progress = v->quiet || v->dry_run ? NULL : show_progress, .user = &progress};
    o.job.seconds = v->seconds;
    o.job.noise = v->noise;
    if (!samples_parse(v->samples, o.job.samples) || !parse_series(v->series, o.bounces, o.series) ||
        !parse_tail(v->tail, &o.tail) || !parse_later(v->later, &o.later))
        return EXIT_USAGE;
    if (ranks_index() > 0)
        o.progress = NULL;
    progress_begin(&progress, "precompute", !o.progress);
    const bool done = precompute_polynomial(&o, &result);
    progress_end(&progress);
    if (ranks_index() > 0) // rank 0 reports
        return done ? EXIT_DONE : EXIT_FAILED;
    const bool valid = done || (result.stopped && result.samples > 0);
    if (valid)
        report(v, &result);
    return done ? EXIT_DONE : valid ? EXIT_UNCONVERGED : EXIT_FAILED;
}
