// SPDX-License-Identifier: Apache-2.0
// The same command gives the same bits: for any number of threads, for a picture and its crops,
// for a second run; with all layers. And the layers add up to the picture.
//
// Rays are traced in several ways, by the scene: one by one past instances and surfaces that let rays
// through; against every primitive where there are few; as packets of any rays; or, where a tree is
// large, the camera's and the first shadow rays as coherent packets, later hits one by one and later
// shadow rays as streams, behind the facets that were learnt to block most of them. Each is compared.
#include "accel/world.h"
#include "render/picture.h"

enum { WIDTH = 70, HEIGHT = 45 };

#define FILM                                                                                       \
    "<sampler type='%s'/><film type='hdrfilm'><integer name='width' value='70'/>"                   \
    "<integer name='height' value='45'/><rfilter type='mitchell'/></film></sensor>"

// One of everything that could depend on order: instances, straight-through surfaces, a lens, a
// wide filter, several lights with and without group.
static const char instances[] =
    "<scene version='3.0.0'>%s"
    "<sensor type='thinlens'><float name='aperture_radius' value='0.05'/>"
    "<float name='focus_distance' value='5'/><float name='fov' value='50'/>"
    "<transform name='to_world'><lookat origin='1,2,5' target='0,0.5,0' up='0,1,0'/></transform>"
    FILM
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

// A street under a sky: most of the sky's rays end at its walls, those of the small panel run side by
// side. The ground's triangles decide how rays are traced.
static const char street[] =
    "<scene version='3.0.0'>%s<sensor type='perspective'><float name='fov' value='50'/>"
    "<transform name='to_world'><lookat origin='0.5,3,5' target='0,0.5,0' up='0,1,0'/></transform>"
    FILM
    "<emitter type='constant' id='sky'><rgb name='radiance' value='0.1,0.2,0.3'/></emitter>"
    "<emitter type='point' id='lamp'><point name='position' x='-1' y='3' z='2'/>"
    "<rgb name='intensity' value='9,7,5'/></emitter>"
    "<shape type='obj'><string name='filename' value='ground.obj'/><bsdf type='twosided'>"
    "<bsdf type='diffuse'/></bsdf></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
    "<rotate y='1' angle='90'/><translate x='-2'/></transform><bsdf type='twosided'>"
    "<bsdf type='diffuse'/></bsdf></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='4'/>"
    "<rotate y='1' angle='-90'/><translate x='2'/></transform><bsdf type='twosided'>"
    "<bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf></bsdf></shape>"
    "<shape type='rectangle' id='panel'><transform name='to_world'><scale value='0.2'/>"
    "<rotate x='1' angle='90'/><translate y='3'/></transform>"
    "<emitter type='area'><rgb name='radiance' value='30'/></emitter></shape>"
    "<shape type='cube'><transform name='to_world'><scale value='0.4'/>"
    "<rotate y='1' angle='30'/><translate x='0.8' y='0.5'/></transform><bsdf type='plastic'/></shape>"
    "<shape type='sphere'><point name='center' x='-0.7' y='0.8' z='0.5'/>"
    "<float name='radius' value='0.6'/><bsdf type='roughdielectric'>"
    "<float name='alpha' value='0.2'/></bsdf></shape></scene>";

// n x n squares of low hills, two triangles each.
static void write_ground(int n) {
    const size_t room = (size_t)(n + 1) * (size_t)(n + 1) * 160;
    char *text = mem_array(room, 1);
    size_t used = 0;
    for (int i = 0; i < (n + 1) * (n + 1); i++) {
        const double x = i % (n + 1) * 8.0 / n - 4, z = i / (n + 1) * 8.0 / n - 4;
        used += (size_t)snprintf(text + used, room - used, "v %g %g %g\n", x,
                                 0.1 * sin(3 * x) * sin(2 * z), z);
    }
    for (int i = 0; i < n * n; i++) {
        const int v = i / n * (n + 1) + i % n + 1, w = v + n + 1; // counted from 1
        used += (size_t)snprintf(text + used, room - used, "f %d %d %d\nf %d %d %d\n", v, w, v + 1,
                                 v + 1, w, w + 1);
    }
    scene_write("ground.obj", text);
    mem_free(text);
}

// ---- what is rendered -------------------------------------------------------------------------

enum tracing { ONE_BY_ONE, FEW, ANY_PACKETS, STREAMS };

struct subject {
    const char *name, *scene, *integrator, *sampler;
    int spp;
    enum tracing tracing;
    int squares; // of the ground
};

static const char all_layers[] = "albedo,N,Ng,Z,P,uv,shape,instance";

static struct job_options options_with(const struct subject *s, int threads) {
    return (struct job_options){.spp = s->spp, .threads = threads, .variance = true, .paths = true,
                                .light_groups = true, .aovs = all_layers};
}

static void write_subject(const struct subject *s) {
    char text[8192];
    snprintf(text, sizeof text, s->scene, s->integrator, s->sampler);
    scene_write("scene.xml", text);
}

static void render_subject(const struct subject *s, const struct job_options *o, struct image *im) {
    struct render_result result;
    write_subject(s);
    render_file(scene_path("scene.xml"), o, im, &result);
}

