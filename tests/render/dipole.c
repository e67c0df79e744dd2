// SPDX-License-Identifier: Apache-2.0
// Subsurface scattering by the dipole against its closed forms on a half space.
//
// A square many free paths wide stands for the half space. With albedo A of the profile, F of the
// boundary at normal incidence, T the diffuse transmittance that the profile's fits say and T' the
// exact one, an eye above sees in uniform light of radiance 1:   F + (1 - F) A T' / T;
// in light of irradiance E under the angle i:                    (1 - F) (1 - F(i)) E A / (pi T);
// and at distance x inside the edge of light that ends in a straight shadow the share of A that does
// not come from beyond it: A less the integral of 2 r acos(x / r) R_d(r) over r > x.
#include "math/dipole.h"
#include "math/fresnel.h"
#include "math/quadrature.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;
static const float ETA = 1.4f, FREE_PATH = 0.01f;

struct setting {
    const char *model;
    enum dipole_model kind;
    double albedo; // of an event, reduced
    bool normalized, rough;
};

static const struct setting settings[] = {
    {"jensen", DIPOLE_JENSEN, 0.5, true, false}, {"jensen", DIPOLE_JENSEN, 0.95, true, false},
    {"better", DIPOLE_BETTER, 0.5, true, false}, {"better", DIPOLE_BETTER, 0.95, true, false},
    {"jensen", DIPOLE_JENSEN, 0.9, false, false}, {"better", DIPOLE_BETTER, 0.9, true, true},
};
enum { SETTINGS = sizeof settings / sizeof *settings, SIDE = 16 };

static struct dipole profile(const struct setting *s) {
    const float sigma_t = 1 / FREE_PATH, sigma_s = sigma_t * (float)s->albedo;
    return dipole_make(spectrum_grey(sigma_s), spectrum_grey(sigma_t - sigma_s), ETA, s->kind);
}

// The eye sees |x - middle| and |y| < half; the square's outer side faces it.
static struct measured render_shape(const struct setting *s, const char *light, const char *shape,
                                    double middle, double half, int spp) {
    char text[4096];
    snprintf(text, sizeof text,
             "<scene version='3.0.0'><integrator type='dipole'><string name='model' value='%s'/>"
             "<boolean name='normalized' value='%s'/><integer name='max_depth' value='2'/>"
             "</integrator>"
             "<sensor type='orthographic'><transform name='to_world'><scale x='%g' y='%g'/>"
             "<lookat origin='%g,0,5' target='%g,0,0' up='0,1,0'/></transform><film type='hdrfilm'>"
             "<integer name='width' value='%d'/><integer name='height' value='%d'/>"
             "<rfilter type='box'/></film></sensor>%s%s"
             "<bsdf type='%s'><float name='int_ior' value='%g'/><float name='ext_ior' value='1'/>"
             "%s</bsdf><medium name='interior' type='homogeneous'><float name='sigma_t' value='%g'/>"
             "<float name='albedo' value='%g'/></medium></shape></scene>",
             s->model, s->normalized ? "true" : "false", half, half, middle, middle, SIDE, SIDE, light,
             shape, s->rough ? "roughdielectric" : "dielectric", (double)ETA,
             s->rough ? "<float name='alpha' value='0.001'/>" : "", 1 / (double)FREE_PATH, s->albedo);
    const struct job_options o = {.spp = spp * (full_mode() ? 16 : 1), .variance = true,
                                  .seed = (uint32_t)ztable_count};
    struct render_result result;
    struct image im;
    render_text(text, &o, &im, &result);
    const struct measured m = measure(&im, 'G');
    CHECK(result.truncated == 0);
    image_finish(&im);
    return m;
}

static struct measured render_square(const struct setting *s, const char *light, double middle,
                                     double half, int spp) {
    return render_shape(s, light,
                        "<shape type='rectangle'><transform name='to_world'><scale value='2'/>"
                        "</transform>", middle, half, spp);
}

static double fresnel(double cosine) {
    float cos_t;
    return (double)fresnel_dielectric((float)cosine, ETA, &cos_t);
}

#define UNIFORM "<emitter type='constant'><rgb name='radiance' value='1'/></emitter>"

static double normalization(const struct setting *s) {
    return s->normalized ? 1 / (double)dipole_diffuse_transmittance(ETA) : 1;
}

static void test_uniform(const struct setting *s) {
    const struct dipole d = profile(s);
    const double passes = 1 - fresnel_dielectric_average((double)ETA);
    const double expected = fresnel(1) + (1 - fresnel(1)) * (double)dipole_albedo(&d)[0] * passes *
                                             normalization(s);
    char name[96];
    snprintf(name, sizeof name, "%s, albedo %g, uniform light%s", s->model, s->albedo,
             s->normalized ? "" : ", literal");
    ztable_add(name, expected, render_square(s, UNIFORM, 0, 0.5, 256), 2e-5);
}

#define SUN                                                                                        \
    "<emitter type='directional'><vector name='direction' value='1,0,-1'/>"                        \
    "<rgb name='irradiance' value='1'/></emitter>"

