// SPDX-License-Identifier: Apache-2.0
// Light that arrives at a point of a diffuse floor straight from its source, in closed form:
// polygons (Lambert 1760, Photometria), disks, spheres, the sun, a point, a uniform sky.
//
// Seen through a narrow lens, so that the picture is of one point; radiance = albedo / pi E.
#include "render/ztable.h"

static const double FALSE_ALARMS = 1e-3;
static const double ALBEDO = 0.8;

// How light is looked for. The floor itself reflects nothing onto itself, so all see the same.
struct way {
    const char *name, *integrator;
};

static const struct way methods[] = {
    {"path", "<integrator type='path'/>"},
    {"direct", "<integrator type='direct'/>"},
    {"lights only", "<integrator type='direct'><integer name='bsdf_samples' value='0'/></integrator>"},
    {"materials only",
     "<integrator type='direct'><integer name='emitter_samples' value='0'/></integrator>"},
    {"3 lights : 2 materials",
     "<integrator type='direct'><integer name='emitter_samples' value='3'/>"
     "<integer name='bsdf_samples' value='2'/></integrator>"},
};

enum { METHODS = sizeof methods / sizeof *methods, DELTA_METHODS = 3, MATERIALS_ONLY = 3 };

static const char frame[] =
    "<scene version='3.0.0'>%s<sensor type='perspective'><float name='fov' value='0.001'/>"
    "<transform name='to_world'><lookat origin='-0.003,0.02,-0.004' target='0,0,0' up='0,0,1'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/>"
    "<rfilter type='box'/></film></sensor>"
    "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/></transform>"
    "<bsdf type='diffuse'><rgb name='reflectance' value='0.8'/></bsdf></shape>%s</scene>";

static void test_light(const char *name, const char *light, double irradiance, int method) {
    const int spp = full_mode() ? 16384 : 1024;
    const struct job_options o = {.spp = spp, .variance = true, .seed = (uint32_t)ztable_count};
    const double expected = ALBEDO / M_PI * irradiance;
    if (method == MATERIALS_ONLY && expected < 1e-3)
        return; // hits are too rare for an error estimate
    char text[4096], row[96];
    struct render_result result;
    struct image im;
    snprintf(text, sizeof text, frame, methods[method].integrator, light);
    render_text(text, &o, &im, &result);
    snprintf(row, sizeof row, "%s: %s, %d spp", name, methods[method].name, spp);
    // Positions are rounded, which a light that is as near as 1/20 sees 20 times larger.
    ztable_add(row, expected, measure(&im, 'G'), 20 * ulp_floor(expected, 1));
    image_finish(&im);
}

// ---- polygons -------------------------------------------------------------------------------

struct polygon {
    const char *name;
    int count;
    double p[6][3];
};

static const struct polygon polygons[] = {
    {"square overhead", 4, {{-.5, 1, -.5}, {.5, 1, -.5}, {.5, 1, .5}, {-.5, 1, .5}}},
    {"wall that stands on the floor", 4, {{.5, 0, -1}, {.5, 0, 1}, {.5, 2, 1}, {.5, 2, -1}}},
    {"tilted square, half below the floor", 4,
     {{1, -1, -1}, {1, -1, 1}, {2, 1, 1}, {2, 1, -1}}},
    {"ceiling of 200 at 0.1", 4, {{-100, .1, -100}, {100, .1, -100}, {100, .1, 100}, {-100, .1, 100}}},
    {"near triangle", 3, {{-.1, .05, -.1}, {.2, .05, -.1}, {0, .06, .3}}},
    {"far small triangle", 3, {{4, 9, 1}, {4.0078125, 9, 1}, {4, 9.0078125, 1.0078125}}},
    {"sliver", 3, {{-1, .5, .3}, {1, .5, .3}, {1, .501, .301}}},
    {"kite", 4, {{0, .5, -1}, {.4, .5, 0}, {0, .5, .3}, {-.4, .5, 0}}},
    {"hexagon", 6, {{1, 1, 0}, {.5, 1.2, .8}, {-.5, 1.2, .8}, {-1, 1, 0}, {-.5, .8, -.8}, {.5, .8, -.8}}},
};

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross3(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

// The part above the floor, seen from the origin.
static int clip_to_floor(const struct polygon *q, double out[12][3]) {
    int n = 0;
    for (int i = 0; i < q->count; i++) {
        const double *a = q->p[i], *b = q->p[(i + 1) % q->count];
        if (a[1] >= 0)
            memcpy(out[n++], a, sizeof *out);
        if ((a[1] > 0 && b[1] < 0) || (a[1] < 0 && b[1] > 0)) {
            const double t = a[1] / (a[1] - b[1]);
            for (int k = 0; k < 3; k++)
                out[n][k] = a[k] + t * (b[k] - a[k]);
            n++;
        }
    }
    return n;
}

// Irradiance at the origin, normal +y, from radiance 1: half the sum over edges of the angle they
// subtend times the normal component of the unit vector across them.
static double lambert(const struct polygon *q) {
    double p[12][3], sum = 0;
    const int n = clip_to_floor(q, p);
    for (int i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n];
        double c[3];
        cross3(a, b, c);
        const double across = sqrt(dot3(c, c));
        if (across > 0)
            sum += atan2(across, dot3(a, b)) * c[1] / across;
    }
    return 0.5 * fabs(sum);
}

