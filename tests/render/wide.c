// SPDX-License-Identifier: Apache-2.0
// Vertices that are shaded, and lights that are sampled, WIDE_LANES at a time have the bits of those one
// by one, for every sampler; and pictures of scenes whose packets mix pixels do not depend on the
// crop. Materials by themselves: property/bsdf_wide.c.
#include "math/hash.h"
#include "render/picture.h"

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'>%s</integrator>"
    "<sensor type='perspective'><float name='fov' value='60'/><transform name='to_world'>"
    "<lookat origin='0.1,1,3.9' target='0,0.9,0' up='0,1,0'/></transform><sampler type='%s'/>"
    "<film type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='24'/>"
    "</film></sensor>"
    "<bsdf type='twosided' id='grey'><bsdf type='diffuse'/></bsdf>"
    "<bsdf type='twosided' id='checks'><bsdf type='diffuse'><texture name='reflectance' "
    "type='checkerboard'><transform name='to_uv'><scale value='5'/></transform></texture></bsdf>"
    "</bsdf>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
    "<rotate x='1' angle='-90'/></transform><ref id='checks'/></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='3'/>"
    "<translate z='-2'/></transform><boolean name='flip_normals' value='true'/>"
    "<ref id='grey'/></shape>"
    "<shape type='cube'><transform name='to_world'><scale value='0.5'/>"
    "<rotate y='1' angle='30'/><translate x='-0.8' y='0.5'/></transform>"
    "<bsdf type='diffuse'><rgb name='reflectance' value='0.9,0.5,0.1'/></bsdf></shape>"
    "<shape type='cube'><transform name='to_world'><scale x='0.6' y='0.05' z='0.4'/>"
    "<rotate z='1' angle='20'/><translate x='0.3' y='0.2' z='1.2'/></transform>"
    "<bsdf type='twosided'><bsdf type='roughconductor'><float name='alpha' value='0.05'/>"
    "<texture name='specular_reflectance' type='checkerboard'/></bsdf></bsdf></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='0.7'/>"
    "<translate x='-1' y='1.2' z='-1.5'/></transform><bsdf type='roughconductor'>"
    "<string name='distribution' value='ggx'/><float name='alpha' value='0.3'/>"
    "<string name='material' value='Cu'/></bsdf></shape>"
    "<shape type='sphere'><point name='center' x='0.8' y='0.5' z='0.3'/>"
    "<float name='radius' value='0.5'/><bsdf type='plastic'/></shape>"
    "%s</scene>";

#define LAMP                                                                                       \
    "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/>"                      \
    "<rotate x='1' angle='90'/><translate y='2.2'/></transform>"                                   \
    "<emitter type='area'><rgb name='radiance' value='6,5,4'/></emitter></shape>"

static const char more_lights[] =
    LAMP "<emitter type='constant'><rgb name='radiance' value='0.1,0.2,0.3'/></emitter>"
    "<emitter type='point'><point name='position' x='-2' y='3' z='2'/>"
    "<rgb name='intensity' value='3,2,1'/></emitter>"
    "<shape type='sphere'><point name='center' x='0' y='1.2' z='-1'/>"
    "<float name='radius' value='0.1'/><emitter type='area'/></shape>";

// Enough triangles for the light tree, beside a light without a place.
static const char many_lights[] =
    LAMP "<emitter type='constant'><rgb name='radiance' value='0.1,0.2,0.3'/></emitter>"
    "<shape type='cube'><transform name='to_world'><scale value='0.2'/>"
    "<translate x='-0.5' y='1' z='0.8'/></transform><emitter type='area'>"
    "<rgb name='radiance' value='5,6,7'/></emitter></shape>"
    "<shape type='cube'><transform name='to_world'><scale value='0.1'/>"
    "<translate x='0.9' y='1.5' z='-0.5'/></transform><emitter type='area'>"
    "<rgb name='radiance' value='9,7,2'/></emitter></shape>";

