// SPDX-License-Identifier: Apache-2.0
// Words of pbrt files, across the files that Include names.
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "scene/pbrt.h"

enum { MOST_FILES = 32 };
static const size_t MOST_BYTES = (size_t)1 << 30;

bool pbrt_open_file(struct pbrt *p, const char *path) {
    size_t size;
    if (p->files.count >= MOST_FILES) {
        log_error("%s: files are included more than %d deep", path, MOST_FILES);
        return false;
    }
    char *bytes = file_read(path, MOST_BYTES, &size);
    if (!bytes)
        return false;
    if (memchr(bytes, '\0', size)) {
        log_error("%s: holds a zero byte, expected text", path);
        mem_free(bytes);
        return false;
    }
    *LIST_ADD(&p->files, struct pbrt_file) = (struct pbrt_file){bytes, bytes, {path, 1}};
    return load_hash_file(p->r, path);
}

void pbrt_close_files(struct pbrt *p) {
    for (size_t i = 0; i < p->files.count; i++)
        mem_free(LIST_AT(&p->files, struct pbrt_file, i).bytes);
    mem_free(p->files.items);
}

// Over white space and comments.
static void skip(struct pbrt_file *f) {
    for (; *f->next; f->next++) {
        if (*f->next == '\n')
            f->at.line++;
        else if (*f->next == '#')
            f->next += strcspn(f->next, "\n") - 1;
        else if (!text_is_space(*f->next))
            return;
    }
}

static bool take_string(struct pbrt_file *f, struct pbrt_token *t) {
    const char *end = f->next + 1;
    while (*end && *end != '"' && *end != '\n')
        end += *end == '\\' && end[1] && end[1] != '\n' ? 2 : 1;
    if (*end != '"') {
        log_error_at(f->at, "a string does not end in its line");
        return false;
    }
    *t = (struct pbrt_token){PBRT_STRING, f->next + 1, (size_t)(end - f->next - 1), f->at};
    f->next = end + 1;
    return true;
}

bool pbrt_next(struct pbrt *p, struct pbrt_token *t) {
    if (p->has_ahead) {
        *t = p->ahead;
        p->has_ahead = false;
        return true;
    }
    struct pbrt_file *f = &LIST_AT(&p->files, struct pbrt_file, p->files.count - 1);
    skip(f);
    while (*f->next == '\0') {
        if (p->files.count == 1) {
            *t = (struct pbrt_token){PBRT_END, "", 0, f->at};
            return true;
        }
        mem_free(f->bytes);
        p->files.count--;
        f--;
        skip(f);
    }
    if (*f->next == '"')
        return take_string(f, t);
    const bool bracket = *f->next == '[' || *f->next == ']';
    const size_t n = bracket ? 1 : strcspn(f->next, " \t\r\n\v\f[]\"#");
    *t = (struct pbrt_token){!bracket ? PBRT_WORD : *f->next == '[' ? PBRT_OPEN : PBRT_CLOSE, f->next,
                             n, f->at};
    f->next += n;
    return true;
}

void pbrt_put_back(struct pbrt *p, const struct pbrt_token *t) {
    p->ahead = *t;
    p->has_ahead = true;
}

bool pbrt_token_is(const struct pbrt_token *t, const char *word) {
    return t->kind == PBRT_WORD && t->size == strlen(word) && memcmp(t->text, word, t->size) == 0;
}

static bool expected(const struct pbrt_token *t, const char *what) {
    char word[64];
    log_error_at(t->at, "found '%s', expected %s",
                 t->kind == PBRT_END ? "end of file" : text_excerpt(t->text, word, sizeof word), what);
    return false;
}

const char *pbrt_read_string(struct pbrt *p, const char *what) {
    struct pbrt_token t;
    if (!pbrt_next(p, &t))
        return NULL;
    if (t.kind != PBRT_STRING) {
        expected(&t, what);
        return NULL;
    }
    return arena_printf(p->r->arena, "%.*s", (int)t.size, t.text);
}

static bool read_number(const struct pbrt_token *t, double *out) {
    const char *at = t->text;
    return t->kind == PBRT_WORD && text_number(&at, out) && at == t->text + t->size &&
           *out < 1e300 && *out > -1e300;
}

bool pbrt_read_numbers(struct pbrt *p, const char *what, int count, double *out) {
    struct pbrt_token t;
    if (!pbrt_next(p, &t))
        return false;
    const bool bracket = t.kind == PBRT_OPEN;
    for (int i = 0; i < count; i++) {
        if ((bracket || i > 0) && !pbrt_next(p, &t))
            return false;
        if (!read_number(&t, &out[i]))
            return expected(&t, arena_printf(p->r->arena, "%d numbers of %s", count, what));
    }
    return !bracket || (pbrt_next(p, &t) && (t.kind == PBRT_CLOSE || expected(&t, "]")));
}

void pbrt_warn(struct pbrt *p, struct where at, const char *format, ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (size_t i = 0; i < p->warned.count; i++)
        if (strcmp(LIST_AT(&p->warned, const char *, i), text) == 0)
            return;
    *LIST_ADD(&p->warned, const char *) = arena_strdup(p->r->arena, text);
    log_warn_at(at, "%s", text);
}
