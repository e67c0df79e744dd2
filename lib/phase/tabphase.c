// SPDX-License-Identifier: Apache-2.0
// A phase function from a table: values at equal steps of the cosine of the deflection, from straight
// back (-1) to straight on (1), linear between, made to integrate to 1 (as Mitsuba 3 has it).
#include <string.h>

#include "base/log.h"
#include "base/text.h"
#include "phase/phase.h"

struct tabphase {
    const char *text;
    // made by prepare
    uint32_t segments;
    float *value; // segments + 1, per steradian
    float *cdf;   // segments + 1, from 0 to 1
    float mean_cosine;
};

static const struct param params[] = {
    {"values", PARAM_STRING, offsetof(struct tabphase, text), .def = "1, 1",
     .help = "values by cosine from -1 (straight back) to 1, apart by commas or blanks"},
    PARAM_END,
};

static bool between(char c) {
    return text_is_space(c) || c == ',';
}

// Reads up to `most` values; their number, or 0 after an error message.
static uint32_t read_values(const struct tabphase *t, const struct object *self, double *values,
                            uint32_t most) {
    const char *p = t->text;
    for (uint32_t n = 0;; n++) {
        while (between(*p))
            p++;
        if (!*p)
            return n;
        double value;
        const char *from = p;
        if (n == most || !text_number(&p, &value) || (*p && !between(*p)) || value < 0 ||
            value > 1e30) {
            char what[32];
            log_error_at(self->at, "tabphase: value %u is \"%s\"; expected a number from 0 to 1e30",
                         n + 1, text_excerpt(from, what, sizeof what));
            return 0;
        }
        values[n] = value;
    }
}

// From values per anything to a density, its distribution and its mean cosine.
static void tabulate(struct tabphase *t, const double *values) {
    const double step = 2.0 / t->segments, tau = 2 * 3.14159265358979323846;
    double sum = 0, mean = 0, part = 0;
    for (uint32_t i = 0; i < t->segments; i++) {
        const double a = values[i], b = values[i + 1];
        sum += 0.5 * step * (a + b);
        mean += step * ((i * step - 1) * (a + b) / 2 + step * (a / 6 + b / 3));
    }
    for (uint32_t i = 0; i <= t->segments; i++) {
        t->value[i] = (float)(values[i] / (tau * sum));
        t->cdf[i] = (float)fmin(part / sum, 1);
        if (i < t->segments)
            part += 0.5 * step * (values[i] + values[i + 1]);
    }
    t->cdf[t->segments] = 1;
    t->mean_cosine = (float)(mean / sum);
}

static bool prepare(struct object *self, struct arena *arena) {
    struct tabphase *t = self->data;
    const uint32_t most = (uint32_t)(strlen(t->text) / 2 + 1); // a digit and a comma each
    double *values = mem_array(most, sizeof *values);
    const uint32_t count = read_values(t, self, values, most);
    bool good = false;
    for (uint32_t i = 0; i < count; i++)
        good |= values[i] >= 1e-30;
    if (count >= 2 && good) {
        t->segments = count - 1;
        t->value = arena_alloc(arena, count * sizeof *t->value);
        t->cdf = arena_alloc(arena, count * sizeof *t->cdf);
        tabulate(t, values);
    } else if (count > 0 || !t->text[strspn(t->text, ", \t\r\n\v\f")]) {
        log_error_at(self->at, "tabphase: %u values; expected at least two, not all 0 (below 1e-30)", count);
        good = false;
    }
    mem_free(values);
    return good && count >= 2;
}

static float pdf_sa(const void *data, vec3 p, struct deflection c) {
    const struct tabphase *t = data;
    (void)p;
    const float x = 0.5f * c.backward * (float)t->segments;
    const uint32_t i = x < (float)t->segments ? (uint32_t)x : t->segments - 1;
    return maxf(lerpf(x - (float)i, t->value[i], t->value[i + 1]), 0);
}

static struct deflection sample(const void *data, vec3 p, float u1, float u2) {
    const struct tabphase *t = data;
    (void)p;
    (void)u1;
    uint32_t first = 0, last = t->segments; // cdf[first] <= u2 < cdf[last]
    while (last - first > 1) {
        const uint32_t middle = (first + last) / 2;
        if (t->cdf[middle] <= u2)
            first = middle;
        else
            last = middle;
    }
    const float a = t->value[first], b = t->value[first + 1];
    const float u = clampf((u2 - t->cdf[first]) / (t->cdf[first + 1] - t->cdf[first]), 0, 1);
    const float root = a + sqrtf(lerpf(u, a * a, b * b)); // of the quadratic distribution inside
    const float x = root > 0 ? minf(u * (a + b) / root, 1) : u;
    const float backward = minf(2 * ((float)first + x) / (float)t->segments, 2);
    return (struct deflection){2 - backward, backward};
}

static float mean_cosine(const void *data, vec3 p) {
    (void)p;
    return ((const struct tabphase *)data)->mean_cosine;
}

const struct phase_type phase_tabphase = {
    .entry = {.name = "tabphase", .help = "values by the cosine of the deflection", .params = params,
              .size = sizeof(struct tabphase)},
    .prepare = prepare, .pdf_sa = pdf_sa, .sample = sample, .mean_cosine = mean_cosine,
};
