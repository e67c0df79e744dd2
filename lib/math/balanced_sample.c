// SPDX-License-Identifier: Apache-2.0
#include "math/balanced_sample.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/student.h"

struct place {
    uint32_t key, cell;
};

static uint32_t spread(uint32_t v) { // bits to even places
    v = (v | v << 8) & 0x00ff00ffu;
    v = (v | v << 4) & 0x0f0f0f0fu;
    v = (v | v << 2) & 0x33333333u;
    return (v | v << 1) & 0x55555555u;
}

// Nested uniform scrambling (A. Owen 1995): points that share their first bits go on sharing as many.
static uint32_t scramble(uint32_t code, uint32_t seed) {
    uint32_t flips = 0;
    for (uint32_t bit = 0; bit < 32; bit++)
        flips |= (hash_combine(hash_combine(seed, bit), code >> bit >> 1) & 1) << bit;
    return code ^ flips;
}

static int by_key(const void *a, const void *b) {
    const uint32_t x = ((const struct place *)a)->key, y = ((const struct place *)b)->key;
    return (x > y) - (x < y);
}

static struct place *random_order(uint32_t across, uint32_t down, uint32_t seed) {
    const size_t n = (size_t)across * down;
    struct place *order = mem_array(n, sizeof *order);
    for (uint32_t i = 0; i < n; i++)
        order[i] = (struct place){scramble(spread(i % across) | spread(i / across) << 1, seed), i};
    qsort(order, n, sizeof *order, by_key);
    return order;
}

static bool sizes_are_good(const double *size, uint32_t n) {
    double sum = 0;
    bool good = true;
    for (uint32_t i = 0; i < n; i++) {
        good = good && size[i] > 0;
        sum += size[i];
    }
    return good && isfinite(sum);
}

// Probabilities of n cells. Those that would come to 1 or more are certain, and the others share what
// is left, of whom some may then be certain: until none is.
static void set_probabilities(const double *size, uint32_t n, uint32_t wanted, double *p) {
    const bool good = sizes_are_good(size, n);
    for (uint32_t before = n + 1, certain = 0; certain != before;) {
        double sum = 0;
        for (uint32_t i = 0; i < n; i++)
            sum += p[i] < 1 ? good ? size[i] : 1 : 0;
        before = certain;
        certain = 0;
        for (uint32_t i = 0; i < n; i++) {
            if (p[i] < 1)
                p[i] = fmin(1, (wanted - before) * (good ? size[i] : 1) / sum);
            certain += p[i] >= 1;
        }
    }
}

void balanced_sample_draw(struct balanced_sample *s, uint32_t across, uint32_t down,
                          const double *size, uint32_t wanted, struct rng *rng) {
    const uint32_t n = across * down, most = wanted < n ? wanted : n;
    struct place *order = random_order(across, down, rng_u32(rng));
    double *p = mem_array(n, sizeof *p);
    double next = rng_u32(rng) * 0x1p-32, sum = 0;
    *s = (struct balanced_sample){.cells = n, .cell = mem_array(most, sizeof *s->cell),
                                  .probability = mem_array(most, sizeof *s->probability)};
    set_probabilities(size, n, most, p);
    for (uint32_t i = 0; i < n && s->count < most; i++) {
        const uint32_t cell = order[i].cell;
        sum += p[cell] < 1 ? p[cell] : 0;
        if (p[cell] < 1 && sum <= next)
            continue;
        next += p[cell] < 1;
        s->probability[s->count] = p[cell];
        s->cell[s->count++] = cell;
    }
    mem_free(p);
    mem_free(order);
}

void balanced_sample_finish(struct balanced_sample *s) {
    mem_free(s->cell);
    mem_free(s->probability);
}

// Variance of the estimate by differences of draws that follow each other, the last the first: as of
// independent draws with the same probabilities (J. Hajek, Ann. Math. Stat. 35, 1964), but about what
// is found near by, since cells that are spread evenly follow what changes slowly (K. Wolter,
// "Introduction to Variance Estimation", 2007, 8.2). Not about anything where a single draw is uncertain.
static double drawing_variance(const struct balanced_sample *s, const double *value, int *uncertain) {
    double first = 0, first_share = 0, last = 0, last_share = 0, sum = 0;
    *uncertain = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const double p = s->probability[i], y = value[i] / p, share = 1 - p;
        if (!(share > 0))
            continue;
        if ((*uncertain)++ == 0) {
            first = y;
            first_share = share;
        } else {
            sum += (last_share + share) * (y - last) * (y - last) / 4;
        }
        last = y;
        last_share = share;
    }
    return *uncertain > 1 ? sum + (first_share + last_share) * (first - last) * (first - last) / 4
                          : first_share * first * first;
}

// The estimate of D. Horvitz and D. Thompson (JASA 47, 1952). To its variance the measurements' noise v
// adds the sum over all cells of v / p, of which the spread of what was measured has 1 - p already and
// v / p of those drawn is the rest (C.-E. Sarndal, B. Swensson and J. Wretman, "Model Assisted Survey
// Sampling", 1992, result 4.3.1). Degrees of freedom: F. Satterthwaite, Biometrics 2 (1946).
struct measured balanced_sample_total(const struct balanced_sample *s, const double *value,
                                      const double *variance) {
    double total = 0, noise = 0, squares = 0;
    int uncertain;
    for (uint32_t i = 0; i < s->count; i++) {
        total += value[i] / s->probability[i];
        const double v = variance[i] / s->probability[i];
        noise += v;
        squares += v * v;
    }
    const double drawn = drawing_variance(s, value, &uncertain), sum = drawn + noise;
    const double parts = drawn * drawn / fmax(1, uncertain / 1.5) + squares / 3;
    const double degrees = parts > 0 ? fmax(1, sum * sum / parts) : 1;
    const double half = sum > 0 ? student_95((int)degrees) * sqrt(sum) : 0;
    return (struct measured){total, sqrt(sum), total - half, total + half};
}
