// SPDX-License-Identifier: Apache-2.0
#include "render_report.h"

#include <inttypes.h>

#include "base/json.h"
#include "base/log.h"
#include "base/mem.h"

void render_report_warnings(const struct render_outcome *o) {
    const struct render_result *t = &o->render;
    if (o->rejected)
        log_warn("%" PRIu64 " samples were not finite and count as black", o->rejected);
    if (t->truncated)
        log_warn("%" PRIu64 " of %" PRIu64 " paths met the cap of %d events and were cut: the "
                 "picture is too dark by what they would have brought", t->truncated, t->paths,
                 INTEGRATOR_MOST_EVENTS);
    if (o->clamped >= 0)
        log_warn("--clamp %g removed %.3g %% of the picture's light (layer clamped)", o->clamp,
                 100 * o->clamped);
    if (o->one_sample)
        log_warn("the layer variance of one sample per pixel is 0 and tells nothing");
    image_warn_overflows(o->overflows, o->half_overflows);
}

void render_report(const struct render_outcome *o) {
    const struct render_result *t = &o->render;
    log_info("%s: %" PRIu64 " samples per pixel in %.2f s, %.2f Mpaths/s, %.2f Mrays/s", o->output,
             t->samples, t->seconds, (double)t->paths / t->seconds * 1e-6,
             (double)(t->rays + t->shadow_rays) / t->seconds * 1e-6);
}

void render_report_json(const struct job *job, const struct render_outcome *o) {
    const struct render_result *t = &o->render;
    struct json *j = json_new_object();
    json_add_text(j, "output", o->output);
    json_add_count(j, "samples", (int64_t)t->samples);
    json_add_bool(j, "stopped", t->stopped);
    json_add_number(j, "seconds", t->seconds);
    json_add_number(j, "keeping_seconds", o->keeping);
    json_add_number(j, "load_seconds", job->load_seconds);
    json_add_number(j, "accel_seconds", job->world->accel_seconds);
    json_add_count(j, "accel_bytes", (int64_t)accel_bytes(job->world->accel));
    json_add_count(j, "peak_bytes", (int64_t)mem_peak());
    json_add_count(j, "triangles", (int64_t)job->triangles);
    json_add_count(j, "paths", (int64_t)t->paths);
    json_add_count(j, "rays", (int64_t)t->rays);
    json_add_count(j, "shadow_rays", (int64_t)t->shadow_rays);
    json_add_count(j, "truncated_paths", (int64_t)t->truncated);
    json_add_count(j, "rejected_samples", (int64_t)o->rejected);
    json_add_count(j, "overflows", (int64_t)o->overflows);
    json_add_count(j, "half_overflows", (int64_t)o->half_overflows);
    if (t->noise >= 0)
        json_add_number(j, "noise", t->noise);
    if (o->clamped >= 0)
        json_add_number(j, "clamped_share", o->clamped);
    json_print(j, false);
    json_destroy(j);
}
