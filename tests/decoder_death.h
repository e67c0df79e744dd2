// SPDX-License-Identifier: Apache-2.0
// A decoder that crashes, or that a sanitizer ends, is a refusal to the program (image/decode.h);
// to a test it is a fault. The message tells it from a decoder that said what is wrong.
// What the sanitizer says goes to files FILE.PID with ASAN_OPTIONS (UBSAN_OPTIONS) log_path=FILE.
#pragma once

#include <stdbool.h>
#include <string.h>

static inline bool decoder_died(const char *message) {
    return strstr(message, "the decoder died of signal ") ||
           strstr(message, "the decoder ended early");
}
