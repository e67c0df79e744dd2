// SPDX-License-Identifier: Apache-2.0
// EXR files come back as they were written: bits, names, attributes, windows.
#include "check.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "image/image.h"
#include "math/hash.h"

static const char *const path = "exr_test.exr";

// Every kind of float: random bits, among them NaN, infinities and subnormals.
static void fill_random(struct image *im) {
    const size_t n = (size_t)im->width * im->height * im->channels;
    for (size_t i = 0; i < n; i++) {
        const uint32_t bits = (uint32_t)hash_u64(i);
        memcpy(&im->pixels[i], &bits, sizeof bits);
    }
    const float special[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-45f, 3.4e38f};
    for (size_t i = 0; i < sizeof special / sizeof *special && i < n; i++)
        im->pixels[i] = special[i];
}

// Values of different bits, channels matched by name; all of them if sizes or names differ.
static size_t differing_bits(const struct image *a, const struct image *b) {
    const size_t n = (size_t)a->width * a->height;
    if (a->width != b->width || a->height != b->height || a->channels != b->channels)
        return n * a->channels;
    size_t count = 0;
    for (int c = 0; c < a->channels; c++) {
        const int d = image_find_channel(b, a->channel_names[c]);
        for (size_t p = 0; p < n; p++)
            count += d < 0 || memcmp(&a->pixels[p * a->channels + c],
                                     &b->pixels[p * a->channels + d], sizeof(float)) != 0;
    }
    return count;
}

static void float_round_trip_is_bit_exact(int width, int height, int channels, int threads) {
    struct image im, back;
    CHECK(image_init(&im, width, height, channels));
    fill_random(&im);
    CHECK(image_write_exr(path, &im, &(struct image_exr_options){.threads = threads}));
    CHECK(image_read(path, &back));
    CHECK(back.bits == 32 && !back.srgb_encoded && back.full_width == 0);
    CHECK(differing_bits(&im, &back) == 0);
    image_finish(&im);
    image_finish(&back);
}

// Where an image without pixels has them from, and how often each row was asked for.
struct rows_of {
    const struct image *im;
    atomic_int *asked;
};

static void make_rows(const void *self, int y, int rows, float *pixels) {
    const struct rows_of *r = self;
    const size_t line = (size_t)r->im->width * (size_t)r->im->channels;
    for (int i = 0; i < rows; i++)
        r->asked[y + i]++;
    memcpy(pixels, r->im->pixels + (size_t)y * line, (size_t)rows * line * sizeof *pixels);
}

// Pixels that are made while they are written give the file that they give in one piece, values that
// no float or half holds counted in it: on few and many threads, with more and less than a batch of
// chunks, the last of them short or not.
static void rows_give_the_same_file(int width, int height, int channels, int threads) {
    struct image im, head;
    size_t size[2];
    char *file[2];
    uint64_t counts[2][2];
    CHECK(image_init(&im, width, height, channels));
    CHECK(image_init_head(&head, width, height, channels) && !head.pixels);
    fill_random(&im);
    im.full_width = head.full_width = width + 7;
    im.full_height = head.full_height = height + 5;
    im.crop_x = head.crop_x = 7;
    im.crop_y = head.crop_y = 3;
    const struct rows_of rows = {&im, mem_array((size_t)height, sizeof *rows.asked)};
    for (int i = 0; i < 2; i++) {
        CHECK(image_write_exr(path, i ? &head : &im,
                              &(struct image_exr_options){.threads = threads, .half = channels == 2,
                                                          .overflows = &counts[i][0],
                                                          .half_overflows = &counts[i][1],
                                                          .rows = {make_rows, &rows}}));
        file[i] = file_read(path, 0, &size[i]);
    }
    for (int y = 0; y < height; y++)
        CHECK(rows.asked[y] == 1);
    CHECK(size[0] == size[1] && memcmp(file[0], file[1], size[0]) == 0);
    CHECK(counts[0][0] > 0 && (counts[0][1] > 0) == (channels == 2));
    CHECK(memcmp(counts[0], counts[1], sizeof counts[0]) == 0);
    mem_free(file[0]);
    mem_free(file[1]);
    mem_free(rows.asked);
    image_finish(&head);
    image_finish(&im);
}

