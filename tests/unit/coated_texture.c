// SPDX-License-Identifier: Apache-2.0
// A coat whose roughness is a texture is at every place the coat of that roughness, but for tables
// between whose roughnesses it is interpolated (5e-4 of what is reflected).
#include "scene_text.h"

#define COAT(alpha) "<shape type='rectangle'><bsdf type='coated'>" alpha                           \
    "<bsdf type='diffuse'><rgb name='reflectance' value='1'/></bsdf></bsdf></shape>"
#define NUMBER(x) "<float name='alpha' value='" x "'/>"
#define TEXTURE(x) "<texture type='product' name='alpha'><rgb name='texture_0' value='" x "'/></texture>"
#define BOTH(x) {COAT(NUMBER(x)) COAT(TEXTURE(x)), x}

static const struct closure *resolve(const struct scene *s, int shape, vec3 wo,
                                     struct closure_stack *stack) {
    const struct bsdf_point point = {0};
    stack->used = 0;
    return bsdf_resolve(s->shapes[shape].bsdf, &point, wo, stack);
}

// Energy that the coat reflects and, of what it leaves, a white base; noise of 5e-4.
static double mean_weight(const struct closure *c) {
    enum { N = 32768 };
    struct rng rng = {1};
    double sum = 0;
    for (int i = 0; i < N; i++) {
        struct bsdf_sample s;
        const float u1 = ((float)i + 0.5f) / N;
        if (closure_sample(c, u1, (struct vec2){rng_float(&rng), rng_float(&rng)}, &s))
            sum += (double)spectrum_mean(s.weight);
    }
    return sum / N;
}

static void compare(const struct scene *s, vec3 wo, const char *alpha) {
    static struct closure_stack stacks[2];
    const struct closure *a = resolve(s, 0, wo, &stacks[0]), *b = resolve(s, 1, wo, &stacks[1]);
    CHECK(a->lobes == b->lobes);
    CHECK_NEAR(spectrum_mean(closure_albedo(a)), spectrum_mean(closure_albedo(b)), 5e-4);
    const double x = mean_weight(a), y = mean_weight(b);
    CHECK_NEAR(x, y, 2e-3);
    if (fabs(x - y) > 2e-3)
        printf("alpha %s, cosine %g: %g, textured %g\n", alpha, (double)wo[2], x, y);
    for (int i = 0; i < 8; i++) {
        float pdf[2];
        const vec3 wi = normalize(v3(-wo[0] + 0.1f * (float)i, 0.05f * (float)i, wo[2]));
        const spectrum f = closure_eval(a, wi, &pdf[0]), g = closure_eval(b, wi, &pdf[1]);
        CHECK_NEAR(spectrum_mean(g), spectrum_mean(f), 1e-3 * (1 + (double)spectrum_mean(f)));
        CHECK_NEAR(pdf[1], pdf[0], 4e-3 * (1 + (double)pdf[0]));
    }
}

static bool prepare(struct scene *s) {
    bool good = true;
    for (uint32_t i = 0; i < s->bsdf_count && good; i++) {
        const struct bsdf_type *type = bsdf_type_of(s->bsdfs[i]);
        good = !type->prepare || type->prepare(s->bsdfs[i], &s->arena);
    }
    return good;
}

int main(void) {
    static const struct {
        const char *text, *alpha;
    } cases[] = {BOTH("0"), BOTH("1e-3"), BOTH("0.02"), BOTH("0.1"), BOTH("0.33"), BOTH("0.7"),
                 BOTH("1")};
    scene_folder_open();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct scene *s = scene_parse(cases[i].text);
        const bool good = s && s->shape_count == 2 && prepare(s);
        CHECK(good);
        for (int k = 0; good && k < 6; k++) {
            const float cosine = k < 5 ? 1 - 0.2f * (float)k : 0.05f;
            compare(s, v3(sqrtf(1 - cosine * cosine), 0, cosine), cases[i].alpha);
        }
        scene_destroy(s);
    }
    scene_folder_close();
    return check_result();
}