// What an eye above sees of a share of the profile under the sun at 45 degrees.
static double sunlit(const struct setting *s, double share) {
    const double cosine = sqrt(0.5);
    return (1 - fresnel(1)) * (1 - fresnel(cosine)) * cosine / 3.14159265358979 * share *
           normalization(s);
}

static void test_sun(const struct setting *s) {
    const struct dipole d = profile(s);
    char name[96];
    snprintf(name, sizeof name, "%s, albedo %g, sun%s%s", s->model, s->albedo,
             s->normalized ? "" : ", literal", s->rough ? ", hardly rough" : "");
    ztable_add(name, sunlit(s, (double)dipole_albedo(&d)[0]), render_square(s, SUN, 0, 0.5, 256), 1e-5);
}

// The mean over x from 0 to `width` of what comes from beyond the edge.
static double beyond(const struct dipole *d, double width) {
    enum { NODES = 48 };
    double node[NODES], weight[NODES], sum = 0;
    gauss_legendre(NODES, node, weight);
    for (int i = 0; i < NODES; i++)
        for (int k = 0; k < NODES; k++) {
            const double x = width * node[i], t = node[k] * node[k]; // r = x / (1 - t), squared nodes
            const double r = x / (1 - t), dr = x / ((1 - t) * (1 - t)) * 2 * node[k];
            sum += weight[i] * weight[k] * dr * 2 * r * acos(x / r) *
                   (double)dipole_Rd(d, (float)r)[0];
        }
    return sum;
}

// A screen at height 1 that the sun passes at x > -1 lets light fall on x > 0.
static void test_edge(const struct setting *s, double free_paths) {
    const struct dipole d = profile(s);
    const double width = free_paths * (double)FREE_PATH;
    char name[96];
    snprintf(name, sizeof name, "%s, albedo %g, lit side of an edge, %g free paths", s->model,
             s->albedo, free_paths);
    const char *light =
        SUN "<shape type='rectangle'><transform name='to_world'><scale x='1.5' y='100'/>"
            "<translate x='-2.5' z='1'/></transform><bsdf type='diffuse'><rgb name='reflectance' "
            "value='0'/></bsdf></shape>";
    const double share = (double)dipole_albedo(&d)[0] - beyond(&d, width);
    ztable_add(name, sunlit(s, share), render_square(s, light, width / 2, width / 2, 256), 2e-5);
}

// A sphere has as much area within a chord r as a plane, so that in uniform light its middle shows the
// closed form with the integral of R_d up to the diameter; all axes of the probes find some of it.
static void test_sphere(const struct setting *s, double free_paths) {
    const struct dipole d = profile(s);
    const double radius = free_paths * (double)FREE_PATH;
    enum { NODES = 48 };
    double node[NODES], weight[NODES], inside = 0;
    gauss_legendre(NODES, node, weight);
    for (int i = 0; i < NODES; i++) {
        const double r = 2 * radius * node[i];
        inside += 2 * radius * weight[i] * 2 * 3.14159265358979 * r * (double)dipole_Rd(&d, (float)r)[0];
    }
    const double passes = 1 - fresnel_dielectric_average((double)ETA);
    char text[512], name[96];
    snprintf(name, sizeof name, "%s, albedo %g, sphere of %g free paths", s->model, s->albedo,
             free_paths);
    snprintf(text, sizeof text, "<shape type='sphere'><float name='radius' value='%.9g'/>", radius);
    ztable_add(name, fresnel(1) + (1 - fresnel(1)) * inside * passes * normalization(s),
               render_shape(s, UNIFORM, text, 0, 1e-3 * radius, 1024), 2e-5);
}

// Nothing is lost and nothing gained where nothing absorbs. The sphere is closed, so that no light
// escapes by the profile's tail; its curvature matters little at so many free paths.
static void test_white_sphere(void) {
    const struct job_options o = {.spp = 1024, .variance = true};
    struct render_result result;
    struct image im;
    render_text("<scene version='3.0.0'><integrator type='dipole'/><sensor type='orthographic'>"
                "<transform name='to_world'><scale value='0.7'/><lookat origin='0,0,5' "
                "target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' "
                "value='16'/><integer name='height' value='16'/><rfilter type='box'/></film></sensor>"
                "<emitter type='constant'/><shape type='sphere'><bsdf type='dielectric'/>"
                "<medium name='interior' type='homogeneous'><float name='sigma_t' value='1e4'/>"
                "<float name='albedo' value='1'/></medium></shape></scene>", &o, &im, &result);
    const struct measured m = measure(&im, 'G');
    printf("white sphere of 1e4 free paths in uniform light: %.5f +- %.5f\n", m.mean, m.error);
    CHECK_NEAR(m.mean, 1, 0.005 + 4 * m.error); // the fits of dipole_diffuse_transmittance: 0.003
    image_finish(&im);
}

int main(void) {
    scene_folder_open();
    for (int i = 0; i < SETTINGS; i++) {
        if (!settings[i].rough)
            test_uniform(&settings[i]);
        test_sun(&settings[i]);
    }
    for (int i = 1; i < 4; i += 2) {
        test_edge(&settings[i], 1);
        test_edge(&settings[i], 4);
        test_sphere(&settings[i], 1);
        test_sphere(&settings[i], 8);
    }
    test_white_sphere();
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
