// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_script.h"

#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/thread.h"

enum { MOST_STEPS = 1 << 20, MOST_FRAMES = 1 << 16, MOST_CHANGES = 4096, MOST_SETTLING = 100000 };

static const struct {
    const char *name;
    enum edit_kind kind;
} kinds[] = {{"reset", EDIT_RESET}, {"set", EDIT_SET}, {"curve", EDIT_CURVE}, {"op", EDIT_OPERATE},
           {"light", EDIT_LIGHT}};
enum { KINDS = sizeof kinds / sizeof *kinds };

struct reader {
    const char *path;
    size_t step;
    struct arena *arena;
};

static bool fail(const struct reader *r, const char *what, const char *name) {
    log_error("%s: step %zu: %s \"%s\"", r->path, r->step + 1, what, name);
    return false;
}

// ---- reading ------------------------------------------------------------------------------------

static bool is_among(const char *key, const char *const *known) {
    while (*known && strcmp(*known, key) != 0)
        known++;
    return *known != NULL;
}

static bool read_changes(struct reader *r, const struct json *j, struct edit_step *s) {
    s->changes = NULL;
    for (int pass = 0; pass < 2; pass++) {
        s->change_count = 0;
        for (int k = 0; k < KINDS; k++) {
            const struct json *list = json_get(j, kinds[k].name);
            const size_t n = json_is_array(list) ? json_count(list) : list != NULL;
            for (size_t i = 0; i < n; i++) {
                const char *text = json_text(json_is_array(list) ? json_at(list, i) : list);
                if (!text || s->change_count == MOST_CHANGES)
                    return fail(r, "expected a text or a list of texts in", kinds[k].name);
                if (pass) {
                    s->changes[s->change_count].kind = kinds[k].kind;
                    s->changes[s->change_count].text = text;
                }
                s->change_count++;
            }
        }
        if (!pass)
            s->changes = arena_alloc(r->arena, (s->change_count + 1) * sizeof *s->changes);
    }
    return true;
}

static bool read_count(const struct json *j, int64_t least, int64_t most, uint32_t *out) {
    int64_t v = *out;
    if (j && (!json_read_integer(j, &v) || v < least || v > most))
        return false;
    *out = (uint32_t)v;
    return true;
}

static bool read_truth(const struct json *j, bool *out) {
    return !j || json_read_bool(j, out);
}

static bool read_step(struct reader *r, const struct json *j, struct edit_step *s) {
    static const char *const known[] = {"reset",  "set",   "curve",  "op", "light",
                                        "frames", "write", "settle", NULL};
    if (!json_is_object(j))
        return fail(r, "expected an object in", "steps");
    for (size_t i = 0; i < json_count(j); i++)
        if (!is_among(json_key(j, i), known))
            return fail(r, "expected reset, set, curve, op, light, frames, write or settle, found",
                        json_key(j, i));
    s->frames = 1;
    if (!read_count(json_get(j, "frames"), 0, MOST_FRAMES, &s->frames))
        return fail(r, "expected 0 to 65536 in", "frames");
    if (!read_truth(json_get(j, "write"), &s->write) ||
        !read_truth(json_get(j, "settle"), &s->settle))
        return fail(r, "expected true or false in", "write and settle");
    return read_changes(r, j, s);
}

static bool read_head(struct edit_script *s, const char *path) {
    static const char *const known[] = {"focus", "terms", "steps", NULL};
    const struct json *steps = json_get(s->text, "steps");
    s->focus = true;
    for (size_t i = 0; i < json_count(s->text); i++)
        if (!json_is_object(s->text) || !is_among(json_key(s->text, i), known)) {
            log_error("%s: expected {\"focus\", \"terms\", \"steps\"}", path);
            return false;
        }
    if (!json_is_array(steps) || json_count(steps) > MOST_STEPS ||
        !read_truth(json_get(s->text, "focus"), &s->focus) ||
        !read_count(json_get(s->text, "terms"), 0, 1 << 28, &s->terms)) {
        log_error("%s: expected a list of steps, focus true or false, and a number of terms", path);
        return false;
    }
    s->step_count = json_count(steps);
    return true;
}

