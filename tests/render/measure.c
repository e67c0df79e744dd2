// SPDX-License-Identifier: Apache-2.0
// Measuring at points against closed forms, in lux: lights over a floor, a uniform sky, a closed
// diffuse room, fog; and the same by the meters that stand in a scene.
#include "driver/measure.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3, EFFICACY = 683;

struct probe {
    const char *name;
    struct sensor_point at;
    double expected; // irradiance or radiance of a grey light
};

// A point has sixteen replicates; as many of the same point make the error that ztable.h wants.
enum { REPEATS = 16, MOST_PROBES = 4 };

static void add_rows(const char *integrator, const struct probe *probes, int count,
                     const struct measure_result *results) {
    for (int i = 0; i < count; i++) {
        const double lux = EFFICACY * probes[i].expected;
        struct measured got = {0, 0};
        char row[96];
        for (int k = 0; k < REPEATS; k++) {
            const struct meter_reading *r = &results[k * count + i].reading;
            got.mean += EFFICACY * r->luminance / REPEATS;
            got.error += pow(EFFICACY * r->luminance_error / REPEATS, 2);
        }
        got.error = sqrt(got.error);
        snprintf(row, sizeof row, "%s: %s", probes[i].name, integrator);
        ztable_add(row, lux, got, 20 * ulp_floor(lux, 1));
    }
}

static void measure_scene(const char *scene, const char *integrator, bool radiance,
                          const struct probe *probes, int count) {
    struct sensor_point points[MOST_PROBES * REPEATS];
    struct measure_result results[MOST_PROBES * REPEATS];
    struct job job;
    char text[4096];
    snprintf(text, sizeof text, "<scene version='3.0.0'><integrator type='%s'/>%s</scene>",
             integrator, scene);
    scene_write("scene.xml", text);
    const struct job_options options = {.scene = scene_path("scene.xml"),
                                        .seed = (uint32_t)ztable_count,
                                        .reading = {.sensorless = true}};
    const struct measure_options measuring = {.radiance = radiance,
                                              .samples = full_mode() ? 65536 : 1024};
    if (!job_open(&job, &options))
        exit(1);
    struct measure *m = measure_create(&job, &measuring);
    for (int i = 0; i < REPEATS * count; i++)
        points[i] = probes[i % count].at;
    CHECK(m && measure_points(m, points, (uint32_t)(REPEATS * count), results));
    for (int i = 0; i < REPEATS * count; i++)
        CHECK(results[i].samples == measuring.samples && !results[i].noisy);
    add_rows(integrator, probes, count, results);
    measure_destroy(m);
    job_close(&job);
}

#define MEASURE(scene, radiance, probes)                                                           \
    for (int way = 0; way < 2; way++)                                                              \
    measure_scene((scene), way ? "volpath" : "path", (radiance), (probes),                         \
                  sizeof(probes) / sizeof *(probes))

#define FLOOR(albedo)                                                                              \
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"               \
    "<scale value='1000'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='" albedo \
    "'/></bsdf></shape>"

// Above the horizon a sphere of radiance L gives pi L (r/d)^2 cos.
static void test_lights(void) {
    const double e = M_PI * 100 * 0.01;
    const struct probe sphere[] = {
        {"sphere light, below it", {{0, 0, 0}, {0, 1, 0}}, e / 4},
        {"sphere light, aside", {{1.5, 0, 0}, {0, 1, 0}}, e / 6.25 * 2 / 2.5},
        {"sphere light, turned to it", {{1.5, 1e-3, 0}, {-0.6f, 0.8f, 0}}, 0},
        {"sphere light, turned away", {{0, 3, 0}, {0, 1, 0}}, 0},
    };
    struct probe turned[4];
    memcpy(turned, sphere, sizeof sphere);
    const double x = 1.5, y = 2 - 1e-3, d2 = x * x + y * y;
    turned[2].expected = e / d2 * (0.6 * x + 0.8 * y) / sqrt(d2);
    MEASURE("<shape type='sphere'><point name='center' x='0' y='2' z='0'/>"
            "<float name='radius' value='0.1'/><emitter type='area'>"
            "<rgb name='radiance' value='100'/></emitter></shape>" FLOOR("0"), false, turned);
    const struct probe point[] = {
        {"point light, below it", {{0, 0, 0}, {0, 1, 0}}, 10.0 / 4},
        {"point light, aside", {{1.5, 0, 0}, {0, 1, 0}}, 10.0 / 6.25 * 2 / 2.5},
    };
    MEASURE("<emitter type='point'><point name='position' x='0' y='2' z='0'/>"
            "<rgb name='intensity' value='10'/></emitter>" FLOOR("0"), false, point);
}

