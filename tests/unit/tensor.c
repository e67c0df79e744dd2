// SPDX-License-Identifier: Apache-2.0
// The tensor file: what was written is read back; what is wrong is refused with a reason.
#include "transport/tensor.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "check.h"

enum { PIXELS = 70, BINS = 3, GROUPS = 2 };

static char path[256], other[256];
static uint32_t pixels[PIXELS];
static const double edges[BINS + 1] = {0, 0.1, 0.5, 1.5};

static void make_shape(struct tensor *t, struct tensor_block blocks[2]) {
    static float view[2 * TENSOR_LANES], some;
    for (uint32_t i = 0; i < PIXELS; i++)
        pixels[i] = 3 * i + 1;
    view[5] = 0.25f;
    blocks[0] = (struct tensor_block){
        .object = "teapot", .term = "specular", .axis_count = 1, .groups = GROUPS,
        .axes = {{"theta_h", TENSOR_BOX, BINS, edges}}, .coefficients = GROUPS * BINS, .channels = 3,
        .pixel_count = PIXELS, .pixels = pixels, .storage = TENSOR_F32, .halves = &some, .view = view};
    blocks[1] = (struct tensor_block){
        .object = "sky", .term = "", .axis_count = 1, .groups = 1,
        .axes = {{"light", TENSOR_BOX, 5, NULL}}, .coefficients = 5, .channels = 3, .pixel_count = 2,
        .pixels = pixels, .storage = TENSOR_BF16};
    *t = (struct tensor){.width = 20, .height = 11, .block_count = 2, .blocks = blocks, .fixed = &some};
}

static size_t value_count(const struct tensor_block *b) {
    return tensor_bytes(b) / tensor_value_size(b->storage);
}

// A process that is killed leaves nothing of a file it had not completed, where files may have no name.
static void leaves_no_trace(void) {
    char directory[256], temp[300];
    file_directory(path, directory, sizeof directory);
    CHECK(file_temp_name(path, temp, sizeof temp));
    const int fd = open(directory, O_TMPFILE | O_RDWR, 0644);
    CHECK(fd < 0 || !file_exists(temp));
    if (fd >= 0)
        close(fd);
}

static void write_file(void) {
    struct tensor t;
    struct tensor_block blocks[2];
    struct json *meta = json_new_object();
    json_add_text(meta, "kind", "edit");
    make_shape(&t, blocks);
    t.meta = meta;
    struct tensor_writer *w = tensor_create(path, &t);
    CHECK(w != NULL);
    float *values = tensor_values(w, 0), *halves = tensor_halves(w, 0);
    for (size_t i = 0; i < value_count(&blocks[0]); i++) {
        values[i] = (float)i;
        halves[i] = -(float)i;
    }
    uint16_t *small = tensor_values(w, 1);
    for (size_t i = 0; i < value_count(&blocks[1]); i++)
        small[i] = bf16_from_float((float)i / 8);
    tensor_fixed(w)[20 * 11 - 1] = 7;
    CHECK(!file_exists(path)); // not before it is whole
    leaves_no_trace();
    CHECK(tensor_finish(w));
    json_destroy(meta);
}

static void reads_what_was_written(void) {
    struct tensor_file *f = tensor_open(path);
    CHECK(f != NULL);
    const struct tensor *t = tensor_get(f);
    const struct tensor_block *a = &t->blocks[0], *b = &t->blocks[1];
    CHECK(t->width == 20 && t->height == 11 && t->block_count == 2);
    CHECK(strcmp(json_text(json_get(t->meta, "kind")), "edit") == 0);
    CHECK(strcmp(a->object, "teapot") == 0 && strcmp(a->term, "specular") == 0);
    CHECK(a->coefficients == GROUPS * BINS && a->groups == GROUPS && a->pixel_count == PIXELS);
    CHECK(strcmp(a->axes[0].name, "theta_h") == 0 && a->axes[0].edges[2] == 0.5);
    CHECK(a->pixels[PIXELS - 1] == 3 * (PIXELS - 1) + 1 && a->view[5] == 0.25f);
    CHECK((uintptr_t)a->values % TENSOR_ALIGN == 0 && (uintptr_t)b->values % TENSOR_ALIGN == 0);
    CHECK(((const float *)a->values)[999] == 999 && ((const float *)a->halves)[999] == -999);
    CHECK(b->storage == TENSOR_BF16 && !b->halves && !b->view && !b->axes[0].edges);
    CHECK(bf16_to_float(((const uint16_t *)b->values)[9]) == 9 / 8.0f);
    CHECK(t->fixed[20 * 11 - 1] == 7 && t->fixed[20 * 11] == 0);
    CHECK(tensor_check_values(f));
    tensor_close(f);
}

