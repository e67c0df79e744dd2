// SPDX-License-Identifier: Apache-2.0
#include "replay/budget.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "kernels/tile.h"
#include "replay/budget_data.h"
#include "replay/edit_weights.h"

// Halves may change the noise that they tell of by about that.
static const double NOISE_SHARE = 0.02;
enum { STEPS = 9 }; // of the bisection, of the price's logarithm

static size_t plane_of(const struct budget *b) {
    return (size_t)b->tensor->width * b->tensor->height;
}

static size_t rows_of(const struct tensor_block *b) {
    return tensor_tiles(b) * b->coefficients;
}

// ---- trials -------------------------------------------------------------------------------------

// What errors of a trial's picture count. All is divided by its mean, whatever that is.
static void weigh_picture(struct budget *b, int trial) {
    const size_t n = 3 * plane_of(b);
    double mean = 0;
    for (size_t i = 0; i < n; i++)
        mean += (double)b->picture[trial][i] / (double)n;
    const double unit = b->unit[trial] = mean > 0 ? 1 / mean : 1;
    for (size_t i = 0; i < n; i++) {
        const double v = unit * (double)b->picture[trial][i];
        b->loss[trial][i] = (float)(1 / ((v * v + 1e-3) * (double)n));
    }
    for (uint32_t i = 0; i < b->tensor->block_count; i++)
        for (size_t k = 0; k < 3 * (size_t)b->tensor->blocks[i].coefficients; k++)
            b->weights[trial][i][k] *= (float)unit;
}

static void make_trials(struct budget *b, struct edit_tensor *e) {
    const size_t n = 3 * plane_of(b);
    for (int t = 0; t < TRIALS; t++) {
        struct trial_memory memory = {.values = NULL};
        trial_apply(e, t, &memory);
        b->weights[t] = trial_weights(e, &b->arena);
        trial_restore(e, &memory);
        b->picture[t] = arena_alloc(&b->arena, n * sizeof(float));
        b->loss[t] = arena_alloc(&b->arena, n * sizeof(float));
        if (b->tensor->fixed)
            memcpy(b->picture[t], b->tensor->fixed, n * sizeof(float));
    }
    budget_pictures(b, false, false, b->picture);
    for (int t = 0; t < TRIALS; t++)
        weigh_picture(b, t);
}

// f_o by the new lanes; the trials leave it as it is.
static void order_factor(struct budget *b, const struct edit_tensor *e, uint32_t block) {
    struct budget_block *own = &b->blocks[block];
    const size_t n = tensor_tiles(&own->from) * ROW_VALUES;
    float *old = mem_array(n, sizeof *old);
    if (n > 0 && edit_view_factor(e, block, old)) {
        own->factor = arena_alloc(&b->arena, n * sizeof *own->factor);
        for (size_t i = 0; i < n; i++) {
            const uint32_t lane = own->order[i / ROW_VALUES * TILE_LANES + i % TILE_LANES];
            own->factor[i] = old[lane / TILE_LANES * (size_t)ROW_VALUES +
                                 i % ROW_VALUES / TILE_LANES * TILE_LANES + lane % TILE_LANES];
        }
    }
    mem_free(old);
}

static void make_blocks(struct budget *b, const struct edit_tensor *e) {
    b->blocks = arena_alloc(&b->arena, (b->tensor->block_count + 1) * sizeof *b->blocks);
    for (uint32_t i = 0; i < b->tensor->block_count; i++) {
        struct budget_block *own = &b->blocks[i];
        own->from = tensor_unpack(&b->tensor->blocks[i], own->unpacked);
        const size_t rows = rows_of(&own->from);
        if (b->options->no_halves)
            own->from.halves = NULL;
        budget_order(own, b->tensor->width, &b->arena);
        order_factor(b, e, i);
        own->ways[0] = arena_alloc(&b->arena, rows + 1);
        own->ways[1] = arena_alloc(&b->arena, rows + 1);
        own->costs = mem_array(rows * ROW_WAYS, sizeof *own->costs);
    }
}

