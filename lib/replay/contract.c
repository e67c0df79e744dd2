// SPDX-License-Identifier: Apache-2.0
// From the coefficients of a block to fewer: in pieces that the device has room for.
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "replay/replay_data.h"
#include "replay/tiles.h"

// Bytes of results that are made at once.
enum { MOST_RESULT = 1 << 28 };

struct device_contraction {
    const struct contraction *c;
    struct compute_buffer weight, index, target, start;
    size_t most; // tiles at once
    struct compute_kernel *kernel;
};

static struct compute_buffer send(struct replay *r, const void *data, size_t bytes) {
    struct compute_buffer b = compute_buffer_create(r->device, bytes);
    if (b.handle && bytes && !compute_write(r->device, &b, 0, data, bytes))
        compute_buffer_destroy(&b);
    return b;
}

static bool run_piece(struct replay *r, const struct device_contraction *d,
                      const struct replay_block *b, const struct replay_chunk *chunk, size_t first,
                      size_t tiles, float *out) {
    const size_t floats = (size_t)d->c->reduced * REPLAY_ROW;
    float *to = out + (chunk->first + first) * floats;
    struct compute_buffer results = compute_buffer_over(r->device, to, tiles * floats * sizeof *to);
    struct compute_arg args[REPLAY_CHUNK_ARGS + 8];
    const struct compute_arg own[] = {
        COMPUTE_BUFFER(&d->weight), COMPUTE_BUFFER(&d->index), COMPUTE_BUFFER(&d->start),
        COMPUTE_UINT(b->tensor->coefficients), COMPUTE_UINT(d->c->reduced),
        COMPUTE_UINT((uint32_t)first), COMPUTE_BUFFER(&results)};
    uint32_t n = replay_chunk_args(b, chunk, args);
    if (d->c->together > 1)
        args[n++] = COMPUTE_BUFFER(&d->target);
    memcpy(args + n, own, sizeof own);
    const bool good = results.handle &&
                      compute_run(r->device, d->kernel, tiles * contraction_runs(d->c), args, n + 7) &&
                      compute_collect(r->device, &results, to);
    compute_buffer_destroy(&results);
    return good;
}

static bool run_chunks(struct replay *r, struct replay_block *b, const struct device_contraction *d,
                       float *out) {
    bool good = true;
    for (size_t i = 0; i < b->chunk_count && good; i++) {
        struct replay_chunk *c = &b->chunks[i];
        good = replay_open_chunk(r, b, c) && replay_read_ahead(r, b, i + 1);
        for (size_t first = 0; first < c->tiles && good; first += d->most) {
            const size_t tiles = c->tiles - first < d->most ? c->tiles - first : d->most;
            good = run_piece(r, d, b, c, first, tiles, out);
        }
        replay_close_chunk(c);
    }
    return good;
}

static bool on_device(struct replay *r, struct replay_block *b, const struct contraction *c,
                      float *out) {
    const size_t entries = c->start[contraction_runs(c)], bytes = (size_t)c->reduced * REPLAY_ROW * 4;
    const size_t limit = compute_most_allocation(r->device) < MOST_RESULT
                             ? compute_most_allocation(r->device) : MOST_RESULT;
    const size_t tiles = tensor_tiles(b->tensor);
    struct device_contraction d = {.c = c, .most = limit / bytes > 0 ? limit / bytes : 1};
    d.most = d.most < tiles ? d.most : tiles;
    d.weight = send(r, c->weight, entries * TILE_CHANNELS * sizeof *c->weight);
    d.index = send(r, c->index, entries * sizeof *c->index);
    d.target = send(r, c->target, entries * sizeof *c->target);
    d.start = send(r, c->start, ((size_t)contraction_runs(c) + 1) * sizeof *c->start);
    d.kernel = replay_kernel(r, b, "contract", "contract");
    const bool good = d.weight.handle && d.index.handle && d.target.handle && d.start.handle &&
                      d.kernel && run_chunks(r, b, &d, out);
    compute_buffer_destroy(&d.weight);
    compute_buffer_destroy(&d.index);
    compute_buffer_destroy(&d.target);
    compute_buffer_destroy(&d.start);
    return good;
}

bool replay_contract(struct replay *r, uint32_t block, const struct contraction *c, float *out) {
    struct replay_block *b = &r->blocks[block];
    const struct tensor_block *t = b->tensor;
    if (tensor_tiles(t) == 0)
        return true;
    if (r->device)
        return on_device(r, b, c, out);
    tiles_contract(tensor_values_of(t), c, t->coefficients, tensor_tiles(t), out, r->threads);
    return true;
}