bool edit_script_parse(struct edit_script *s, const char *text, size_t size, const char *path) {
    *s = (struct edit_script){0};
    s->text = json_parse(text, size, path);
    bool good = s->text && read_head(s, path);
    if (good)
        s->steps = arena_alloc(&s->arena, (s->step_count + 1) * sizeof *s->steps);
    struct reader r = {path, 0, &s->arena};
    for (; r.step < s->step_count && good; r.step++)
        good = read_step(&r, json_at(json_get(s->text, "steps"), r.step), &s->steps[r.step]);
    if (!good)
        edit_script_finish(s);
    return good;
}

bool edit_script_read(struct edit_script *s, const char *path) {
    size_t size;
    char *text = file_read(path, 64u << 20, &size);
    const bool good = text && edit_script_parse(s, text, size, path);
    mem_free(text);
    return good;
}

void edit_script_finish(struct edit_script *s) {
    json_destroy(s->text);
    arena_finish(&s->arena);
    *s = (struct edit_script){0};
}

// ---- playing ------------------------------------------------------------------------------------

static void place_of(char *out, size_t n, const char *path, size_t step) {
    snprintf(out, n, "%s: step %zu", path, step + 1);
}

static bool change_all(const struct edit_step *s, struct edit *e, const char *at) {
    bool good = true;
    for (size_t i = 0; i < s->change_count && good; i++)
        good = edit_change(e, s->changes[i].kind, s->changes[i].text, at);
    return good;
}

struct player {
    struct edit *e;
    float *frame;
    edit_frame_fn fn;
    void *user;
};

static bool play_frame(const struct player *p, const struct edit_step *s, struct edit_timing *t) {
    const double before = edit_last_cost(p->e).switch_seconds, start = time_seconds();
    if (!edit_frame(p->e, p->frame))
        return false;
    const struct edit_cost cost = edit_last_cost(p->e);
    const double all = time_seconds() - start;
    t->switch_seconds = cost.switch_seconds != before ? cost.switch_seconds : 0;
    t->frame_seconds = all - t->switch_seconds;
    t->coefficients = cost.coefficients;
    t->bytes = cost.bytes;
    t->exact = edit_is_exact(p->e);
    return p->fn(p->user, s, t, p->frame);
}

static bool play_step(const struct player *p, const struct edit_step *s, size_t step,
                      const char *path) {
    char at[300];
    const double start = time_seconds();
    place_of(at, sizeof at, path, step);
    if (!change_all(s, p->e, at))
        return false;
    struct edit_timing t = {.step = step, .change_seconds = time_seconds() - start};
    const uint32_t most = s->settle ? MOST_SETTLING : s->frames;
    for (; t.frame < most; t.frame++) {
        if (!play_frame(p, s, &t))
            return false;
        if (s->settle && t.exact && t.frame + 1 >= s->frames)
            break;
        t.change_seconds = 0;
    }
    return true;
}

bool edit_script_play(const struct edit_script *s, struct edit *e, const char *path, float *frame,
                      edit_frame_fn fn, void *user) {
    const struct player p = {e, frame, fn, user};
    bool good = true;
    for (size_t i = 0; i < s->step_count && good; i++)
        good = play_step(&p, &s->steps[i], i, path);
    return good;
}

bool edit_script_apply(const struct edit_script *s, struct edit_tensor *e, const char *path) {
    char at[300];
    struct edit_touch touch;
    for (size_t i = 0; i < s->step_count; i++) {
        place_of(at, sizeof at, path, i);
        for (size_t k = 0; k < s->steps[i].change_count; k++)
            if (!edit_apply(e, s->steps[i].changes[k].kind, s->steps[i].changes[k].text, at, &touch))
                return false;
    }
    return true;
}