// ---- search -------------------------------------------------------------------------------------

// The cheapest ways where an error of 1 costs `price` bytes.
static void choose(struct budget *b, bool halves, double price) {
    for (uint32_t i = 0; i < b->tensor->block_count; i++) {
        struct budget_block *own = &b->blocks[i];
        for (size_t row = 0; row < rows_of(&own->from); row++) {
            double least = INFINITY;
            for (uint32_t way = 0; way < ROW_WAYS; way++) {
                const double cost = row_ways[way]->bytes +
                                    price * (double)own->costs[row * ROW_WAYS + way];
                if (cost < least) {
                    least = cost;
                    own->ways[halves][row] = (uint8_t)way;
                }
            }
        }
    }
}

// relMSE of a sum of weighted coefficients, taken as an error of the trial's picture.
static double relmse_of(const struct budget *b, int trial, const float *error) {
    double sum = 0;
    for (size_t i = 0; i < 3 * plane_of(b); i++)
        sum += (double)error[i] * (double)error[i] * (double)b->loss[trial][i];
    return sum;
}

static double measure(struct budget *b, bool halves, double relmse[TRIALS]) {
    double worst = 0;
    float *error[TRIALS];
    for (int t = 0; t < TRIALS; t++)
        error[t] = mem_array(3 * plane_of(b), sizeof *error[t]);
    budget_pictures(b, halves, true, error);
    for (int t = 0; t < TRIALS; t++) {
        relmse[t] = relmse_of(b, t, error[t]);
        worst = fmax(worst, relmse[t]);
        mem_free(error[t]);
    }
    return worst;
}

// Finds the lowest price at which errors are within the budget, and leaves the ways chosen.
static double search(struct budget *b, bool halves, double budget, double relmse[TRIALS]) {
    double low = -INFINITY, high = INFINITY, at = log2(1e6 / budget), worst = 0;
    budget_costs(b, halves);
    for (int step = 0; step < STEPS || (high == INFINITY && step < 8 * STEPS); step++) {
        choose(b, halves, exp2(at));
        worst = measure(b, halves, relmse);
        if (worst <= budget)
            high = at;
        else
            low = at;
        at = high == INFINITY ? low + 4 : low == -INFINITY ? high - 4 : 0.5 * (low + high);
    }
    choose(b, halves, high < INFINITY ? exp2(high) : INFINITY);
    return measure(b, halves, relmse);
}

// The error of the layout of Ben-Artzi 2007: RGBE for all.
static double rgbe_error(struct budget *b) {
    double relmse[TRIALS];
    for (uint32_t i = 0; i < b->tensor->block_count; i++)
        memset(b->blocks[i].ways[0], WAY_row_rgbe, rows_of(&b->blocks[i].from));
    return measure(b, false, relmse);
}

// The noise that the halves tell of, as relMSE; if `changed`, with the halves as they are stored.
static double told_noise(struct budget *b, bool changed, int trial) {
    float *sum[TRIALS];
    for (int t = 0; t < TRIALS; t++)
        sum[t] = mem_array(3 * plane_of(b), sizeof *sum[t]);
    budget_pictures(b, true, false, sum);
    if (changed)
        budget_pictures(b, true, true, sum);
    const double noise = relmse_of(b, trial, sum[trial]);
    for (int t = 0; t < TRIALS; t++)
        mem_free(sum[t]);
    return noise;
}

// ---- writing ------------------------------------------------------------------------------------

// Entries and starts for the ways that were chosen.
static struct tensor_rows lay_out(struct budget *b, const struct budget_block *own, bool halves) {
    const uint32_t n = own->from.coefficients;
    const size_t tiles = tensor_tiles(&own->from);
    uint32_t *entries = arena_alloc(&b->arena, (rows_of(&own->from) + 1) * sizeof *entries);
    uint64_t *starts = arena_alloc(&b->arena, (tiles + 1) * sizeof *starts);
    for (size_t tile = 0; tile < tiles; tile++) {
        uint64_t at = 0;
        for (uint32_t c = 0; c < n; c++) {
            const uint32_t way = own->ways[halves][tile * n + c];
            entries[tile * n + c] = row_entry(way, at);
            at += row_ways[way]->bytes;
        }
        starts[tile + 1] = starts[tile] + (at + ROW_TILE_ALIGN - 1) / ROW_TILE_ALIGN * ROW_TILE_ALIGN;
    }
    return (struct tensor_rows){entries, starts};
}

