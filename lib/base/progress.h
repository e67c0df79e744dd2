// SPDX-License-Identifier: Apache-2.0
// How far a long computation is: a bar with the time left on a terminal, a plain line now and then
// otherwise. Writes to standard error.
#pragma once

#include <stdbool.h>

struct progress {
    const char *what;
    double start, last; // seconds
    bool quiet, terminal;
};

void progress_begin(struct progress *p, const char *what, bool quiet);
bool progress_is_due(const struct progress *p); // whether an update would show anything now
// done: share from 0 to 1; note: more to show ("noise 1.2 %"), or "".
void progress_update(struct progress *p, double done, const char *note);
void progress_end(struct progress *p);

// "1 h 02 min", "3 min 20 s", "4.2 s" into text (size n).
void progress_format_seconds(double seconds, char *text, unsigned n);
