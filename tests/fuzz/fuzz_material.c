// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "bsdf/bsdf.h"
#include "fuzz.h"
#include "math/hash.h"

static const struct bsdf_type *type_for(const char *path) {
    char extension[16];
    file_extension(path, extension, sizeof extension);
    return strcmp(extension, "binary") == 0  ? &bsdf_merl
           : strcmp(extension, "bsdf") == 0 ? &bsdf_measured
           : strcmp(extension, "xml") == 0  ? &bsdf_window
                                            : &bsdf_goniometer;
}

static _Noreturn void fault(const char *path, const char *what) {
    fprintf(stderr, "%s: was read, but %s\n", path, what);
    abort();
}

static bool is_sane(spectrum f) {
    return spectrum_is_finite(f) && spectrum_min(f) >= 0;
}

// A few directions of the eye, samples and values.
static void use(const char *path, const struct object *o) {
    struct rng rng = {1};
    for (int i = 0; i < 12; i++) {
        struct closure_stack stack = {0};
        const struct bsdf_point point = {0};
        const float phi = TWO_PI * rng_float(&rng), z = i < 2 ? 1 - 2.0f * (float)i
                                                              : 2 * rng_float(&rng) - 1;
        const float r = safe_sqrt(1 - z * z);
        const struct closure *c =
            bsdf_resolve(o, &point, v3(r * cosf(phi), r * sinf(phi), z), &stack);
        for (int k = 0; c && k < 50; k++) {
            struct bsdf_sample s;
            float pdf;
            const float u1 = rng_float(&rng), u = rng_float(&rng), v = rng_float(&rng);
            if (!closure_sample(c, u1, (struct vec2){u, v}, &s))
                continue;
            if (!is_sane(s.weight) || !(s.pdf_sa > 0) || !isfinite(s.pdf_sa))
                fault(path, "a sample is not finite");
            if (!is_sane(closure_eval(c, s.wi, &pdf)) || !(pdf >= 0) || !isfinite(pdf))
                fault(path, "a value is not finite");
        }
        if (c && !is_sane(closure_albedo(c)))
            fault(path, "an albedo is not finite");
    }
}

static bool read_material(const char *path) {
    const struct bsdf_type *type = type_for(path);
    struct arena arena = {0};
    struct object *o = arena_alloc(&arena, sizeof *o);
    o->type = &type->entry;
    o->data = arena_alloc(&arena, type->entry.size);
    memcpy(o->data, &path, sizeof path); // the file's name comes first in all of them
    const bool good = type->prepare(o, &arena);
    if (good)
        use(path, o);
    arena_finish(&arena);
    return good;
}

int main(int argc, char **argv) {
    return fuzz_main(argc, argv, "fuzz-material", read_material);
}
