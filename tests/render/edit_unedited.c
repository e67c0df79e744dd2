// SPDX-License-Identifier: Apache-2.0
// The picture of a tensor whose surfaces, or whose terms, keep their reflection at later hops, with a frozen tail, is that
// of unlimited path tracing as long as nothing is edited; and it is the same whether a material is
// treated as fixed or as editable.
//
// Each mean over 8x8 pixels and channel is compared within its noise, told by two independent halves:
// 36 comparisons at 5 standard errors, false alarms below 1e-4, and 0.3 % for curves of 128 hats.
#include "render/edit_reference.h"

enum { SIDE = 16, PLANE = SIDE * SIDE, BLOCK = 8 };

static char tensor_path[300];

static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='-1'/></integrator>"
    "<sensor type='perspective'><float name='fov' value='50'/><transform name='to_world'>"
    "<lookat origin='0.2,1.4,3' target='0,0.5,0' up='0,1,0'/></transform><film type='hdrfilm'>"
    "<integer name='width' value='16'/><integer name='height' value='16'/><rfilter type='box'/></film>"
    "</sensor><bsdf type='blinnphong' id='floor'><float name='exponent' value='30'/>"
    "<rgb name='specular_reflectance' value='0.5,0.4,0.3'/>"
    "<rgb name='diffuse_reflectance' value='0.2,0.3,0.4'/></bsdf>"
    "<bsdf type='editable' id='ball'><string name='model' value='cooktorrance'/>"
    "<boolean name='fixed_fresnel' value='true'/><float name='alpha' value='0.3'/>"
    "<rgb name='diffuse_reflectance' value='0.3,0.1,0.1'/></bsdf>"
    "<bsdf type='twosided' id='wall'><bsdf type='editable'><string name='model' value='lightview'/>"
    "<texture name='specular_reflectance' type='checkerboard'><rgb name='color0' value='0.9,0.8,0.2'/>"
    "<rgb name='color1' value='0.2,0.3,0.8'/><transform name='to_uv'><scale value='3'/></transform>"
    "</texture></bsdf></bsdf>"
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='2'/>"
    "</transform><ref id='floor'/></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
    "<translate y='1' z='-1'/></transform><ref id='wall'/></shape>"
    "<shape type='sphere'><point name='center' x='0.3' y='0.5' z='0'/>"
    "<float name='radius' value='0.5'/><ref id='ball'/></shape>"
    "<emitter type='constant'><rgb name='radiance' value='0.4,0.5,0.6'/></emitter></scene>";

struct picture {
    double mean[3 * PLANE], half[3 * PLANE];
};

static void make_tensor(const struct polynomial_options *o, struct picture *p) {
    struct polynomial_report report;
    struct edited e;
    if (!precompute_polynomial(o, &report))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    edited_open(&e, o, tensor_get(f));
    edited_contract(&e, tensor_get(f), false, p->mean);
    edited_contract(&e, tensor_get(f), true, p->half);
    edited_close(&e);
    tensor_close(f);
}

// With all bounces.
static void make_truth(const struct polynomial_options *options, uint32_t samples, struct picture *p) {
    static double twin[3 * PLANE];
    for (int i = 0; i < 2; i++) {
        struct polynomial_options o = *options;
        struct polynomial open;
        o.job.seed += 10 + (uint32_t)i;
        if (!polynomial_open(&open, &o))
            exit(1);
        plain_trace(&open, NULL, samples, i ? twin : p->mean);
        polynomial_close(&open);
    }
    for (int i = 0; i < 3 * PLANE; i++) {
        p->half[i] = 0.5 * (p->mean[i] - twin[i]);
        p->mean[i] = 0.5 * (p->mean[i] + twin[i]);
    }
}

static void compare(const char *name, const struct picture *a, const struct picture *b) {
    double worst = 0, all = 0, truth = 0;
    for (int k = 0; k < 3; k++)
        for (int block = 0; block < PLANE / (BLOCK * BLOCK); block++) {
            double difference = 0, variance = 0, mean = 0;
            for (int i = 0; i < BLOCK * BLOCK; i++) {
                const int across = SIDE / BLOCK, x = block % across * BLOCK + i % BLOCK;
                const int at = k * PLANE + (block / across * BLOCK + i / BLOCK) * SIDE + x;
                difference += a->mean[at] - b->mean[at];
                variance += a->half[at] * a->half[at] + b->half[at] * b->half[at];
                mean += b->mean[at];
            }
            const double over = fmax(fabs(difference) - 0.003 * mean, 0) / sqrt(variance);
            worst = fmax(worst, over);
            all += difference;
            truth += mean;
        }
    printf("%s: %+.2f %% of the light, a block by up to %.1f standard errors\n", name,
           100 * all / truth, worst);
    CHECK(worst < 5);
}

int main(void) {
    static const char *const floor[] = {"floor"};
    static struct picture truth, fixed, edited, terms;
    const uint32_t samples = full_mode() ? 4096 : 256;
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    scene_write("scene.xml", scene);
    struct polynomial_options o = {
        .job = {.scene = scene_path("scene.xml"), .spp = (int)samples, .seed = 3}, .bounces = 3,
        .series = {128, 1, 1}, .tail = TAIL_FROZEN, .later = LATER_KEPT, .output = tensor_path,
        .command = "", .version = ""};
    make_truth(&o, samples, &truth);
    make_tensor(&o, &fixed);
    o.edit = floor;
    o.edit_count = 1;
    make_tensor(&o, &edited);
    o.later = LATER_TERMS;
    make_tensor(&o, &terms);
    compare("fixed floor against path tracing", &fixed, &truth);
    compare("editable floor against path tracing", &edited, &truth);
    compare("editable floor by terms against path tracing", &terms, &truth);
    scene_folder_close();
    return check_result();
}