static void many_layers_keep_their_names(void) {
    struct image im, back;
    CHECK(image_init(&im, 33, 47, 200));
    fill_random(&im);
    for (int c = 0; c < im.channels; c++)
        snprintf(im.channel_names[c], IMAGE_NAME_SIZE, "%055d.%s", 7 * c % 200,
                 c % 3 == 0 ? "R" : c % 3 == 1 ? "luminan" : "Z");
    CHECK(strlen(im.channel_names[1]) == IMAGE_NAME_SIZE - 1);
    CHECK(image_write_exr(path, &im, NULL) && image_read(path, &back));
    CHECK(differing_bits(&im, &back) == 0);
    image_finish(&im);
    image_finish(&back);
}

static void colours_come_before_other_channels(void) {
    static const char *const names[] = {"Z", "albedo.B", "A", "albedo.G", "R", "B", "albedo.R", "G"};
    static const char *const sorted[] = {"R", "G", "B", "A", "Z", "albedo.R", "albedo.G",
                                         "albedo.B"};
    struct image im, back;
    CHECK(image_init(&im, 2, 1, 8));
    for (int c = 0; c < 8; c++) {
        snprintf(im.channel_names[c], IMAGE_NAME_SIZE, "%s", names[c]);
        im.pixels[c] = (float)names[c][strlen(names[c]) - 1];
    }
    CHECK(image_write_exr(path, &im, NULL) && image_read(path, &back));
    for (int c = 0; c < 8; c++) {
        CHECK(strcmp(back.channel_names[c], sorted[c]) == 0);
        CHECK(back.pixels[c] == (float)sorted[c][strlen(sorted[c]) - 1]);
    }
    struct image rgb;
    CHECK(image_layer_to_rgb(&back, "albedo", path, &rgb));
    CHECK(rgb.pixels[0] == 'R' && rgb.pixels[1] == 'G' && rgb.pixels[2] == 'B');
    image_finish(&rgb);
    CHECK(image_layer_to_rgb(&back, "Z", path, &rgb) && rgb.pixels[1] == 'Z');
    image_finish(&rgb);
    CHECK(!image_layer_to_rgb(&back, "nothing", path, &rgb));
    image_finish(&im);
    image_finish(&back);
}

static void attributes_and_windows_return(void) {
    struct image im, back;
    CHECK(image_init(&im, 5, 4, 3));
    image_set_text(&im, "command", "relume render 'a b.xml' -o out.exr");
    image_set_text(&im, "empty", "");
    image_set_number(&im, "seconds", 12.000000001);
    image_set_number(&im, "seconds", 0.1);
    image_set_text(&im, "a_name_that_is_longer_than_thirty_one_characters",
                   "long");
    image_set_text(&im, "file.format", "must not be written");
    im.full_width = 20;
    im.full_height = 10;
    im.crop_x = 3;
    im.crop_y = 2;
    CHECK(image_write_exr(path, &im, NULL) && image_read(path, &back));
    const struct image_attribute *a = image_find_attribute(&back, "command");
    CHECK(a && a->text && strcmp(a->text, "relume render 'a b.xml' -o out.exr") == 0);
    a = image_find_attribute(&back, "seconds");
    CHECK(a && !a->text && a->number == 0.1);
    a = image_find_attribute(&back, "empty");
    CHECK(a && a->text && !a->text[0]);
    CHECK(image_find_attribute(
        &back, "a_name_that_is_longer_than_thirty_one_characters"));
    CHECK(!image_find_attribute(&back, "file.format"));
    CHECK(image_find_attribute(&back, "file.part 1"));
    CHECK(back.full_width == 20 && back.full_height == 10 && back.crop_x == 3 && back.crop_y == 2);
    image_finish(&im);
    image_finish(&back);
}

static void half_rounds_and_counts_overflow(void) {
    struct image im, back;
    uint64_t overflows = 99, infinite = 99;
    const float in[] = {1, 65504, 65519.9f, 65520, -1e30f, INFINITY, 1 + 0x1p-11f, 0x1p-24f, NAN};
    const float out[] = {1,         65504,    65504, INFINITY, -INFINITY,
                         INFINITY, 1,        0x1p-24f};
    CHECK(image_init(&im, 9, 1, 1));
    memcpy(im.pixels, in, sizeof in);
    CHECK(image_write_exr(path, &im,
                          &(struct image_exr_options){.half = true, .half_overflows = &overflows,
                                                      .overflows = &infinite}));
    CHECK(overflows == 2 && infinite == 2);
    CHECK(image_read(path, &back) && back.bits == 16);
    for (int i = 0; i < 8; i++)
        CHECK(back.pixels[i] == out[i]);
    CHECK(isnan(back.pixels[8]));
    image_finish(&im);
    image_finish(&back);
}

