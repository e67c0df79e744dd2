// SPDX-License-Identifier: Apache-2.0
#include "base/progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/thread.h"

void progress_begin(struct progress *p, const char *what, bool quiet) {
    *p = (struct progress){what, time_seconds(), 0, quiet, isatty(2) == 1};
    p->last = p->start;
}

void progress_format_seconds(double s, char *text, unsigned n) {
    if (s < 60)
        snprintf(text, n, "%.1f s", s);
    else if (s < 3600)
        snprintf(text, n, "%d min %02d s", (int)s / 60, (int)s % 60);
    else
        snprintf(text, n, "%d h %02d min", (int)(s / 3600), (int)(s / 60) % 60);
}

bool progress_is_due(const struct progress *p) {
    const double interval = p->terminal ? 0.2 : 10;
    return !p->quiet && time_seconds() - p->last >= interval;
}

void progress_update(struct progress *p, double done, const char *note) {
    const double now = time_seconds();
    if (!progress_is_due(p))
        return;
    p->last = now;
    char left[32] = "?";
    if (done > 0)
        progress_format_seconds((now - p->start) * (1 - done) / done, left, sizeof left);
    if (!p->terminal) {
        fprintf(stderr, "relume: %s %.0f %%, %s left%s%s\n", p->what, 100 * done, left,
                *note ? ", " : "", note);
        return;
    }
    enum { WIDTH = 32 };
    char bar[WIDTH + 1];
    const int full = (int)(done * WIDTH);
    memset(bar, '-', WIDTH);
    memset(bar, '#', (size_t)(full < 0 ? 0 : full > WIDTH ? WIDTH : full));
    bar[WIDTH] = '\0';
    fprintf(stderr, "\r%s [%s] %3.0f %%  %s left  %s\033[K", p->what, bar, 100 * done, left, note);
}

void progress_end(struct progress *p) {
    if (!p->quiet && p->terminal && p->last > p->start)
        fprintf(stderr, "\r\033[K");
}
