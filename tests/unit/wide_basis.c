// SPDX-License-Identifier: Apache-2.0
// The basis that answers where the eye sees an object: WIDE_LANES points at once leave the marks, the
// densities and the directions of one by one, bit by bit, where lanes repeat the first, too.
#include "integrator/wide_basis.h"

#include "check.h"
#include "curve/model.h"

enum { ROUNDS = 400 };

static uint64_t state = 11;
static struct chain alone[WIDE_LANES], together[WIDE_LANES];
static struct closure_stack stack;

static float uniform(void) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (float)(state >> 40) * 0x1p-24f;
}

static struct form form_of(struct arena *arena, const char *model, uint32_t bins,
                           enum basis_kind kind, enum basis_spacing spacing) {
    struct model_parameters p = model_defaults;
    struct form f;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        p.diffuse[k] = 0.2 + 0.1 * k;
    CHECK(model_make(model_find(model), &p, arena, &f, model));
    for (uint32_t c = 0; c < f.curves; c++) {
        const struct basis b = basis_make(arena, kind, bins >> c, spacing);
        form_tabulate(&f, c, &b, form_filter(&f, c), arena);
    }
    return f;
}

static vec3 above(void) {
    const float z = uniform() < 0.2f ? 0.02f * uniform() + 1e-4f : uniform();
    const float r = sqrtf(1 - z * z), phi = TWO_PI * uniform();
    return v3(r * cosf(phi), r * sinf(phi), z);
}

static uint32_t same_marks(const struct marks *a, const struct marks *b) {
    if (a->count != b->count)
        return 0;
    for (uint32_t i = 0; i < a->count; i++)
        if (a->mark[i].index != b->mark[i].index ||
            memcmp(&a->mark[i].weight, &b->mark[i].weight, 3 * sizeof(float)) != 0)
            return 0;
    return 1;
}

// What is seen from wo, one by one.
static const struct closure *resolve_alone(const struct symbolic *s, int lane, vec3 wo) {
    struct sink sink = {.chains = alone};
    struct trace_context ctx = {.response = &s->response, .sink = &sink, .stack = &stack};
    const struct surface at = {.shape = (uint32_t)lane % 2};
    chain_begin(&alone[lane]);
    return response_resolve(&ctx, lane, 0, &at, wo);
}

// Some points: the lanes beyond repeat the first.
static void compare(const struct symbolic *s, int count, uint32_t wrong[3]) {
    struct wide_points points;
    struct wide_closures closures;
    struct wide_samples found;
    struct wide3 wo, wi;
    wide u[3], pdf;
    for (int i = 0; i < WIDE_LANES; i++) {
        together[i].basis = &s->objects[i % 2];
        points.data[i] = &together[i];
        wide3_set_lane(&wo, i, above());
        wide3_set_lane(&wi, i, uniform() < 0.05f ? -above() : above());
        for (int k = 0; k < 3; k++)
            u[k][i] = uniform();
    }
    for (int i = count; i < WIDE_LANES; i++) {
        points.data[i] = points.data[0];
        wide3_set_lane(&wo, i, wide3_lane(&wo, 0));
        wide3_set_lane(&wi, i, wide3_lane(&wi, 0));
        for (int k = 0; k < 3; k++)
            u[k][i] = u[k][0];
    }
    wide_basis.resolve(&points, &wo, &closures);
    wide_basis.eval(&closures, &wi, &pdf);
    const uint32_t scattered = wide_bits(wide_basis.sample(&closures, u[0], u + 1, &found));
    for (int i = 0; i < count; i++) {
        struct bsdf_sample b;
        float one;
        const struct closure *c = resolve_alone(s, i, wide3_lane(&wo, i));
        closure_eval(c, wide3_lane(&wi, i), &one);
        wrong[0] += one != pdf[i] || (one > 0 && !same_marks(&alone[i].first[CHAIN_LIGHT],
                                                             &together[i].first[CHAIN_LIGHT]));
        const bool some = closure_sample(c, u[0][i], (struct vec2){u[1][i], u[2][i]}, &b);
        wrong[1] += some != (scattered >> i & 1);
        wrong[2] += some && (b.pdf_sa != found.pdf_sa[i] || b.wi[0] != found.wi.x[i] ||
                             b.wi[1] != found.wi.y[i] || b.wi[2] != found.wi.z[i] ||
                             !same_marks(&alone[i].first[CHAIN_PATH],
                                         &together[i].first[CHAIN_PATH]));
    }
}

// Two objects in turn.
static void check(const char *first, const char *second, uint32_t bins, enum basis_kind kind,
                  enum basis_spacing spacing) {
    struct arena arena = {0};
    const struct form forms[2] = {form_of(&arena, first, bins, kind, spacing),
                                  form_of(&arena, second, bins / 2, kind, spacing)};
    struct symbolic_object objects[2];
    const int object_of_shape[2] = {0, 1};
    const bool two_sided[2] = {false, false};
    struct symbolic s = {.objects = objects, .object_of_shape = object_of_shape,
                         .two_sided = two_sided, .bounces = 2};
    uint32_t wrong[3] = {0};
    symbolic_init(&s);
    for (int i = 0; i < 2; i++) {
        symbolic_object_init(&objects[i], &forms[i], &arena);
        symbolic_object_ready(&objects[i]);
        CHECK(objects[i].wide);
    }
    for (int n = 0; n < ROUNDS; n++)
        compare(&s, n % 2 ? WIDE_LANES : 1 + n / 2 % WIDE_LANES, wrong);
    printf("%s, %s, %u bins: %u eval, %u scattering, %u samples differ\n", first, second, bins,
           wrong[0], wrong[1], wrong[2]);
    CHECK(wrong[0] == 0 && wrong[1] == 0 && wrong[2] == 0);
    arena_finish(&arena);
}

int main(void) {
    check("blinnphong", "phong", 64, BASIS_BOX, SPACING_UNIFORM);
    check("phong", "blinnphong", 64, BASIS_HAT, SPACING_QUADRATIC);
    check("blinnphong", "blinnphong", 256, BASIS_HAT, SPACING_UNIFORM);
    check("blinnphong", "lightview", 16, BASIS_BOX, SPACING_QUADRATIC);
    return check_result();
}
