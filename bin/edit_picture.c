// SPDX-License-Identifier: Apache-2.0
#include "edit_picture.h"

#include "base/thread.h"
#include "replay/measure.h"
#include "replay/picture.h"

struct evaluation {
    struct edit *edit;
    float *frame;
};

static bool product(void *ctx) {
    struct evaluation *e = ctx;
    edit_forget(e->edit);
    return edit_follow(e->edit);
}

static bool compose(void *ctx) {
    struct evaluation *e = ctx;
    return edit_compose(e->edit, e->frame);
}

bool edit_picture(const struct replay_values *c, const struct edit_session *s, struct edit *edit,
                  float *frame, struct replay_timing *t, float *variance) {
    struct evaluation e = {edit, frame};
    const double start = time_seconds();
    if (!edit_settle(edit, frame))
        return false;
    t->first = time_seconds() - start;
    t->device = edit_device(edit);
    replay_count(s->tensor, t);
    if (c->time && !replay_measure(&(struct replay_measured){product, compose, &e}, t))
        return false;
    t->bytes = edit_last_cost(edit).bytes;
    edit_variance(edit, variance);
    t->noise = measure_noise(s->tensor, frame, variance);
    return picture_write(c->output, s->tensor, frame, c->variance ? variance : NULL, s->command,
                         RELUME_VERSION);
}
