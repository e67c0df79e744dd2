// SPDX-License-Identifier: Apache-2.0
// Units of any work, handed out by rank 0, and the numbers that come back.
#include <unistd.h>

#include "base/mem.h"
#include "driver/rank_messages.h"
#include "driver/ranks.h"

enum { TAG_UNIT = RANK_TAG_FREE, TAG_HEAD, TAG_COUNT, TAG_VALUES };
enum { UNITS_AHEAD = 2 }; // a rank holds, so that it need not wait for the next one
enum { NAP = 200 };       // microseconds between looks for messages

#define NONE UINT32_MAX

// What comes before the parts of a unit.
struct head {
    uint32_t unit, parts;
    uint32_t done; // else it was given up
};

bool ranks_work_alone(const struct ranks_work *w) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < w->units; i++) {
        if (!w->work(w->user, i, NULL, &count))
            return false;
        w->progress(w->user, i + 1);
    }
    return true;
}

// ---- on other ranks than 0 ----------------------------------------------------------------------

static void send_part(const struct ranks_part *p) {
    const uint64_t count = p->count;
    rank_send(0, TAG_COUNT, &count, sizeof count);
    rank_send(0, TAG_VALUES, p->values, p->count * sizeof *p->values);
}

static void help(const struct ranks_work *w) {
    struct ranks_part *parts = mem_array(w->most_parts, sizeof *parts);
    for (;;) {
        struct head h = {.parts = 0};
        rank_receive(0, TAG_UNIT, &h.unit, sizeof h.unit);
        if (h.unit == NONE)
            break;
        h.done = w->work(w->user, h.unit, parts, &h.parts);
        h.parts = h.done ? h.parts : 0;
        rank_send(0, TAG_HEAD, &h, sizeof h);
        for (uint32_t i = 0; i < h.parts; i++)
            send_part(&parts[i]);
    }
    mem_free(parts);
}

// ---- on rank 0 ----------------------------------------------------------------------------------

struct coordinator {
    const struct ranks_work *work;
    uint32_t next, done;
    int *held; // units by rank
    bool closed;
    double *values;
    size_t capacity;
};

static void receive_part(struct coordinator *c, int rank, uint32_t unit, uint32_t part) {
    uint64_t count;
    rank_receive(rank, TAG_COUNT, &count, sizeof count);
    mem_grow(&c->values, &c->capacity, count, sizeof *c->values);
    rank_receive(rank, TAG_VALUES, c->values, count * sizeof *c->values);
    c->work->take(c->work->user, unit, part, c->values, count);
}

// Hands a rank units until it holds enough.
static void supply(struct coordinator *c, int rank) {
    while (!c->closed && c->held[rank] < UNITS_AHEAD && c->next < c->work->units) {
        const uint32_t unit = c->next++;
        rank_send(rank, TAG_UNIT, &unit, sizeof unit);
        c->held[rank]++;
    }
}

static void count_unit(struct coordinator *c, bool done) {
    c->done += done;
    c->closed = c->closed || !done;
    c->work->progress(c->work->user, c->done);
}

// Takes one finished unit in, if there is one.
static bool receive(struct coordinator *c) {
    struct head h;
    int rank;
    if (!rank_waits(TAG_HEAD, &rank))
        return false;
    rank_receive(rank, TAG_HEAD, &h, sizeof h);
    for (uint32_t i = 0; i < h.parts; i++)
        receive_part(c, rank, h.unit, i);
    c->held[rank]--;
    count_unit(c, h.done);
    supply(c, rank);
    return true;
}

static bool any_held(const struct coordinator *c) {
    for (int i = 1; i < ranks_count(); i++)
        if (c->held[i])
            return true;
    return false;
}

static void coordinate(struct coordinator *c) {
    uint32_t parts;
    for (int i = 1; i < ranks_count(); i++)
        supply(c, i);
    for (;;) {
        while (receive(c))
            ;
        if (!c->closed && c->next < c->work->units)
            count_unit(c, c->work->work(c->work->user, c->next++, NULL, &parts));
        else if (any_held(c))
            usleep(NAP);
        else
            return;
    }
}

bool ranks_share(const struct ranks_work *w) {
    const uint32_t none = NONE;
    if (ranks_count() == 1)
        return ranks_work_alone(w);
    if (ranks_index() > 0) {
        help(w);
        return true;
    }
    struct coordinator c = {.work = w, .held = mem_array((size_t)ranks_count(), sizeof *c.held)};
    coordinate(&c);
    for (int i = 1; i < ranks_count(); i++)
        rank_send(i, TAG_UNIT, &none, sizeof none);
    mem_free(c.held);
    mem_free(c.values);
    return c.done == w->units;
}
