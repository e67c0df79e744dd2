// SPDX-License-Identifier: Apache-2.0
// The same command gives the same bits: for any number of threads, for a picture and its crops,
// for a second run; with all layers. And the layers add up to the picture.
#include "render/picture.h"

enum { WIDTH = 70, HEIGHT = 45 };

// One of everything that could depend on order: instances, straight-through surfaces, a lens, a
// wide filter, several lights with and without group.
static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'>"
    "<integer name='shading_samples' value='%d'/></integrator>"
    "<sensor type='thinlens'><float name='aperture_radius' value='0.05'/>"
    "<float name='focus_distance' value='5'/><float name='fov' value='50'/>"
    "<transform name='to_world'><lookat origin='1,2,5' target='0,0.5,0' up='0,1,0'/></transform>"
    "<sampler type='%s'/><film type='hdrfilm'><integer name='width' value='70'/>"
    "<integer name='height' value='45'/><rfilter type='mitchell'/></film></sensor>"
    "<emitter type='constant' id='sky'><rgb name='radiance' value='0.1,0.2,0.3'/></emitter>"
    "<emitter type='point' id='lamp'><point name='position' x='-2' y='3' z='2'/>"
    "<rgb name='intensity' value='9,7,5'/></emitter>"
    "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
    "<rotate x='1' angle='-90'/></transform><bsdf type='diffuse'>"
    "<texture name='reflectance' type='checkerboard'><transform name='to_uv'>"
    "<scale value='10'/></transform></texture></bsdf></shape>"
    "<shape type='rectangle' id='panel'><transform name='to_world'><scale value='0.5'/>"
    "<rotate x='1' angle='90'/><translate y='3'/></transform>"
    "<emitter type='area'><rgb name='radiance' value='6'/></emitter></shape>"
    "<shape type='sphere'><point name='center' x='-1' y='0.7' z='0'/>"
    "<float name='radius' value='0.7'/><bsdf type='roughdielectric'>"
    "<float name='alpha' value='0.2'/></bsdf></shape>"
    "<shape type='shapegroup' id='group'><shape type='cube'>"
    "<bsdf type='roughconductor'><float name='alpha' value='0.1'/></bsdf></shape>"
    "<shape type='rectangle'><transform name='to_world'><translate z='2'/></transform>"
    "<bsdf type='mask'><float name='opacity' value='0.5'/><bsdf type='twosided'>"
    "<bsdf type='plastic'/></bsdf></bsdf></shape></shape>"
    "<shape type='instance'><ref id='group'/><transform name='to_world'><scale value='0.4'/>"
    "<rotate y='1' angle='30'/><translate x='1' y='0.4' z='0.5'/></transform></shape>"
    "<shape type='instance'><ref id='group'/><transform name='to_world'><scale value='0.2'/>"
    "<translate x='0.3' y='0.2' z='1.5'/></transform></shape></scene>";

static const char all_layers[] = "albedo,N,Ng,Z,P,uv,shape,instance";

static struct job_options options_with(int threads) {
    return (struct job_options){.spp = 20, .threads = threads, .variance = true, .paths = true,
                                .light_groups = true, .aovs = all_layers};
}

static int shading_samples = 1;

static void render_scene(const char *sampler, const struct job_options *o, struct image *im) {
    char text[8192];
    struct render_result result;
    snprintf(text, sizeof text, scene, shading_samples, sampler);
    render_text(text, o, im, &result);
}

static size_t row_bytes(const struct image *im) {
    return (size_t)im->width * (size_t)im->channels * sizeof(float);
}

// Number of rows of `part`, whose first pixel is (x0, y0) of `whole`, that differ in any bit.
static int different_rows(const struct image *whole, const struct image *part, int x0, int y0) {
    int different = 0;
    if (whole->channels != part->channels)
        return part->height;
    for (int y = 0; y < part->height; y++)
        different += memcmp(pixel_at(whole, x0, y0 + y), pixel_at(part, 0, y), row_bytes(part)) != 0;
    return different;
}

static void threads_and_runs_give_the_same_bits(const char *sampler, const struct image *whole) {
    const int threads[] = {1, 2, 3, 8};
    for (int i = 0; i < 4; i++) {
        const struct job_options o = options_with(threads[i]);
        struct image im;
        render_scene(sampler, &o, &im);
        const int different = different_rows(whole, &im, 0, 0);
        printf("%s: %d threads: %d rows of %d channels differ\n", sampler, threads[i], different,
               im.channels);
        CHECK(im.width == WIDTH && im.height == HEIGHT && different == 0);
        image_finish(&im);
    }
}

static void crops_give_the_same_bits(const char *sampler, const struct image *whole) {
    const int xs[] = {0, 13, 37, WIDTH}, ys[] = {0, 7, 34, HEIGHT};
    for (int i = 0; i < 9; i++) {
        struct job_options o = options_with(2);
        const int crop[4] = {xs[i % 3], ys[i / 3], xs[i % 3 + 1], ys[i / 3 + 1]};
        struct image im;
        memcpy(o.crop, crop, sizeof crop);
        render_scene(sampler, &o, &im);
        const int different = different_rows(whole, &im, crop[0], crop[1]);
        printf("%s: crop %d,%d,%d,%d: %d rows differ\n", sampler, crop[0], crop[1], crop[2],
               crop[3], different);
        CHECK(im.width == crop[2] - crop[0] && im.height == crop[3] - crop[1] && different == 0);
        image_finish(&im);
    }
}

