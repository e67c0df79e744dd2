// SPDX-License-Identifier: Apache-2.0
// Rough materials under a uniform sky: a flat piece reflects (and transmits) its directional albedo
// of single scattering, which is computed here from the material's own eval by quadrature over the
// microfacet normals, without any of its sampling code.
//
// Each of the 48 rows is held to 3 standard errors: 0.13 are expected outside, so that a new choice of
// seeds fails in 12 %. Whether such a row is chance is told by --full: at 16 times the samples a bias of
// 3 standard errors would be one of 12. The sum of squares of all rows has chi-square's bounds.
#include "make_object.h"
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3; // of chi-square over all rows

static const double METAL_ETA = 1.5, METAL_K = 2;

enum { STEPS_U = 1024, STEPS_PHI = 512 };

struct material {
    const char *type, *distribution;
    double alpha, eta; // eta: int_ior over ext_ior; 0: a conductor
};

// Turned over, so that wo is above: `below` says whether it really is.
struct view {
    const struct closure *closure;
    vec3 wo;
    bool below;
    double alpha, eta; // eta: side of wi over side of wo when refracted
};

static double value_at(const struct view *v, vec3 wi) {
    const vec3 turned = v3(wi[0], wi[1], v->below ? -wi[2] : wi[2]);
    float pdf;
    return (double)spectrum_max(closure_eval(v->closure, turned, &pdf));
}

// eval of a direction above, which is reflected, or below, which is refracted.
static double value_on_side(const struct view *v, vec3 wi, float side) {
    return wi[2] * side > 0 ? value_at(v, wi) : 0;
}

// eval times the solid angle of wi per that of the microfacet's normal m, reflection and refraction
// together (Walter et al. 2007, equations 14 and 17).
static double scattered(const struct view *v, vec3 m) {
    const vec3 wo = v->wo;
    const double c = dot(wo, m);
    if (!(c > 0))
        return 0;
    const double sum = value_on_side(v, normalize(2 * (float)c * m - wo), 1) * 4 * c;
    const double eta = v->eta, sin2 = (1 - c * c) / (eta * eta);
    if (!(eta > 0) || sin2 >= 1)
        return sum;
    const double ct = sqrt(1 - sin2); // wi = m (c / eta - ct) - wo / eta, and wi.m = -ct
    const vec3 wi = normalize((float)(c / eta - ct) * m - (float)(1 / eta) * wo);
    const double denominator = c - eta * ct;
    return sum + value_on_side(v, wi, -1) * denominator * denominator / (eta * eta * ct);
}

// Over the hemisphere of m by midpoints, in the variables in which GGX is constant: cos^2 = (1 - u)
// / (1 + (alpha^2 - 1) u), so that dm = |d cos / du| du dphi. wo lies in the xz plane.
static double single_scattering(const struct view *v) {
    const double k = v->alpha * v->alpha - 1;
    double sum = 0;
    for (int i = 0; i < STEPS_U; i++) {
        const double s = (i + 0.5) / STEPS_U, u = 1 - (1 - s) * (1 - s); // denser where m grazes
        const double cos2 = (1 - u) / (1 + k * u), cosine = sqrt(cos2), sine = sqrt(1 - cos2);
        const double dcos2 = (1 + k) / ((1 + k * u) * (1 + k * u));
        double ring = 0;
        for (int j = 0; j < STEPS_PHI; j++) {
            const double phi = M_PI * (j + 0.5) / STEPS_PHI;
            const vec3 m = v3((float)(sine * cos(phi)), (float)(sine * sin(phi)), (float)cosine);
            ring += scattered(v, m);
        }
        sum += ring * dcos2 / (2 * cosine) * 2 * (1 - s);
    }
    return sum / STEPS_U * 2 * M_PI / STEPS_PHI;
}