// As an OBJ file that faces the origin.
static void write_polygon(const struct polygon *q) {
    char text[1024];
    double e1[3], e2[3], n[3];
    subtract(q->p[1], q->p[0], e1);
    subtract(q->p[2], q->p[0], e2);
    cross3(e1, e2, n);
    const bool turn = dot3(n, q->p[0]) > 0;
    int used = 0;
    for (int i = 0; i < q->count; i++) {
        const double *p = q->p[turn ? q->count - 1 - i : i];
        used += snprintf(text + used, sizeof text - (size_t)used, "v %.9g %.9g %.9g\n", p[0], p[1],
                         p[2]);
    }
    used += snprintf(text + used, sizeof text - (size_t)used, "f");
    for (int i = 0; i < q->count; i++)
        used += snprintf(text + used, sizeof text - (size_t)used, " %d", i + 1);
    scene_write("light.obj", text);
}

static void test_polygons(void) {
    for (size_t i = 0; i < sizeof polygons / sizeof *polygons; i++)
        for (int m = 0; m < METHODS; m++) {
            write_polygon(&polygons[i]);
            test_light(polygons[i].name,
                       "<shape type='obj'><string name='filename' value='light.obj'/>"
                       "<emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>",
                       lambert(&polygons[i]), m);
        }
}

// ---- other lights ---------------------------------------------------------------------------

// A disk of radius r at height h parallel to the floor, its centre d aside (Howell, A Catalog of
// Radiation Heat Transfer Configuration Factors, B-13).
static double disk(double r, double h, double d) {
    const double x = d * d + h * h + r * r;
    return M_PI / 2 * (1 - (d * d + h * h - r * r) / sqrt(x * x - 4 * r * r * d * d));
}

static void test_curved(void) {
    const char *const emitter = "<emitter type='area'><rgb name='radiance' value='1'/></emitter>";
    char text[1024];
    for (int m = 0; m < METHODS; m++) {
        for (int i = 0; i < 3; i++) {
            const double radius = 0.5, height = i == 2 ? 0.05 : 0.75, aside = i == 0 ? 0 : 0.6;
            snprintf(text, sizeof text,
                     "<shape type='disk'><transform name='to_world'><rotate x='1' angle='90'/>"
                     "<scale value='%g'/><translate x='%g' y='%g'/></transform>%s</shape>",
                     radius, aside, height, emitter);
            test_light(i == 0 ? "disk on the axis" : i == 1 ? "disk aside" : "near disk aside", text,
                       disk(radius, height, aside), m);
        }
        for (int i = 0; i < 2; i++) { // wholly above the floor: pi sin^2 times the cosine
            const double x = 1, y = i ? 0.11 : 1, radius = 0.1, d2 = x * x + y * y;
            snprintf(text, sizeof text,
                     "<shape type='sphere'><point name='center' x='%g' y='%g' z='0'/>"
                     "<float name='radius' value='%g'/>%s</shape>", x, y, radius, emitter);
            test_light(i ? "sphere near the horizon" : "sphere", text,
                       M_PI * radius * radius / d2 * y / sqrt(d2), m);
        }
        test_light("uniform sky", "<emitter type='constant'><rgb name='radiance' value='1'/>"
                                  "</emitter>", M_PI, m);
    }
}

static void test_delta(void) {
    for (int m = 0; m < DELTA_METHODS; m++) {
        test_light("directional at 60 degrees",
                   "<emitter type='directional'><vector name='direction' x='1.7320508' y='-1' z='0'/>"
                   "<rgb name='irradiance' value='2'/></emitter>", 1, m);
        test_light("point", "<emitter type='point'><point name='position' x='1' y='2' z='-2'/>"
                            "<rgb name='intensity' value='9'/></emitter>", 2.0 / 3, m);
        test_light("spot inside its beam",
                   "<emitter type='spot'><transform name='to_world'>"
                   "<lookat origin='1,2,-2' target='0,0,0' up='0,0,1'/></transform>"
                   "<rgb name='intensity' value='9'/></emitter>", 2.0 / 3, m);
    }
}

int main(void) {
    scene_folder_open();
    test_polygons();
    test_curved();
    test_delta();
    scene_folder_close();
    ztable_finish(FALSE_ALARMS);
    return check_result();
}
