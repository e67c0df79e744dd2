// SPDX-License-Identifier: Apache-2.0
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "curve/curve.h"
#include "fuzz.h"

// What was read must be a curve: knots that ascend from 0 to pi/2, values from 0 on.
static bool is_curve(const struct curve *c) {
    const uint32_t last = basis_intervals(&c->basis);
    bool ok = c->basis.count > 0 && c->basis.knots[0] == 0 && c->basis.knots[last] == CURVE_END;
    for (uint32_t i = 0; i < last; i++)
        ok = ok && c->basis.knots[i] < c->basis.knots[i + 1];
    for (uint32_t i = 0; i < c->basis.count * c->channels; i++)
        ok = ok && isfinite(c->values[i]) && c->values[i] >= 0;
    return ok;
}

static bool read_curve(const char *path) {
    struct arena arena = {0};
    struct curve c;
    const bool ok = curve_read(&c, &arena, path);
    if (ok && !is_curve(&c)) {
        fprintf(stderr, "%s: was read, but is no curve\n", path);
        abort();
    }
    arena_finish(&arena);
    return ok;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-curve", read_curve);
}
