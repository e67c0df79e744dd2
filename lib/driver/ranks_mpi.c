// SPDX-License-Identifier: Apache-2.0
#include <mpi.h>

#include "driver/ranks.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "driver/rank_messages.h"

enum { MOST_BYTES = 1 << 30 }; // of a message of bytes

static int rank_index, rank_count = 1;

void ranks_start(void) {
    if (!getenv("OMPI_COMM_WORLD_SIZE") && !getenv("PMI_SIZE"))
        return;
    MPI_Init(NULL, NULL);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_index);
    MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
}

void ranks_finish(void) {
    int begun = 0;
    MPI_Initialized(&begun);
    if (begun)
        MPI_Finalize();
}

int ranks_index(void) {
    return rank_index;
}

int ranks_count(void) {
    return rank_count;
}

// Bytes of the next piece of a message.
static int piece(size_t size) {
    return size < MOST_BYTES ? (int)size : MOST_BYTES;
}

void ranks_broadcast(void *data, size_t size) {
    char *at = data;
    for (int n; rank_count > 1 && size > 0; at += n, size -= (size_t)n) {
        n = piece(size);
        MPI_Bcast(at, n, MPI_BYTE, 0, MPI_COMM_WORLD);
    }
}

void ranks_sum(uint64_t *values, size_t count) {
    uint64_t *own = mem_array(count, sizeof *own);
    memcpy(own, values, count * sizeof *own);
    if (rank_count > 1)
        MPI_Reduce(own, values, (int)count, MPI_UINT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
    mem_free(own);
}

// ---- messages -----------------------------------------------------------------------------------

void rank_send(int rank, int tag, const void *data, size_t size) {
    MPI_Send(data, (int)size, MPI_BYTE, rank, tag, MPI_COMM_WORLD);
}

void rank_receive(int rank, int tag, void *data, size_t size) {
    MPI_Recv(data, (int)size, MPI_BYTE, rank, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
}

struct rank_message {
    uint64_t *words;
    size_t count, capacity;
    MPI_Request request;
};

struct rank_message *rank_message_create(void) {
    struct rank_message *m = mem_array(1, sizeof *m);
    m->request = MPI_REQUEST_NULL;
    return m;
}

static void make_room(struct rank_message *m, size_t words) {
    if (m->capacity < words) {
        mem_free(m->words);
        m->words = mem_array(words, sizeof *m->words);
        m->capacity = words;
    }
    m->count = words;
}

void rank_message_destroy(struct rank_message *m) {
    if (m) {
        MPI_Wait(&m->request, MPI_STATUS_IGNORE);
        mem_free(m->words);
    }
    mem_free(m);
}

uint64_t *rank_message_room(struct rank_message *m, size_t words) {
    MPI_Wait(&m->request, MPI_STATUS_IGNORE);
    make_room(m, words);
    return m->words;
}

void rank_message_send(struct rank_message *m, int rank, int tag) {
    MPI_Isend(m->words, (int)m->count, MPI_UINT64_T, rank, tag, MPI_COMM_WORLD, &m->request);
}

bool rank_message_begin(struct rank_message *m, int tag, int *rank) {
    MPI_Status status;
    int there, words;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status);
    if (!there)
        return false;
    *rank = status.MPI_SOURCE;
    MPI_Get_count(&status, MPI_UINT64_T, &words);
    make_room(m, (size_t)words);
    MPI_Irecv(m->words, words, MPI_UINT64_T, *rank, tag, MPI_COMM_WORLD, &m->request);
    return true;
}

const uint64_t *rank_message_words(struct rank_message *m) {
    int done;
    MPI_Test(&m->request, &done, MPI_STATUS_IGNORE);
    return done ? m->words : NULL;
}
