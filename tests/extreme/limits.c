// SPDX-License-Identifier: Apache-2.0
// Materials at the ends of their ranges, in pictures: below a roughness of 1e-4 the smooth one itself,
// at equal indices nothing at all, at albedo 1 paths that only the hard cap ends.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

static void render_scene(const char *integrator, const char *shapes, int spp, struct image *im,
                         struct render_result *result) {
    const struct job_options o = {.spp = spp, .variance = true};
    char text[4096];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'>%s<sensor type='perspective'><float name='fov' value='40'/>"
             "<transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/>"
             "</transform><film type='hdrfilm'><integer name='width' value='16'/>"
             "<integer name='height' value='16'/><rfilter type='box'/></film></sensor>%s</scene>",
             integrator, shapes);
    render_text(text, &o, im, result);
}

static bool same_picture(const struct image *a, const struct image *b) {
    return a->channels == b->channels && a->width == b->width && a->height == b->height &&
           memcmp(a->pixels, b->pixels, (size_t)a->width * (size_t)a->height *
                                            (size_t)a->channels * sizeof(float)) == 0;
}

// ---- roughness to 0 -------------------------------------------------------------------------

// A sphere of the material under a small light, a large one and the sky.
static void render_sphere(const char *bsdf, struct image *im) {
    struct render_result result;
    char shapes[2048];
    snprintf(shapes, sizeof shapes,
             "<shape type='sphere'>%s</shape><emitter type='constant'>"
             "<rgb name='radiance' value='0.2'/></emitter>"
             "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
             "<lookat origin='3,4,5' target='0,0,0' up='0,1,0'/></transform>"
             "<emitter type='area'/></shape>"
             "<shape type='sphere'><point name='center' x='-3' y='1' z='3'/>"
             "<float name='radius' value='0.3'/><emitter type='area'>"
             "<rgb name='radiance' value='10'/></emitter></shape>", bsdf);
    render_scene("<integrator type='path'/>", shapes, 256, im, &result);
}

static void roughness_below_the_switch_is_smooth(void) {
    const char *const pairs[][2] = {
        {"<bsdf type='roughconductor'><float name='alpha' value='%g'/>"
         "<string name='material' value='Au'/></bsdf>",
         "<bsdf type='conductor'><string name='material' value='Au'/></bsdf>"},
        {"<bsdf type='roughdielectric'><float name='alpha' value='%g'/></bsdf>",
         "<bsdf type='dielectric'/>"},
        // the coat's inside is averaged otherwise than in plastic (roughplastic.c)
        {"<bsdf type='roughplastic'><float name='alpha' value='%g'/></bsdf>",
         "<bsdf type='roughplastic'><float name='alpha' value='0'/></bsdf>"},
    };
    const double alphas[] = {0, 1e-30, 1e-6, 0.00009999};
    for (int i = 0; i < 3; i++) {
        struct image smooth, rough;
        char bsdf[256];
        render_sphere(pairs[i][1], &smooth);
        for (int k = 0; k < 4; k++) {
            snprintf(bsdf, sizeof bsdf, pairs[i][0], alphas[k]);
            render_sphere(bsdf, &rough);
            const bool same = same_picture(&smooth, &rough);
            if (!same)
                printf("%s: alpha %g is not the smooth one: %.9g, %.9g\n", pairs[i][1], alphas[k],
                       measure(&rough, 'G').mean, measure(&smooth, 'G').mean);
            CHECK(same);
            image_finish(&rough);
        }
        snprintf(bsdf, sizeof bsdf, pairs[i][0], 0.00010001);
        render_sphere(bsdf, &rough);
        const struct measured a = measure(&rough, 'G'), b = measure(&smooth, 'G');
        printf("%s: above the switch %.6f +- %.6f, below %.6f +- %.6f: jump %+.4f %%\n", pairs[i][1],
               a.mean, a.error, b.mean, b.error, 100 * (a.mean / b.mean - 1));
        CHECK(!same_picture(&smooth, &rough));
        CHECK_NEAR(a.mean / b.mean, 1, 1e-3);
        image_finish(&smooth);
        image_finish(&rough);
    }
}

