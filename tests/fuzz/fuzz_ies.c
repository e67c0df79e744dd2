// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "fuzz.h"
#include "light/ies_profile.h"
#include "math/hash.h"

// What was read must answer for every direction.
static bool read_ies(const char *path) {
    struct ies_profile p;
    if (!ies_profile_read(path, 10, &p))
        return false;
    struct rng rng = {1};
    for (int i = 0; i < 2000; i++) {
        const vec3 d = v3(rng_float(&rng) - 0.5f, rng_float(&rng) - 0.5f, rng_float(&rng) - 0.5f);
        const float candela = ies_profile_eval(&p, i < 3 ? v3(0, 0, (float)(i - 1)) : normalize(d));
        if (!(candela >= 0 && candela < INFINITY)) {
            fprintf(stderr, "%s: was read, but shines with %g cd\n", path, (double)candela);
            abort();
        }
    }
    const float cone = ies_profile_cone(&p);
    if (!(cone >= -1 && cone <= 1))
        abort();
    ies_profile_finish(&p);
    return true;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-ies", read_ies);
}
