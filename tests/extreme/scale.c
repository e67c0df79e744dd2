// SPDX-License-Identifier: Apache-2.0
// Scenes of any size and lights of any strength: a factor that is a power of two on all lengths
// leaves the picture as it is, bit for bit; one on all emission is a factor on the picture.
//
// Lengths from 2^-20 to 2^20 (a room of a micrometre, of 4000 km), radiance from 2^-100 to 2^100
// (about 1e-30 to 1e30). Heights of bumps, clip distances and the lens are lengths too, and the
// intensity of a point grows with their square.
//
// What breaks it: below 2^-25 areas of lights leave the range of float (the scene is refused), and
// at 2^-100 the weakest contributions, below 2^-126, count as zero.
#include "render/picture.h"

enum { WIDTH = 48, HEIGHT = 32 };

// Every kind of shape, light and surface that meets a length; SIZE ends every transform.
#define SIZE "<scale value='$l'/>"

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'/><sensor type='thinlens'>"
    "<float name='aperture_radius' value='$aperture'/><float name='focus_distance' value='$focus'/>"
    "<float name='near_clip' value='$near'/><float name='far_clip' value='$far'/>"
    "<float name='fov' value='50'/><transform name='to_world'><lookat "
    "origin='$camera' target='0,$middle,0' up='0,1,0'/></transform>"
    "<sampler type='%s'/><film type='hdrfilm'><integer name='width' value='48'/>"
    "<integer name='height' value='32'/><rfilter type='gaussian'/></film></sensor>"
    "<emitter type='constant'><rgb name='radiance' value='$sky'/></emitter>"
    "<emitter type='directional'><vector name='direction' x='1' y='-2' z='-1'/>"
    "<rgb name='irradiance' value='$sun'/></emitter>"
    "<emitter type='point'><transform name='to_world'><translate x='-2' y='3' z='2'/>" SIZE
    "</transform><rgb name='intensity' value='$lamp'/></emitter>"
    "<emitter type='spot'><transform name='to_world'><lookat origin='2,3,2' target='0,0,0' "
    "up='0,1,0'/>" SIZE "</transform><rgb name='intensity' value='$lamp'/></emitter>"
    // ground with bumps
    "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
    "<rotate x='1' angle='-90'/>" SIZE "</transform><bsdf type='bumpmap'>"
    "<texture name='arbitrary' type='checkerboard'><rgb name='color0' value='0'/>"
    "<rgb name='color1' value='1'/></texture><float name='scale' value='$l'/>"
    "<bsdf type='diffuse'><texture name='reflectance' type='checkerboard'>"
    "<transform name='to_uv'><scale value='10'/></transform></texture></bsdf></bsdf></shape>"
    // lights of every kind of shape
    "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/>"
    "<rotate x='1' angle='90'/><translate y='3'/>" SIZE "</transform>"
    "<emitter type='area'><rgb name='radiance' value='$panel'/></emitter></shape>"
    "<shape type='sphere'><transform name='to_world'><scale value='0.2'/>"
    "<translate x='1.5' y='0.3' z='1.2'/>" SIZE "</transform>"
    "<emitter type='area'><rgb name='radiance' value='$panel'/></emitter></shape>"
    "<shape type='disk'><transform name='to_world'><scale value='0.3'/>"
    "<rotate y='1' angle='80'/><translate x='-2' y='0.5'/>" SIZE "</transform>"
    "<emitter type='area'><rgb name='radiance' value='$panel'/></emitter></shape>"
    "<shape type='obj'><string name='filename' value='light.obj'/><transform name='to_world'>" SIZE
    "</transform><emitter type='area'><rgb name='radiance' value='$panel'/></emitter></shape>"
    // rough glass, a metal cylinder, a mask
    "<shape type='sphere'><transform name='to_world'><scale x='0.7' y='0.5' z='0.7'/>"
    "<translate x='-1' y='0.7'/>" SIZE "</transform><bsdf type='roughdielectric'>"
    "<float name='alpha' value='0.2'/></bsdf></shape>"
    "<shape type='cylinder'><transform name='to_world'><scale value='0.3'/>"
    "<rotate x='1' angle='-90'/><translate x='0.3' z='-1'/>" SIZE "</transform>"
    "<bsdf type='twosided'><bsdf type='roughconductor'><float name='alpha' value='0.1'/></bsdf>"
    "</bsdf></shape>"
    "<shape type='shapegroup' id='group'><shape type='cube'><transform name='to_world'>" SIZE
    "</transform><bsdf type='plastic'/></shape><shape type='rectangle'><transform name='to_world'>"
    "<translate z='2'/>" SIZE "</transform><bsdf type='mask'><float name='opacity' value='0.5'/>"
    "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf></shape></shape>"
    "<shape type='instance'><ref id='group'/><transform name='to_world'><matrix value='$turned'/>"
    "</transform></shape>"
    "<shape type='instance'><ref id='group'/><transform name='to_world'><matrix value='$small'/>"
    "</transform></shape></scene>";

// Several triangles, some wound the other way.
static const char light_mesh[] = "v 1 1 -1\nv 2 1 -1\nv 2 2 -1\nv 1 2 -1.25\nv 1.5 1.5 -0.5\n"
                                 "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 1 5 4\n";

enum { DEFINES = 14 };

struct defines {
    struct scene_define all[DEFINES];
    char texts[DEFINES][128];
    size_t count;
};

