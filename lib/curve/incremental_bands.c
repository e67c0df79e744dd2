// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "curve/incremental.h"

struct choice {
    const struct incremental *s;
    const struct incremental_bands *bands;
    double *kept, *anew; // squares of what is off, by term: going on, and from zero
    double *left;        // [band][2]: what is not reached
    size_t *above;       // [band][2]: terms that a threshold takes
};

static void measure(struct choice *c, const double *wanted) {
    const struct incremental *s = c->s;
    for (size_t i = 0; i < s->count; i++) {
        const double w = s->weight ? s->weight[i] * s->weight[i] : 1;
        c->kept[i] = c->anew[i] = 0;
        for (size_t k = i * s->channels; k < (i + 1) * s->channels; k++) {
            c->kept[i] += w * (wanted[k] - s->effective[k]) * (wanted[k] - s->effective[k]);
            c->anew[i] += w * wanted[k] * wanted[k];
        }
    }
}

static bool is_anew(const struct choice *c, uint32_t band) {
    return c->left[2 * band + 1] < c->left[2 * band];
}

// How many terms are above the square of a threshold, each band in its better way.
static size_t count_above(struct choice *c, double square) {
    size_t n = 0;
    memset(c->left, 0, 2 * c->bands->count * sizeof *c->left);
    memset(c->above, 0, 2 * c->bands->count * sizeof *c->above);
    for (size_t i = 0; i < c->s->count; i++)
        for (int way = 0; way < 2; way++) {
            const double off = way ? c->anew[i] : c->kept[i];
            const size_t at = 2 * (size_t)c->bands->of_term[i] + (size_t)way;
            c->left[at] += fmin(off, square);
            c->above[at] += off > square;
        }
    for (uint32_t b = 0; b < c->bands->count; b++)
        n += c->above[2 * b + is_anew(c, b)];
    return n;
}

// Halves the interval of thresholds until neighbours are left: those of positive numbers lie in the
// order of their bits.
static void find_threshold(struct choice *c, size_t most) {
    uint64_t low = 0, high;
    double square = 0;
    if (count_above(c, 0) <= most)
        return;
    for (size_t i = 0; i < c->s->count; i++)
        square = fmax(square, fmax(c->kept[i], c->anew[i]));
    memcpy(&high, &square, sizeof high);
    while (high - low > 1) {
        const uint64_t middle = low + (high - low) / 2;
        memcpy(&square, &middle, sizeof square);
        *(count_above(c, square) <= most ? &high : &low) = middle;
    }
    memcpy(&square, &high, sizeof square);
    count_above(c, square);
}

void incremental_rebuild(struct incremental *s, const struct incremental_bands *b,
                         const double *wanted, size_t most, bool *rebuilt) {
    struct choice c = {s, b, mem_array(s->count, sizeof(double)), mem_array(s->count, sizeof(double)),
                       mem_array(2 * (size_t)b->count, sizeof(double)),
                       mem_array(2 * (size_t)b->count, sizeof(size_t))};
    measure(&c, wanted);
    find_threshold(&c, most);
    for (uint32_t k = 0; k < b->count; k++)
        rebuilt[k] = is_anew(&c, k);
    for (size_t i = 0; i < s->count; i++)
        if (rebuilt[b->of_term[i]])
            memset(s->effective + i * s->channels, 0, s->channels * sizeof *s->effective);
    mem_free(c.kept);
    mem_free(c.anew);
    mem_free(c.left);
    mem_free(c.above);
}

// 0 for the first, then one more for every doubling.
static uint32_t level_of(uint32_t i) {
    uint32_t level = 0;
    for (; i > 0; i /= 2)
        level++;
    return level;
}

uint32_t incremental_bands_of(uint32_t rows, uint32_t columns, uint8_t *of_term) {
    uint32_t most = 0;
    for (uint32_t y = 0; y < rows; y++)
        for (uint32_t x = 0; x < columns; x++) {
            const uint32_t a = level_of(y), b = level_of(x), band = a > b ? a : b;
            of_term[y * columns + x] = (uint8_t)band;
            most = band > most ? band : most;
        }
    return most + 1;
}
