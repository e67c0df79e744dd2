// SPDX-License-Identifier: Apache-2.0
#include "relight_frames.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "replay/follow.h"
#include "replay/picture.h"

static struct follow *begin(const struct relight_frames *f) {
    const struct json *basis = json_get(f->tensor->meta, "basis");
    const char *type = json_text(json_get(basis, "type"));
    if (type && strcmp(type, "lights") == 0) {
        log_error("%s: its coefficients are lights, which do not turn; --frames needs --basis pixels, "
                  "sh, haar or daub4", f->path);
        return NULL;
    }
    const bool wavelets = type && (strcmp(type, "haar") == 0 || strcmp(type, "daub4") == 0);
    int64_t columns = 0, rows = 0;
    json_read_integer(json_get(basis, "width"), &columns);
    json_read_integer(json_get(basis, "height"), &rows);
    const uint32_t all = f->tensor->blocks[0].coefficients;
    const struct follow_options o = {
        .terms = f->terms > 0 && f->terms < all ? f->terms : all, .rows = wavelets ? (uint32_t)rows : 0,
        .columns = wavelets ? (uint32_t)columns : 0, .no_device = f->no_device, .threads = f->threads};
    return follow_create(f->tensor, &o);
}

static void report(const struct relight_frames *f, int number, const char *path, double seconds,
                   bool exact) {
    if (!f->quiet)
        log_info("%s: %.2f ms%s", path, seconds * 1e3, exact ? "" : ", not exact yet");
    if (!f->json)
        return;
    struct json *j = json_new_object();
    json_add_text(j, "output", path);
    json_add_count(j, "frame", number);
    json_add_number(j, "frame_seconds", seconds);
    json_add_bool(j, "exact", exact);
    json_print(j, false);
    json_destroy(j);
}

// "OUT.0001.exr"
static bool name_frame(const struct relight_frames *f, int number, char *path, size_t size) {
    const char *point = strrchr(f->output, '.');
    const int stem = point && !strchr(point, '/') ? (int)(point - f->output) : (int)strlen(f->output);
    if (snprintf(path, size, "%.*s.%04d%s", stem, f->output, number, f->output + stem) < (int)size)
        return true;
    log_error("%s: name is too long", f->output);
    return false;
}

static bool make_frame(const struct relight_frames *f, struct follow *follow, int number,
                       const float *weights, float *frame) {
    char path[4096];
    bool exact;
    const double start = time_seconds();
    if (!name_frame(f, number, path, sizeof path) || !follow_frame(follow, weights, frame, &exact))
        return false;
    const double seconds = time_seconds() - start;
    if (!picture_write(path, f->tensor, frame, NULL, f->command, RELUME_VERSION))
        return false;
    report(f, number, path, seconds, exact);
    return true;
}

bool relight_frames_write(const struct relight_frames *f, const struct relight_lighting *first) {
    const size_t plane = (size_t)f->tensor->width * f->tensor->height;
    float *frame = mem_array(3 * plane, sizeof *frame);
    float *weights = mem_array(3 * (size_t)f->tensor->blocks[0].coefficients, sizeof *weights);
    struct relight_lighting l = *first;
    struct follow *follow = begin(f);
    bool good = follow != NULL;
    for (int i = 0; i < f->count && good; i++, l.rotate += f->turn)
        good = relight_weights(f->tensor, f->path, &l, weights) &&
               make_frame(f, follow, i + 1, weights, frame);
    follow_destroy(follow);
    mem_free(weights);
    mem_free(frame);
    return good;
}
