// SPDX-License-Identifier: Apache-2.0
// Merging, cropping and requantising tensors: pictures of the new one are what they should be.
#include "transport/tensor_remake.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "capture.h"
#include "check.h"
#include "edit_sample.h"

enum { W = SAMPLE_WIDTH, H = SAMPLE_HEIGHT, PLANE = W * H };

static char a[256], b[256], c[256], d[256];

// The picture of a tensor from the definition.
static void picture(const char *path, double *frame) {
    struct edit_tensor e;
    struct tensor_file *f = tensor_open(path);
    CHECK(f && tensor_check_values(f) && edit_tensor_init(&e, tensor_get(f), path));
    sample_truth(&e, frame);
    edit_tensor_finish(&e);
    tensor_close(f);
}

static bool make(struct tensor_remake o, const char *from, const char *and, const char *to,
                 struct tensor_remade *r) {
    const char *const paths[] = {from, and};
    o.paths = paths;
    o.count = and ? 2 : 1;
    o.command = "test";
    return tensor_remake(&o, to, r);
}

static void merging_gives_the_weighted_mean(bool polynomial) {
    static double one[3 * PLANE], two[3 * PLANE], both[3 * PLANE];
    struct tensor_remade r;
    CHECK(sample_write(&(struct sample_options){.polynomial = polynomial}, a));
    CHECK(sample_write(&(struct sample_options){.polynomial = polynomial, .seed = 1}, b));
    CHECK(make((struct tensor_remake){0}, a, b, c, &r) && r.samples == 48);
    picture(a, one);
    picture(b, two);
    picture(c, both);
    double worst = 0;
    for (int i = 0; i < 3 * PLANE; i++)
        worst = fmax(worst, fabs(both[i] - (16 * one[i] + 32 * two[i]) / 48));
    CHECK(worst < 1e-6);
    capture_begin();
    const bool again = make((struct tensor_remake){0}, c, a, d, &r);
    capture_end();
    CHECK(!again && captured_has("seed"));
    CHECK(access(d, F_OK) != 0);
}

// A lane of a block in the lists of two tensors.
static void halves_merge_too(void) {
    struct tensor_file *f[3] = {tensor_open(a), tensor_open(b), tensor_open(c)};
    const struct tensor_block *x = &tensor_get(f[0])->blocks[0], *y = &tensor_get(f[1])->blocks[0],
                              *z = &tensor_get(f[2])->blocks[0];
    CHECK(x->pixel_count == z->pixel_count && memcmp(x->pixels, z->pixels, 400) == 0);
    const float *p = x->halves, *q = y->halves, *r = z->halves;
    int wrong = 0;
    for (size_t i = 0; i < tensor_bytes(z) / 4; i++)
        wrong += r[i] != (float)(16.0 / 48 * (double)p[i] + 32.0 / 48 * (double)q[i]);
    CHECK(wrong == 0);
    CHECK(tensor_get(f[2])->blocks[1].pixel_count == 2 * 83);
    for (int i = 0; i < 3; i++)
        tensor_close(f[i]);
}

static void cropping_cuts_the_picture(void) {
    static double whole[3 * PLANE], part[3 * PLANE];
    struct tensor_remade r;
    CHECK(make((struct tensor_remake){.crop = {3, 2, 14, 11}}, a, NULL, c, &r));
    picture(a, whole);
    struct edit_tensor e;
    struct tensor_file *f = tensor_open(c);
    CHECK(f && tensor_get(f)->width == 11 && tensor_get(f)->height == 9 &&
          edit_tensor_init(&e, tensor_get(f), c));
    // sample_truth lays planes out for the whole picture
    memset(part, 0, sizeof part);
    double worst = 0;
    struct tensor t = *tensor_get(f);
    float *fixed = calloc(3 * PLANE, sizeof *fixed);
    t.fixed = fixed;
    e.tensor = &t;
    sample_truth(&e, part);
    for (int k = 0; k < 3; k++)
        for (int y = 0; y < 9; y++)
            for (int x = 0; x < 11; x++) {
                const double f0 = (double)tensor_get(f)->fixed[(k * 9 + y) * 11 + x];
                worst = fmax(worst, fabs(part[k * PLANE + y * 11 + x] + f0 -
                                         whole[k * PLANE + (y + 2) * W + x + 3]));
            }
    CHECK(worst < 1e-12);
    free(fixed);
    edit_tensor_finish(&e);
    tensor_close(f);
    capture_begin();
    CHECK(!make((struct tensor_remake){.crop = {3, 2, W + 1, 11}}, a, NULL, d, &r));
    CHECK(!make((struct tensor_remake){.crop = {3, 2, 3, 11}}, a, NULL, d, &r));
    capture_end();
}

static void requantising_rounds(void) {
    static double fine[3 * PLANE], coarse[3 * PLANE];
    struct tensor_remade r;
    const struct tensor_remake half = {.new_storage = true, .storage = TENSOR_BF16};
    CHECK(make(half, a, NULL, c, &r) && r.worst > 1e-4 && r.worst <= 0x1p-8);
    picture(a, fine);
    picture(c, coarse);
    double worst = 0, most = 0;
    for (int i = 0; i < 3 * PLANE; i++) {
        worst = fmax(worst, fabs(coarse[i] - fine[i]));
        most = fmax(most, fabs(fine[i]));
    }
    printf("16 bits change the picture by at most %.1e of its brightest pixel\n", worst / most);
    CHECK(worst > 0 && worst < most / 256);
    CHECK(make((struct tensor_remake){.new_storage = true}, c, NULL, d, &r) && r.worst == 0);
    picture(d, fine);
    CHECK(memcmp(fine, coarse, sizeof fine) == 0);
}

// Pixels without light leave the list, and nothing changes.
static void zeros_are_dropped(void) {
    static double before[3 * PLANE], after[3 * PLANE];
    struct tensor_remade r;
    struct arena arena = {0};
    const struct sample_options o = {.bins = 4};
    const struct tensor t = sample_make(&o, &arena);
    struct tensor_writer *w = tensor_create(c, &t);
    float *values = tensor_values(w, 0);
    for (size_t i = 0; i < tensor_bytes(&t.blocks[0]) / 4; i++) // the first tile's lanes from 10 on
        values[i] = i / TENSOR_LANES < 3 * t.blocks[0].coefficients && i % TENSOR_LANES < 10;
    CHECK(tensor_finish(w));
    CHECK(make((struct tensor_remake){.drop_zeros = true}, c, NULL, d, &r));
    CHECK(r.pixels == 10); // the other blocks have none
    picture(c, before);
    picture(d, after);
    CHECK(memcmp(before, after, sizeof before) == 0);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

static void strangers_are_refused(void) {
    struct tensor_remade r;
    CHECK(sample_write(&(struct sample_options){.bins = 16, .seed = 3}, c));
    capture_begin();
    const bool done = make((struct tensor_remake){0}, a, c, d, &r);
    capture_end();
    CHECK(!done && captured_has("not of the same scene"));
}

int main(void) {
    const char *folder = getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp";
    char *const names[] = {a, b, c, d};
    for (int i = 0; i < 4; i++)
        snprintf(names[i], sizeof a, "%s/relume-remake-%ld-%d.safetensors", folder, (long)getpid(), i);
    merging_gives_the_weighted_mean(true);
    merging_gives_the_weighted_mean(false);
    halves_merge_too();
    cropping_cuts_the_picture();
    requantising_rounds();
    zeros_are_dropped();
    strangers_are_refused();
    for (int i = 0; i < 4; i++)
        unlink(names[i]);
    return check_result();
}
