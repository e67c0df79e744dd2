// SPDX-License-Identifier: Apache-2.0
// Stopping on SIGINT and SIGTERM: the flag that long loops look at.
#pragma once

#include <signal.h>

// Installs the handlers and returns the flag they raise. A second signal ends the process.
const volatile sig_atomic_t *stop_on_signals(void);