static struct tensor_block shape_block(struct budget *b, const struct budget_block *own) {
    struct tensor_block out = own->from;
    out.storage = TENSOR_ROWS;
    out.pixels = own->pixels;
    out.view = own->view;
    out.sums = out.views = NULL;
    out.value_rows = lay_out(b, own, false);
    if (out.halves)
        out.half_rows = lay_out(b, own, true);
    return out;
}

static void fill(const struct budget_block *own, const struct tensor_rows *rows, bool halves, char *out) {
    float row[ROW_VALUES];
    for (size_t i = 0; i < rows_of(&own->from); i++) {
        const size_t tile = i / own->from.coefficients;
        budget_gather(own, halves, tile, (uint32_t)(i % own->from.coefficients), row);
        row_ways[own->ways[halves][i]]->encode(
            row, out + rows->starts[tile] + (size_t)(rows->entries[i] >> ROW_WAY_BITS) * ROW_UNIT);
    }
}

static struct json *describe(const struct budget *b, const struct budget_report *r) {
    struct json *meta = json_clone(b->tensor->meta);
    json_add_text(meta, "command", b->options->command);
    json_add_number(meta, "budget relmse", b->options->relmse);
    json_add_number(meta, "storage relmse", r->worst);
    struct json *trials = json_add_object(meta, "storage trials");
    for (int t = 0; t < TRIALS; t++)
        json_add_number(trials, trial_names[t], r->relmse[t]);
    if (r->noise > 0)
        json_add_number(meta, "storage noise change", r->noise_change);
    return meta;
}

// The tensor in the ways that were chosen, without its values and metadata.
static struct tensor shape_tensor(struct budget *b, struct budget_report *r) {
    struct tensor shape = *b->tensor;
    shape.fixed_sums = NULL;
    shape.blocks = arena_alloc(&b->arena, (shape.block_count + 1) * sizeof *shape.blocks);
    for (uint32_t i = 0; i < shape.block_count; i++) {
        shape.blocks[i] = shape_block(b, &b->blocks[i]);
        r->value_bytes += tensor_bytes(&shape.blocks[i]);
        r->bytes += tensor_block_bytes(&shape.blocks[i]);
        r->float_bytes += tensor_value_count(&shape.blocks[i]) * sizeof(float);
    }
    return shape;
}

static bool write_file(struct budget *b, const char *output, struct budget_report *r) {
    struct tensor shape = shape_tensor(b, r);
    struct json *meta = describe(b, r);
    shape.meta = meta;
    struct tensor_writer *w = tensor_create(output, &shape);
    for (uint32_t i = 0; w && i < shape.block_count; i++) {
        fill(&b->blocks[i], &shape.blocks[i].value_rows, false, tensor_values(w, i));
        if (shape.blocks[i].halves)
            fill(&b->blocks[i], &shape.blocks[i].half_rows, true, tensor_halves(w, i));
    }
    if (w && shape.fixed)
        memcpy(tensor_fixed(w), shape.fixed, 3 * plane_of(b) * sizeof(float));
    json_destroy(meta);
    return w && tensor_finish(w);
}

// ---- all ----------------------------------------------------------------------------------------

static void count_rows(const struct budget *b, struct budget_report *r) {
    for (uint32_t i = 0; i < b->tensor->block_count; i++) {
        const struct budget_block *own = &b->blocks[i];
        float row[ROW_VALUES];
        for (size_t k = 0; k < rows_of(&own->from); k++) {
            const size_t tile = k / own->from.coefficients;
            r->rows[own->ways[0][k]]++;
            budget_gather(own, false, tile, (uint32_t)(k % own->from.coefficients), row);
            for (uint64_t l = 0; l < TILE_LANES && tile * TILE_LANES + l < own->from.pixel_count; l++)
                r->nonzero += row[l] != 0 || row[TILE_LANES + l] != 0 || row[2 * TILE_LANES + l] != 0;
        }
    }
}

