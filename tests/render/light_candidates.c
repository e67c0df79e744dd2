// SPDX-License-Identifier: Apache-2.0
// However many light samples a glossy surface chooses from, the picture is the same: metal, plastic
// and glass, rough ones, under the picture of a sky, a sky with a sun, and lights near by; and under
// a sky it has less noise.
#include "math/hash.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='4'/>"
    "<integer name='light_candidates' value='%d'/>%s</integrator>"
    "<sensor type='perspective'><float name='fov' value='50'/><transform name='to_world'>"
    "<lookat origin='0,2,-5' target='%s' up='0,1,0'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/>"
    "<rfilter type='box'/></film></sensor>"
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"
    "<scale value='4'/></transform>%s</shape>"
    "<shape type='sphere'><point name='center' x='-1.1' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughconductor'>"
    "<float name='alpha' value='0.1'/></bsdf></shape>"
    "<shape type='sphere'><point name='center' x='0.2' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughplastic'>"
    "<float name='alpha' value='0.1'/></bsdf></shape>"
    "<shape type='sphere'><point name='center' x='1.5' y='0.6' z='0'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughdielectric'>"
    "<float name='alpha' value='0.3'/></bsdf></shape>%s</scene>";

static const char all[] = "0,0.4,0", only_floor[] = "0,0,-3";
static const char diffuse[] = "<bsdf type='diffuse'/>";
static const char metal[] =
    "<bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf>";

static const char picture[] =
    "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>";
#define SUN \
    "<emitter type='sunsky'><vector name='sun_direction' x='0.5' y='0.6' z='0.6'/>" \
    "<float name='sun_aperture' value='20'/></emitter>"
#define LAMP \
    "<shape type='rectangle'><transform name='to_world'><scale value='0.8'/>" \
    "<rotate x='1' angle='90'/><translate y='3'/></transform><emitter type='area'>" \
    "<rgb name='radiance' value='3,2,1'/></emitter></shape>"

static const char sun[] = SUN;
static const char sun_and_lamp[] = SUN LAMP;
static const char near_lights[] =
    LAMP
    "<shape type='sphere'><point name='center' x='-2' y='1.5' z='-2'/>"
    "<float name='radius' value='0.2'/><emitter type='area'>"
    "<rgb name='radiance' value='5'/></emitter></shape>"
    "<emitter type='point'><point name='position' x='2' y='3' z='-2'/>"
    "<rgb name='intensity' value='2,3,4'/></emitter>";

static const char masked[] =
    LAMP "<shape type='rectangle'><transform name='to_world'><scale x='0.5'/>"
    "<rotate x='1' angle='90'/><translate y='2.5'/></transform><bsdf type='mask'>"
    "<float name='opacity' value='0.4'/><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf></shape>";

// A dim sky with a broad bright place.
static void write_sky(void) {
    enum { WIDTH = 64, HEIGHT = 32 };
    struct image im;
    image_init(&im, WIDTH, HEIGHT, 3);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const float r2 = sqr((float)(x - 20) / 2) + sqr((float)(y - 8) / 2);
            for (int k = 0; k < 3; k++)
                im.pixels[3 * (y * WIDTH + x) + k] = 0.1f + 50 * expf(-r2);
        }
    CHECK(image_write_exr(scene_path("sky.exr"), &im, NULL));
    image_finish(&im);
}

struct picture_of {
    const char *emitters, *settings, *floor, *target;
};

static uint32_t seed = 100; // of the last picture

static struct measured mean_of(const struct picture_of *p, int candidates, int spp) {
    static char text[8192];
    struct render_result result;
    struct image im;
    snprintf(text, sizeof text, scene, candidates, p->settings, p->target, p->floor, p->emitters);
    const struct job_options o = {.spp = spp, .variance = true, .seed = ++seed};
    render_text(text, &o, &im, &result);
    const struct measured m = measure(&im, 'G');
    image_finish(&im);
    return m;
}

static void compare(const char *name, const char *emitters, const char *settings, int spp) {
    static const int counts[] = {0, 2, 3, 8};
    const struct picture_of p = {emitters, settings, diffuse, all};
    const struct measured one = mean_of(&p, 1, 4 * spp);
    for (int i = 0; i < 4; i++) {
        char row[96];
        struct measured m = mean_of(&p, counts[i], spp);
        m.error = hypot(m.error, one.error);
        snprintf(row, sizeof row, "%s, %d candidates against 1", name, counts[i]);
        ztable_add(row, one.mean, m, ulp_floor(one.mean, 3));
    }
}

// On rough metal, seen alone. The sum of eight pairs: of a single one either variance is known to a tenth.
static void noise_falls(int spp) {
    const struct picture_of p = {picture, "", metal, only_floor};
    double one = 0, eight = 0;
    for (int i = 0; i < 8; i++) {
        one += pow(mean_of(&p, 1, spp).error, 2);
        eight += pow(mean_of(&p, 8, spp).error, 2);
    }
    printf("variance with 8 candidates: %.3f of that with 1\n", eight / one);
    CHECK(eight < 0.88 * one);
}

int main(void) {
    const int spp = full_mode() ? 16384 : 1024;
    const char strict[] = "<boolean name='strict_normals' value='true'/>";
    scene_folder_open();
    write_sky();
    compare("picture of a sky", picture, "", spp);
    compare("sun and sky", sun, "", spp);
    compare("near lights", near_lights, "", spp);
    compare("near lights, tree", near_lights,
            "<string name='light_choice' value='tree'/>", spp);
    compare("picture of a sky, strict normals", picture, strict, spp);
    compare("sun and sky beside a lamp", sun_and_lamp, "", spp);
    compare("lamp behind a mask, two paths", masked,
            "<integer name='shading_samples' value='2'/>", spp);
    ztable_finish(FALSE_ALARMS);
    noise_falls(spp);
    scene_folder_close();
    return check_result();
}
