// SPDX-License-Identifier: Apache-2.0
#include "replay/replay_data.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "replay/tiles.h"

enum { READ_AHEAD = 128 << 20 }; // bytes at once, of tensors larger than memory

// Where tile `tile` of a block's values begins.
static size_t tile_start(const struct tensor_block *b, size_t tile) {
    return b->storage == TENSOR_ROWS
               ? b->value_rows.starts[tile]
               : tile * b->coefficients * REPLAY_ROW * tensor_value_size(b->storage);
}

// ---- chunks -------------------------------------------------------------------------------------

bool replay_open_chunk(struct replay *r, const struct replay_block *b, struct replay_chunk *c) {
    static const char nothing[TENSOR_ALIGN] __attribute__((aligned(TENSOR_ALIGN)));
    const size_t first = tile_start(b->tensor, c->first);
    const size_t bytes = tile_start(b->tensor, c->first + c->tiles) - first;
    if (!c->values.handle)
        c->values = bytes ? compute_buffer_wrap(r->device, (const char *)b->tensor->values + first, bytes)
                          : compute_buffer_wrap(r->device, nothing, sizeof nothing);
    return c->values.handle != NULL;
}

bool replay_read_ahead(struct replay *r, const struct replay_block *b, size_t chunk) {
    if (!r->reads_ahead || chunk >= b->chunk_count)
        return true;
    const struct replay_chunk *c = &b->chunks[chunk];
    const size_t first = tile_start(b->tensor, c->first);
    mem_will_need((const char *)b->tensor->values + first,
                  tile_start(b->tensor, c->first + c->tiles) - first);
    return compute_wait(r->device);
}

void replay_close_chunk(struct replay_chunk *c) {
    if (!c->resident)
        compute_buffer_destroy(&c->values);
}

struct compute_kernel *replay_kernel(struct replay *r, const struct replay_block *b,
                                     const char *file, const char *name) {
    char full[32];
    static const char *const suffix[] = {"f32", "bf16", "rows"}; // by enum tensor_storage
    const bool rows = b->tensor->storage == TENSOR_ROWS;
    snprintf(full, sizeof full, "%s_%s", name, suffix[b->tensor->storage]);
    return compute_kernel(r->device, rows ? "rows" : file, full);
}

uint32_t replay_chunk_args(const struct replay_block *b, const struct replay_chunk *c,
                           struct compute_arg args[REPLAY_CHUNK_ARGS]) {
    args[0] = COMPUTE_BUFFER(&c->values);
    if (b->tensor->storage != TENSOR_ROWS)
        return 1;
    args[1] = COMPUTE_BUFFER(&b->entries);
    args[2] = COMPUTE_BUFFER(&b->starts);
    args[3] = COMPUTE_UINT((uint32_t)c->first);
    return 4;
}

// ---- set up -------------------------------------------------------------------------------------

// As many tiles from `first` on as `limit` bytes hold.
static size_t tiles_within(const struct tensor_block *b, size_t first, size_t limit) {
    const size_t tiles = tensor_tiles(b), start = tile_start(b, first);
    size_t low = first, high = tiles; // all of low fit
    while (low < high) {
        const size_t middle = high - (high - low) / 2;
        if (tile_start(b, middle) - start <= limit)
            low = middle;
        else
            high = middle - 1;
    }
    return low - first;
}

// Chunks stay on the device as long as there is room; the others go through an eighth of it.
static bool make_chunks(struct replay *r, struct replay_block *b) {
    const size_t tiles = tensor_tiles(b->tensor), most = compute_most_allocation(r->device);
    const size_t limit = r->room < tile_start(b->tensor, tiles) && r->room / 8 < most ? r->room / 8 : most;
    size_t capacity = 0;
    for (size_t first = 0; first < tiles; first += b->chunks[b->chunk_count - 1].tiles) {
        size_t count = tiles_within(b->tensor, first, limit);
        count = count > 0 ? count : tiles_within(b->tensor, first, most) > 0;
        const size_t bytes = tile_start(b->tensor, first + count) - tile_start(b->tensor, first);
        if (count == 0) {
            log_error("%s cannot hold a tile of %zu bytes; go on without it (--no-device)",
                      compute_name(r->device), tile_start(b->tensor, first + 1) - tile_start(b->tensor, first));
            return false;
        }
        mem_grow(&b->chunks, &capacity, b->chunk_count + 1, sizeof *b->chunks);
        struct replay_chunk *c = &b->chunks[b->chunk_count++];
        *c = (struct replay_chunk){.first = first, .tiles = count,
                                   .resident = bytes <= r->room - r->room / 4};
        if (c->resident && !replay_open_chunk(r, b, c))
            return false;
        r->room -= c->resident ? bytes : 0;
    }
    return true;
}

