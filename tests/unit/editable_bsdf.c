// SPDX-License-Identifier: Apache-2.0
// The editable material: from scene files, against the models it is made from, at its extremes.
#include <stdlib.h>

#include "bsdf/editable.h"
#include "make_object.h"
#include "math/hash.h"
#include "scene_text.h"

static struct bsdf_point point_at(float u, float v) {
    struct bsdf_point p = {.at = {.uv = {u, v}}};
    p.frame = (struct frame){v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)};
    p.dpdu = v3(1, 0, 0);
    p.dpdv = v3(0, 1, 0);
    return p;
}

static vec3 random_direction(struct rng *r) {
    const float z = 0.05f + 0.95f * rng_float(r), phi = TWO_PI * rng_float(r);
    const float s = safe_sqrt(1 - z * z);
    return v3(s * cosf(phi), s * sinf(phi), z);
}

// ---- scene files ----------------------------------------------------------------------------

// The last material of a scene, all prepared; NULL after an error, which is captured.
static const struct object *prepared(struct scene *s) {
    bool ok = true;
    capture_begin();
    for (uint32_t i = 0; i < s->texture_count && ok; i++) {
        const struct texture_type *type = texture_type_of(s->textures[i]);
        ok = !type->prepare || type->prepare(s->textures[i], &s->arena);
    }
    for (uint32_t i = 0; i < s->bsdf_count && ok; i++) {
        const struct bsdf_type *type = bsdf_type_of(s->bsdfs[i]);
        ok = !type->prepare || type->prepare(s->bsdfs[i], &s->arena);
    }
    capture_end();
    return ok ? s->bsdfs[s->bsdf_count - 1] : NULL;
}

static spectrum value_of(const struct object *o, float u, vec3 wo, vec3 wi) {
    static struct closure_stack stack;
    const struct bsdf_point point = point_at(u, 0.5f);
    float pdf;
    stack.used = 0;
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    return c ? closure_eval(c, wi, &pdf) : spectrum_grey(0);
}

static void curves_come_from_files(void) {
    scene_write("lobe.csv", "from,to,r,g,b\n0,10,4,2,1\n10,20,1,1,1\n20,90,0,0,0.5\n");
    scene_write("view.csv", "at,value\n0,1\n90,0\n");
    struct scene *s = scene_parse(
        "<bsdf type='editable'><string name='model' value='freehand'/>\n"
        "<string name='gamma_a' value='theta_h'/><string name='curve_a' value='lobe.csv'/>\n"
        "<string name='gamma_o' value='theta_o'/><string name='curve_o' value='view.csv'/>\n"
        "<texture name='specular_reflectance' type='checkerboard'><rgb name='color0' value='1'/>\n"
        "<rgb name='color1' value='0.5'/></texture></bsdf>");
    CHECK(s);
    const struct object *o = s ? prepared(s) : NULL;
    CHECK(o && editable_form(o));
    if (!o)
        return;
    const vec3 n = v3(0, 0, 1), at30 = v3(0.5f, 0, 0.8660254f), at60 = v3(0.8660254f, 0, 0.5f);
    check_colour(value_of(o, 0.25f, n, n), 4, 2, 1, 1e-6);
    // half vector at 15 degrees; cos_i times f_o(30 degrees) = 2/3
    check_colour(value_of(o, 0.25f, at30, n), 2.0 / 3, 2.0 / 3, 2.0 / 3, 1e-6);
    check_colour(value_of(o, 0.25f, at60, n), 0, 0, 1.0 / 6, 1e-6);
    check_colour(value_of(o, 0.75f, n, n), 2, 1, 0.5, 1e-6);
    scene_destroy(s);
}

static void terms_add_up(void) {
    struct scene *s = scene_parse(
        "<bsdf type='editable'><string name='model' value='lightview'/>\n"
        "<rgb name='specular_reflectance' value='0.25'/>\n"
        "<bsdf type='editable'><string name='model' value='phong'/>\n"
        "<float name='exponent' value='20'/>\n"
        "<rgb name='specular_reflectance' value='0.5, 0.4, 0.3'/>\n"
        "</bsdf></bsdf>");
    const struct object *o = s ? prepared(s) : NULL;
    CHECK(o);
    if (!o)
        return;
    CHECK(editable_form(o)->terms == 2);
    const double peak = 22 / (2 * M_PI), even = 0.25 / M_PI;
    check_colour(value_of(o, 0.25f, v3(0, 0, 1), v3(0, 0, 1)), even + 0.5 * peak, even + 0.4 * peak,
                 even + 0.3 * peak, 2e-4 * peak);
    // Plain colours are f_q; only textures are factors of their own.
    const struct form_term *even_term = &editable_form(o)->term[0];
    CHECK_NEAR(even_term->scale[0], 0.25 / M_PI, 1e-7);
    CHECK(editable_texture(o, 0)->value[0] == 1 && editable_texture(o, 1)->value[0] == 1);
    scene_destroy(s);
}

