// SPDX-License-Identifier: Apache-2.0
// Editing sessions over tensors of random numbers: every way to a picture gives the one that the
// definition gives, with a device and without, with focus and without, whatever was edited before.
#include "replay/edit.h"

#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "capture.h"
#include "check.h"
#include "edit_sample.h"
#include "math/hash.h"
#include "replay/edit_focus.h"

enum { PIXELS = SAMPLE_WIDTH * SAMPLE_HEIGHT };

// The largest distance of a picture from the definition, over its brightest pixel.
static double distance(struct edit *e, const float *frame) {
    static double truth[3 * PIXELS];
    double worst = 0, most = 0;
    sample_truth(edit_objects(e), truth);
    for (int i = 0; i < 3 * PIXELS; i++) {
        worst = fmax(worst, fabs((double)frame[i] - truth[i]));
        most = fmax(most, fabs(truth[i]));
    }
    return worst / most;
}

static const char *const operators[] = {
    "cup.specular.f_A:amplify-y,0,5,10,20,1.5", "cup.diffuse.f_o:amplify-y,20,30,50,60,0.5",
    "pot.lid.specular.f_A:translate-y,10,20,30,40,0.2", "pot.lid.specular.f_B.g:amplify-y,0,0,90,90,0.7",
    "cup.diffuse.f_A.rb:translate-y,0,10,40,50,0.3",
};
static const char *const numbers[] = {
    "cup.exponent=12", "cup.specular.exponent=300", "pot.lid.exponent_v=7", "cup.diffuse=0.4,0.1,0",
    "pot.lid.reflectance=0.3", "cup.specular.scale=2", "pot.lid.specular.exponent=33",
};

static void change(struct edit *e, struct rng *r) {
    enum { OPERATORS = sizeof operators / sizeof *operators,
           NUMBERS = sizeof numbers / sizeof *numbers };
    const uint32_t which = rng_u32(r) % (OPERATORS + NUMBERS + 1);
    if (which < OPERATORS)
        CHECK(edit_change(e, EDIT_OPERATE, operators[which], "test"));
    else if (which < OPERATORS + NUMBERS)
        CHECK(edit_change(e, EDIT_SET, numbers[which - OPERATORS], "test"));
    else
        CHECK(edit_change(e, EDIT_RESET, "cup", "test"));
}