// The entries and starts of rows.
static bool send_rows(struct replay *r, struct replay_block *b) {
    const struct tensor_block *t = b->tensor;
    const struct tensor_rows *rows = &t->value_rows;
    if (t->storage != TENSOR_ROWS)
        return true;
    b->entries = compute_buffer_wrap(r->device, rows->entries, tensor_tiles(t) * t->coefficients * 4);
    b->starts = compute_buffer_wrap(r->device, rows->starts, (tensor_tiles(t) + 1) * 8);
    return b->entries.handle && b->starts.handle;
}

static bool prepare_block(struct replay *r, struct replay_block *b) {
    const size_t tiles = tensor_tiles(b->tensor), weights = (size_t)b->tensor->coefficients * 3 * 4;
    const size_t bytes = tiles * REPLAY_ROW * sizeof *b->sums;
    b->sums = mem_array(tiles * REPLAY_ROW, sizeof *b->sums);
    b->layers = r->layers > 1 ? mem_array(r->layers * tiles * REPLAY_ROW, sizeof *b->layers) : b->sums;
    if (!r->device || tiles == 0)
        return true;
    b->out = compute_buffer_create(r->device, r->layers * bytes);
    if (r->layers > 1 && !(b->total = compute_buffer_create(r->device, bytes)).handle)
        return false;
    b->weights = compute_buffer_create(r->device, weights);
    b->terms = compute_buffer_create(r->device, (size_t)b->tensor->coefficients * 4);
    return b->out.handle && b->weights.handle && b->terms.handle && send_rows(r, b) &&
           make_chunks(r, b);
}

static size_t values_size(const struct tensor *t) {
    size_t bytes = 0;
    for (uint32_t i = 0; i < t->block_count; i++)
        bytes += tile_start(&t->blocks[i], tensor_tiles(&t->blocks[i]));
    return bytes;
}

// A device that shares the host's memory works on the file where it is mapped; in chunks, the next of
// which is read meanwhile, where the memory cannot keep it: faults alone get a tenth of a disk's speed.
static size_t room_of(const struct replay *r, const struct replay_options *options) {
    if (options->most_memory)
        return options->most_memory;
    if (!r->device)
        return SIZE_MAX;
    if (!compute_is_cpu(r->device))
        return compute_memory(r->device);
    return values_size(r->tensor) <= mem_of_machine() / 4 * 3 ? SIZE_MAX : 8 * (size_t)READ_AHEAD;
}

struct replay *replay_create(const struct tensor *t, const struct replay_options *options) {
    struct replay *r = mem_array(1, sizeof *r);
    r->tensor = t;
    r->threads = options->threads;
    r->layers = options->layers ? options->layers : 1;
    r->borrowed = options->share != NULL;
    r->device = r->borrowed ? options->share->device : options->no_device ? NULL : compute_open();
    if (r->device)
        snprintf(r->name, sizeof r->name, "OpenCL, %s", compute_name(r->device));
    else
        snprintf(r->name, sizeof r->name, "C, %d threads",
                 r->threads > 0 ? r->threads : thread_default_count());
    r->room = room_of(r, options);
    r->reads_ahead = r->device && compute_is_cpu(r->device) && r->room < SIZE_MAX;
    r->blocks = mem_array(t->block_count, sizeof *r->blocks);
    for (uint32_t i = 0; i < t->block_count; i++) {
        r->blocks[i].tensor = &t->blocks[i];
        if (!prepare_block(r, &r->blocks[i])) {
            replay_destroy(r);
            return NULL;
        }
    }
    return r;
}