static void check_refused(const char *body, const char *words) {
    struct scene *s = scene_parse(body);
    const bool ok = s && prepared(s);
    CHECK(!ok && captured_has(words));
    if (ok || !captured_has(words))
        printf("%s: said: %s\n", words, captured);
    scene_destroy(s);
}

static void mistakes_are_refused(void) {
    scene_write("negative.csv", "at,value\n0,1\n90,-1\n");
    check_refused("<bsdf type='editable'><string name='model' value='phong'/>"
                  "<string name='curve_b' value='lobe.csv'/></bsdf>",
                  "model \"phong\" has no curve f_B");
    check_refused("<bsdf type='editable'><string name='curve_a' value='negative.csv'/></bsdf>",
                  "negative.csv:3: ");
    check_refused("<bsdf type='editable'><string name='curve_a' value='none.csv'/></bsdf>",
                  "no file \"none.csv\"");
    check_refused("<bsdf type='editable'><bsdf type='diffuse'/></bsdf>",
                  "more terms are editable materials, found \"diffuse\"");
    check_refused("<bsdf type='editable'><string name='edit_a' value='translate-x,10,20,30,40,9'/>"
                  "</bsdf>", "would fold the curve; a fade of 10 degrees allows less than 1.25");
    check_refused("<bsdf type='editable'><string name='edit_o' value='translate-y,1,2,3,4,9'/>"
                  "</bsdf>", "there is no curve f_o to edit");
    check_refused("<bsdf type='editable'><string name='model' value='freehand'/>"
                  "<string name='quotient' value='facets'/></bsdf>", "belongs to the model");
    check_refused("<bsdf type='editable'><string name='model' value='fong'/></bsdf>",
                  "expected one of ashikhminfresnel");
}

// ---- the models -----------------------------------------------------------------------------

struct twin {
    const char *name, *overrides, *editable;
};

#define FINE " bins=2048 spacing=quadratic"

static const struct twin twins[] = {
    {"phong", "exponent=50 specular_reflectance=0.4 diffuse_reflectance=0.3",
     "model=phong exponent=50 specular_reflectance=0.4 diffuse_reflectance=0.3" FINE},
    {"blinnphong", "exponent=200 specular_reflectance=1 diffuse_reflectance=0",
     "model=blinnphong exponent=200" FINE},
    {"cooktorrance", "alpha=0.2 material=Au", "model=cooktorrance alpha=0.2 material=Au" FINE},
    {"ashikhminshirley",
     "exponent_u=300 exponent_v=20 specular_reflectance=0.9,0.5,0.1 diffuse_reflectance=0",
     "model=ashikhminshirley exponent_u=300 exponent_v=20 r0=0.9,0.5,0.1" FINE},
    {"ashikhminshirley",
     "exponent_u=300 exponent_v=20 specular_reflectance=0.9,0.5,0.1 diffuse_reflectance=0",
     "model=ashikhminfresnel exponent_u=300 exponent_v=20 r0=0.9,0.5,0.1" FINE},
    {"ashikhminshirley",
     "exponent_u=300 exponent_v=20 specular_reflectance=0.9,0.5,0.1 diffuse_reflectance=0",
     "model=ashikhminratio exponent_u=300 exponent_v=20 r0=0.9,0.5,0.1" FINE},
    {"ward", "alpha_u=0.1 alpha_v=0.3 specular_reflectance=0.8 diffuse_reflectance=0",
     "model=ward alpha_u=0.1 alpha_v=0.3 specular_reflectance=0.8" FINE},
    {"ward", "variant=ward alpha_u=0.2 alpha_v=0.2 specular_reflectance=0.8 diffuse_reflectance=0",
     "model=ward variant=original alpha=0.2 specular_reflectance=0.8" FINE},
    {"orennayar", "alpha=0.6 reflectance=0.7 use_fast_approx=true",
     "model=orennayar alpha=0.6 specular_reflectance=0.7"},
    {"schlick", "roughness=0.04 isotropy=0.5 specular_reflectance=0.6 diffuse_reflectance=0",
     "model=schlick alpha=0.2 isotropy=0.5 r0=0.6" FINE},
};