// 2049 is the first whole number that a half rounds.
static void half_keeps_numbers_that_name_objects(void) {
    static const char *const names[] = {"Crypto00.R", "instance.Y", "shape.Y", "shape.Z"};
    struct image im, back;
    CHECK(image_init(&im, 1, 1, 4));
    for (int c = 0; c < 4; c++) {
        snprintf(im.channel_names[c], IMAGE_NAME_SIZE, "%s", names[c]);
        im.pixels[c] = 2049;
    }
    CHECK(image_write_exr(path, &im, &(struct image_exr_options){.half = true}));
    CHECK(image_read(path, &back));
    for (int c = 0; c < 4; c++)
        CHECK(back.pixels[image_find_channel(&back, names[c])] == (c < 3 ? 2049 : 2048));
    image_finish(&im);
    image_finish(&back);
}

static void refusals_leave_the_old_file(void) {
    struct image im, back;
    CHECK(image_init(&im, 3, 3, 2));
    CHECK(image_write_exr(path, &im, NULL));
    strcpy(im.channel_names[1], im.channel_names[0]);
    CHECK(!image_write_exr(path, &im, NULL));
    CHECK(!image_write_exr("no/such/folder/a.exr", &im, NULL));
    CHECK(image_read(path, &back) && back.channels == 2);
    image_finish(&back);
    CHECK(!image_read("no_such_file.exr", &back) && !back.pixels);
    CHECK(file_write("not.exr", "hello", 5) && !image_read("not.exr", &back));
    unlink("not.exr");
    image_finish(&im);
}

// A file cut anywhere is refused: never read as a picture with holes.
static void truncated_files_are_refused(void) {
    struct image im, back;
    size_t size = 0;
    CHECK(image_init(&im, 64, 64, 3));
    fill_random(&im);
    CHECK(image_write_exr(path, &im, NULL));
    char *data = file_read(path, 0, &size);
    CHECK(data != NULL);
    for (size_t n = 0; n < size; n += size / 15) {
        CHECK(file_write("cut.exr", data, n));
        CHECK(!image_read("cut.exr", &back));
    }
    unlink("cut.exr");
    mem_free(data);
    image_finish(&im);
}

// No more than a few bytes may be written, as on a disk that is full: it fails at every place of the
// file, whole or by rows, ends (OpenEXRCore holds a lock while it tells of some errors), and leaves what was there.
static void failed_writes_end(void) {
    struct image im, head, back;
    struct rlimit before, limit;
    size_t size = 0;
    CHECK(image_init(&im, 150, 100, 3) && image_init_head(&head, 150, 100, 3));
    const struct rows_of rows = {&im, mem_array(100, sizeof *rows.asked)};
    const struct image_exr_options options = {.rows = {make_rows, &rows}};
    fill_random(&im);
    CHECK(image_write_exr(path, &im, NULL));
    mem_free(file_read(path, 0, &size));
    CHECK(getrlimit(RLIMIT_FSIZE, &before) == 0);
    signal(SIGXFSZ, SIG_IGN);
    alarm(60);
    for (size_t i = 0; i < 16; i++) {
        limit = before;
        limit.rlim_cur = i < 8 ? 60 * i : (i - 8) * size / 8;
        CHECK(setrlimit(RLIMIT_FSIZE, &limit) == 0);
        CHECK(!image_write_exr(path, i % 2 ? &head : &im, &options));
    }
    alarm(0);
    CHECK(setrlimit(RLIMIT_FSIZE, &before) == 0);
    CHECK(image_read(path, &back) && differing_bits(&im, &back) == 0);
    mem_free(rows.asked);
    image_finish(&head);
    image_finish(&im);
    image_finish(&back);
}

int main(void) {
    float_round_trip_is_bit_exact(1, 1, 1, 1);
    float_round_trip_is_bit_exact(1, 1, 4, 2);
    float_round_trip_is_bit_exact(17, 1, 3, 1);
    float_round_trip_is_bit_exact(1, 97, 2, 3);
    float_round_trip_is_bit_exact(123, 777, 3, 4);
    float_round_trip_is_bit_exact(640, 1025, 4, 8);
    rows_give_the_same_file(123, 1, 2, 1);
    rows_give_the_same_file(65, 16, 3, 8);
    rows_give_the_same_file(20, 777, 2, 1);
    rows_give_the_same_file(9, 1025, 40, 3);
    many_layers_keep_their_names();
    colours_come_before_other_channels();
    attributes_and_windows_return();
    half_rounds_and_counts_overflow();
    half_keeps_numbers_that_name_objects();
    refusals_leave_the_old_file();
    truncated_files_are_refused();
    failed_writes_end();
    unlink(path);
    return check_result();
}