// A floor of albedo a under a sky of radiance 1: above it a meter turned down gets a pi.
static void test_sky(void) {
    const struct probe probes[] = {
        {"sky, on the floor", {{0, 0, 0}, {0, 1, 0}}, M_PI},
        {"sky, above it, tilted up", {{5, 1, 2}, {0, 1, 0}}, M_PI},
        {"sky, turned down", {{0, 0.01, 0}, {0, -1, 0}}, 0.25 * M_PI},
    };
    const char *const scene =
        "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>" FLOOR("0.25");
    MEASURE(scene, false, probes);
    const struct probe rays[] = {
        {"sky, radiance upwards", {{0, 1, 0}, {0.6f, 0.8f, 0}}, 1},
        {"sky, radiance of the floor", {{0, 1, 0}, {0.6f, -0.8f, 0}}, 0.25},
    };
    MEASURE(scene, true, rays);
}

// In a closed room that emits e and reflects a, everything has the radiance e / (1 - a).
static void test_room(void) {
    const struct probe probes[] = {
        {"room, in the middle", {{0, 0, 0}, {0, 1, 0}}, 2 * M_PI},
        {"room, near a wall", {{0.999, 0.3, -0.2}, {-1, 0, 0}}, 2 * M_PI},
        {"room, askew", {{0.5, -0.5, 0.2}, {0.48f, 0.6f, 0.64f}}, 2 * M_PI},
    };
    MEASURE("<shape type='cube'><boolean name='flip_normals' value='true'/><bsdf type='diffuse'>"
            "<rgb name='reflectance' value='0.5'/></bsdf><emitter type='area'>"
            "<rgb name='radiance' value='1'/></emitter></shape>", false, probes);
}

// A meter in the scene; the picture's mean.
static void test_sensor(const char *name, const char *scene, double expected) {
    const struct job_options o = {.spp = full_mode() ? 16384 : 1024, .variance = true,
                                  .seed = (uint32_t)ztable_count};
    struct render_result result;
    struct image im;
    char text[4096];
    snprintf(text, sizeof text, "<scene version='3.0.0'>%s</scene>", scene);
    render_text(text, &o, &im, &result);
    ztable_add(name, EFFICACY * expected,
               (struct measured){EFFICACY * measure(&im, 'G').mean, EFFICACY * measure(&im, 'G').error},
               20 * ulp_floor(EFFICACY * expected, 1));
    image_finish(&im);
}

#define FILM "<film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='2'/></film>"
#define SKY "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>"
#define METER "<sensor type='irradiancemeter'>" FILM "</sensor>"

static void test_sensors(void) {
    test_sensor("irradiancemeter, rectangle under the sky", SKY
                "<shape type='rectangle'>" METER "</shape>", M_PI);
    test_sensor("irradiancemeter, its dark side",
                SKY "<shape type='rectangle'><boolean name='flip_normals' value='true'/>" METER
                "</shape><shape type='rectangle'><transform name='to_world'><scale value='1000'/>"
                "<translate z='-1e-3'/></transform><bsdf type='diffuse'>"
                "<rgb name='reflectance' value='0'/></bsdf></shape>", 0);
    test_sensor("irradiancemeter, ellipsoid under the sky", SKY
                "<shape type='sphere'><transform name='to_world'><scale x='3' y='1' z='2'/>"
                "</transform>" METER "</shape>", M_PI);
    // The flux of a point light in the middle of a cylinder without ends over its area, by height
    // and radius: 4 pi I sin(atan(1/2)) / (2 pi) / 1, h = 1.
    test_sensor("irradiancemeter, cylinder around a point light",
                "<emitter type='point'><point name='position' x='0' y='0' z='0.5'/>"
                "<rgb name='intensity' value='1'/></emitter><shape type='cylinder'>"
                "<boolean name='flip_normals' value='true'/><bsdf type='diffuse'>"
                "<rgb name='reflectance' value='0'/></bsdf>" METER "</shape>",
                2 * sin(atan(0.5)));
    // All of the light: 4 pi I over the area of a cube of side 2.
    test_sensor("irradiancemeter, cube around a point light",
                "<emitter type='point'><point name='position' x='0.4' y='-0.3' z='0.5'/>"
                "<rgb name='intensity' value='1'/></emitter><shape type='cube'>"
                "<boolean name='flip_normals' value='true'/><bsdf type='diffuse'>"
                "<rgb name='reflectance' value='0'/></bsdf>" METER "</shape>", 4 * M_PI / 24);
    test_sensor("radiancemeter", SKY "<sensor type='radiancemeter'><point name='origin' x='0' y='1' "
                "z='0'/><vector name='direction' x='0.6' y='-0.8' z='0'/>" FILM "</sensor>"
                FLOOR("0.25"), 0.25);
}

int main(void) {
    scene_folder_open();
    test_lights();
    test_sky();
    test_room();
    test_sensors();
    ztable_finish(FALSE_ALARMS);
    scene_folder_close();
    return check_result();
}
