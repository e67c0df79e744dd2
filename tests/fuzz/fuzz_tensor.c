// SPDX-License-Identifier: Apache-2.0
// Damaged tensors: opened, listed, edited and replayed, or refused: by the twins of the kernels; with
// RELUME_TEST_DEVICE=1 by OpenCL kernels too, whose pictures are then those of the twins.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "fuzz.h"
#include "replay/edit.h"
#include "replay/edit_list.h"
#include "replay/relight.h"
#include "replay/replay.h"

// Pictures of sound values are finite, unless an edit was refused as too large.
static void look_at(const char *path, const struct tensor *t, const float *frame, bool sound) {
    for (size_t i = 0; i < 3 * (size_t)t->width * t->height && sound; i++)
        if (!isfinite(frame[i]) && fabs((double)frame[i]) < 1e30) {
            fprintf(stderr, "%s: was read, but pixel %zu is not a number\n", path, i);
            abort();
        }
}

// The first object's first term, changed in every way.
static bool use_session(const char *path, const struct tensor *t, bool no_device, bool focus,
                        float *frame, float *variance) {
    struct edit *e = edit_create(t, path, &(struct edit_settings){
        .no_device = no_device, .threads = 1, .focus = focus, .terms = focus ? 3 : 0});
    char text[400];
    if (!e)
        return false;
    bool good = edit_frame(e, frame);
    const struct edit_tensor *o = edit_objects(e);
    if (good && o->object_count > 0) {
        snprintf(text, sizeof text, "%.100s.exponent=5", o->objects[0].name);
        edit_change(e, EDIT_SET, text, path);
        good = edit_frame(e, frame);
        snprintf(text, sizeof text, "%.100s.%.100s.f_A:amplify-y,0,0,40,60,2", o->objects[0].name,
                 o->objects[0].form.term[0].name);
        edit_change(e, EDIT_OPERATE, text, path);
        good = good && edit_frame(e, frame);
        edit_change(e, EDIT_RESET, o->objects[0].name, path);
        good = good && edit_frame(e, frame);
    }
    if (good) {
        struct json *list = json_new_object();
        edit_list(o, list);
        json_destroy(list);
        edit_variance(e, variance);
    }
    edit_destroy(e);
    return good;
}

static bool use_relight(const char *path, const struct tensor *t, bool no_device, float *frame,
                        float *variance) {
    const size_t n = t->block_count ? t->blocks[0].coefficients : 0;
    float *weights = mem_array(3 * n, sizeof *weights);
    const float *const all = weights;
    bool good = relight_weights(t, path, &(struct relight_lighting){.terms = 3}, weights);
    struct replay *r = good ? replay_create(t, &(struct replay_options){.no_device = no_device}) : NULL;
    good = r && replay_product(r, 0, weights) && replay_frame(r, NULL, frame);
    if (good)
        replay_variance(r, &all, NULL, variance);
    replay_destroy(r);
    mem_free(weights);
    return good;
}

static bool use(const char *path, const struct tensor *t, bool no_device, float *frame,
                float *variance) {
    const char *kind = json_text(json_get(t->meta, "kind"));
    if (kind && strcmp(kind, "relight") == 0)
        return use_relight(path, t, no_device, frame, variance);
    return use_session(path, t, no_device, false, frame, variance) &&
           use_session(path, t, no_device, true, frame, variance);
}

// Whether the device gives the picture of the twins, bit for bit where it is finite.
static void compare(const char *path, const struct tensor *t, const float *twins, float *variance) {
    const size_t n = 3 * (size_t)t->width * t->height;
    float *frame = mem_array(n, sizeof *frame);
    if (!use(path, t, false, frame, variance)) {
        fprintf(stderr, "%s: the twins made a picture, the device did not\n", path);
        abort();
    }
    for (size_t i = 0; i < n; i++)
        if (isfinite(twins[i]) ? !(fabsf(frame[i] - twins[i]) <= 0) : isfinite(frame[i])) {
            fprintf(stderr, "%s: value %zu is %g by the device, %g by the twins\n", path, i,
                    (double)frame[i], (double)twins[i]);
            abort();
        }
    mem_free(frame);
}

static bool read_tensor(const char *path) {
    const char *device = getenv("RELUME_TEST_DEVICE");
    struct tensor_file *f = tensor_open(path);
    if (!f)
        return false;
    const struct tensor *t = tensor_get(f);
    const size_t plane = (size_t)t->width * t->height;
    if (plane > 1 << 22) { // allowed, but not in a small memory
        tensor_close(f);
        return true;
    }
    const bool sound = tensor_check_values(f);
    float *frame = mem_array(3 * plane, sizeof *frame), *variance = mem_array(plane, sizeof *frame);
    const bool good = use(path, t, true, frame, variance);
    if (good)
        look_at(path, t, frame, sound);
    if (good && device && *device)
        compare(path, t, frame, variance);
    mem_free(frame);
    mem_free(variance);
    tensor_close(f);
    return good;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-tensor", read_tensor);
}