static bool has_halves(const struct budget *b) {
    bool has = false;
    for (uint32_t i = 0; i < b->tensor->block_count; i++)
        has = has || b->blocks[i].from.halves;
    return has;
}

static void free_blocks(struct budget *b) {
    for (uint32_t i = 0; i < b->tensor->block_count; i++) {
        mem_free(b->blocks[i].unpacked[0]);
        mem_free(b->blocks[i].unpacked[1]);
        mem_free(b->blocks[i].costs);
    }
}

static bool store(struct budget *b, const char *output, struct budget_report *r) {
    if (has_halves(b)) {
        double unused[TRIALS];
        r->noise = told_noise(b, false, 0);
        search(b, true, fmax(NOISE_SHARE * r->noise, 1e-30), unused);
        r->noise_change = r->noise > 0 ? told_noise(b, true, 0) / r->noise - 1 : 0;
    }
    r->rgbe = rgbe_error(b);
    r->worst = search(b, false, b->options->relmse, r->relmse);
    count_rows(b, r);
    return write_file(b, output, r);
}

// The picture of a trial, with what the ways that were chosen change in it.
static void picture(struct budget *b, int trial, float *frame, struct budget_report *r) {
    float *error[TRIALS];
    for (int t = 0; t < TRIALS; t++)
        error[t] = mem_array(3 * plane_of(b), sizeof *error[t]);
    if (b->options->relmse > 0) {
        r->worst = search(b, false, b->options->relmse, r->relmse);
        shape_tensor(b, r);
        budget_pictures(b, false, true, error);
    } else {
        for (uint32_t i = 0; i < b->tensor->block_count; i++)
            r->value_bytes += tensor_bytes(&b->tensor->blocks[i]);
    }
    for (size_t i = 0; i < 3 * plane_of(b); i++)
        frame[i] = b->picture[trial][i] + (float)((double)error[trial][i] / b->unit[trial]);
    for (int t = 0; t < TRIALS; t++)
        mem_free(error[t]);
}

struct opened {
    struct tensor_file *file;
    struct edit_tensor edit;
    struct budget budget;
};

static bool open_budget(struct opened *s, const char *path, const struct budget_options *o) {
    *s = (struct opened){.file = tensor_open(path)};
    s->budget = (struct budget){.tensor = s->file ? tensor_get(s->file) : NULL, .options = o};
    if (!s->file || !tensor_check_values(s->file) ||
        !edit_tensor_init(&s->edit, s->budget.tensor, path))
        return false;
    make_blocks(&s->budget, &s->edit);
    make_trials(&s->budget, &s->edit);
    return true;
}

static void close_budget(struct opened *s) {
    if (s->budget.blocks)
        free_blocks(&s->budget);
    if (s->edit.tensor)
        edit_tensor_finish(&s->edit);
    arena_finish(&s->budget.arena);
    tensor_close(s->file);
}

bool budget_store(const char *path, const char *output, const struct budget_options *o,
                  struct budget_report *report) {
    struct opened s;
    *report = (struct budget_report){0};
    const bool done = open_budget(&s, path, o) && store(&s.budget, output, report);
    close_budget(&s);
    return done;
}

bool budget_picture(const char *path, const struct budget_options *o, int trial, int width, int height,
                    float *frame, struct budget_report *report) {
    struct opened s;
    *report = (struct budget_report){0};
    bool done = open_budget(&s, path, o);
    const struct tensor *t = s.budget.tensor;
    if (done && (t->width != (uint32_t)width || t->height != (uint32_t)height)) {
        log_error("%s: expected a picture of %dx%d, found one of %ux%u", path, width, height, t->width,
                  t->height);
        done = false;
    }
    if (done)
        picture(&s.budget, trial, frame, report);
    close_budget(&s);
    return done;
}
