// SPDX-License-Identifier: Apache-2.0
// Real scenes of others are read in full: counts as their files have them, as many warnings as they
// must give (which ones: tool/real_scenes.sh). Skips without $RELUME_SHARED_DATA.
#include "scene/summary.h"
#include "scene_text.h"

static const struct known {
    const char *path;
    uint32_t shapes, lights, textures; // elements in the files
    uint64_t triangles;                // counting instances; from the meshes' headers or Mitsuba 3.9.1
    int width, height, depth;          // depth 0: not asked
    unsigned warnings;
} scenes[] = {
    {"bitterli/cornell-box/scene_mitsuba05.xml", 8, 1, 0, 36, 1024, 1024, 65, 0},
    {"bitterli/veach-mis/scene_mitsuba05.xml", 9, 3, 0, 52, 1280, 720, 5, 0},
    {"bitterli/veach-mis/scene_mitsuba3.xml", 9, 3, 0, 52, 1280, 720, 3, 1},
    {"bitterli/classroom/scene.xml", 79, 1, 3, 103832, 1280, 720, 17, 1},
    {"sponza-dabrovic/sponza.xml", 38, 1, 10, 66445, 768, 575, -1, 0},
    {"matpreview/matpreview.xml", 3, 1, 1, 61600, 683, 512, -1, 0},
    {"cbox-spectral/cbox.xml", 8, 1, 0, 38, 256, 256, 6, 0},
    {"cbox-spectral/cbox-rgb.xml", 8, 1, 0, 38, 256, 256, 6, 0},
    {"cbox-spectral/cbox-spectral.xml", 8, 1, 0, 38, 256, 256, 6, 0},
    {"mitsuba-tests/bsdf_spheres/test_arealight_path.xml", 13, 1, 3, 325126, 48, 48, 0, 0},
    {"mitsuba-tests/bsdf_spheres/test_constant_path.xml", 12, 1, 3, 325124, 48, 48, 0, 0},
    {"mitsuba-tests/bsdf_spheres/test_envmap_path.xml", 12, 1, 3, 325124, 48, 48, 0, 0},
    {"mitsuba-tests/bsdf_spheres/test_roughdielectric_path.xml", 2, 3, 0, 32514, 48, 48, 0, 0},
    {"mitsuba-tests/bsdf_spheres/test_roughplastic_linear_path.xml", 5, 3, 0, 130050, 48, 48, 0, 0},
    {"mitsuba-tests/bsdf_spheres/test_textured_diffuse_path.xml", 2, 3, 1, 32514, 48, 48, 0, 0},
    {"mitsuba-tests/floating_sphere/test_directional_direct.xml", 2, 1, 0, 32514, 48, 48, 0, 0},
    {"mitsuba-tests/instancing/test_instancing_path.xml", 3, 1, 0, 97542, 64, 64, 0, 0},
    {"mitsuba-tests/mesh_attributes/test_mesh_attributes_1_face_direct.xml", 1, 1, 1, 528, 48, 48,
     0, 0},
    {"mitsuba-tests/participating_media/test_homo_area_light_volpath.xml", 4, 1, 1, 8720, 48, 48,
     0, 0},
    {"mitsuba-tests/spot_light/test_spot_direct.xml", 1, 2, 1, 2, 48, 48, 0, 0},
};

static void check_scene(const char *folder, const struct known *k) {
    char path[512];
    const struct scene_options options = scene_real_options();
    snprintf(path, sizeof path, "%s/scenes/%s", folder, k->path);
    const unsigned before = log_warning_count();
    struct scene *s = scene_read(path, &options);
    CHECK(s);
    if (!s)
        return;
    printf("%s\n", k->path);
    struct scene_summary sum;
    scene_summary_init(&sum, s);
    CHECK(s->shape_count == k->shapes);
    CHECK(s->light_count == k->lights);
    CHECK(s->texture_count == k->textures);
    CHECK(sum.placed_triangles == k->triangles);
    CHECK(s->film.width == k->width && s->film.height == k->height);
    if (k->depth)
        CHECK(PARAM(int, s->integrator, "max_depth") == k->depth);
    CHECK(log_warning_count() - before == k->warnings);
    CHECK(s->centre[0] == 0 && s->centre[1] == 0 && s->centre[2] == 0);
    scene_summary_finish(&sum);
    scene_destroy(s);
}

int main(void) {
    const char *folder = getenv("RELUME_SHARED_DATA");
    if (!folder || !*folder)
        return 77;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        check_scene(folder, &scenes[i]);
    return check_result();
}