static const char sky[] =
    LAMP "<emitter type='sunsky'><vector name='sun_direction' x='0.3' y='0.2' z='0.8'/>"
    "<float name='sun_aperture' value='20'/></emitter>";

// Beside other lights, so that lanes of a packet choose different ones.
static const char picture_of_sky[] =
    LAMP "<emitter type='envmap'><string name='filename' value='sky.exr'/>"
    "<transform name='to_world'><rotate x='1' y='2' angle='50'/></transform></emitter>";
// Alone, so that their samples are taken ahead where surfaces are shaded one by one.
static const char only_sky[] =
    "<emitter type='sunsky'><vector name='sun_direction' x='0.3' y='0.2' z='0.8'/></emitter>";
static const char only_picture[] =
    "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>";
static const char picture_and_point[] =
    LAMP "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>"
    "<emitter type='point'><point name='position' x='-2' y='3' z='2'/>"
    "<rgb name='intensity' value='3,2,1'/></emitter>";

#define CANDIDATES "<integer name='light_candidates' value='5'/>"

enum { LANES = 128, SAMPLES = 64, MOST_LIGHTS = 8 };

// Wider than one node of its sums, with black texels and a bright one.
static void write_sky(void) {
    enum { WIDTH = 300, HEIGHT = 20 };
    struct rng rng = {5};
    struct image im;
    image_init(&im, WIDTH, HEIGHT, 3);
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        im.pixels[i] = i / 3 % 7 ? rng_float(&rng) : 0;
    im.pixels[3 * (6 * WIDTH + 40)] = 500;
    CHECK(image_write_exr(scene_path("sky.exr"), &im, NULL));
    image_finish(&im);
}

// Adds up what arrives, lane by lane.
struct sum_sink {
    struct sink sink;
    spectrum sums[LANES];
    uint32_t covered;
};

static void nothing(struct sink *s, int lane) {
    (void)s;
    (void)lane;
}

static void add(struct sink *s, int lane, const struct contribution *c) {
    struct sum_sink *sink = (void *)s;
    const float mix = 1 + 0.1f * (float)c->depth + 0.01f * (float)c->lobe + (float)c->source +
                      0.3f * c->wi[0];
    sink->sums[lane] += c->weight * c->emission * mix;
}

static void covered(struct sink *s, int lane) {
    (void)lane;
    ((struct sum_sink *)(void *)s)->covered++;
}

static const struct sink_type sum_type = {.begin = nothing, .add = add, .covered = covered};

static void trace(const struct job *job, const struct response *response, struct sum_sink *sink) {
    const struct scene *s = job->scene;
    const struct sensor_type *sensor = sensor_type_of(s->sensors[0]);
    struct closure_stack stack;
    struct trace_context ctx = {.world = job->world, .response = response, .sink = &sink->sink,
                                .stack = &stack, .lanes = LANES};
    accel_thread_init();
    for (uint32_t k = 0; k < SAMPLES; k++) {
        struct path_start starts[LANES] = {0};
        for (uint32_t i = 0; i < LANES; i++) {
            const uint32_t x = i % 16, y = i / 16;
            starts[i].sampler = sampler_start(job->render.tracer.sampler, x, y, k, SAMPLES, 1, 7);
            const struct vec2 u = sampler_2d(&starts[i].sampler);
            sampler_2d(&starts[i].sampler);
            sensor->ray(s->sensors[0]->data, 2.5f * ((float)x + u.x), 3 * ((float)y + u.y), u,
                        &starts[i].ray);
        }
        integrator_type_of(s->integrator)->trace(s->integrator->data, &ctx, starts);
    }
}

// No light is sampled for many lanes at once.
static void sample_lights_alone(const struct world *w, struct light_type *types) {
    for (uint32_t i = 0; i < w->light_count; i++) {
        types[i] = *w->lights[i].type;
        types[i].sample_wide = NULL;
        w->lights[i].type = &types[i];
    }
}

