// SPDX-License-Identifier: Apache-2.0
// The tree of sums: however samples were cut and whoever summed them, the total has the same bits.
#include "sink/sums.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "check.h"

enum { VALUES = 3, BLOCKS = 45, LAST_SHORT = 17 };

// A value that rounds differently with every order of summing.
static double value(uint32_t seed, uint64_t block, size_t i) {
    return sin((double)(seed * 1000 + block * 7 + i) * 1.7) * pow(10, (double)(block % 9));
}

static struct sums_node block_node(uint32_t seed, uint64_t block, uint32_t missing) {
    double *values = mem_array(VALUES, sizeof *values);
    for (size_t i = 0; i < VALUES; i++)
        values[i] = value(seed, block, i);
    return (struct sums_node){seed, 0, block, missing, values};
}

static void add_blocks(struct sums *s, uint32_t seed, const uint64_t *order, size_t n) {
    for (size_t i = 0; i < n; i++)
        sums_add(s, block_node(seed, order[i], 0));
}

static void count_up(uint64_t *order, uint64_t first, size_t n) {
    for (size_t i = 0; i < n; i++)
        order[i] = first + i;
}

// Whole nodes at once against single values.
static bool same_totals(const struct sums *a, const struct sums *b) {
    const double last = 0;
    double all[VALUES], one;
    bool same = true;
    sums_total(a, 0, VALUES, NULL, all);
    for (size_t i = 0; i < VALUES; i++) {
        sums_total(b, i, 1, &last, &one);
        same &= all[i] == one;
    }
    return same;
}

static void any_order_gives_the_same_bits(void) {
    struct sums in_order, shuffled;
    uint64_t order[BLOCKS];
    int different = 0;
    sums_init(&in_order, VALUES);
    count_up(order, 0, BLOCKS);
    add_blocks(&in_order, 0, order, BLOCKS);
    CHECK(in_order.count == (size_t)__builtin_popcount(BLOCKS)); // the fewest nodes
    for (int trial = 0; trial < 200; trial++) {
        for (size_t i = BLOCKS - 1; i > 0; i--) {
            const size_t k = (size_t)rand() % (i + 1);
            const uint64_t swap = order[i];
            order[i] = order[k];
            order[k] = swap;
        }
        sums_init(&shuffled, VALUES);
        add_blocks(&shuffled, 0, order, BLOCKS);
        different += !same_totals(&in_order, &shuffled) || shuffled.count != in_order.count;
        sums_finish(&shuffled);
    }
    CHECK(different == 0);
    sums_finish(&in_order);
}

// Moves every node of `from` into `to`.
static void merge(struct sums *to, struct sums *from) {
    for (size_t i = 0; i < from->count; i++) {
        CHECK(!sums_overlap(to, &from->nodes[i]));
        sums_add(to, from->nodes[i]);
    }
    from->count = 0;
    sums_finish(from);
}

static void ranges_merge_to_the_whole(void) {
    struct sums whole, united;
    uint64_t order[BLOCKS];
    const uint64_t cuts[] = {0, 3, 4, 21, BLOCKS}, sequence[] = {2, 0, 3, 1};
    sums_init(&whole, VALUES);
    sums_init(&united, VALUES);
    count_up(order, 0, BLOCKS);
    add_blocks(&whole, 5, order, BLOCKS);
    for (int i = 0; i < 4; i++) {
        struct sums part;
        const uint64_t first = cuts[sequence[i]], end = cuts[sequence[i] + 1];
        sums_init(&part, VALUES);
        count_up(order, first, end - first);
        add_blocks(&part, 5, order, end - first);
        CHECK(sums_samples(&part) == (end - first) * SUMS_BLOCK);
        CHECK(sums_next(&part, 5, first * SUMS_BLOCK) == end * SUMS_BLOCK);
        merge(&united, &part);
    }
    CHECK(same_totals(&whole, &united) && united.count == whole.count);
    CHECK(sums_next(&united, 5, 0) == BLOCKS * SUMS_BLOCK);
    CHECK(sums_next(&united, 4, 0) == 0);
    sums_finish(&whole);
    sums_finish(&united);
}

static void overlaps_are_seen(void) {
    struct sums s;
    uint64_t order[4];
    const struct sums_node twice = {.seed = 1, .level = 0, .index = 2},
                           around = {.seed = 1, .level = 3, .index = 0},
                           after = {.seed = 1, .level = 2, .index = 1},
                           other = {.seed = 2, .level = 0, .index = 2};
    sums_init(&s, VALUES);
    count_up(order, 0, 4);
    add_blocks(&s, 1, order, 4);
    CHECK(sums_overlap(&s, &twice) && sums_overlap(&s, &around));
    CHECK(!sums_overlap(&s, &after) && !sums_overlap(&s, &other));
    sums_finish(&s);
}

static void short_blocks_count_and_come_back(void) {
    struct sums s;
    struct sums_node node;
    sums_init(&s, VALUES);
    sums_add(&s, block_node(0, 0, 0));
    sums_add(&s, block_node(0, 1, SUMS_BLOCK - LAST_SHORT));
    sums_add(&s, block_node(1, 0, SUMS_BLOCK - LAST_SHORT));
    CHECK(s.count == 3); // a short block joins nothing
    CHECK(sums_samples(&s) == SUMS_BLOCK + 2 * LAST_SHORT);
    CHECK(sums_samples_of_phase(&s, 16, 0) == 4 + 2 + 2);
    CHECK(sums_samples_of_phase(&s, 16, 1) == 4 + 1 + 1);
    CHECK(sums_next(&s, 0, 0) == SUMS_BLOCK + LAST_SHORT);
    CHECK(sums_take_short(&s, 0, &node) && node.index == 1 && s.count == 2);
    mem_free(node.values);
    CHECK(!sums_take_short(&s, 0, &node));
    CHECK(sums_next(&s, 0, 0) == SUMS_BLOCK);
    sums_finish(&s);
}

int main(void) {
    any_order_gives_the_same_bits();
    ranges_merge_to_the_whole();
    overlaps_are_seen();
    short_blocks_count_and_come_back();
    return check_result();
}