// Relative second moment of the weights of samples: 1 where f is followed exactly.
static double moment(const struct object *o, vec3 wo) {
    static struct closure_stack stack;
    const struct bsdf_point point = point_at(0.25f, 0.5f);
    struct rng rng = {6};
    double first = 0, second = 0;
    stack.used = 0;
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    enum { N = 4000 };
    for (int i = 0; i < N; i++) {
        struct bsdf_sample s;
        const float u1 = rng_float(&rng), u = rng_float(&rng), v = rng_float(&rng);
        const double w = closure_sample(c, u1, (struct vec2){u, v}, &s)
                             ? (double)spectrum_mean(s.weight) : 0;
        first += w;
        second += w * w;
    }
    return N * second / (first * first);
}

// With 2048 narrow-to-wide nodes the editable material is the model to 1e-3 of the lobe, and its
// samples vary little more than those of the model's own sampling.
static void models_equal_the_materials(void) {
    for (size_t i = 0; i < sizeof twins / sizeof *twins; i++) {
        struct arena arena = {0};
        const struct object *a = make_bsdf(&arena, twins[i].name, twins[i].overrides, NULL);
        const struct object *b = make_bsdf(&arena, "editable", twins[i].editable, NULL);
        struct rng rng = {i + 1};
        double top = 0, bottom = 0, ma = 0, mb = 0;
        for (int k = 0; k < 20000; k++) {
            const vec3 wo = random_direction(&rng), wi = random_direction(&rng);
            const spectrum x = value_of(a, 0.25f, wo, wi), y = value_of(b, 0.25f, wo, wi);
            top += (double)spectrum_mean((x - y) * (x - y));
            bottom += (double)spectrum_mean(x * x);
        }
        for (int k = 0; k < 5; k++) {
            const vec3 wo = random_direction(&rng);
            ma += moment(a, wo) / 5;
            mb += moment(b, wo) / 5;
        }
        printf("%-17s error %.1e; second moment of samples: own %.3f, editable %.3f\n",
               twins[i].name, sqrt(top / bottom), ma, mb);
        CHECK(sqrt(top / bottom) < 1e-3);
        CHECK(mb < 1.6 * ma);
        arena_finish(&arena);
    }
}

// What a precomputation sees, multiplied out, is what the material says.
static void values_multiply_to_eval(void) {
    struct arena arena = {0};
    const struct object *more = make_bsdf(&arena, "editable", "model=ward alpha_u=0.1 alpha_v=0.3",
                                          NULL);
    const struct object *children[] = {more, NULL};
    const struct object *o = make_bsdf(&arena, "editable", "model=homomorphic basis=box bins=16 "
                                       "diffuse_reflectance=0.2 edit_b=amplify-y,20,40,90,90,0",
                                       children);
    const struct form *f = editable_form(o);
    const struct bsdf_point point = point_at(0.25f, 0.5f);
    struct rng rng = {9};
    CHECK(f->terms == 3);
    for (int k = 0; k < 1000; k++) {
        static struct closure_stack stack;
        struct editable_value v[FORM_TERMS];
        const vec3 wo = random_direction(&rng), wi = random_direction(&rng);
        stack.used = 0;
        const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
        double sum = 0;
        float pdf;
        for (uint32_t t = 0, n = editable_values(c, wi, v); t < n; t++) {
            double product = (double)spectrum_mean(v[t].factor);
            for (int s = 0; s < SLOTS; s++) {
                const struct form_slot *slot = &f->term[t].slots[s];
                const struct curve_place *p = &v[t].place[s];
                double value = 0;
                for (uint32_t j = 0; j < p->count; j++)
                    value += p->value[j] *
                             curve_values(f->curve[slot->curve].f[0].table, 0)[p->index[j]];
                product *= slot->gamma.kind == GAMMA_NONE ? 1 : value;
            }
            sum += product;
        }
        CHECK_NEAR((double)spectrum_mean(closure_eval(c, wi, &pdf)) / sum, 1, 1e-6);
        CHECK(editable_values(c, -wi, v) == 0);
    }
    CHECK(editable_form(make_bsdf(&arena, "diffuse", "", NULL)) == NULL);
    arena_finish(&arena);
}