static void together_is_as_one_by_one(const char *settings, const char *sampler,
                                      const char *others) {
    // Another response than the physical one is asked at every vertex.
    const struct response one_by_one = response_physical;
    static struct sum_sink a, b;
    struct light_type types[MOST_LIGHTS];
    struct job job;
    char text[8192];
    int different = 0, lit = 0;
    snprintf(text, sizeof text, scene, settings, sampler, others);
    scene_write("scene.xml", text);
    if (!job_open(&job, &(struct job_options){.scene = scene_path("scene.xml"), .threads = 1}))
        exit(1);
    a = b = (struct sum_sink){.sink = {.type = &sum_type, .sums = true}};
    trace(&job, &response_physical, &a);
    CHECK(job.world->light_count <= MOST_LIGHTS);
    sample_lights_alone(job.world, types);
    trace(&job, &one_by_one, &b);
    for (int i = 0; i < LANES; i++) {
        different += memcmp(&a.sums[i], &b.sums[i], sizeof a.sums[i]) != 0;
        lit += !spectrum_is_black(a.sums[i]);
    }
    printf("%s, %s: %d of %d lanes differ\n", sampler, settings, different, LANES);
    CHECK(different == 0 && a.covered == b.covered && a.covered > 0);
    CHECK(lit > LANES / 4);
    job_close(&job);
}

static void crops_give_the_same_bits(void) {
    struct job_options o = {.spp = 20, .variance = true, .threads = 1};
    struct render_result result;
    struct image whole, part;
    char text[8192];
    snprintf(text, sizeof text, scene, "", "sobol", more_lights);
    render_text(text, &o, &whole, &result);
    const int crops[][4] = {{0, 0, 13, 9}, {13, 9, 14, 10}, {5, 3, 40, 24}};
    for (int i = 0; i < 3; i++) {
        int different = 0;
        memcpy(o.crop, crops[i], sizeof crops[i]);
        render_text(text, &o, &part, &result);
        for (int y = 0; y < part.height; y++)
            different += memcmp(pixel_at(&whole, crops[i][0], crops[i][1] + y), pixel_at(&part, 0, y),
                                (size_t)part.width * (size_t)part.channels * sizeof(float)) != 0;
        printf("crop %d: %d of %d rows differ\n", i, different, part.height);
        CHECK(different == 0);
        image_finish(&part);
    }
    image_finish(&whole);
}

int main(void) {
    scene_folder_open();
    write_sky();
    for (int i = 0; samplers.entries[i]; i++) {
        together_is_as_one_by_one("", samplers.entries[i]->name, LAMP);
        together_is_as_one_by_one("", samplers.entries[i]->name, more_lights);
        together_is_as_one_by_one("", samplers.entries[i]->name, sky);
        together_is_as_one_by_one("", samplers.entries[i]->name, only_picture);
    }
    together_is_as_one_by_one("<boolean name='hide_emitters' value='true'/>"
                              "<boolean name='strict_normals' value='true'/>", "sobol", more_lights);
    together_is_as_one_by_one("<string name='light_choice' value='tree'/>", "sobol", more_lights);
    together_is_as_one_by_one("", "sobol", many_lights);
    together_is_as_one_by_one("", "sobol", picture_of_sky);
    together_is_as_one_by_one("", "sobol", picture_and_point);
    together_is_as_one_by_one("", "sobol", only_sky);
    together_is_as_one_by_one(CANDIDATES, "sobol", more_lights);
    together_is_as_one_by_one(CANDIDATES, "independent", many_lights);
    together_is_as_one_by_one(CANDIDATES, "sobol", sky);
    together_is_as_one_by_one(CANDIDATES, "sobol", only_picture);
    together_is_as_one_by_one(CANDIDATES "<boolean name='strict_normals' value='true'/>", "sobol",
                              only_sky);
    together_is_as_one_by_one("<integer name='max_depth' value='3'/>"
                              "<integer name='rr_depth' value='1'/>", "independent", LAMP);
    crops_give_the_same_bits();
    scene_folder_close();
    return check_result();
}
