// SPDX-License-Identifier: Apache-2.0
// Media against what is known of them.
//
// In uniform light of radiance 1 whatever neither absorbs nor emits shows radiance 1 everywhere, at
// any density and any phase function (and so does what absorbs and glows with radiance 1). Single
// scattering from a point light: Lecocq et al. 2000, by quadrature.
#include "medium_text.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;

#define CAMERA                                                                                     \
    "<sensor type='orthographic'><transform name='to_world'><scale value='0.99'/>"                 \
    "<lookat origin='0,0,-5' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'>"         \
    "<integer name='width' value='8'/><integer name='height' value='8'/><rfilter type='box'/>"     \
    "</film></sensor>"
#define LIGHT "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>"
#define NULL_BSDF "<bsdf type='null'/>"

static struct measured render_mean(const char *text, const char *integrator, int spp, char channel) {
    const struct job_options o = {.spp = spp, .variance = true, .seed = (uint32_t)ztable_count,
                                  .reading = {.integrator = integrator}};
    struct render_result result;
    struct image im;
    render_text(text, &o, &im, &result);
    const struct measured m = measure(&im, channel);
    CHECK(result.truncated == 0);
    image_finish(&im);
    return m;
}

// ---- furnaces -----------------------------------------------------------------------------------

struct furnace {
    const char *name, *bsdf, *medium;
    int spp;
};

static void furnace_text(const struct furnace *f, char *text, size_t n) {
    snprintf(text, n,
             "<scene version='3.0.0'><integrator type='volpath'/>" CAMERA LIGHT
             "<shape type='sphere'>%s<medium name='interior' %s</medium></shape></scene>",
             f->bsdf, f->medium);
}

static void test_furnace(const struct furnace *f, double floor) {
    static const char *const methods[] = {"volpath", "volpathmis"};
    const int spp = f->spp * (full_mode() ? 16 : 1);
    for (int i = 0; i < 2; i++) {
        char text[2048], name[96];
        furnace_text(f, text, sizeof text);
        snprintf(name, sizeof name, "%s, %s, %d spp", f->name, methods[i], spp);
        ztable_add(name, 1, render_mean(text, methods[i], spp, 'G'), floor);
    }
}

// Without light sampling no weight ever changes.
static void test_analogue(void) {
    static const float g[] = {-0.99f, -0.5f, 0, 0.5f, 0.99f};
    static const float depth[] = {0.01f, 1, 30};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 3; k++) {
            char name[64], medium[512], text[2048];
            snprintf(name, sizeof name, "analogue, g %g, depth %g", (double)g[i], (double)depth[k]);
            snprintf(medium, sizeof medium,
                     "type='homogeneous'><float name='sigma_t' value='%g'/><float name='albedo' "
                     "value='1'/><boolean name='sample_emitters' value='false'/><phase type='hg'>"
                     "<float name='g' value='%g'/></phase>", (double)depth[k], (double)g[i]);
            const struct furnace f = {name, NULL_BSDF, medium, 8};
            furnace_text(&f, text, sizeof text);
            const struct measured m = render_mean(text, "volpath", 8, 'G');
            CHECK_NEAR(m.mean, 1, 1e-6);
            CHECK(m.error < 1e-6);
        }
}

static void test_next_event(void) {
    static const float g[] = {-0.99f, 0, 0.9f, 0.99f};
    static const float depth[] = {0.01f, 1, 30, 1000};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) {
            char name[64], medium[512];
            snprintf(name, sizeof name, "furnace, g %g, depth %g", (double)g[i], (double)depth[k]);
            snprintf(medium, sizeof medium,
                     "type='homogeneous'><float name='sigma_t' value='%g'/>"
                     "<float name='albedo' value='1'/><phase type='hg'><float name='g' value='%g'/>"
                     "</phase>", (double)depth[k], (double)g[i]);
            const struct furnace f = {name, NULL_BSDF, medium,
                                      depth[k] > 100 ? 4 : depth[k] < 0.1f ? 4096 : 64};
            test_furnace(&f, 1e-6);
        }
}

