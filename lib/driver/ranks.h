// SPDX-License-Identifier: Apache-2.0
// Several processes that make one picture together (MPI, where the program is built with it).
//
// The unit of work is a block of samples of a few tiles. Rank 0 hands units out, works on some itself
// and sums what comes back in the order of the tree, so that the picture has the bits of one process
// however many ranks there are and however fast each is. Only rank 0 writes and reports.
#pragma once

#include "driver/render.h"

// Joins the processes that mpirun started. Alone there is one rank, 0, and nothing was started.
void ranks_start(void);
void ranks_finish(void);
int ranks_index(void);
int ranks_count(void);

// ---- any work in units --------------------------------------------------------------------------

// Samples [first, first + count) of tiles [tile, tile + tiles). count > 0.
struct ranks_unit {
    uint64_t first;
    uint32_t count, tile, tiles;
};

// Numbers that a part of a unit leaves.
struct ranks_part {
    const double *values;
    size_t count;
};

struct ranks_work {
    uint32_t most_parts; // of a unit
    // Rank 0: the unit to be worked on next. false: none, for now or, if none is worked on, ever.
    bool (*next)(void *user, struct ranks_unit *unit);
    // Works on a unit. Elsewhere than on rank 0 it leaves parts to be sent there: they stay as they are
    // until the next call. false: given up.
    bool (*work)(void *user, const struct ranks_unit *unit, struct ranks_part *parts,
                 uint32_t *count);
    // Rank 0 gets a part from another rank.
    void (*take)(void *user, const struct ranks_unit *unit, uint32_t part, const double *values,
                 size_t count);
    // Rank 0: a unit and all its parts are there, or it was given up.
    void (*finish)(void *user, const struct ranks_unit *unit, bool done);
    void *user;
};

// Works on all units with the help of all ranks, which must all call it with the same work.
void ranks_share(const struct ranks_work *w);
void ranks_work_alone(const struct ranks_work *w); // the same by one rank
// Gives all ranks what rank 0 has.
void ranks_broadcast(void *data, size_t size);
// Leaves the sums over all ranks on rank 0.
void ranks_sum(uint64_t *values, size_t count);

// ---- pictures -----------------------------------------------------------------------------------

// What render() does, with the help of all ranks, which must all call it with the same options. On
// other ranks than 0 the film stays empty and the result says nothing.
void ranks_render(struct film *film, const struct render_options *options,
                  struct render_result *result);
