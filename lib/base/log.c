// SPDX-License-Identifier: Apache-2.0
#include "base/log.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>

static enum log_level level = LOG_INFO; // the one mutable global of the library
static atomic_uint warnings;

void log_set_level(enum log_level most_verbose) {
    level = most_verbose;
}

enum log_level log_get_level(void) {
    return level;
}

unsigned log_warning_count(void) {
    return atomic_load(&warnings);
}

static void emit(enum log_level l, struct where at, const char *format, va_list args) {
    static const char *const label[] = {"error: ", "warning: ", ""};
    if (l == LOG_WARN)
        atomic_fetch_add(&warnings, 1);
    if (l > level)
        return;
    char text[2048]; // one write a message, so that threads do not interleave
    vsnprintf(text, sizeof text, format, args);
    if (at.file && at.line > 0)
        fprintf(stderr, "relume: %s%s:%d: %s\n", label[l], at.file, at.line, text);
    else if (at.file)
        fprintf(stderr, "relume: %s%s: %s\n", label[l], at.file, text);
    else
        fprintf(stderr, "relume: %s%s\n", label[l], text);
}

#define EMIT(l, at)                                                                                \
    va_list args;                                                                                  \
    va_start(args, format);                                                                        \
    emit(l, at, format, args);                                                                     \
    va_end(args)

void log_error(const char *format, ...) {
    EMIT(LOG_ERROR, (struct where){0});
}

void log_warn(const char *format, ...) {
    EMIT(LOG_WARN, (struct where){0});
}

void log_info(const char *format, ...) {
    EMIT(LOG_INFO, (struct where){0});
}

void log_error_at(struct where at, const char *format, ...) {
    EMIT(LOG_ERROR, at);
}

void log_warn_at(struct where at, const char *format, ...) {
    EMIT(LOG_WARN, at);
}
