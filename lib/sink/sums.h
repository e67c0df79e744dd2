// SPDX-License-Identifier: Apache-2.0
// Sums of samples that come out the same bit for bit, however the work was cut and whoever did it.
//
// The samples of one seed are numbered from 0. They are summed in order, in double, within blocks of
// 64, of which the last may be short. Blocks combine in the fixed binary tree of their indices: the
// node of level k and index i sums blocks [i 2^k, (i + 1) 2^k), left half plus right half. The fewest
// nodes that cover what is known are kept; a total adds them from the last to the first. So runs that
// were stopped, resumed, spread over machines and merged give the sums of a run in one piece.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { SUMS_BLOCK = 64 }; // samples

struct sums_node {
    uint32_t seed, level;
    uint64_t index;   // in units of 2^level blocks
    uint32_t missing; // samples that a short block lacks; 0 for all others
    double *values;   // owned
};

struct sums {
    size_t values;           // doubles of a node
    struct sums_node *nodes; // by seed, then by first block; disjoint
    size_t count, capacity;
};

void sums_init(struct sums *s, size_t values);
void sums_finish(struct sums *s);

// Samples of a node; node.values is not looked at.
uint64_t sums_node_samples(const struct sums_node *node);
uint64_t sums_node_first(const struct sums_node *node); // its first sample
// Whether any sample of the node is in s already.
bool sums_overlap(const struct sums *s, const struct sums_node *node);
// Adds a node that does not overlap, and takes over its values (from mem_array). A short block must
// stay the last of its seed.
void sums_add(struct sums *s, struct sums_node node);
// Takes a short block out again, so that it can be gone on with: its values are the caller's.
// false: the seed's samples end with a full block.
bool sums_take_short(struct sums *s, uint32_t seed, struct sums_node *node);

uint64_t sums_samples(const struct sums *s);
// Samples whose number modulo `period` (a divisor of SUMS_BLOCK) is `phase`.
uint64_t sums_samples_of_phase(const struct sums *s, uint32_t period, uint32_t phase);
// The sample after the last one that is known without a gap from `first` on.
uint64_t sums_next(const struct sums *s, uint32_t seed, uint64_t first);
// Sums over all nodes of `count` values from `first` on, beginning with `last`, which stand behind all
// nodes; NULL: none do.
void sums_total(const struct sums *s, size_t first, size_t count, const double *last, double *sums);
