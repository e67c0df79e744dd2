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

struct rank_message *rank_message_create(void) {
    return NULL;
}

void rank_message_destroy(struct rank_message *m) {
    (void)m;
}

uint64_t *rank_message_room(struct rank_message *m, size_t words) {
    (void)m, (void)words;
    return NULL;
}

void rank_message_send(struct rank_message *m, int rank, int tag) {
    (void)m, (void)rank, (void)tag;
}

bool rank_message_begin(struct rank_message *m, int tag, int *rank) {
    (void)m, (void)tag, (void)rank;
    return false;
}

const uint64_t *rank_message_words(struct rank_message *m) {
    (void)m;
    return NULL;
}

void ranks_broadcast(void *data, size_t size) {
    (void)data, (void)size;
}

void ranks_sum(uint64_t *values, size_t count) {
    (void)values, (void)count;
}
