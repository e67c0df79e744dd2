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

// What render() does, with the help of all ranks, which must all call it with the same options. On
// other ranks than 0 the film stays empty and the result says nothing.
void ranks_render(struct film *film, const struct render_options *options,
                  struct render_result *result);
