// SPDX-License-Identifier: Apache-2.0
#include "sink/sample_map.h"

#include <math.h>
#include <string.h>

enum { FIRST_CHARACTER = '0' }; // of the text: SAMPLE_MAP_MOST printable ones from there on

static uint8_t factor(double wish, double scale, uint32_t least) {
    const double q = floor(wish * scale + 0.5);
    return q < least ? (uint8_t)least : q > SAMPLE_MAP_MOST ? SAMPLE_MAP_MOST : (uint8_t)q;
}

// Mean factor under a scale of the wishes, in quarters.
static double mean_factor(const double *wish, size_t n, double scale, uint32_t least) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        if (wish[i] >= 0) {
            sum += factor(wish[i], scale, least);
            count++;
        }
    return count ? sum / (double)count : SAMPLE_MAP_ONE;
}

void sample_map_fill(struct sample_map *m, const double *wish, uint32_t least) {
    const size_t n = (size_t)m->width * (size_t)m->height;
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = wish[i] > most ? wish[i] : most;
    if (!(most > 0 && most < INFINITY)) {
        memset(m->quarters, SAMPLE_MAP_ONE, n);
        return;
    }
    double low = 0, high = SAMPLE_MAP_MOST * 1e6 / most;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        const bool less = mean_factor(wish, n, middle, least) < SAMPLE_MAP_ONE;
        low = less ? middle : low;
        high = less ? high : middle;
    }
    for (size_t i = 0; i < n; i++)
        m->quarters[i] = wish[i] >= 0 ? factor(wish[i], high, least) : SAMPLE_MAP_ONE;
}

char *sample_map_text(const struct sample_map *m, struct arena *arena) {
    const size_t n = (size_t)m->width * (size_t)m->height;
    char *text = arena_alloc(arena, n + 1);
    for (size_t i = 0; i < n; i++)
        text[i] = (char)(FIRST_CHARACTER + m->quarters[i] - 1);
    return text;
}

bool sample_map_parse(struct sample_map *m, const char *text, int width, int height,
                      struct arena *arena) {
    const size_t n = (size_t)width * (size_t)height;
    if (strlen(text) != n)
        return false;
    *m = (struct sample_map){width, height, arena_alloc(arena, n)};
    for (size_t i = 0; i < n; i++) {
        const int q = text[i] - FIRST_CHARACTER + 1;
        if (q < 1 || q > SAMPLE_MAP_MOST)
            return false;
        m->quarters[i] = (uint8_t)q;
    }
    return true;
}
