// SPDX-License-Identifier: Apache-2.0
// Running a loop on several threads. Results never depend on the number of threads: a work item
// may depend on its index, never on its worker, except for scratch memory.
#pragma once

#include <stddef.h>

// Number of processors this process may use.
int thread_default_count(void);

// Calls work(ctx, item, worker) for item 0 .. items-1 on `threads` threads (0: the default);
// worker is 0 .. threads-1. Items are handed out in order. Returns when all are done.
void thread_for(int threads, size_t items, void (*work)(void *ctx, size_t item, int worker),
                void *ctx);

double time_seconds(void); // monotonic clock