// ---- extremes -------------------------------------------------------------------------------

static double mean_weight(const struct object *o, vec3 wo) {
    static struct closure_stack stack;
    const struct bsdf_point point = point_at(0.25f, 0.5f);
    struct rng rng = {12};
    double sum = 0;
    stack.used = 0;
    const struct closure *c = bsdf_resolve(o, &point, wo, &stack);
    for (int i = 0; i < 4000; i++) {
        struct bsdf_sample s;
        const float u1 = rng_float(&rng), u = rng_float(&rng), v = rng_float(&rng);
        if (!closure_sample(c, u1, (struct vec2){u, v}, &s))
            continue;
        CHECK(spectrum_is_finite(s.weight) && spectrum_min(s.weight) >= 0);
        sum += (double)spectrum_mean(s.weight) / 4000;
    }
    return sum;
}

// Bins keep a lobe's energy however narrow it is: what an exponent of 1e7 reflects at 30 degrees,
// in 8 bins or 4096. Inside a wide bin the quotient changes: by up to 5 % in the first of 8.
static void narrow_lobes_keep_their_energy(void) {
    static const char *const exponents[] = {"1e-3", "1", "100", "1e5", "1e7"};
    static const int bins[] = {8, 64, 4096};
    const vec3 wo = v3(0.5f, 0, 0.8660254f);
    for (int e = 0; e < 5; e++)
        for (int i = 0; i < 6; i++) {
            struct arena arena = {0};
            const struct object *fine = make_bsdf(&arena, "blinnphong", arena_printf(&arena,
                "exponent=%s specular_reflectance=1 diffuse_reflectance=0", exponents[e]), NULL);
            const struct object *o = make_bsdf(&arena, "editable", arena_printf(&arena,
                "exponent=%s bins=%d basis=%s", exponents[e], bins[i / 2], i % 2 ? "hat" : "box"),
                NULL);
            const double a = mean_weight(o, wo), b = mean_weight(fine, wo);
            printf("exponent %-5s %4d %s: reflects %.4f, model %.4f\n", exponents[e], bins[i / 2],
                   i % 2 ? "hats" : "boxes", a, b);
            CHECK_NEAR(a / b, 1, bins[i / 2] == 8 ? 0.06 : 0.03);
            arena_finish(&arena);
        }
}

// Curves of 0 and of 1e6 side by side, in every kind of slot.
static void great_and_empty_bins_stay_finite(void) {
    static const char *const gammas[] = {"theta_h", "theta_d", "theta_i", "theta_r", "phi_h",
                                         "power_u", "power_v", "ratio", "slope_u", "slope_v"};
    static const float heights[] = {1, 0.7f, 0.0174524f, 1.7453e-5f, 1e-12f};
    for (int g = 0; g < 100; g++) {
        struct arena arena = {0};
        const struct object *o = make_bsdf(&arena, "editable", arena_printf(&arena,
            "model=freehand quotient=%s gamma_a=%s gamma_b=%s gamma_o=theta_o bins=32 basis=%s "
            "edit_a=amplify-y,20,25,90,90,0;translate-y,30,35,40,45,1e6 "
            "edit_b=translate-y,0,0,2,4,1e6;amplify-y,70,80,90,90,0 "
            "edit_o=translate-y,80,85,90,90,1e6",
            g % 3 ? "v_cavity" : "ward_bounded", gammas[g % 10], gammas[g / 10],
            g % 2 ? "hat" : "box"), NULL);
        for (int i = 0; i < 5; i++) {
            const float z = heights[i];
            const double w = mean_weight(o, v3(safe_sqrt(1 - z * z), 0, z));
            CHECK(isfinite(w) && w >= 0);
        }
        arena_finish(&arena);
    }
}

int main(void) {
    scene_folder_open();
    curves_come_from_files();
    terms_add_up();
    mistakes_are_refused();
    scene_folder_close();
    models_equal_the_materials();
    values_multiply_to_eval();
    narrow_lobes_keep_their_energy();
    great_and_empty_bins_stay_finite();
    return check_result();
}