// ---- stopping -------------------------------------------------------------------------------

static volatile sig_atomic_t stop;

static void stop_after_some(void *user, double done, const struct film *film) {
    (void)done;
    stop = film_samples(film) >= *(const uint64_t *)user;
}

// A run that is stopped holds the bits of a run of that many samples: passes were cut elsewhere.
static void stopping_gives_the_same_bits(const char *sampler, uint64_t samples) {
    struct job_options o = options_with(2);
    struct render_result result;
    struct image stopped, fresh;
    char text[8192];
    snprintf(text, sizeof text, scene, shading_samples, sampler);
    o.spp = 100000;
    o.stop = &stop;
    o.progress = stop_after_some;
    o.user = &samples;
    stop = 0;
    render_text(text, &o, &stopped, &result);
    CHECK(result.stopped && result.samples >= samples && result.samples < 100000);
    o = options_with(3);
    o.spp = (int)result.samples;
    render_text(text, &o, &fresh, &result);
    const int different = different_rows(&stopped, &fresh, 0, 0);
    printf("%s: stopped after %d samples: %d rows differ\n", sampler, o.spp, different);
    CHECK(!result.stopped && different == 0);
    image_finish(&stopped);
    image_finish(&fresh);
}

// ---- layers ---------------------------------------------------------------------------------

static void layers_do_not_change_the_picture(const char *sampler, const struct image *whole) {
    const struct job_options o = {.spp = 20, .variance = true};
    struct image im;
    double worst = 0;
    render_scene(sampler, &o, &im);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++) {
            const double a = im.pixels[i * im.channels + c];
            const double b = whole->pixels[i * whole->channels + c];
            worst = fmax(worst, fabs(a - b) / fmax(fabs(a), 1e-3));
        }
    printf("%s: without layers the picture differs by %.2g\n", sampler, worst);
    // A sample's contributions are summed in float, here in another order; negative lobes of the
    // filter then let part of the picture cancel.
    CHECK(worst < 1e-5);
    image_finish(&im);
}

// The double sum of the layers of a pixel and of their magnitudes; false: one is not there.
static bool sum_layers(const struct image *im, int pixel, char channel, const char *const *layers,
                       double *sum, double *size) {
    const float *p = im->pixels + (size_t)pixel * (size_t)im->channels;
    *sum = *size = 0;
    for (const char *const *l = layers; *l; l++) {
        char name[64];
        snprintf(name, sizeof name, "%s.%c", *l, channel);
        const int k = image_find_channel(im, name);
        if (k < 0)
            return false;
        *sum += (double)p[k];
        *size += fabs((double)p[k]);
    }
    return true;
}

// What the pixels around hold: their samples are in this one too, of either sign, so that it may be
// far less than what was added up.
static double size_around(const struct image *im, int pixel, char channel, const char *const *layers) {
    const int x = pixel % im->width, y = pixel / im->width;
    double most = 0, sum, size;
    for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < im->height; v++)
        for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < im->width; u++)
            if (sum_layers(im, v * im->width + u, channel, layers, &sum, &size))
                most = fmax(most, size);
    return most;
}

// Largest difference between the picture and the double sum of the layers, in ulp of their size.
static double sum_error(const struct image *im, const char *const *layers) {
    double worst = 0, sum, size;
    for (const char *channel = "RGB"; *channel; channel++) {
        const int c = image_find_channel(im, (const char[]){*channel, 0});
        for (int i = 0; i < im->width * im->height; i++) {
            if (!sum_layers(im, i, *channel, layers, &sum, &size))
                return INFINITY;
            const double off = fabs(sum - (double)im->pixels[(size_t)i * (size_t)im->channels + (size_t)c]);
            worst = fmax(worst, off / fmax(size_around(im, i, *channel, layers) * 0x1p-23, 1e-30));
        }
    }
    return worst;
}

static void layers_add_up(const struct image *im) {
    const char *const groups[] = {"sky", "lamp", "panel", "rest", NULL};
    const char *const paths[] = {"direct_diffuse", "direct_glossy", "direct_specular",
                                 "indirect_diffuse", "indirect_glossy", "indirect_specular",
                                 "emission", NULL};
    const double by_group = sum_error(im, groups), by_path = sum_error(im, paths);
    printf("sum of light groups: %.2f ulp, of paths: %.2f ulp\n", by_group, by_path);
    CHECK(by_group <= 1); // half an ulp for each rounding: the picture is the sum of the layers
    CHECK(by_path <= 2);  // a sample's contributions are summed in float
}

static void test_sampler(const char *sampler) {
    const struct job_options o = options_with(2);
    struct image whole;
    render_scene(sampler, &o, &whole);
    threads_and_runs_give_the_same_bits(sampler, &whole);
    crops_give_the_same_bits(sampler, &whole);
    layers_do_not_change_the_picture(sampler, &whole);
    layers_add_up(&whole);
    image_finish(&whole);
}

int main(void) {
    scene_folder_open();
    for (const struct entry *const *s = samplers.entries; *s; s++)
        test_sampler((*s)->name);
    shading_samples = 3; // paths that share a first hit, and a sum
    test_sampler("sobol");
    shading_samples = 1;
    // These two draw the same numbers whatever the number of samples.
    stopping_gives_the_same_bits("independent", 2);
    stopping_gives_the_same_bits("sobol", 65);
    scene_folder_close();
    return check_result();
}
