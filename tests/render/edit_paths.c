// SPDX-License-Identifier: Apache-2.0
// Editing tensors with bounces are sums over the very paths of a path tracer: with the same random
// numbers, a tensor made from one set of materials and contracted with the weights of another gives
// the picture that is traced with that other set, the answers of its surfaces being those of the
// tensor's model.
#include "render/edit_reference.h"

enum { WIDTH = 20, HEIGHT = 14, PLANE = WIDTH * HEIGHT };

// %s: the materials "floor", "wall", "ball", "box"; the cylinder is not editable.
static const char scene[] =
    "<scene version='3.0.0'><integrator type='path'><integer name='rr_depth' value='1000'/>"
    "<integer name='max_depth' value='%d'/></integrator>"
    "<sensor type='perspective'><float name='fov' value='60'/><transform name='to_world'>"
    "<lookat origin='0.2,1,3.4' target='0,0.8,0' up='0,1,0'/></transform><sampler type='sobol'/>"
    "<film type='hdrfilm'><integer name='width' value='20'/><integer name='height' value='14'/>"
    "<rfilter type='tent'/></film></sensor>%s"
    "<emitter type='constant'><rgb name='radiance' value='0.2,0.3,0.4'/></emitter>"
    "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
    "<rotate x='1' angle='-90'/></transform><ref id='floor'/></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
    "<translate z='-1.5'/></transform><boolean name='flip_normals' value='true'/>"
    "<ref id='wall'/></shape>"
    "<shape type='sphere'><point name='center' x='-0.6' y='0.5' z='0'/>"
    "<float name='radius' value='0.5'/><ref id='ball'/></shape>"
    "<shape type='cube'><transform name='to_world'><scale value='0.35'/>"
    "<rotate y='1' angle='30'/><translate x='0.6' y='0.36' z='0.3'/></transform><ref id='box'/></shape>"
    "<shape type='cylinder'><point name='p0' x='1.3' y='0' z='-0.6'/>"
    "<point name='p1' x='1.3' y='1.2' z='-0.6'/><float name='radius' value='0.2'/>"
    "<bsdf type='roughconductor'><float name='alpha' value='0.2'/></bsdf></shape>"
    "<shape type='rectangle'><transform name='to_world'><scale value='0.6'/>"
    "<rotate x='1' angle='90'/><translate y='2.2'/></transform><emitter type='area'>"
    "<rgb name='radiance' value='6,5,4'/></emitter></shape></scene>";

static const char before[] =
    "<bsdf type='editable' id='floor'><string name='model' value='blinnphong'/>"
    "<float name='exponent' value='20'/><rgb name='specular_reflectance' value='0.5'/>"
    "<texture name='diffuse_reflectance' type='checkerboard'><rgb name='color0' value='0.1,0.2,0.3'/>"
    "<rgb name='color1' value='0.6,0.4,0.2'/><transform name='to_uv'><scale value='4'/></transform>"
    "</texture></bsdf>"
    "<bsdf type='twosided' id='wall'><bsdf type='editable'><string name='model' value='cooktorrance'/>"
    "<string name='basis' value='box'/><integer name='bins_b' value='4'/>"
    "<float name='alpha' value='0.3'/><rgb name='diffuse_reflectance' value='0.3,0.4,0.5'/><rgb name='eta' value='1.5'/><rgb name='k' value='0'/>"
    "</bsdf></bsdf>"
    "<bsdf type='editable' id='ball'><string name='model' value='ashikhminfresnel'/>"
    "<float name='exponent' value='15'/><rgb name='diffuse_reflectance' value='0.2'/></bsdf>"
    "<bsdf type='editable' id='box'><string name='model' value='lightview'/>"
    "<rgb name='specular_reflectance' value='0.7,0.2,0.1'/></bsdf>";

