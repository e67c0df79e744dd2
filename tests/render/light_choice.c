// SPDX-License-Identifier: Apache-2.0
// However lights are chosen, the picture is the same: hundreds of emitting triangles, spheres,
// spots, points and a sky over a rough glass sheet and a diffuse floor, by tree, by power and
// uniformly, with light samples alone and with MIS.
#include "math/hash.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

enum { TRIANGLES = 300, TEXT = 65536 };

static float number(struct rng *r, float lo, float hi) {
    return lerpf(rng_float(r), lo, hi);
}

static void write_triangles(void) {
    static char text[TEXT];
    struct rng r = {5};
    size_t n = 0;
    for (int i = 0; i < TRIANGLES; i++) {
        const float x = number(&r, -4, 4), y = number(&r, 1, 3), z = number(&r, -4, 4);
        const float size = i % 10 ? 0.05f : 0.4f;
        for (int k = 0; k < 3; k++)
            n += (size_t)snprintf(text + n, TEXT - n, "v %.4f %.4f %.4f\n",
                                  (double)(x + number(&r, -size, size)),
                                  (double)(y + number(&r, -size, size)),
                                  (double)(z + number(&r, -size, size)));
    }
    for (int i = 0; i < TRIANGLES; i++)
        n += (size_t)snprintf(text + n, TEXT - n, "f %d %d %d\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    scene_write("lights.obj", text);
}

static size_t add_lights(char *text, size_t n) {
    struct rng r = {6};
    for (int i = 0; i < 12; i++) {
        const double x = (double)number(&r, -4, 4), z = (double)number(&r, -4, 4);
        const double y = (double)number(&r, 1, 3);
        if (i % 3 == 0)
            n += (size_t)snprintf(text + n, TEXT - n,
                                  "<shape type='sphere'><point name='center' x='%g' y='%g' z='%g'/>"
                                  "<float name='radius' value='0.1'/><emitter type='area'>"
                                  "<rgb name='radiance' value='3'/></emitter></shape>", x, y, z);
        else if (i % 3 == 1)
            n += (size_t)snprintf(text + n, TEXT - n,
                                  "<emitter type='spot'><transform name='to_world'><lookat "
                                  "origin='%g,%g,%g' target='0,0,0' up='0,0.1,1'/></transform>"
                                  "<rgb name='intensity' value='0.5'/></emitter>", x, y, z);
        else
            n += (size_t)snprintf(text + n, TEXT - n,
                                  "<emitter type='point'><point name='position' x='%g' y='%g' "
                                  "z='%g'/><rgb name='intensity' value='0.05'/></emitter>",
                                  x, y, z);
    }
    return n;
}

// Mean of the picture.
static struct measured render_choice(const char *integrator, const char *choice, int spp) {
    static char text[TEXT];
    size_t n = (size_t)snprintf(
        text, TEXT,
        "<scene version='3.0.0'><integrator type='%s'><string name='light_choice' value='%s'/>%s"
        "</integrator><sensor type='perspective'><float name='fov' value='70'/>"
        "<transform name='to_world'>"
        "<lookat origin='0,2,-5' target='0,0.3,0' up='0,1,0'/></transform>"
        "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/>"
        "<rfilter type='box'/></film></sensor>"
        "<emitter type='constant'><rgb name='radiance' value='0.02'/></emitter>"
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"
        "<scale value='5'/></transform><bsdf type='diffuse'/></shape>"
        "<shape type='rectangle'><transform name='to_world'><translate z='1'/></transform>"
        "<bsdf type='roughdielectric'><float name='alpha' value='0.4'/></bsdf></shape>"
        "<shape type='obj'><string name='filename' value='lights.obj'/><emitter type='area'>"
        "<rgb name='radiance' value='2'/></emitter></shape>",
        integrator, choice,
        strcmp(integrator, "direct") == 0
            ? "<integer name='bsdf_samples' value='0'/><integer name='emitter_samples' value='1'/>"
            : "<integer name='max_depth' value='3'/><boolean name='hide_emitters' value='true'/>");
    n = add_lights(text, n);
    snprintf(text + n, TEXT - n, "</scene>");
    const struct job_options o = {.spp = spp, .variance = true, .seed = (uint32_t)ztable_count};
    struct render_result result;
    struct image im;
    render_text(text, &o, &im, &result);
    const struct measured m = measure(&im, 'G');
    image_finish(&im);
    return m;
}

static void compare_choices(const char *integrator, int spp) {
    static const char *const choices[] = {"auto", "power", "uniform"};
    const struct measured tree = render_choice(integrator, "tree", 4 * spp);
    for (int i = 0; i < 3; i++) {
        char row[96];
        struct measured m = render_choice(integrator, choices[i], spp);
        m.error = hypot(m.error, tree.error);
        snprintf(row, sizeof row, "%s: %s against tree, %d spp", integrator, choices[i], spp);
        ztable_add(row, tree.mean, m, ulp_floor(tree.mean, 3));
    }
}

int main(void) {
    const int spp = full_mode() ? 16384 : 1024;
    scene_folder_open();
    write_triangles();
    compare_choices("direct", spp);
    compare_choices("path", spp);
    ztable_finish(FALSE_ALARMS);
    scene_folder_close();
    return check_result();
}