static void test_boundaries(void) {
    static const struct furnace furnaces[] = {
        {"index-matched dielectric", "<bsdf type='dielectric'><float name='int_ior' value='1.3'/>"
         "<float name='ext_ior' value='1.3'/></bsdf>",
         "type='homogeneous'><float name='sigma_t' value='5'/><float name='albedo' value='1'/>", 64},
        {"glass", "<bsdf type='dielectric'/>",
         "type='homogeneous'><float name='sigma_t' value='5'/><float name='albedo' value='1'/>", 64},
        {"thin glass", "<bsdf type='thindielectric'/>",
         "type='homogeneous'><float name='sigma_t' value='5'/><float name='albedo' value='1'/>", 64},
        {"coloured extinction", NULL_BSDF,
         "type='homogeneous'><rgb name='sigma_t' value='0.3 3 20'/>"
         "<float name='albedo' value='1'/>", 64},
        {"glowing", NULL_BSDF,
         "type='homogeneous'><rgb name='sigma_t' value='0.3 3 20'/>"
         "<float name='albedo' value='0.7'/><float name='emission' value='1'/>", 64},
        {"glowing, no scattering", NULL_BSDF,
         "type='homogeneous'><float name='sigma_t' value='3'/>"
         "<float name='albedo' value='0'/><float name='emission' value='1'/>", 64},
        {"grid", NULL_BSDF,
         "type='heterogeneous'><volume type='gridvolume' name='sigma_t'><transform name='to_world'>"
         "<translate value='-0.5'/><scale value='1.9'/></transform>"
         "<string name='filename' value='grid.vol'/></volume><float name='scale' value='5'/>"
         "<float name='albedo' value='1'/>", 64},
        {"glowing grid", NULL_BSDF,
         "type='heterogeneous'><volume type='gridvolume' name='sigma_t'><transform name='to_world'>"
         "<translate value='-0.5'/><scale value='1.9'/></transform>"
         "<string name='filename' value='grid.vol'/></volume><float name='scale' value='5'/>"
         "<float name='albedo' value='0.6'/><float name='emission' value='1'/>", 64},
    };
    for (size_t i = 0; i < sizeof furnaces / sizeof *furnaces; i++)
        test_furnace(&furnaces[i], 2e-6);
}

// ---- the longest walks --------------------------------------------------------------------------

struct sum_sink {
    struct sink sink;
    double sum;
};

static void sum_add(struct sink *s, int lane, const struct contribution *c) {
    struct sum_sink *sum = (void *)s;
    if (lane == 0)
        sum->sum += (double)(c->weight[1] * c->emission[1]);
}

static void sum_covered(struct sink *s, int lane) {
    (void)s;
    (void)lane;
}

static const struct sink_type sum_type = {.add = sum_add, .covered = sum_covered};

// Optical depth 1e4 along the radius, albedo 1: every path ends, none is cut, all weigh 1.
static void test_dense(void) {
    const int paths = full_mode() ? 10000 : 300;
    static const struct furnace f = {"dense", NULL_BSDF, "type='homogeneous'><float name='sigma_t' "
                                     "value='1e4'/><float name='albedo' value='1'/>"
                                     "<boolean name='sample_emitters' value='false'/>", 1};
    char text[2048];
    struct job job;
    static struct closure_stack stack;
    struct sum_sink sum = {{&sum_type, false}, 0};
    furnace_text(&f, text, sizeof text);
    scene_write("scene.xml", text);
    const struct job_options options = {.scene = scene_path("scene.xml"), .spp = 1};
    if (!job_open(&job, &options))
        exit(1);
    struct trace_context ctx = {.world = job.world, .response = &response_physical,
                                .sink = &sum.sink, .stack = &stack};
    uint64_t longest = 0, steps = 0;
    for (int i = 0; i < paths; i++) {
        struct path_start starts[SINK_LANES] = {0};
        for (int k = 0; k < SINK_LANES; k++) { // the first meets the ball, the others leave at once
            starts[k].ray = (struct ray){v3(0.5f, 0.2f, -5), v3(0, 0, k ? -1 : 1), 0, INFINITY};
            starts[k].sampler = sampler_start(&sampler_independent, 0, 0, (uint32_t)i,
                                              (uint32_t)paths, 1, 1);
        }
        const uint64_t before = ctx.rays;
        integrator_type_of(job.scene->integrator)->trace(job.scene->integrator->data, &ctx, starts);
        const uint64_t n = ctx.rays - before - (SINK_LANES - 1);
        longest = n > longest ? n : longest;
        steps += n;
    }
    printf("optical depth 1e4: %d paths, %.3g steps each, the longest %llu; mean %.9g\n", paths,
           (double)steps / paths, (unsigned long long)longest, sum.sum / paths);
    CHECK(ctx.truncated == 0);
    CHECK_NEAR(sum.sum / paths, 1, 1e-6);
    job_close(&job);
}

// ---- differences --------------------------------------------------------------------------------

// Two ways of saying the same: each of the other's expected value.
static void compare(const char *name, const char *a, const char *a_integrator, const char *b,
                    const char *b_integrator, int spp) {
    for (int c = 0; c < 3; c++) {
        char what[96];
        const struct measured x = render_mean(a, a_integrator, spp, "RGB"[c]);
        struct measured y = render_mean(b, b_integrator, spp, "RGB"[c]);
        y.error = hypot(x.error, y.error);
        snprintf(what, sizeof what, "%s, %c", name, "RGB"[c]);
        ztable_add(what, x.mean, y, 1e-6);
    }
}