static const char after[] =
    "<bsdf type='editable' id='floor'><string name='model' value='blinnphong'/>"
    "<float name='exponent' value='60'/><rgb name='specular_reflectance' value='0.1,0.3,0.2'/>"
    "<texture name='diffuse_reflectance' type='checkerboard'><rgb name='color0' value='0.1,0.2,0.3'/>"
    "<rgb name='color1' value='0.6,0.4,0.2'/><transform name='to_uv'><scale value='4'/></transform>"
    "</texture></bsdf>"
    "<bsdf type='twosided' id='wall'><bsdf type='editable'><string name='model' value='cooktorrance'/>"
    "<string name='basis' value='box'/><integer name='bins_b' value='4'/>"
    "<float name='alpha' value='0.15'/><rgb name='eta' value='1.2,1.5,0.3'/>"
    "<rgb name='k' value='0,0,2.5'/>"
    "<rgb name='diffuse_reflectance' value='0.7,0.1,0.2'/></bsdf></bsdf>"
    "<bsdf type='editable' id='ball'><string name='model' value='ashikhminfresnel'/>"
    "<float name='exponent' value='70'/><rgb name='r0' value='0.9,0.5,0.2'/>"
    "<rgb name='diffuse_reflectance' value='0.4,0,0.1'/></bsdf>"
    "<bsdf type='editable' id='box'><string name='model' value='lightview'/>"
    "<rgb name='specular_reflectance' value='0,0.9,0.4'/></bsdf>";

static char tensor_path[300];

static void write_scene(const char *materials) {
    char text[16384];
    snprintf(text, sizeof text, scene, -1, materials);
    scene_write("scene.xml", text);
}

static void same_paths(const struct polynomial_options *options) {
    static double a[3 * PLANE], b[3 * PLANE];
    struct polynomial_options o = *options;
    struct polynomial_report report;
    struct edited e, was;
    o.job.scene = scene_path("scene.xml");
    o.output = tensor_path;
    o.command = o.version = "";
    write_scene(before);
    if (!precompute_polynomial(&o, &report))
        exit(1);
    struct tensor_file *f = tensor_open(tensor_path);
    CHECK(f && tensor_check_values(f));
    edited_open(&was, &o, tensor_get(f));
    write_scene(after);
    edited_open(&e, &o, tensor_get(f));
    e.was = &was;
    edited_contract(&e, tensor_get(f), false, a);
    plain_trace(&e.p, &e.response, (uint32_t)o.job.spp, b);
    double worst = 0, size = 0;
    for (int i = 0; i < 3 * PLANE; i++) {
        worst = fmax(worst, fabs(a[i] - b[i]));
        size = fmax(size, fabs(b[i]));
    }
    printf("series %u,%u, %u bounces, later %s: %u groups, %u coefficients; differs by %.2g of the "
           "brightest, %.3g\n", o.series[0], o.series[1], o.bounces, polynomial_laters[o.later],
           report.groups,
           report.coefficients, worst / size, size);
    CHECK(worst < 1e-4 * size && report.rejected == 0);
    edited_close(&e);
    edited_close(&was);
    tensor_close(f);
}

int main(void) {
    scene_folder_open();
    snprintf(tensor_path, sizeof tensor_path, "%s", scene_path("t.safetensors"));
    const struct job_options job = {.spp = 16, .seed = 3};
    same_paths(&(struct polynomial_options){.job = job, .bounces = 1, .series = {32}});
    same_paths(&(struct polynomial_options){.job = job, .bounces = 4, .series = {16, 1, 1, 1}});
    same_paths(&(struct polynomial_options){.job = job, .bounces = 2, .series = {32, 8}});
    same_paths(&(struct polynomial_options){.job = job, .bounces = 3, .series = {16, 4, 1}});
    same_paths(&(struct polynomial_options){.job = job, .bounces = 3, .series = {16, 1, 1},
                                            .later = LATER_TERMS});
    same_paths(&(struct polynomial_options){.job = job, .bounces = 3, .series = {16, 4, 1},
                                            .later = LATER_TERMS});
    if (full_mode()) {
        same_paths(&(struct polynomial_options){.job = job, .bounces = 2, .series = {64, 16}});
        same_paths(&(struct polynomial_options){.job = job, .bounces = 3, .series = {128, 8, 1}});
        same_paths(&(struct polynomial_options){.job = job, .bounces = 4, .series = {16, 8, 1, 1}});
    }
    scene_folder_close();
    return check_result();
}
