// SPDX-License-Identifier: Apache-2.0
// A decoder that crashes, eats memory, fails or lies harms nobody: one message that names the file.
#include "check.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/thread.h"
#include "capture.h"
#include "decoder_death.h"
#include "image/decode.h"
#include "memory_limit.h"

static const char *const path = "decode_test.bin";

static bool paint(struct decoder_input *in, struct image *im) {
    if (!decoder_init_image(in, im, 3, 2, 1))
        return false;
    for (int i = 0; i < 6; i++)
        im->pixels[i] = (float)i;
    image_set_text(im, "note", "hand-painted");
    image_set_number(im, "number", 42);
    im->bits = 8;
    im->srgb_encoded = true;
    return true;
}

static bool crash(struct decoder_input *in, struct image *im) {
    (void)in;
    (void)im;
    raise(SIGSEGV);
    return true;
}

static bool give_up(struct decoder_input *in, struct image *im) {
    (void)im;
    fprintf(stderr, "noise that nobody wants\n");
    return decoder_fail(in, "line %d\nis \xff wrong\n", 7);
}

static bool claim_much(struct decoder_input *in, struct image *im) {
    return decoder_init_image(in, im, 1 << 20, 1 << 20, 4);
}

static bool take_much(struct decoder_input *in, struct image *im) {
    (void)im;
    for (int i = 0; i < 64; i++) {                          // 4 GiB, touched
        char *volatile kept = malloc((size_t)64 << 20), *p = kept; // or clang would leave it out
        if (!p)
            return decoder_fail(in, "memory ran out");
        memset(p, i, (size_t)64 << 20);
    }
    return decoder_fail(in, "nobody stopped me");
}

static bool leave(struct decoder_input *in, struct image *im) {
    (void)in;
    (void)im;
    _exit(0);
}

static bool lack(struct decoder_input *in, struct image *im) {
    (void)im;
    in->unsupported = true;
    return decoder_fail(in, "not yet implemented");
}

static void refuses(image_decoder decode, image_decoder fallback, const char *words) {
    struct image im = {0};
    capture_begin();
    const bool ok = image_decode_in_child(path, decode, fallback, &im);
    capture_end();
    CHECK(!ok && !im.pixels);
    CHECK(captured_has(path) && captured_has(words));
    CHECK(strchr(captured, '\n') == strrchr(captured, '\n'));
}

static void a_picture_comes_through_whole(image_decoder decode, image_decoder fallback) {
    struct image im = {0};
    CHECK(image_decode_in_child(path, decode, fallback, &im));
    CHECK(im.width == 3 && im.height == 2 && im.channels == 1 && im.bits == 8 && im.srgb_encoded);
    CHECK(im.pixels && im.pixels[5] == 5);
    const struct image_attribute *a = image_find_attribute(&im, "note");
    CHECK(a && a->text && strcmp(a->text, "hand-painted") == 0);
    a = image_find_attribute(&im, "number");
    CHECK(a && a->number == 42);
    image_finish(&im);
}

struct many {
    int bad[64];
};

static void decode_one(void *ctx, size_t item, int worker) {
    struct many *m = ctx;
    struct image im = {0};
    (void)worker;
    void *volatile noise = malloc(1000 + item); // allocators of forking threads are busy
    m->bad[item] = !image_decode_in_child(path, paint, NULL, &im) || im.pixels[4] != 4;
    free(noise);
    image_finish(&im);
}

static void many_threads_decode_at_once(void) {
    struct many m = {{0}};
    int bad = 0;
    // AddressSanitizer's allocator does not survive a fork while another thread is in it.
    thread_for(ADDRESS_SANITIZER ? 1 : 8, 64, decode_one, &m);
    for (int i = 0; i < 64; i++)
        bad += m.bad[i];
    CHECK(bad == 0);
}

int main(void) {
    CHECK(file_write(path, "12345", 5));
    a_picture_comes_through_whole(paint, NULL);
    a_picture_comes_through_whole(lack, paint);
    refuses(crash, NULL, "damaged");
    CHECK(decoder_died(captured));
    refuses(give_up, NULL, "line 7 is ? wrong");
    CHECK(!decoder_died(captured));
    refuses(claim_much, NULL, "may take at most 768 MiB");
    refuses(leave, NULL, "ended early");
    CHECK(decoder_died(captured));
    refuses(lack, NULL, "not yet implemented");
    refuses(lack, give_up, "line 7");
    if (!ADDRESS_SANITIZER)
        refuses(take_much, NULL, "memory ran out");
    many_threads_decode_at_once();
    unlink(path);
    struct image im;
    CHECK(!image_read(".", &im) && !image_read("", &im) && !image_read("/dev/null", &im));
    return check_result();
}