#define LAMP                                                                                       \
    "<shape type='sphere'><point name='center' x='3' y='3' z='-3'/><emitter type='area'>"          \
    "<rgb name='radiance' value='20'/></emitter></shape>"
#define MILK                                                                                       \
    "<medium type='homogeneous' id='milk'><rgb name='sigma_t' value='0.5 2 6'/>"                   \
    "<float name='albedo' value='0.9'/><phase type='hg'><float name='g' value='0.6'/></phase>"     \
    "</medium>"
#define SCENE(body)                                                                                \
    "<scene version='3.0.0'><integrator type='volpath'/>" CAMERA LAMP MILK body "</scene>"

static void test_same(void) {
    static const char ball[] = SCENE(
        "<shape type='sphere'>" NULL_BSDF "<ref id='milk' name='interior'/></shape>");
    static const char split[] = SCENE(
        "<shape type='sphere'>" NULL_BSDF "<ref id='milk' name='interior'/></shape>"
        "<shape type='sphere'><float name='radius' value='0.6'/>" NULL_BSDF
        "<ref id='milk' name='interior'/><ref id='milk' name='exterior'/></shape>");
    static const char matched[] = SCENE(
        "<shape type='sphere'><bsdf type='dielectric'><float name='int_ior' value='1.2'/>"
        "<float name='ext_ior' value='1.2'/></bsdf><ref id='milk' name='interior'/></shape>");
    static const char untouched[] = SCENE(
        "<shape type='sphere'>" NULL_BSDF "<ref id='milk' name='interior'/></shape>"
        "<shape type='cube'><transform name='to_world'><scale value='0.3'/></transform>" NULL_BSDF
        "</shape>");
    const int spp = full_mode() ? 4096 : 256;
    compare("a boundary inside", ball, "volpath", split, "volpath", spp);
    compare("an index-matched dielectric", ball, "volpath", matched, "volpath", spp);
    compare("a surface that parts nothing", ball, "volpath", untouched, "volpath", spp);
    compare("spectral MIS", ball, "volpath", ball, "volpathmis", spp);
}

// ---- single scattering --------------------------------------------------------------------------

// An eye at the origin looks along z through a medium for 10 metres; a point light of intensity
// 4 pi stands beside the ray at distance h, 5 metres on.
static void test_single_scattering(void) {
    static const struct {
        double sigma_t, h, J;
    } cases[] = {
        {0.05, 0.5, 4.365917}, {0.2, 0.5, 1.8238544}, {0.2, 1, 0.76189707},
        {1, 0.5, 0.021866208}, {1, 1, 0.0071081715},
    };
    for (int i = 0; i < 5; i++) {
        char text[2048], name[96];
        snprintf(text, sizeof text,
                 "<scene version='3.0.0'><integrator type='volpath'><integer name='max_depth' "
                 "value='2'/></integrator><medium type='homogeneous' id='fog'>"
                 "<float name='sigma_t' value='%g'/><float name='albedo' value='0.5'/></medium>"
                 "<sensor type='orthographic'><float name='near_clip' value='1e-6'/>"
                 "<ref id='fog'/><transform name='to_world'>"
                 "<scale x='1e-4' y='1e-4' z='1'/></transform><film type='hdrfilm'>"
                 "<integer name='width' value='16'/><integer name='height' value='16'/>"
                 "<rfilter type='box'/></film></sensor>"
                 "<emitter type='point'><point name='position' x='%g' y='0' z='5'/>"
                 "<rgb name='intensity' value='%.9g'/></emitter>"
                 "<shape type='rectangle'><transform name='to_world'><scale value='100'/>"
                 "<translate z='10'/></transform><bsdf type='diffuse'><rgb name='reflectance' "
                 "value='0'/></bsdf></shape></scene>",
                 cases[i].sigma_t, cases[i].h, 4 * (double)PI);
        const int spp = full_mode() ? 65536 : 4096;
        snprintf(name, sizeof name, "single scattering, sigma_t %g, h %g", cases[i].sigma_t, cases[i].h);
        ztable_add(name, 0.5 * cases[i].sigma_t * cases[i].J, render_mean(text, "volpath", spp, 'G'),
                   1e-6 * cases[i].J);
    }
}

static void write_grid(void) {
    enum { SIDE = 12 };
    static float values[SIDE * SIDE * SIDE];
    const int size[3] = {SIDE, SIDE, SIDE};
    struct rng rng = {2};
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        values[i] = rng_float(&rng);
    test_write_vol(scene_path("grid.vol"), size, 1, values, NULL);
}

int main(void) {
    scene_folder_open();
    write_grid();
    test_analogue();
    test_dense();
    test_next_event();
    test_boundaries();
    test_same();
    test_single_scattering();
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
