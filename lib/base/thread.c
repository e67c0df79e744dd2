// SPDX-License-Identifier: Apache-2.0
#include "base/thread.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>

#include "base/mem.h"

struct loop {
    atomic_size_t next;
    size_t items;
    void (*work)(void *ctx, size_t item, int worker);
    void *ctx;
};

struct worker {
    struct loop *loop;
    int index;
    pthread_t thread;
};

int thread_default_count(void) {
    cpu_set_t set;
    const int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    return n > 0 ? n : 1;
}

static void *run(void *arg) {
    const struct worker *w = arg;
    struct loop *l = w->loop;
    for (size_t i; (i = atomic_fetch_add(&l->next, 1)) < l->items;)
        l->work(l->ctx, i, w->index);
    return NULL;
}

void thread_for(int threads, size_t items, void (*work)(void *ctx, size_t item, int worker),
                void *ctx) {
    if (threads <= 0)
        threads = thread_default_count();
    struct loop loop = {.items = items, .work = work, .ctx = ctx};
    if (threads == 1 || items <= 1) {
        run(&(struct worker){.loop = &loop});
        return;
    }
    struct worker *workers = mem_array((size_t)threads, sizeof *workers);
    int started = 1; // worker 0 is this thread; a thread that cannot start is simply not there
    for (int i = 1; i < threads; i++) {
        workers[started] = (struct worker){.loop = &loop, .index = started};
        started += pthread_create(&workers[started].thread, NULL, run, &workers[started]) == 0;
    }
    workers[0] = (struct worker){.loop = &loop};
    run(&workers[0]);
    for (int i = 1; i < started; i++)
        pthread_join(workers[i].thread, NULL);
    mem_free(workers);
}

double time_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