static double expected_albedo(const struct material *m, double degrees) {
    struct arena arena = {0};
    struct closure_stack stack = {0};
    char overrides[128];
    int n = snprintf(overrides, sizeof overrides, "distribution=%s alpha=%g", m->distribution, m->alpha);
    if (m->eta > 0)
        snprintf(overrides + n, sizeof overrides - (size_t)n, " int_ior=%g ext_ior=1", m->eta);
    else
        snprintf(overrides + n, sizeof overrides - (size_t)n, " eta=%g k=%g", METAL_ETA, METAL_K);
    const struct object *o = make_bsdf(&arena, m->type, overrides, NULL);
    const struct bsdf_point point = {.frame = {v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1)}};
    const double theta = degrees * M_PI / 180;
    const vec3 wo = v3((float)sin(theta), 0, (float)cos(theta));
    const bool below = wo[2] < 0;
    const struct view v = {.closure = bsdf_resolve(o, &point, wo, &stack),
                           .wo = v3(wo[0], 0, fabsf(wo[2])), .below = below, .alpha = m->alpha,
                           .eta = m->eta > 0 && below ? 1 / m->eta : m->eta};
    const double albedo = single_scattering(&v);
    arena_finish(&arena);
    return albedo;
}

static void write_material(const struct material *m, double degrees, char *text, size_t n) {
    const double theta = degrees * M_PI / 180;
    char ior[128] = "";
    if (m->eta > 0)
        snprintf(ior, sizeof ior, "<float name='int_ior' value='%g'/><float name='ext_ior' "
                 "value='1'/>", m->eta);
    else
        snprintf(ior, sizeof ior, "<spectrum name='eta' value='%g'/><spectrum name='k' "
                 "value='%g'/>", METAL_ETA, METAL_K);
    snprintf(text, n,
             "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='2'/>"
             "</integrator><emitter type='constant'/><sensor type='perspective'>"
             "<float name='fov' value='0.001'/><transform name='to_world'>"
             "<lookat origin='%.9g,0,%.9g' target='0,0,0' up='0,1,0'/></transform>"
             "<film type='hdrfilm'><integer name='width' value='4'/>"
             "<integer name='height' value='4'/><rfilter type='box'/></film></sensor>"
             "<shape type='rectangle'><bsdf type='%s'><string name='distribution' value='%s'/>"
             "<float name='alpha' value='%g'/>%s</bsdf></shape></scene>",
             10 * sin(theta), 10 * cos(theta), m->type, m->distribution, m->alpha, ior);
}

static void test_material(const struct material *m, double degrees) {
    const int spp = full_mode() ? 16384 : 1024;
    const struct job_options o = {.spp = spp, .variance = true, .seed = (uint32_t)ztable_count};
    struct render_result result;
    struct image im;
    char text[2048], name[96];
    write_material(m, degrees, text, sizeof text);
    render_text(text, &o, &im, &result);
    snprintf(name, sizeof name, "%s %s alpha %g, %g degrees, %d spp", m->type, m->distribution,
             m->alpha, degrees, spp);
    const double expected = expected_albedo(m, degrees);
    ztable_add(name, expected, measure(&im, 'G'), 1e-5 * expected); // floor: the quadrature's own error
    image_finish(&im);
}

int main(void) {
    const char *const distributions[] = {"ggx", "beckmann"};
    const double alphas[] = {0.05, 0.3, 1}, angles[] = {1, 60, 85, 120, 150};
    scene_folder_open();
    for (int d = 0; d < 2; d++)
        for (int a = 0; a < 3; a++)
            for (int i = 0; i < 5; i++) {
                const struct material metal = {"roughconductor", distributions[d], alphas[a], 0};
                const struct material glass = {"roughdielectric", distributions[d], alphas[a], 1.5};
                if (angles[i] < 90)
                    test_material(&metal, angles[i]);
                test_material(&glass, angles[i]);
            }
    scene_folder_close();
    ztable_finish_within_three(FALSE_ALARMS);
    return check_result();
}
