// SPDX-License-Identifier: Apache-2.0
// Damaged editing sessions, played on a small tensor: by the twins of the kernels; with
// RELUME_TEST_DEVICE=1 by OpenCL kernels.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "edit_sample.h"
#include "fuzz.h"
#include "replay/edit_script.h"

enum { MOST_FRAMES = 60 };

static bool on_frame(void *user, const struct edit_step *step, const struct edit_timing *t,
                     const float *frame) {
    (void)step;
    (void)t;
    for (int i = 0; i < 3 * SAMPLE_WIDTH * SAMPLE_HEIGHT; i++)
        if (isnan(frame[i])) {
            fprintf(stderr, "a picture holds what is not a number\n");
            abort();
        }
    return ++*(int *)user < MOST_FRAMES;
}

static bool read_edits(const char *path) {
    static float frame[3 * SAMPLE_WIDTH * SAMPLE_HEIGHT];
    struct arena arena = {0};
    struct edit_script s;
    int frames = 0;
    const char *device = getenv("RELUME_TEST_DEVICE");
    if (!edit_script_read(&s, path))
        return false;
    const struct sample_options o = {.bins = 8};
    const struct tensor t = sample_make(&o, &arena);
    struct edit *e = edit_create(&t, "sample", &(struct edit_settings){
        .no_device = !device || !*device, .threads = 1, .focus = s.focus, .terms = s.terms});
    const bool played = e && edit_script_play(&s, e, path, frame, on_frame, &frames);
    edit_destroy(e);
    edit_script_finish(&s);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
    return played || frames == MOST_FRAMES; // long enough
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-edits", read_edits);
}