// The same edits in sessions of different kinds; A9: switching back and forth, A16: freezing.
static void all_ways_agree(const struct sample_options *o, const char *what) {
    static const struct edit_settings ways[] = {
        {.no_device = true, .threads = 2}, {.threads = 2}, {.threads = 2, .most_memory = 100000},
        {.no_device = true, .threads = 2, .focus = true}, {.threads = 2, .focus = true},
        {.threads = 2, .focus = true, .terms = 1000},
    };
    enum { WAYS = sizeof ways / sizeof *ways, EDITS = 30 };
    struct arena arena = {0};
    const struct tensor t = sample_make(o, &arena);
    struct edit *e[WAYS];
    static float frame[WAYS][3 * PIXELS];
    double worst = 0;
    int different = 0;
    for (int w = 0; w < WAYS; w++)
        CHECK((e[w] = edit_create(&t, "test", &ways[w])) != NULL);
    for (int i = 0; i < EDITS; i++) {
        for (int w = 0; w < WAYS; w++) {
            struct rng same = {(uint64_t)(100 + i)};
            if (i > 0)
                change(e[w], &same);
            if (i % 7 == 6)
                change(e[w], &same); // two changes: a focus on one curve or on two, or none
            CHECK((ways[w].terms ? edit_settle(e[w], frame[w]) : edit_frame(e[w], frame[w])) &&
                  edit_is_exact(e[w]));
            worst = fmax(worst, distance(e[w], frame[w]));
        }
        different += memcmp(frame[0], frame[1], sizeof frame[0]) != 0;
        different += memcmp(frame[0], frame[2], sizeof frame[0]) != 0;
        different += memcmp(frame[3], frame[4], sizeof frame[0]) != 0;
    }
    printf("%s: %d edits, %d ways: within %.1e of the definition\n", what, EDITS, WAYS, worst);
    CHECK(worst < 1e-5);
    CHECK(different == 0); // device and twin
    for (int w = 0; w < WAYS; w++)
        edit_destroy(e[w]);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

// An albedo of 0 and back: nothing was divided by it.
static void black_comes_back(void) {
    const struct sample_options o = {.polynomial = true};
    struct arena arena = {0};
    const struct tensor t = sample_make(&o, &arena);
    struct edit *e = edit_create(&t, "test", &(struct edit_settings){.no_device = true, .focus = true});
    static float before[3 * PIXELS], after[3 * PIXELS];
    CHECK(edit_change(e, EDIT_OPERATE, "cup.specular.f_A:amplify-y,0,0,90,90,1", "test"));
    CHECK(edit_frame(e, before));
    CHECK(edit_change(e, EDIT_SET, "cup.specular.scale=0", "test") &&
          edit_change(e, EDIT_SET, "cup.diffuse=0", "test") && edit_frame(e, after));
    CHECK(distance(e, after) < 1e-5);
    CHECK(edit_change(e, EDIT_RESET, "cup", "test") && edit_frame(e, after));
    double worst = 0;
    for (int i = 0; i < 3 * PIXELS; i++)
        worst = fmax(worst, fabs((double)before[i] - (double)after[i]));
    CHECK(worst < 1e-5);
    edit_destroy(e);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

// A12: 256 boxes and 30 terms a frame.
static void updates_follow(void) {
    const struct sample_options o = {.bins = 256};
    struct arena arena = {0};
    const struct tensor t = sample_make(&o, &arena);
    struct edit *e = edit_create(&t, "test", &(struct edit_settings){.no_device = true, .focus = true,
                                                                    .terms = 30});
    static float frame[3 * PIXELS];
    CHECK(edit_change(e, EDIT_OPERATE, "cup.specular.f_A:amplify-y,0,0,90,90,1", "test") &&
          edit_frame(e, frame));
    // 4 bins of 90/255 degrees
    CHECK(edit_change(e, EDIT_OPERATE, "cup.specular.f_A:translate-y,10,10.4,10.7,11.1,0.5", "test") &&
          edit_frame(e, frame));
    printf("an edit of few bins: %llu coefficients, within %.1e\n",
           (unsigned long long)edit_last_cost(e).coefficients, distance(e, frame));
    CHECK(edit_is_exact(e) && distance(e, frame) < 1e-5);
    CHECK(edit_change(e, EDIT_SET, "cup.exponent=3", "test"));
    int frames = 0;
    do
        CHECK(edit_frame(e, frame));
    while (++frames < 20 && !edit_is_exact(e));
    printf("an edit of the whole curve: %d frames\n", frames);
    CHECK(frames <= 9 && distance(e, frame) < 1e-5);
    // Pictures drift, and are made anew when changes pause.
    const int edits = getenv("RELUME_TEST_FULL") ? 100000 : 2000;
    struct rng r = {5};
    double drift = 0;
    for (int i = 0; i < edits; i++) {
        char text[100];
        const double a = 80 * (double)rng_float(&r);
        snprintf(text, sizeof text, "cup.specular.f_A:amplify-y,%g,%g,%g,%g,%g", a, a + 1, a + 5,
                 a + 8, 0.6 + 0.8 * (double)rng_float(&r));
        if (i % 50 == 49)
            CHECK(edit_change(e, EDIT_RESET, "cup", "test"));
        CHECK(edit_change(e, EDIT_OPERATE, text, "test") && edit_frame(e, frame));
        if (i % 500 == 499) {
            while (!edit_is_exact(e))
                CHECK(edit_frame(e, frame));
            drift = fmax(drift, distance(e, frame));
        }
    }
    CHECK(edit_frame(e, frame)); // nothing changed: made anew
    printf("%d edits: drift %.1e, made anew %.1e of the brightest pixel\n", edits, drift,
           distance(e, frame));
    CHECK(drift < 0.5 / 255 && distance(e, frame) < 1e-6);
    edit_destroy(e);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

// What freezing leaves is as little as it can be.
static void freezing_leaves_little(void) {
    const struct sample_options o = {.polynomial = true};
    struct arena arena = {0};
    const struct tensor t = sample_make(&o, &arena);
    struct edit_tensor e;
    struct edit_focus f;
    CHECK(edit_tensor_init(&e, &t, "test"));
    edit_focus_init(&f, &e, &(struct focus_curve){0, 1}, 1); // pot.lid, f_B
    // 1, d, D, d^2, dD: D is a sum that the object has a part in
    CHECK(f.power_count == 5 && f.powers[0].count == 0 && f.powers[3].count == 2);
    CHECK(edit_focus_coefficients(&f, &e, 0) == 5 * 8 && edit_focus_axes(&f, &e, 0) == 2);
    CHECK(edit_focus_coefficients(&f, &e, 1) == 5 && edit_focus_coefficients(&f, &e, 3) == 5);
    edit_focus_finish(&f);
    edit_focus_init(&f, &e, &(struct focus_curve){1, EDIT_NOTHING}, 1);
    CHECK(f.power_count == 3 && edit_focus_coefficients(&f, &e, 0) == 3); // 1, D, and D times another
    edit_focus_finish(&f);
    edit_tensor_finish(&e);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

// Two objects between frames, or in turn: the focus is on both, and does not move to and fro.
static void two_objects_are_unfrozen(void) {
    static const char *const both[] = {"cup.specular.f_A:amplify-y,0,0,90,90,1.1",
                                       "pot.lid.specular.f_A:amplify-y,0,0,90,90,0.9"};
    const struct sample_options o = {.polynomial = true};
    struct arena arena = {0};
    const struct tensor t = sample_make(&o, &arena);
    static float frame[3 * PIXELS];
    for (int in_turn = 0; in_turn < 2; in_turn++) {
        struct edit *e = edit_create(&t, "test", &(struct edit_settings){.no_device = true, .focus = true});
        CHECK(edit_frame(e, frame));
        const uint64_t whole = edit_last_cost(e).coefficients;
        double moved = 0;
        for (int i = 0; i < 12; i++) {
            CHECK(edit_change(e, EDIT_OPERATE, both[i % 2], "test"));
            if (!in_turn)
                CHECK(edit_change(e, EDIT_OPERATE, both[(i + 1) % 2], "test"));
            CHECK(edit_frame(e, frame) && distance(e, frame) < 1e-5);
            moved = i == 2 ? edit_last_cost(e).switch_seconds : moved; // the last time it moves
        }
        CHECK(moved > 0 && edit_last_cost(e).switch_seconds == moved);
        CHECK(edit_last_cost(e).coefficients > 0 && edit_last_cost(e).coefficients < whole);
        printf("two objects unfrozen: %llu of %llu coefficients\n",
               (unsigned long long)edit_last_cost(e).coefficients, (unsigned long long)whole);
        edit_destroy(e);
    }
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

static void wrong_changes_are_refused(void) {
    static const struct { enum edit_kind kind; const char *text; } wrong[] = {
        {EDIT_SET, "cup"}, {EDIT_SET, "cup=1"}, {EDIT_SET, "can.exponent=1"},
        {EDIT_SET, "cup.exponent"}, {EDIT_SET, "cup.exponent=x"}, {EDIT_SET, "cup.exponent=-1"},
        {EDIT_SET, "cup.exponent=1e99"}, {EDIT_SET, "cup.eta=1.5"}, {EDIT_SET, "cup.gloss.exponent=3"},
        {EDIT_SET, "pot.lid.diffuse=0.5"}, {EDIT_SET, "cup.specular.scale=-1"},
        {EDIT_SET, "cup.specular.scale=1,2"}, {EDIT_SET, "pot.lid.r0=0.5"},
        {EDIT_SET, "cup.specular#2.exponent=3"}, {EDIT_CURVE, "cup.specular.f_A=/nonexistent.csv"},
        {EDIT_CURVE, "cup.specular.f_B=x.csv"}, {EDIT_OPERATE, "cup.specular.f_A"},
        {EDIT_OPERATE, "cup.specular.f_A:amplify-y"}, {EDIT_OPERATE, "cup.specular.f_A.x:amplify-y,0,0,90,90,1"},
        {EDIT_OPERATE, "cup.specular.f_A:translate-x,0,1,2,3,1"},
        {EDIT_OPERATE, "cup.specular.f_A:translate-y,0,0,90,90,1e99"}, {EDIT_RESET, "cup.specular"},
        {EDIT_RESET, ""},
    };
    const struct sample_options o = {.polynomial = false};
    struct arena arena = {0};
    const struct tensor t = sample_make(&o, &arena);
    struct edit *e = edit_create(&t, "test", &(struct edit_settings){.no_device = true});
    static float before[3 * PIXELS], after[3 * PIXELS];
    CHECK(edit_frame(e, before));
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        capture_begin();
        const bool done = edit_change(e, wrong[i].kind, wrong[i].text, "place 7");
        capture_end();
        if (done)
            printf("accepted: %s\n", wrong[i].text);
        CHECK(!done && (captured_has("place 7") || captured_has("nonexistent")));
    }
    CHECK(edit_frame(e, after) && memcmp(before, after, sizeof before) == 0);
    edit_destroy(e);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
}

int main(void) {
    all_ways_agree(&(struct sample_options){.storage = TENSOR_F32}, "linear");
    all_ways_agree(&(struct sample_options){.storage = TENSOR_BF16}, "linear, 16 bits");
    all_ways_agree(&(struct sample_options){.polynomial = true}, "polynomial");
    all_ways_agree(&(struct sample_options){.bins = 1}, "a bin a curve");
    all_ways_agree(&(struct sample_options){.bins = 4096}, "4096 bins");
    black_comes_back();
    freezing_leaves_little();
    updates_follow();
    two_objects_are_unfrozen();
    wrong_changes_are_refused();
    return check_result();
}
