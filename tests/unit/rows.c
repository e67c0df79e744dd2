// SPDX-License-Identifier: Apache-2.0
// Each way to store a row: what comes back is within the error that follows from its bits, also for
// rows of one value, signed, huge and tiny ones. And files of such rows: read back, or refused.
#include "transport/rows.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "check.h"
#include "rows_sample.h"

static float row_at(int kind, int i) {
    const float v = (float)rand() / (float)RAND_MAX, size = 0.1f + (float)(i / ROW_LANES);
    switch (kind) {
    case 0: return v * size;           // positive
    case 1: return (v - 0.5f) * size;  // signed
    case 2: return 0.37f;              // one value
    case 3: return 1e30f * v * size;
    case 4: return 1e-30f * v * size;
    default: return v > 0.9f ? 100 * v : 0; // a few
    }
}

enum { ROW_KINDS = 6 };

// The largest error at value i, by the definition of each way.
static double allowed(uint32_t way, const float *v, int i) {
    const int c = i / ROW_LANES, lane = i % ROW_LANES;
    double lo = DBL_MAX, hi = -DBL_MAX, mean = 0, quad = 0, most = 0;
    for (int k = 0; k < ROW_LANES; k++) {
        lo = fmin(lo, (double)v[c * ROW_LANES + k]);
        hi = fmax(hi, (double)v[c * ROW_LANES + k]);
        mean += (double)v[c * ROW_LANES + k] / ROW_LANES;
    }
    for (int k = 0; k < 4; k++)
        quad += (double)v[c * ROW_LANES + lane / 4 * 4 + k] / 4;
    for (int k = 0; k < 3; k++)
        most = fmax(most, (double)v[k * ROW_LANES + lane]);
    // The lowest value and the step are rounded outwards, by 2^-7 at most.
    const double range = hi - lo + fabs(lo) / 128, own = (double)v[i];
    const double step = range * 1.01 / 2 + 1e-38, rounding = 3e-7 * fmax(fabs(lo), fabs(hi));
    switch (way) {
    case WAY_row_zero: return fabs(own);
    case WAY_row_float32: return 0;
    case WAY_row_bfloat16: return fabs(own) / 256;
    case WAY_row_rgbe: return own < 0 ? -own : most / 255 + 1e-35;
    case WAY_row_int8: return step / 255 + rounding;
    case WAY_row_int4: return step / 15 + rounding;
    case WAY_row_int2: return step / 3 + rounding;
    case WAY_row_half8: return fabs(own - quad) + step / 255 + rounding;
    case WAY_row_half4: return fabs(own - quad) + step / 15 + rounding;
    default: return fabs(own - mean) * (1 + 1e-6) + rounding;
    }
}

static void round_trips(void) {
    for (uint32_t way = 0; way < ROW_WAYS; way++) {
        double largest = 0;
        for (int kind = 0; kind < ROW_KINDS; kind++)
            for (int repeat = 0; repeat < 50; repeat++) {
                float in[ROW_VALUES], out[ROW_VALUES];
                _Alignas(16) unsigned char bytes[4 * ROW_VALUES + 16];
                for (int i = 0; i < ROW_VALUES; i++)
                    in[i] = row_at(kind, i);
                memset(bytes, 0xa5, sizeof bytes);
                row_ways[way]->encode(in, bytes);
                row_ways[way]->decode(bytes, out);
                CHECK(bytes[row_ways[way]->bytes] == 0xa5);
                for (int i = 0; i < ROW_VALUES; i++) {
                    const double error = fabs((double)out[i] - (double)in[i]);
                    const double most = allowed(way, in, i);
                    CHECK(error <= most);
                    largest = fmax(largest, most > 0 ? error / most : 0);
                }
            }
        printf("%s: %u bytes, at most %.3f of the error allowed\n", row_ways[way]->name,
               row_ways[way]->bytes, largest);
        CHECK(row_ways[way]->bytes % ROW_UNIT == 0);
    }
}

// ---- files --------------------------------------------------------------------------------------

enum { PIXELS = 200, COEFFICIENTS = 20, TILES = 4 };

static char path[256];

static bool write_file(const struct tensor_block *b) {
    const struct tensor t = {.width = PIXELS, .height = 1, .block_count = 1,
                             .blocks = (struct tensor_block *)(uintptr_t)b};
    struct tensor_writer *w = tensor_create(path, &t);
    memcpy(tensor_values(w, 0), b->values, b->value_rows.starts[TILES]);
    memcpy(tensor_halves(w, 0), b->halves, b->half_rows.starts[TILES]);
    return tensor_finish(w);
}

static void files_come_back(const struct tensor_block *b) {
    CHECK(write_file(b));
    struct tensor_file *f = tensor_open(path);
    CHECK(f && tensor_check_values(f));
    const struct tensor_block *got = &tensor_get(f)->blocks[0];
    CHECK(tensor_block_bytes(got) == tensor_block_bytes(b));
    const struct tensor_data d[2] = {tensor_values_of(b), tensor_halves_of(b)};
    const struct tensor_data e[2] = {tensor_values_of(got), tensor_halves_of(got)};
    for (int k = 0; k < 2; k++)
        for (size_t i = 0; i < TILES * COEFFICIENTS; i++) {
            float x[ROW_VALUES], y[ROW_VALUES];
            tensor_row(&d[k], COEFFICIENTS, i / COEFFICIENTS, i % COEFFICIENTS, x);
            tensor_row(&e[k], COEFFICIENTS, i / COEFFICIENTS, i % COEFFICIENTS, y);
            CHECK(memcmp(x, y, sizeof x) == 0);
        }
    tensor_close(f);
}

// Whether a file is opened in which one entry or start is another.
static bool opens_with(const struct tensor_block *b, uint32_t entry, uint64_t start) {
    uint32_t *entries = (uint32_t *)(uintptr_t)b->half_rows.entries;
    uint64_t *starts = (uint64_t *)(uintptr_t)b->value_rows.starts;
    const uint32_t old_entry = entries[33];
    const uint64_t old_start = starts[2];
    entries[33] = entry ? entry : old_entry;
    starts[2] = start ? start : old_start;
    CHECK(write_file(b));
    entries[33] = old_entry;
    starts[2] = old_start;
    struct tensor_file *f = tensor_open(path);
    tensor_close(f);
    return f != NULL;
}

static void refuses_what_is_wrong(const struct tensor_block *b) {
    const uint64_t *starts = b->value_rows.starts;
    CHECK(opens_with(b, 0, 0)); // the test can pass
    CHECK(!opens_with(b, ROW_WAYS, 0));
    CHECK(!opens_with(b, row_entry(WAY_row_mean, b->half_rows.starts[2] - b->half_rows.starts[1]), 0));
    CHECK(!opens_with(b, row_entry(WAY_row_float32, 0xfffffff0), 0));
    CHECK(!opens_with(b, 0, starts[2] + 16));
    CHECK(!opens_with(b, 0, starts[1] - ROW_TILE_ALIGN));
    CHECK(!opens_with(b, 0, starts[TILES] + ROW_TILE_ALIGN));
}

int main(void) {
    const char *folder = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
    struct arena arena = {0};
    snprintf(path, sizeof path, "%s/relume-rows-%ld.safetensors", folder, (long)getpid());
    round_trips();
    const struct tensor_block b = rows_sample(PIXELS, COEFFICIENTS, &arena);
    files_come_back(&b);
    refuses_what_is_wrong(&b);
    unlink(path);
    arena_finish(&arena);
    return check_result();
}
