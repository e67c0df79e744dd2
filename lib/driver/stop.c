// SPDX-License-Identifier: Apache-2.0
#include "driver/stop.h"

#include <stddef.h>

static volatile sig_atomic_t stop; // a signal handler can reach nothing else

static void raise_flag(int signal_number) {
    stop = 1;
    signal(signal_number, SIG_DFL);
}

const volatile sig_atomic_t *stop_on_signals(void) {
    struct sigaction action = {.sa_handler = raise_flag};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    return &stop;
}