void replay_destroy(struct replay *r) {
    if (!r)
        return;
    for (uint32_t i = 0; i < r->tensor->block_count; i++) {
        struct replay_block *b = &r->blocks[i];
        for (size_t k = 0; k < b->chunk_count; k++)
            compute_buffer_destroy(&b->chunks[k].values);
        compute_buffer_destroy(&b->out);
        compute_buffer_destroy(&b->weights);
        compute_buffer_destroy(&b->terms);
        compute_buffer_destroy(&b->total);
        compute_buffer_destroy(&b->entries);
        compute_buffer_destroy(&b->starts);
        if (b->layers != b->sums)
            mem_free(b->layers);
        mem_free(b->chunks);
        mem_free(b->sums);
    }
    if (!r->borrowed)
        compute_close(r->device);
    mem_free(r->blocks);
    mem_free(r);
}

const char *replay_device(const struct replay *r) {
    return r->name;
}

// ---- products -----------------------------------------------------------------------------------

// Runs a kernel over all chunks of a block: its arguments are the chunk's, `args`, where the sums go
// and the number of the first. whole: it reads all of a chunk.
static bool run_chunks(struct replay *r, struct replay_block *b, const char *kernel, bool whole,
                       const struct compute_arg *args, uint32_t count, uint32_t layer) {
    struct compute_arg a[REPLAY_CHUNK_ARGS + 6];
    struct compute_kernel *k = replay_kernel(r, b, "dot", kernel);
    if (!k)
        return false;
    for (size_t i = 0; i < b->chunk_count; i++) {
        struct replay_chunk *c = &b->chunks[i];
        if (!replay_open_chunk(r, b, c))
            return false;
        const uint32_t n = replay_chunk_args(b, c, a);
        memcpy(a + n, args, count * sizeof *a);
        a[n + count] = COMPUTE_BUFFER(&b->out);
        a[n + count + 1] = COMPUTE_UINT((uint32_t)(c->first + layer * tensor_tiles(b->tensor)));
        if (!compute_run(r->device, k, c->tiles, a, n + count + 2) ||
            (whole && !replay_read_ahead(r, b, i + 1)))
            return false;
        replay_close_chunk(c);
    }
    b->dirty = true;
    return true;
}

bool replay_product(struct replay *r, uint32_t block, const float *weights) {
    struct replay_block *b = &r->blocks[block];
    const struct tensor_block *t = b->tensor;
    if (tensor_tiles(t) == 0)
        return true;
    if (!r->device) {
        tiles_dot(tensor_values_of(t), weights, t->coefficients, tensor_tiles(t), b->layers,
                  r->threads);
        return true;
    }
    const struct compute_arg args[] = {COMPUTE_BUFFER(&b->weights), COMPUTE_UINT(t->coefficients)};
    return compute_write(r->device, &b->weights, 0, weights, (size_t)t->coefficients * 3 * 4) &&
           run_chunks(r, b, "dot", true, args, 2, 0);
}

bool replay_update(struct replay *r, uint32_t block, const uint32_t *terms, const float *weights,
                   uint32_t count) {
    return replay_update_layer(r, block, 0, terms, weights, count);
}

bool replay_update_layer(struct replay *r, uint32_t block, uint32_t layer, const uint32_t *terms,
                         const float *weights, uint32_t count) {
    struct replay_block *b = &r->blocks[block];
    const struct tensor_block *t = b->tensor;
    if (tensor_tiles(t) == 0 || count == 0)
        return true;
    if (!r->device) {
        tiles_add_terms(tensor_values_of(t), weights, terms, count, t->coefficients,
                        tensor_tiles(t), b->layers + layer * tensor_tiles(t) * REPLAY_ROW,
                        r->threads);
        return true;
    }
    const struct compute_arg args[] = {COMPUTE_BUFFER(&b->weights), COMPUTE_BUFFER(&b->terms),
                                       COMPUTE_UINT(count), COMPUTE_UINT(t->coefficients)};
    return compute_write(r->device, &b->weights, 0, weights, (size_t)count * 3 * 4) &&
           compute_write(r->device, &b->terms, 0, terms, (size_t)count * 4) &&
           run_chunks(r, b, "add_terms", false, args, 4, layer);
}

