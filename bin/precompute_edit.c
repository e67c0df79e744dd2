// SPDX-License-Identifier: Apache-2.0
// relume precompute edit
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/progress.h"
#include "driver/precompute_edit.h"
#include "precompute.h"
#include "subcommand.h"

const char *const precompute_packets[] = {"auto", "pixels", "lights", NULL};

static void show_progress(void *user, double done) {
    if (progress_is_due(user))
        progress_update(user, done, "");
}

static void print_json(const struct precompute_values *v, const struct edit_report *r) {
    struct json *j = json_new_object();
    json_add_text(j, "output", v->output);
    json_add_bool(j, "dry_run", v->dry_run);
    json_add_count(j, "objects", r->objects);
    json_add_count(j, "blocks", r->blocks);
    json_add_count(j, "pixels", (int64_t)r->pixels);
    json_add_count(j, "coefficients", (int64_t)r->coefficients);
    json_add_count(j, "lights", r->lights);
    json_add_count(j, "positions", r->positions);
    json_add_text(j, "packets", r->packets);
    json_add_count(j, "rays", (int64_t)r->rays);
    json_add_count(j, "file_bytes", (int64_t)r->file_bytes);
    json_add_count(j, "sums_bytes", (int64_t)r->sums_bytes);
    json_add_number(j, "shadow_processor_seconds", r->shadow_seconds);
    json_add_number(j, "overlap_processor_seconds", r->sum_seconds);
    json_add_number(j, "fixed_seconds", r->fixed_seconds);
    json_add_number(j, "seconds", r->seconds);
    json_print(j, false);
    json_destroy(j);
}

static void report(const struct precompute_values *v, const struct edit_report *r) {
    char time[32];
    progress_format_seconds(r->seconds, time, sizeof time);
    if (!v->quiet)
        log_info("%s: %u objects in %llu pixels, %u lights, %.1f MB %s %s (%s a packet; %.1f s of "
                 "processor time for %.1f million shadow rays, %.1f s for adding up)", v->output,
                 r->objects, (unsigned long long)r->pixels, r->lights, (double)r->file_bytes * 1e-6,
                 v->dry_run ? "would take" : "took", time, r->packets, r->shadow_seconds,
                 (double)r->rays * 1e-6, r->sum_seconds);
    if (v->json)
        print_json(v, r);
}

// "A:B" of --samples, or NULL: all of --lights.
static bool parse_range(const struct precompute_values *v, uint32_t *first, uint32_t *end) {
    char rest;
    *first = 0;
    *end = (uint32_t)v->lights;
    if (!v->samples || (sscanf(v->samples, "%" SCNu32 ":%" SCNu32 "%c", first, end, &rest) == 2 &&
                      *end > *first && *end >= 8 && *end <= 1000000 && (*first == 0 || *first >= 8) &&
                      !strchr(v->samples, '-')))
        return true;
    log_error("--samples %s: expected A:B, the first triangle and the one after the last; 8 are the "
              "fewest", v->samples);
    return false;
}

int precompute_edit_run(const struct precompute_values *v, const char *command,
                        const struct scene_define *defines) {
    struct progress progress;
    struct edit_report result;
    uint32_t first, end;
    if (!v->direct)
        return precompute_polynomial_run(v, command, defines);
    if (!parse_range(v, &first, &end))
        return EXIT_USAGE;
    progress_begin(&progress, "precompute", v->quiet);
    const struct edit_options o = {
        .job = precompute_job(v, defines), .edit = v->edit.items, .edit_count = v->edit.count,
        .lights = end, .first = first, .resume = v->resume, .light_samples = (uint32_t)v->light_samples,
        .unshadowed = v->unshadowed, .packets = precompute_packets[v->packets], .output = v->output,
        .storage = v->half ? TENSOR_BF16 : TENSOR_F32, .most_memory = v->memory * 1e9,
        .dry_run = v->dry_run, .command = command, .version = RELUME_VERSION,
        .progress = v->quiet || v->dry_run ? NULL : show_progress, .user = &progress};
    const bool done = precompute_edit(&o, &result);
    progress_end(&progress);
    if (done)
        report(v, &result);
    return done ? EXIT_DONE : EXIT_FAILED;
}
