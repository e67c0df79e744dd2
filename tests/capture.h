// SPDX-License-Identifier: Apache-2.0
// Catches what is written to standard error, so that a test can look at a message.
#pragma once

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static char captured[65536]; // what the last capture caught
static int capture_saved = -1;
static FILE *capture_file;

static inline void capture_begin(void) {
    fflush(stderr);
    capture_saved = dup(2);
    capture_file = tmpfile();
    dup2(fileno(capture_file), 2);
}

static inline const char *capture_end(void) {
    fflush(stderr);
    dup2(capture_saved, 2);
    close(capture_saved);
    rewind(capture_file);
    captured[fread(captured, 1, sizeof captured - 1, capture_file)] = '\0';
    fclose(capture_file);
    return captured;
}

static inline int captured_has(const char *text) {
    return strstr(captured, text) != NULL;
}