bool replay_clear_layer(struct replay *r, uint32_t block, uint32_t layer) {
    struct replay_block *b = &r->blocks[block];
    const size_t tiles = tensor_tiles(b->tensor);
    if (!r->device || tiles == 0) {
        memset(b->layers + layer * tiles * REPLAY_ROW, 0, tiles * REPLAY_ROW * sizeof *b->layers);
        return true;
    }
    const struct compute_arg args[] = {COMPUTE_BUFFER(&b->out), COMPUTE_UINT((uint32_t)(layer * tiles))};
    struct compute_kernel *k = compute_kernel(r->device, "layers", "clear_layer");
    b->dirty = true;
    return k && compute_run(r->device, k, tiles, args, 2);
}

bool replay_wait(struct replay *r) {
    return !r->device || compute_wait(r->device);
}

static bool add_layers_on_device(struct replay *r, struct replay_block *b) {
    const size_t tiles = tensor_tiles(b->tensor);
    struct compute_kernel *k = compute_kernel(r->device, "layers", "add_layers");
    const struct compute_arg args[] = {COMPUTE_BUFFER(&b->out), COMPUTE_UINT(r->layers),
                                       COMPUTE_UINT((uint32_t)tiles), COMPUTE_BUFFER(&b->total)};
    return k && compute_run(r->device, k, tiles, args, 4);
}

static bool fetch(struct replay *r, struct replay_block *b) {
    const bool layered = r->layers > 1;
    if (!r->device && layered)
        tiles_add_layers(b->layers, r->layers, tensor_tiles(b->tensor), b->sums, r->threads);
    if (!b->dirty)
        return true;
    b->dirty = false;
    if (layered && !add_layers_on_device(r, b))
        return false;
    return compute_read(r->device, layered ? &b->total : &b->out, 0, b->sums,
                        tensor_tiles(b->tensor) * REPLAY_ROW * sizeof *b->sums);
}

// Adds a block's sums to a picture.
static void compose(const struct replay *r, uint32_t block, const float *sums,
                    const struct replay_factors *f, float *frame) {
    const float one[3] = {1, 1, 1};
    const struct tensor_block *b = &r->tensor->blocks[block];
    tiles_compose(sums, b->pixels, (uint32_t)b->pixel_count,
                  f && f->scale ? f->scale + 3 * (size_t)block : one,
                  f && f->pixel ? f->pixel[block] : NULL, frame,
                  r->tensor->width * r->tensor->height, r->threads);
}

bool replay_frame(struct replay *r, const struct replay_factors *factors, float *frame) {
    const struct tensor *t = r->tensor;
    const size_t plane = (size_t)t->width * t->height;
    if (t->fixed)
        memcpy(frame, t->fixed, 3 * plane * sizeof *frame);
    else
        memset(frame, 0, 3 * plane * sizeof *frame);
    for (uint32_t i = 0; i < t->block_count; i++) {
        if (!fetch(r, &r->blocks[i]))
            return false;
        compose(r, i, r->blocks[i].sums, factors, frame);
    }
    return true;
}

void replay_variance(struct replay *r, const float *const *weights,
                     const struct replay_factors *factors, float *variance) {
    const struct tensor *t = r->tensor;
    const size_t plane = (size_t)t->width * t->height;
    float *sum = mem_array(3 * plane, sizeof *sum);
    for (uint32_t i = 0; i < t->block_count; i++) {
        const struct tensor_block *b = &t->blocks[i];
        if (!b->halves)
            continue;
        float *out = mem_array(tensor_tiles(b) * REPLAY_ROW, sizeof *out);
        tiles_dot(tensor_halves_of(b), weights[i], b->coefficients, tensor_tiles(b), out,
                  r->threads);
        compose(r, i, out, factors, sum);
        mem_free(out);
    }
    for (size_t i = 0; i < plane; i++) {
        variance[i] = 0;
        for (size_t c = 0; c < 3; c++) {
            const float d = sum[c * plane + i];
            variance[i] += d * d / 3;
        }
    }
    mem_free(sum);
}
