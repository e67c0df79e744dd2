// SPDX-License-Identifier: Apache-2.0
#include "relight_frames.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "replay/follow.h"
#include "replay/picture.h"

static struct follow *begin(const struct relight_frames *f) {
    const struct json *basis = json_get(f->tensor->meta, "basis");
    const char *type = json_text(json_get(basis, "type"));
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

static bool write_frame(const struct relight_frames *f, int number, const float *frame) {
    char path[4096];
    const char *point = strrchr(f->output, '.');
    const int stem = point && !strchr(point, '/') ? (int)(point - f->output) : (int)strlen(f->output);
    if (snprintf(path, sizeof path, "%.*s.%04d%s", stem, f->output, number, f->output + stem) >=
        (int)sizeof path) {
        log_error("%s: name is too long", f->output);
        return false;
    }
    return picture_write(path, f->tensor, frame, NULL, f->command, RELUME_VERSION);
}

bool relight_frames_write(const struct relight_frames *f, const struct relight_lighting *first) {
    const size_t plane = (size_t)f->tensor->width * f->tensor->height;
    float *frame = mem_array(3 * plane, sizeof *frame);
    float *weights = mem_array(3 * (size_t)f->tensor->blocks[0].coefficients, sizeof *weights);
    struct relight_lighting l = *first;
    struct follow *follow = begin(f);
    bool good = follow != NULL, exact;
    for (int i = 0; i < f->count && good; i++, l.rotate += f->turn)
        good = relight_weights(f->tensor, f->path, &l, weights) &&
               follow_frame(follow, weights, frame, &exact) && write_frame(f, i + 1, frame);
    follow_destroy(follow);
    mem_free(weights);
    mem_free(frame);
    return good;
}
