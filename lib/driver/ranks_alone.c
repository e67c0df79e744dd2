// SPDX-License-Identifier: Apache-2.0
// Built without MPI: there is one rank.
#include "driver/rank_messages.h"
#include "driver/ranks.h"

void ranks_start(void) {
}

void ranks_finish(void) {
}

int ranks_index(void) {
    return 0;
}

int ranks_count(void) {
    return 1;
}

void rank_send(int rank, int tag, const void *data, size_t size) {
    (void)rank, (void)tag, (void)data, (void)size;
}

void rank_receive(int rank, int tag, void *data, size_t size) {
    (void)rank, (void)tag, (void)data, (void)size;
}

bool rank_waits(int tag, int *rank) {
    (void)tag, (void)rank;
    return false;
}

void ranks_broadcast(void *data, size_t size) {
    (void)data, (void)size;
}

void ranks_sum(uint64_t *values, size_t count) {
    (void)values, (void)count;
}

void ranks_render(struct film *film, const struct render_options *options,
                  struct render_result *result) {
    render(film, options, result);
}
