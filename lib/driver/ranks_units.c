// SPDX-License-Identifier: Apache-2.0
// Units of any work, handed out by rank 0, and the numbers that come back.
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "driver/rank_messages.h"
#include "driver/ranks.h"

enum { TAG_UNIT, TAG_PARTS };
enum { UNITS_AHEAD = 2 };   // a rank holds, so that it need not wait for the next one
enum { MOST_ARRIVALS = 4 }; // at a time
enum { NAP = 200 };         // microseconds between looks for messages

// What comes before the parts of a unit: as words, then a word each for their sizes.
struct head {
    struct ranks_unit unit;
    uint32_t parts, done; // !done: it was given up
};
enum { HEAD_WORDS = sizeof(struct head) / sizeof(uint64_t) };
_Static_assert(sizeof(struct head) % sizeof(uint64_t) == 0, "whole words");

void ranks_work_alone(const struct ranks_work *w) {
    uint32_t count = 0;
    for (struct ranks_unit u; w->next(w->user, &u);)
        w->finish(w->user, &u, w->work(w->user, &u, NULL, &count));
}

// ---- on other ranks than 0 ----------------------------------------------------------------------

static void send_parts(struct rank_message *m, const struct head *h, const struct ranks_part *parts) {
    size_t words = HEAD_WORDS + h->parts;
    for (uint32_t i = 0; i < h->parts; i++)
        words += parts[i].count;
    uint64_t *at = rank_message_room(m, words);
    memcpy(at, h, sizeof *h);
    at += HEAD_WORDS;
    for (uint32_t i = 0; i < h->parts; i++)
        *at++ = parts[i].count;
    for (uint32_t i = 0; i < h->parts; at += parts[i++].count)
        memcpy(at, parts[i].values, parts[i].count * sizeof *parts[i].values);
    rank_message_send(m, 0, TAG_PARTS);
}

static void help(const struct ranks_work *w) {
    struct ranks_part *parts = mem_array(w->most_parts, sizeof *parts);
    struct rank_message *messages[UNITS_AHEAD];
    for (int i = 0; i < UNITS_AHEAD; i++)
        messages[i] = rank_message_create();
    for (int i = 0;; i = (i + 1) % UNITS_AHEAD) {
        struct head h = {.parts = 0};
        rank_receive(0, TAG_UNIT, &h.unit, sizeof h.unit);
        if (h.unit.count == 0)
            break;
        h.done = w->work(w->user, &h.unit, parts, &h.parts);
        h.parts = h.done ? h.parts : 0;
        send_parts(messages[i], &h, parts);
    }
    for (int i = 0; i < UNITS_AHEAD; i++)
        rank_message_destroy(messages[i]);
    mem_free(parts);
}

// ---- on rank 0 ----------------------------------------------------------------------------------

struct coordinator {
    const struct ranks_work *work;
    int *held; // units by rank
    struct rank_message *arrivals[MOST_ARRIVALS];
    bool coming[MOST_ARRIVALS];
};

// Hands a rank units until it holds enough.
static void supply(struct coordinator *c, int rank) {
    struct ranks_unit u;
    while (c->held[rank] < UNITS_AHEAD && c->work->next(c->work->user, &u)) {
        rank_send(rank, TAG_UNIT, &u, sizeof u);
        c->held[rank]++;
    }
}

static void take_in(const struct ranks_work *w, const uint64_t *words) {
    struct head h;
    memcpy(&h, words, sizeof h);
    const uint64_t *sizes = words + HEAD_WORDS;
    const double *values = (const void *)(sizes + h.parts);
    for (uint32_t i = 0; i < h.parts; values += sizes[i++])
        w->take(w->user, &h.unit, i, values, sizes[i]);
    w->finish(w->user, &h.unit, h.done);
}

// Takes in what has come. Whether more is on its way.
static bool receive(struct coordinator *c) {
    bool more = false;
    for (int i = 0, rank; i < MOST_ARRIVALS; i++) {
        if (!c->coming[i] && rank_message_begin(c->arrivals[i], TAG_PARTS, &rank)) {
            c->coming[i] = true;
            c->held[rank]--;
            supply(c, rank);
        }
        const uint64_t *words = c->coming[i] ? rank_message_words(c->arrivals[i]) : NULL;
        if (words) {
            c->coming[i] = false;
            take_in(c->work, words);
        }
        more = more || c->coming[i];
    }
    return more;
}

static bool any_held(const struct coordinator *c) {
    for (int i = 1; i < ranks_count(); i++)
        if (c->held[i])
            return true;
    return false;
}

static void coordinate(struct coordinator *c) {
    const struct ranks_work *w = c->work;
    uint32_t parts;
    for (int i = 1; i < ranks_count(); i++)
        supply(c, i);
    for (struct ranks_unit u;;) {
        const bool coming = receive(c);
        if (w->next(w->user, &u))
            w->finish(w->user, &u, w->work(w->user, &u, NULL, &parts));
        else if (coming || any_held(c))
            usleep(NAP);
        else
            return;
    }
}

void ranks_share(const struct ranks_work *w) {
    const struct ranks_unit none = {.count = 0};
    if (ranks_count() == 1) {
        ranks_work_alone(w);
        return;
    }
    if (ranks_index() > 0) {
        help(w);
        return;
    }
    struct coordinator c = {.work = w, .held = mem_array((size_t)ranks_count(), sizeof *c.held)};
    for (int i = 0; i < MOST_ARRIVALS; i++)
        c.arrivals[i] = rank_message_create();
    coordinate(&c);
    for (int i = 1; i < ranks_count(); i++)
        rank_send(i, TAG_UNIT, &none, sizeof none);
    for (int i = 0; i < MOST_ARRIVALS; i++)
        rank_message_destroy(c.arrivals[i]);
    mem_free(c.held);
}