// ---- index to 1 -----------------------------------------------------------------------------

static const char around[] =
    "<emitter type='constant'><rgb name='radiance' value='0.1'/></emitter>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate x='1' angle='-90'/>"
    "<translate y='-1'/></transform></shape>"
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/>"
    "<translate y='4'/></transform><emitter type='area'><rgb name='radiance' value='8'/></emitter>"
    "</shape>";

// A sphere and a cube between camera, ground and light that are not there.
static void render_with(const char *bsdf, struct image *im) {
    struct render_result result;
    char shapes[2048];
    if (bsdf)
        snprintf(shapes, sizeof shapes,
                 "%s<shape type='sphere'>%s</shape><shape type='cube'><transform name='to_world'>"
                 "<scale value='0.7'/><translate z='2'/></transform>%s</shape>", around, bsdf, bsdf);
    render_scene("<integrator type='path'/>", bsdf ? shapes : around, 64, im, &result);
}

static void equal_indices_leave_nothing(void) {
    const char *const names[] = {"dielectric", "roughdielectric", "thindielectric", "null"};
    struct image without;
    render_with(NULL, &without);
    for (int i = 0; i < 4; i++) {
        struct image with;
        char bsdf[256];
        snprintf(bsdf, sizeof bsdf, i < 3 ? "<bsdf type='%s'><float name='int_ior' value='1.33'/>"
                                            "<float name='ext_ior' value='1.33'/></bsdf>"
                                          : "<bsdf type='%s'/>", names[i]);
        render_with(bsdf, &with);
        printf("%s, index 1: %s\n", names[i], same_picture(&with, &without) ? "same" : "differs");
        CHECK(same_picture(&with, &without));
        image_finish(&with);
    }
    image_finish(&without);
}

// ---- albedo 1 -------------------------------------------------------------------------------

// Nothing takes light away: each event brings the emission once, until the cap of 4096 events.
static void albedo_one_meets_the_cap(void) {
    const char *const methods[] = {
        "<integrator type='simple'/>",
        "<integrator type='path'><integer name='rr_depth' value='1000000'/></integrator>"};
    for (int i = 0; i < 2; i++) {
        struct render_result result;
        struct image im;
        render_scene(methods[i],
                     "<shape type='sphere'><boolean name='flip_normals' value='true'/>"
                     "<float name='radius' value='10'/><bsdf type='diffuse'>"
                     "<rgb name='reflectance' value='1'/></bsdf><emitter type='area'>"
                     "<rgb name='radiance' value='1'/></emitter></shape>", 2, &im, &result);
        printf("albedo 1: %llu of %llu paths cut\n", (unsigned long long)result.truncated,
               (unsigned long long)result.paths);
        // one direction in 2^23 is drawn along the surface, and ends its path: 0.25 are expected
        CHECK(result.paths == 16 * 16 * 2 && result.truncated >= result.paths - 5);
        // rounding of 4096 sums and of as many products
        ztable_add(i ? "albedo 1: path" : "albedo 1: simple", INTEGRATOR_MOST_EVENTS,
                   measure(&im, 'G'), INTEGRATOR_MOST_EVENTS * 2e-4);
        image_finish(&im);
    }
}

// Roulette ends those paths long before, and the picture is finite.
static void albedo_one_ends_by_roulette(void) {
    struct render_result result;
    struct image im;
    render_scene("<integrator type='path'/>",
                 "<shape type='sphere'><boolean name='flip_normals' value='true'/>"
                 "<float name='radius' value='10'/><bsdf type='diffuse'>"
                 "<rgb name='reflectance' value='1'/></bsdf></shape><emitter type='point'/>", 16, &im,
                 &result);
    const struct measured m = measure(&im, 'G');
    CHECK(result.truncated == 0 && isfinite(m.mean) && m.mean > 0);
    image_finish(&im);
}

int main(void) {
    scene_folder_open();
    roughness_below_the_switch_is_smooth();
    equal_indices_leave_nothing();
    albedo_one_meets_the_cap();
    albedo_one_ends_by_roulette();
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
