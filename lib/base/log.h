// SPDX-License-Identifier: Apache-2.0
// Messages to the person who runs the program, on standard error.
//
// Whoever detects an error of the world (file, argument, device) reports it once, with the place
// and what was expected, and returns false or NULL; callers pass the failure on in silence.
#pragma once

#include <stdbool.h>

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO };

// Where in an input file something stands. file == NULL: no place; line == 0: the file as a whole.
struct where {
    const char *file;
    int line;
};

void log_set_level(enum log_level most_verbose); // default LOG_INFO
enum log_level log_get_level(void);

// "relume: error: ..." ; printf format, no newline at the end.
void log_error(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void log_info(const char *format, ...) __attribute__((format(printf, 1, 2)));

// "relume: error: scene.xml:12: ..."
void log_error_at(struct where at, const char *format, ...) __attribute__((format(printf, 2, 3)));
void log_warn_at(struct where at, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Number of warnings so far, by any thread (tests and `info` ask).
unsigned log_warning_count(void);
