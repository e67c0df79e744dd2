// SPDX-License-Identifier: Apache-2.0
// Closed diffuse rooms, whose radiance is known at every point and in every direction.
//
// Inside a sphere of radius 1 and albedo a, a light of intensity pi at the centre makes the
// irradiance pi everywhere, so radiance a after one bounce, a^2 after two, ...: a / (1 - a). Walls
// that emit e instead make e / (1 - a), in a room of any shape.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

static const char sphere[] =
    "<shape type='sphere'><boolean name='flip_normals' value='true'/>"
    "<bsdf type='diffuse'><rgb name='reflectance' value='%g'/></bsdf>%s</shape>";
static const char cube[] =
    "<shape type='cube'><boolean name='flip_normals' value='true'/>"
    "<bsdf type='diffuse'><rgb name='reflectance' value='%g'/></bsdf>%s</shape>";

static const char point_light[] = "<emitter type='point'><rgb name='intensity' value='3.14159265'/>"
                                  "</emitter>";
// Four lights of different strengths at the same place, which together are the one.
static const char four_lights[] =
    "<emitter type='point'><rgb name='intensity' value='0.314159265'/></emitter>"
    "<emitter type='point'><rgb name='intensity' value='0.628318531'/></emitter>"
    "<emitter type='point'><rgb name='intensity' value='0.942477796'/></emitter>"
    "<emitter type='point'><rgb name='intensity' value='1.256637061'/></emitter>";

struct room {
    const char *name, *shape;
    double albedo, emission; // emission 0: lights at the centre
    const char *lights;
    double direct, all; // radiance with one bounce, with all
};

static const struct room rooms[] = {
    {"sphere, point light", sphere, 0.5, 0, point_light, 0.5, 1},
    {"sphere, four point lights", sphere, 0.5, 0, four_lights, 0.5, 1},
    {"sphere, emitting 0.5", sphere, 0.5, 0.5, "", 0.75, 1},
    {"cube of albedo 0.5, emitting 1", cube, 0.5, 1, "", 1.5, 2},
    {"cube of albedo 0.8, emitting 1", cube, 0.8, 1, "", 1.8, 5},
};

static void write_room(const struct room *r, int paths, char *text, size_t n) {
    char shape[512], area[128] = "", share[64] = "";
    if (paths > 1)
        snprintf(share, sizeof share, "<integer name='shading_samples' value='%d'/>", paths);
    if (r->emission > 0)
        snprintf(area, sizeof area,
                 "<emitter type='area'><rgb name='radiance' value='%g'/></emitter>", r->emission);
    snprintf(shape, sizeof shape, r->shape, r->albedo, area);
    snprintf(text, n,
             "<scene version='3.0.0'><integrator type='path'>%s</integrator>"
             "<sensor type='perspective'><float name='fov' value='100'/><film type='hdrfilm'>"
             "<integer name='width' value='8'/><integer name='height' value='8'/>"
             "<rfilter type='box'/></film></sensor>%s%s</scene>", share, shape, r->lights);
}

// The plain path tracer follows every path until its weight underflows, and has little variance.
// paths: of each first hit.
static void test_room(const struct room *r, const char *integrator, const char *sampler,
                      int paths) {
    const bool simple = strcmp(integrator, "simple") == 0;
    const int spp = (simple ? 16 : 256) * (full_mode() ? 16 : 1);
    const struct job_options o = {.spp = spp, .variance = true, .seed = (uint32_t)ztable_count,
                                  .reading = {.integrator = integrator, .sampler = sampler}};
    const double expected = strcmp(integrator, "direct") == 0 ? r->direct : r->all;
    char text[2048], name[96];
    struct render_result result;
    struct image im;
    write_room(r, paths, text, sizeof text);
    render_text(text, &o, &im, &result);
    snprintf(name, sizeof name, "%s: %s, %s, %d x %d spp", r->name, integrator, sampler, spp,
             paths);
    ztable_add(name, expected, measure(&im, 'G'), ulp_floor(expected, 1 + r->albedo / (1 - r->albedo)));
    CHECK(result.truncated == 0);
    image_finish(&im);
}

int main(void) {
    const char *const methods[] = {"path", "simple", "direct"};
    scene_folder_open();
    for (size_t i = 0; i < sizeof rooms / sizeof *rooms; i++) {
        for (int j = 0; j < 3; j++)
            for (const struct entry *const *s = samplers.entries; *s; s++)
                test_room(&rooms[i], methods[j], (*s)->name, 1);
        for (const struct entry *const *s = samplers.entries; *s; s++)
            test_room(&rooms[i], "path", (*s)->name, 3);
    }
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
