// SPDX-License-Identifier: Apache-2.0
// Editing tensors of closed rooms, whose light is known: each bounce is a power of the albedo; and how
// evenly the bins are filled that a sharp edit multiplies by much.
#include "render/edit_reference.h"

static char tensor_path[300];

static struct tensor_file *precompute(const char *text, const struct polynomial_options *options) {
    struct polynomial_options o = *options;
    struct polynomial_report report;
    scene_write("scene.xml", text);
    o.job.scene = scene_path("scene.xml");
    o.output = tensor_path;
    o.command = o.version = "";
    if (!precompute_polynomial(&o, &report))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    CHECK(f && tensor_check_values(f) && report.rejected == 0);
    return f;
}

// Sum over bins of a pixel's coefficients of one group and channel.
static double bins_sum(const struct tensor_block *b, const float *values, uint64_t pixel,
                       uint32_t group, uint32_t channel) {
    const uint32_t bins = b->coefficients / b->groups;
    const uint64_t tile = pixel / TENSOR_LANES, lane = pixel % TENSOR_LANES;
    double sum = 0;
    for (uint32_t j = 0; j < bins; j++)
        sum += (double)values[((tile * b->coefficients + group * bins + j) * 3 + channel) *
                                  TENSOR_LANES + lane];
    return sum;
}

// A cube seen from inside, of radiance 1 and albedo d: each bounce of N is d^N, whatever d is, so
// the sum over bins of T^N / pi is 1. Also with albedo exactly 1, and the emitter is what is edited.
// The mean's error from the halves; five deviations in 4 tests raise a false alarm in 1 of 400 000.
static void furnace(void) {
    enum { BOUNCES = 5 };
    const char text[] =
        "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'>"
        "<film type='hdrfilm'><integer name='width' value='12'/><integer name='height' value='12'/>"
        "<rfilter type='box'/></film></sensor><shape type='cube'>"
        "<boolean name='flip_normals' value='true'/><bsdf type='editable' id='room'>"
        "<string name='model' value='lightview'/><rgb name='specular_reflectance' value='1'/></bsdf>"
        "<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape></scene>";
    struct tensor_file *f = precompute(
        text, &(struct polynomial_options){.job = {.spp = 64}, .bounces = BOUNCES,
                                           .series = {16, 1, 1, 1, 1}});
    const struct tensor_block *b = &tensor_get(f)->blocks[0];
    CHECK(b->pixel_count == 144 && b->groups == BOUNCES);
    for (uint32_t i = 0; i < 144; i++)
        CHECK_NEAR((double)tensor_get(f)->fixed[i], 1, 1e-6); // the walls themselves
    for (uint32_t g = 0; g < BOUNCES; g++) {
        double mean = 0, squares = 0;
        for (uint64_t i = 0; i < b->pixel_count; i++) {
            mean += bins_sum(b, b->values, i, g, 0) / (M_PI * 144);
            squares += pow(bins_sum(b, b->halves, i, g, 0) / (M_PI * 144), 2);
        }
        printf("bounce %u: %.5f +- %.5f of d^%u\n", g + 1, mean, sqrt(squares), g + 1);
        CHECK_NEAR(mean, 1, 5 * sqrt(squares) + 1e-5);
    }
    tensor_close(f);
}

// Spread of the first bin of a group between pixels of the same expectation, over its mean.
static double deviation_of(const struct tensor_block *b, uint32_t group) {
    const uint32_t bins = b->coefficients / b->groups;
    double mean = 0, square = 0;
    for (uint64_t i = 0; i < b->pixel_count; i++) {
        const uint64_t at = (i / TENSOR_LANES * b->coefficients + group * bins) * 3 * TENSOR_LANES +
                            i % TENSOR_LANES;
        const double v = (double)((const float *)b->values)[at];
        mean += v / (double)b->pixel_count;
        square += v * v / (double)b->pixel_count;
    }
    CHECK(mean > 0);
    return sqrt(square / (mean * mean) - 1);
}

// A glossy patch under 30 degrees in a bright room of albedo 1: the noise of its first bin of 256,
// which a sharp lobe multiplies by most. The sampler of the source leaves 26 % at 12 000 samples, so
// 45 % at 4096. 5 % is asked for, of light that comes from the emitter; where it has been reflected
// once more 7.6 % was measured: some twenty samples fall into the bin, and each has the noise of one
// more hop.
static void first_bin(uint32_t bins, double most, double most_reflected) {
    enum { SIDE = 12 };
    char text[2048];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='path'/><sensor type='orthographic'>"
             "<transform name='to_world'><scale value='0.01'/>"
             "<lookat origin='0,0.866,0.5' target='0,0,0' up='0,1,0'/></transform>"
             "<film type='hdrfilm'><integer name='width' value='%d'/>"
             "<integer name='height' value='%d'/><rfilter type='box'/></film></sensor>"
             "<shape type='rectangle'><transform name='to_world'><scale value='0.05'/>"
             "<rotate x='1' angle='-90'/></transform><bsdf type='editable' id='patch'>"
             "<string name='model' value='blinnphong'/><string name='basis' value='box'/>"
             "<boolean name='fixed_fresnel' value='true'/></bsdf></shape><shape type='cube'>"
             "<transform name='to_world'><scale value='3'/></transform>"
             "<boolean name='flip_normals' value='true'/><bsdf type='editable' id='room'>"
             "<string name='model' value='lightview'/></bsdf>"
             "<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape></scene>",
             SIDE, SIDE);
    struct tensor_file *f = precompute(text, &(struct polynomial_options){
                                                 .job = {.spp = 4096}, .bounces = 2,
                                                 .series = {bins, 1}});
    const struct tensor_block *b = &tensor_get(f)->blocks[0];
    CHECK(b->pixel_count == SIDE * SIDE && b->groups == 3);
    const double direct = deviation_of(b, 0), reflected = deviation_of(b, 2);
    printf("first bin of %u, 4096 samples: deviates by %.2f %%; reflected once more, %.2f %%\n", bins,
           100 * direct, 100 * reflected);
    CHECK(direct < most && reflected < most_reflected);
    tensor_close(f);
}

int main(void) {
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    furnace();
    first_bin(256, 0.05, 0.1);
    scene_folder_close();
    return check_result();
}
