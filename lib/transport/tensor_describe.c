// SPDX-License-Identifier: Apache-2.0
#include <string.h>

#include "transport/tensor_remake.h"

// How many rows are stored in each way.
static void describe_rows(const struct tensor_block *b, struct json *j) {
    int64_t counts[1 << ROW_WAY_BITS] = {0};
    for (uint64_t i = 0; i < tensor_tiles(b) * b->coefficients; i++)
        counts[row_way_of(b->value_rows.entries[i])]++;
    for (int way = 0; way < ROW_WAYS; way++)
        if (counts[way])
            json_add_count(j, row_ways[way]->name, counts[way]);
}

static void describe_block(const struct tensor_block *b, struct json *j) {
    json_add_text(j, "object", b->object);
    json_add_text(j, "term", b->term);
    json_add_count(j, "pixels", (int64_t)b->pixel_count);
    json_add_count(j, "groups", b->groups);
    for (uint32_t i = 0; i < b->axis_count; i++)
        json_add_count(j, b->axes[i].name, b->axes[i].bins);
    json_add_count(j, "coefficients", b->coefficients);
    json_add_text(j, "storage", b->storage == TENSOR_ROWS ? "rows"
                               : b->storage == TENSOR_BF16 ? "bf16" : "f32");
    if (b->storage == TENSOR_ROWS)
        describe_rows(b, json_add_object(j, "rows"));
    json_add_bool(j, "halves", b->halves != NULL);
    if (b->sums)
        json_add_bool(j, "sums", true);
    json_add_count(j, "bytes", (int64_t)tensor_bytes(b));
}

// What a relighting tensor's coefficients are of.
static void describe_basis(const struct json *basis, struct json *out) {
    struct json *j = json_add_object(out, "basis"), *names;
    json_add_text(j, "type", json_text(json_get(basis, "type")));
    static const char *const sizes[] = {"width", "height", "order"};
    int64_t size;
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (json_read_integer(json_get(basis, sizes[i]), &size))
            json_add_count(j, sizes[i], size);
    const struct json *lights = json_get(basis, "lights");
    if (!lights)
        return;
    names = json_add_array(j, "lights");
    for (size_t i = 0; i < json_count(lights); i++)
        json_append_text(names, json_text(json_at(lights, i)));
}

void tensor_describe(const struct tensor *t, struct json *out) {
    json_add_count(out, "width", t->width);
    json_add_count(out, "height", t->height);
    for (size_t i = 0; i < json_count(t->meta); i++) {
        const char *key = json_key(t->meta, i), *text = json_text(json_get(t->meta, key));
        double number;
        if (text)
            json_add_text(out, key, text);
        else if (strcmp(key, "width") != 0 && strcmp(key, "height") != 0 &&
                 json_read_number(json_get(t->meta, key), &number))
            json_add_number(out, key, number);
    }
    if (json_get(t->meta, "basis"))
        describe_basis(json_get(t->meta, "basis"), out);
    json_add_bool(out, "fixed", t->fixed != NULL);
    struct json *blocks = json_add_array(out, "blocks");
    for (uint32_t i = 0; i < t->block_count; i++)
        describe_block(&t->blocks[i], json_append_object(blocks));
}
