// SPDX-License-Identifier: Apache-2.0
// Keeping what a render has done: a journal beside the picture, and a picture to look at meanwhile.
#pragma once

#include "driver/film_head.h"
#include "image/primaries.h"
#include "sink/journal.h"

struct checkpoint_options {
    const char *output;       // the picture; its journal is OUTPUT.journal
    const char *command, *version;
    bool keep;                // write the journal at all
    double seconds;           // between updates of the journal; 0: only at the end
    double preview_seconds;   // between updates of the picture; 0: only at the end
    bool resume;              // go on from the journal, if it is there
    const struct image_exr_options *exr;
    enum image_space space;
};

struct checkpoint {
    struct checkpoint_options options;
    const struct job *job;
    struct json *head;
    bool keeping;            // a journal is asked for, and could be written so far
    struct journal *journal; // NULL: not begun
    char path[4096];
    double start, next_journal, next_preview; // monotonic seconds
    double journal_interval, preview_interval;
    double spent; // seconds that rendering waited for all this between passes
};

// Restores the film from the journal when resuming; a new one takes its place at the first update.
// false after an error message. What is on the disk is untouched.
bool checkpoint_open(struct checkpoint *c, const struct checkpoint_options *options,
                     const struct job *job, struct film *film);
// Called between passes: does what is due. Intervals widen so that all of it takes at most 3 %.
void checkpoint_tick(struct checkpoint *c, const struct film *film);
// Brings the journal up to date. false after an error message.
bool checkpoint_finish(struct checkpoint *c, const struct film *film);
void checkpoint_close(struct checkpoint *c);

// Writes the picture so far with everything there is to say about it. false after an error message.
bool checkpoint_picture(const struct checkpoint *c, const struct film *film,
                        const struct render_result *result);