// That the scene is traced the way it stands for.
static void check_tracing(const struct subject *s) {
    struct job_options o = options_with(s, 1);
    struct job job;
    write_subject(s);
    o.scene = scene_path("scene.xml");
    if (!job_open(&job, &o))
        exit(1);
    const struct accel *a = job.world->accel;
    const bool one_by_one = a->has_instances && job.world->shadow_rays_may_pass;
    CHECK(one_by_one == (s->tracing == ONE_BY_ONE));
    CHECK(accel_mixes_packets(a) == (s->tracing == FEW));
    CHECK(job.world->packets_pay == (s->tracing == FEW || s->tracing == ANY_PACKETS));
    CHECK((a->blockers != NULL) == (s->tracing == ANY_PACKETS || s->tracing == STREAMS));
    job_close(&job);
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

static void threads_and_runs_give_the_same_bits(const struct subject *s, const struct image *whole) {
    const int threads[] = {1, 2, 3, 8};
    for (int i = 0; i < 4; i++) {
        const struct job_options o = options_with(s, threads[i]);
        struct image im;
        render_subject(s, &o, &im);
        const int different = different_rows(whole, &im, 0, 0);
        printf("%s: %d threads: %d rows of %d channels differ\n", s->name, threads[i], different,
               im.channels);
        CHECK(im.width == WIDTH && im.height == HEIGHT && different == 0);
        image_finish(&im);
    }
}

static void crops_give_the_same_bits(const struct subject *s, const struct image *whole) {
    const int xs[] = {0, 13, 37, WIDTH}, ys[] = {0, 7, 34, HEIGHT};
    for (int i = 0; i < 9; i++) {
        struct job_options o = options_with(s, 2);
        const int crop[4] = {xs[i % 3], ys[i / 3], xs[i % 3 + 1], ys[i / 3 + 1]};
        struct image im;
        memcpy(o.crop, crop, sizeof crop);
        render_subject(s, &o, &im);
        const int different = different_rows(whole, &im, crop[0], crop[1]);
        printf("%s: crop %d,%d,%d,%d: %d rows differ\n", s->name, crop[0], crop[1], crop[2],
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
static void stopping_gives_the_same_bits(const struct subject *s, uint64_t samples) {
    struct job_options o = options_with(s, 2);
    struct render_result result;
    struct image stopped, fresh;
    write_subject(s);
    o.spp = 100000;
    o.stop = &stop;
    o.progress = stop_after_some;
    o.user = &samples;
    stop = 0;
    render_file(scene_path("scene.xml"), &o, &stopped, &result);
    CHECK(result.stopped && result.samples >= samples && result.samples < 100000);
    o = options_with(s, 3);
    o.spp = (int)result.samples;
    render_file(scene_path("scene.xml"), &o, &fresh, &result);
    const int different = different_rows(&stopped, &fresh, 0, 0);
    printf("%s: stopped after %d samples: %d rows differ\n", s->name, o.spp, different);
    CHECK(!result.stopped && different == 0);
    image_finish(&stopped);
    image_finish(&fresh);
}

// ---- layers ---------------------------------------------------------------------------------

static void layers_do_not_change_the_picture(const struct subject *s, const struct image *whole) {
    const struct job_options o = {.spp = s->spp, .variance = true};
    struct image im;
    double worst = 0;
    render_subject(s, &o, &im);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++) {
            const double a = im.pixels[i * im.channels + c];
            const double b = whole->pixels[i * whole->channels + c];
            worst = worst_of(worst, fabs(a - b) / fmax(fabs(a), 1e-3));
        }
    printf("%s: without layers the picture differs by %.2g\n", s->name, worst);
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
            worst = worst_of(worst, off / fmax(size_around(im, i, *channel, layers) * 0x1p-23, 1e-30));
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

static void test_subject(const struct subject *s) {
    const struct job_options o = options_with(s, 2);
    struct image whole;
    if (s->squares)
        write_ground(s->squares);
    check_tracing(s);
    render_subject(s, &o, &whole);
    threads_and_runs_give_the_same_bits(s, &whole);
    crops_give_the_same_bits(s, &whole);
    layers_do_not_change_the_picture(s, &whole);
    layers_add_up(&whole);
    image_finish(&whole);
}

static const char path[] = "<integrator type='path'/>";
static const char direct[] = "<integrator type='direct'/>";
static const char volpath[] = "<integrator type='volpath'/>";
// paths that share a first hit, and a sum
static const char shared[] =
    "<integrator type='path'><integer name='shading_samples' value='3'/></integrator>";

static const struct subject subjects[] = {
    {"shared first hits", instances, shared, "sobol", 20, ONE_BY_ONE, 0},
    {"few triangles", street, path, "sobol", 20, FEW, 5},
    {"few triangles, direct", street, direct, "sobol", 16, FEW, 5},
    {"few triangles, volpath", street, volpath, "independent", 8, FEW, 5},
    {"packets, shared first hits", street, shared, "sobol", 8, ANY_PACKETS, 16},
    {"streams", street, path, "sobol", 70, STREAMS, 40},
    {"streams, direct", street, direct, "sobol", 16, STREAMS, 40},
    {"streams, shared first hits", street, shared, "sobol", 8, STREAMS, 40},
};

int main(void) {
    scene_folder_open();
    for (const struct entry *const *e = samplers.entries; *e; e++)
        test_subject(&(struct subject){(*e)->name, instances, path, (*e)->name, 20, ONE_BY_ONE, 0});
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++)
        test_subject(&subjects[i]);
    // These two draw the same numbers whatever the number of samples.
    stopping_gives_the_same_bits(
        &(struct subject){"independent", instances, path, "independent", 20, ONE_BY_ONE, 0}, 2);
    stopping_gives_the_same_bits(
        &(struct subject){"sobol", instances, path, "sobol", 20, ONE_BY_ONE, 0}, 65);
    scene_folder_close();
    return check_result();
}
