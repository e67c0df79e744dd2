// SPDX-License-Identifier: Apache-2.0
// The layer N is the normal that light is scattered by: that of a normal or bump map where there is one,
// in whatever it is wrapped, on the outer side of the surface from wherever it is seen.
#include "render/picture.h"

#define DIFFUSE "<bsdf type='diffuse'/>"
#define MAPPED                                                                                     \
    "<bsdf type='normalmap'><rgb name='normalmap' value='0.8 0.5 0.9'/>" DIFFUSE "</bsdf>"
#define BACK_MAPPED "<bsdf type='twosided'>" DIFFUSE MAPPED "</bsdf>"

// Heights of 0.75 u over a rectangle of width 2, so of slope 3/8 to (-3, 0, 8) / sqrt(73).
#define BUMPED                                                                                     \
    "<bsdf type='bumpmap'><texture type='bitmap' name='texture'>"                                   \
    "<string name='filename' value='ramp.exr'/><boolean name='raw' value='true'/>"                 \
    "<string name='wrap_mode' value='clamp'/></texture>" DIFFUSE "</bsdf>"

static const struct {
    const char *bsdf, *integrator;
    int z; // of the camera
    float n[3];
} cases[] = {
    {DIFFUSE, "aov", 5, {0, 0, 1}},
    {"<bsdf type='twosided'>" DIFFUSE "</bsdf>", "aov", -5, {0, 0, 1}},
    {MAPPED, "aov", 5, {0.6f, 0, 0.8f}},
    {MAPPED, "path", 5, {0.6f, 0, 0.8f}},
    {MAPPED, "direct", 5, {0.6f, 0, 0.8f}},
    {"<bsdf type='twosided'>" MAPPED "</bsdf>", "aov", 5, {0.6f, 0, 0.8f}},
    {"<bsdf type='mask'><float name='opacity' value='0.5'/>" MAPPED "</bsdf>", "aov", 5,
     {0.6f, 0, 0.8f}},
    {BACK_MAPPED, "aov", 5, {0, 0, 1}},
    {BACK_MAPPED, "aov", -5, {-0.6f, 0, 0.8f}}, // (0.6, 0, -0.8) as seen from there
    {BUMPED, "aov", 5, {-0.351123f, 0, 0.936329f}},
};

static void test_case(size_t i) {
    char text[2048];
    struct render_result result;
    struct image im;
    const struct job_options o = {.spp = 16, .aovs = "N",
                                  .reading = {.width = 8, .height = 8, .integrator = cases[i].integrator}};
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><sensor type='orthographic'><transform name='to_world'>"
             "<scale x='0.5' y='0.5'/><lookat origin='0,0,%d' target='0,0,0' up='0,1,0'/></transform>"
             "<film type='hdrfilm'><rfilter type='box'/></film></sensor>"
             "<emitter type='constant'/><shape type='rectangle'>%s</shape></scene>",
             cases[i].z, cases[i].bsdf);
    render_text(text, &o, &im, &result);
    const int first = image_find_channel(&im, "N.X");
    CHECK(first >= 0);
    const float *p = pixel_at(&im, 4, 4) + first;
    // Where half of the rays go through, half of the samples see a normal.
    const float length = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int k = 0; k < 3; k++) {
        CHECK_NEAR(p[k] / length, cases[i].n[k], 2e-6);
        if (!(fabsf(p[k] / length - cases[i].n[k]) <= 2e-6f))
            printf("case %zu: %g %g %g\n", i, (double)p[0], (double)p[1], (double)p[2]);
    }
    image_finish(&im);
}

static void write_ramp(void) {
    struct image im;
    CHECK(image_init(&im, 256, 1, 3));
    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++)
            im.pixels[3 * i + c] = 0.75f * ((float)i + 0.5f) / 256;
    CHECK(image_write_exr(scene_path("ramp.exr"), &im, NULL));
    image_finish(&im);
}

int main(void) {
    scene_folder_open();
    accel_thread_init();
    write_ramp();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        test_case(i);
    scene_folder_close();
    return check_result();
}
