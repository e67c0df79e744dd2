// SPDX-License-Identifier: Apache-2.0
// Editing sessions as files: what is changed, frame by frame.
//
//     {"focus": true, "terms": 30,
//      "steps": [{"set": "teapot.exponent=40"},
//                {"op": ["teapot.specular.f_A:amplify-y,0,5,10,20,1.5", ...], "frames": 5},
//                {"curve": "teapot.specular.f_A=lobe.csv", "write": true},
//                {"reset": "teapot"}]}
//
// A step makes its changes (a text or a list of texts as replay/edit_change.h has them; reset, then
// set, curve, op and light) and then `frames` pictures (1), of which the last is a file where "write" is
// true. "focus" (true) freezes what is not edited, "terms" (0: all) is how many coefficients a frame
// may change; a step with "settle": true goes on until its picture is exact.
#pragma once

#include "replay/edit.h"

struct edit_step {
    struct {
        enum edit_kind kind;
        const char *text;
    } *changes;
    size_t change_count;
    uint32_t frames;
    bool write, settle;
};

struct edit_script {
    bool focus;
    uint32_t terms;
    struct edit_step *steps;
    size_t step_count;
    struct json *text; // owns the texts
    struct arena arena;
};

// false after an error message that names the file and the step.
bool edit_script_read(struct edit_script *s, const char *path);
bool edit_script_parse(struct edit_script *s, const char *text, size_t size, const char *path);
void edit_script_finish(struct edit_script *s);

// What a frame cost.
struct edit_timing {
    size_t step;
    uint32_t frame;          // within the step
    double change_seconds, switch_seconds, frame_seconds; // the first two in a step's first frame
    uint64_t coefficients, bytes;
    bool exact;
};

// Called after each frame; false ends the session.
typedef bool (*edit_frame_fn)(void *user, const struct edit_step *step, const struct edit_timing *t,
                              const float *frame);

// Plays the script. false after an error message.
bool edit_script_play(const struct edit_script *s, struct edit *e, const char *path, float *frame,
                      edit_frame_fn fn, void *user);
// Makes all of the script's changes and no picture.
bool edit_script_apply(const struct edit_script *s, struct edit_tensor *e, const char *path);