// Replaces the first `from` in the file by `to`, of the same length, and tries to open it.
static bool opens_with(const char *from, const char *to) {
    size_t size, n = strlen(from);
    char *data = file_read(path, 0, &size);
    char *at = memmem(data, size, from, n);
    CHECK(at && strlen(to) == n);
    memcpy(at, to, n);
    CHECK(file_write(other, data, size));
    mem_free(data);
    struct tensor_file *f = tensor_open(other);
    tensor_close(f);
    return f != NULL;
}

static void refuses_what_is_wrong(void) {
    size_t size;
    CHECK(opens_with("teapot", "kettle")); // the test can pass
    CHECK(!opens_with("\"0.values\"", "\"0.valuas\""));
    CHECK(!opens_with("\"dtype\": \"U32\"", "\"dtype\": \"F32\""));
    CHECK(!opens_with("\\\"groups\\\": 2", "\\\"groups\\\": 3"));
    CHECK(!opens_with("\\\"pixels\\\": 70", "\\\"pixels\\\": 71"));
    CHECK(!opens_with("\\\"version\\\": 1", "\\\"version\\\": 2"));
    CHECK(!opens_with("\\\"height\\\": 11", "\\\"height\\\": 10")); // then a pixel lies outside
    CHECK(!opens_with("\\\"box\\\"", "\\\"bix\\\""));
    char *data = file_read(path, 0, &size);
    for (size_t cut = 1; cut < size; cut = cut * 3 / 2 + 1) {
        CHECK(file_write(other, data, size - cut));
        struct tensor_file *f = tensor_open(other);
        CHECK(f == NULL);
    }
    mem_free(data);
}

static void sees_values_that_are_not_finite(void) {
    struct tensor t;
    struct tensor_block blocks[2];
    make_shape(&t, blocks);
    struct tensor_writer *w = tensor_create(other, &t);
    ((float *)tensor_halves(w, 0))[77] = NAN;
    CHECK(tensor_finish(w));
    struct tensor_file *f = tensor_open(other);
    CHECK(f && !tensor_check_values(f));
    tensor_close(f);
}

static void rounds_to_bf16(void) {
    int wrong = 0;
    for (uint32_t u = 0; u < 0x7f800000; u += 9973) {
        float f;
        memcpy(&f, &u, sizeof f);
        const float g = bf16_to_float(bf16_from_float(f));
        wrong += isfinite(g) && fabsf(g - f) > fmaxf(fabsf(f) * 0x1p-8f, 0x1p-133f);
    }
    CHECK(wrong == 0);
    CHECK(bf16_from_float(1) == 0x3f80 && isnan(bf16_to_float(bf16_from_float(NAN))));
    CHECK(bf16_to_float(bf16_from_float(-INFINITY)) == -INFINITY);
}

int main(void) {
    const char *folder = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
    snprintf(path, sizeof path, "%s/relume-tensor-%ld.safetensors", folder, (long)getpid());
    snprintf(other, sizeof other, "%s/relume-tensor-%ld-b.safetensors", folder, (long)getpid());
    write_file();
    reads_what_was_written();
    refuses_what_is_wrong();
    sees_values_that_are_not_finite();
    rounds_to_bf16();
    unlink(path);
    unlink(other);
    return check_result();
}