__attribute__((format(printf, 3, 4))) static void define(struct defines *d, const char *name,
                                                         const char *format, ...) {
    va_list args;
    va_start(args, format);
    vsnprintf(d->texts[d->count], sizeof d->texts[0], format, args);
    va_end(args);
    d->all[d->count] = (struct scene_define){name, d->texts[d->count]};
    d->count++;
}

// l: factor on lengths; e: on emission.
static void define_all(struct defines *d, double l, double e) {
    d->count = 0;
    define(d, "l", "%.17g", l);
    define(d, "aperture", "%.17g", 0x1p-5 * l);
    define(d, "focus", "%.17g", 5 * l);
    define(d, "near", "%.17g", 0.0625 * l);
    define(d, "far", "%.17g", 1024 * l);
    define(d, "camera", "%.17g,%.17g,%.17g", l, 2 * l, 5 * l);
    define(d, "middle", "%.17g", 0.5 * l);
    define(d, "sky", "%.17g,%.17g,%.17g", 0x1p-5 * e, 0x1p-4 * e, 0x1p-3 * e);
    define(d, "sun", "%.17g", 0.125 * e);
    define(d, "lamp", "%.17g,%.17g,%.17g", 0.5 * e * l * l, 0.25 * e * l * l, 0.25 * e * l * l);
    define(d, "panel", "%.17g", 0.5 * e);
    // turned by the angle of the triangle 3, 4, 5
    define(d, "turned", "0.24 0 0.32 %.17g 0 0.4 0 %.17g -0.32 0 0.24 %.17g 0 0 0 1", l, 0.5 * l,
           0.5 * l);
    define(d, "small", "0.25 0 0 %.17g 0 0.25 0 %.17g 0 0 0.25 %.17g 0 0 0 1", 0.25 * l, 0.25 * l,
           1.5 * l);
}

static void render_scaled(const char *sampler, double l, double e, struct image *im) {
    struct defines d;
    struct render_result result;
    char text[8192];
    define_all(&d, l, e);
    snprintf(text, sizeof text, scene, sampler);
    const struct job_options o = {.spp = 16, .variance = true, .aovs = "albedo,N,Ng,Z,P,uv,shape",
                                  .reading = {.defines = d.all, .define_count = d.count}};
    render_text(text, &o, im, &result);
    CHECK(result.truncated == 0);
}

// Factor of a channel when lengths have the factor l and emission e.
static double channel_factor(const char *name, double l, double e) {
    if (strcmp(name, "R") == 0 || strcmp(name, "G") == 0 || strcmp(name, "B") == 0)
        return e;
    if (strcmp(name, "Z") == 0 || strncmp(name, "P.", 2) == 0)
        return l;
    return strncmp(name, "variance", 8) == 0 ? e * e : 1;
}

// The channel's largest difference from that of `one`, its factor taken out.
static double difference(const struct image *one, const struct image *im, int c, double factor) {
    double worst = 0;
    for (int i = 0; i < one->width * one->height; i++) {
        const size_t at = (size_t)i * (size_t)one->channels + (size_t)c;
        const double a = (double)one->pixels[at], b = (double)im->pixels[at];
        if (a == 1e10 && b == 1e10)
            continue; // the depth of pixels that see nothing, whatever the size
        worst = worst_of(worst, fabs(b / factor - a));
    }
    return worst;
}

// Over all channels; variances of very weak or strong light leave the range of float.
static double largest_difference(const struct image *one, const struct image *im, double l,
                                 double e) {
    double worst = 0;
    for (int c = 0; c < one->channels; c++) {
        const double factor = channel_factor(one->channel_names[c], l, e);
        if (factor < 0x1p120 && factor > 0x1p-120)
            worst = worst_of(worst, difference(one, im, c, factor));
    }
    return worst;
}

static void check_scaled(const char *sampler, const struct image *one, int length, int emission) {
    const double l = exp2(length), e = exp2(emission);
    // eight contributions of a sample that may each be lost below 2^-126
    const double lost = emission < -90 ? 8 * 0x1p-126 / e : 0;
    struct image im;
    render_scaled(sampler, l, e, &im);
    CHECK(im.channels == one->channels);
    const double worst = largest_difference(one, &im, l, e);
    printf("%s: lengths 2^%d, emission 2^%d: differ by at most %.3g\n", sampler, length, emission,
           worst);
    CHECK(worst <= lost);
    image_finish(&im);
}

static double spread(const struct image *im) {
    double lo = INFINITY, hi = 0;
    for (int i = 0; i < im->width * im->height; i++) {
        lo = fmin(lo, (double)im->pixels[i * im->channels]);
        hi = fmax(hi, (double)im->pixels[i * im->channels]);
    }
    return hi - lo;
}

int main(void) {
    const int lengths[] = {-20, -10, -1, 1, 10, 20}, emissions[] = {-100, -80, -30, 1, 100};
    const char *const names[] = {"independent", "sobol"};
    scene_folder_open();
    scene_write("light.obj", light_mesh);
    for (int s = 0; s < 2; s++) {
        struct image one;
        render_scaled(names[s], 1, 1, &one);
        CHECK(one.width == WIDTH && one.height == HEIGHT && spread(&one) > 0.25);
        for (int i = 0; i < 6; i++)
            check_scaled(names[s], &one, lengths[i], 0);
        for (int i = 0; i < 5; i++)
            check_scaled(names[s], &one, 0, emissions[i]);
        image_finish(&one);
    }
    scene_folder_close();
    return check_result();
}
