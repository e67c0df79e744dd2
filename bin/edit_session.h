// SPDX-License-Identifier: Apache-2.0
// What `relume edit` tells of the frames of an editing session, and which of them it writes.
#pragma once

#include "replay/edit_script.h"

struct edit_session {
    const char *script, *output; // files; output: NULL: none is written
    const char *command;
    const struct tensor *tensor;
    bool quiet, json;            // as asked for: a line a frame, or objects, which gather in `frames`
    struct json *frames;
};

// For edit_script_play, with the session as its user.
bool edit_session_frame(void *session, const struct edit_step *step, const struct edit_timing *t,
                        const float *frame);

// As `relume edit --help` explains sessions.
void edit_session_help(void);
