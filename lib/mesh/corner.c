// SPDX-License-Identifier: Apache-2.0
#include "mesh/corner.h"

#include <assert.h>
#include <string.h>

#include "base/mem.h"
#include "math/hash.h"

static size_t bucket_of(const struct corner_table *t, const struct corner *c) {
    const uint64_t h = hash_u64((uint64_t)c->v << 32 | c->vt) ^ c->vn;
    return hash_u64(h) & (t->bucket_count - 1);
}

static void rehash(struct corner_table *t) {
    const size_t wanted = t->bucket_count ? t->bucket_count * 2 : 1024;
    mem_free(t->buckets);
    t->buckets = mem_array(wanted, sizeof *t->buckets);
    t->bucket_count = wanted;
    memset(t->buckets, 0xff, wanted * sizeof *t->buckets);
    for (size_t i = 0; i < t->count; i++) {
        uint32_t *bucket = &t->buckets[bucket_of(t, &t->corners[i])];
        t->next[i] = *bucket;
        *bucket = (uint32_t)i;
    }
}

uint32_t corner_vertex(struct corner_table *t, struct corner c) {
    if (t->count >= t->bucket_count)
        rehash(t);
    uint32_t *bucket = &t->buckets[bucket_of(t, &c)];
    for (uint32_t i = *bucket; i != CORNER_NONE; i = t->next[i])
        if (t->corners[i].v == c.v && t->corners[i].vt == c.vt && t->corners[i].vn == c.vn)
            return i;
    assert(t->count < CORNER_NONE);
    mem_grow(&t->corners, &t->capacity, t->count + 1, sizeof *t->corners);
    mem_grow(&t->next, &t->next_capacity, t->count + 1, sizeof *t->next);
    t->corners[t->count] = c;
    t->next[t->count] = *bucket;
    *bucket = (uint32_t)t->count;
    return (uint32_t)t->count++;
}

void corner_table_finish(struct corner_table *t) {
    mem_free(t->corners);
    mem_free(t->next);
    mem_free(t->buckets);
    *t = (struct corner_table){0};
}
