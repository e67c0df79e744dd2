// SPDX-License-Identifier: Apache-2.0
// Lights and media of pbrt.
#include <math.h>
#include <string.h>

#include "image/image.h"
#include "scene/pbrt.h"

static bool refuse(const struct pbrt_call *c, const char *why) {
    log_error_at(c->at, "%s \"%s\": %s", c->directive, c->type, why);
    return false;
}

// "I" or "L" times "scale"; white where it is not given.
static bool put_emission(struct pbrt *p, struct pbrt_call *c, const char *name, double factor,
                         struct xml_node *out, const char *ours) {
    bool good = true;
    double v[3] = {1, 1, 1};
    const double scale = factor * pbrt_float(c, "scale", 1, &good);
    pbrt_read_colour(p, c, name, PBRT_ILLUMINANT, v, &good);
    for (int i = 0; i < 3; i++)
        v[i] *= scale;
    if (good && !(scale >= 0))
        return refuse(c, "\"scale\" is negative");
    tree_triple(p->r, out, "rgb", ours, v);
    return good;
}

// What "power" makes of the intensity whose sum over all directions is `whole` for intensity 1.
static double by_power(struct pbrt_call *c, double whole, bool *good) {
    const double power = pbrt_float(c, "power", -1, good);
    return power > 0 ? power / whole : 1;
}

static void from_to(struct pbrt_call *c, double from[3], double to[3], bool *good) {
    pbrt_triple(c, "point3", "from", from, good);
    pbrt_triple(c, "point3", "to", to, good);
}

static bool point(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double from[3] = {0, 0, 0}, world[3];
    pbrt_triple(c, "point3", "from", from, &good);
    transform_point(&p->state.ctm, from, world);
    pbrt_set_type(p, out, "point");
    tree_triple(p->r, out, "point", "position", world);
    const double factor = by_power(c, 4 * M_PI, &good);
    return good && put_emission(p, c, "I", factor, out, "intensity");
}

static bool distant(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double from[3] = {0, 0, 0}, to[3] = {0, 0, 1}, d[3], world[3];
    from_to(c, from, to, &good);
    for (int i = 0; i < 3; i++)
        d[i] = to[i] - from[i];
    transform_vector(&p->state.ctm, d, world);
    if (!(world[0] * world[0] + world[1] * world[1] + world[2] * world[2] > 0))
        return refuse(c, "\"from\" and \"to\" are the same point");
    pbrt_set_type(p, out, "directional");
    tree_triple(p->r, out, "vector", "direction", world);
    const double lux = pbrt_float(c, "illuminance", -1, &good);
    return good && put_emission(p, c, "L", lux > 0 ? lux : 1, out, "irradiance");
}

static bool spot(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double from[3] = {0, 0, 0}, to[3] = {0, 0, 1}, a[3], b[3];
    const double cone = pbrt_float(c, "coneangle", 30, &good);
    const double delta = pbrt_float(c, "conedeltaangle", 5, &good);
    const double radian = M_PI / 180, start = cos((cone - delta) * radian), end = cos(cone * radian);
    struct transform look;
    from_to(c, from, to, &good);
    transform_point(&p->state.ctm, from, a);
    transform_point(&p->state.ctm, to, b);
    const double up[3] = {0, fabs(b[1] - a[1]) > 0.9 * hypot(b[0] - a[0], b[2] - a[2]) ? 0 : 1,
                          fabs(b[1] - a[1]) > 0.9 * hypot(b[0] - a[0], b[2] - a[2]) ? 1 : 0};
    if (!good || !transform_look_at(a, b, up, &look))
        return good && refuse(c, "\"from\" and \"to\" are the same point");
    if (!(cone > 0 && cone < 180 && delta >= 0 && delta <= cone))
        return refuse(c, "expected coneangle above 0 and conedeltaangle no larger");
    pbrt_set_type(p, out, "spot");
    tree_transform(p->r, out, "to_world", &look);
    tree_number(p->r, out, "cutoff_angle", fmin(cone, 89.9));
    tree_number(p->r, out, "beam_width", fmin(cone, 89.9) - fmin(delta, cone));
    pbrt_warn(p, c->at, "the edge of a spot falls off linearly here, smoothly in pbrt");
    const double whole = 2 * M_PI * ((1 - start) + (start - end) / 2);
    const double factor = by_power(c, whole, &good);
    return good && put_emission(p, c, "I", factor, out, "intensity");
}

// pbrt-v4 wants square pictures in an equal-area map; those of two to one are latitude and longitude,
// of earlier versions: z up, the middle of the picture at -x.
static bool picture(struct pbrt *p, struct pbrt_call *c, const char *name, struct xml_node *out) {
    static const struct transform turn = {{{-1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0, 0, 1}}};
    bool good = true;
    struct image im;
    const char *path = load_find_file(p->r, name, c->at);
    if (!path || !image_read(path, &im))
        return false;
    const bool square = im.width == im.height;
    image_finish(&im);
    if (square)
        return refuse(c, "square pictures (equal-area maps) are not read; expected latitude and "
                      "longitude, twice as wide as high");
    pbrt_warn(p, c->at, "\"%s\" is taken for a picture of latitude and longitude", name);
    const struct transform world = transform_multiply(&p->state.ctm, &turn);
    pbrt_set_type(p, out, "envmap");
    tree_text(p->r, out, "string", "filename", path);
    tree_transform(p->r, out, "to_world", &world);
    tree_number(p->r, out, "scale", pbrt_float(c, "scale", 1, &good));
    return good;
}

static bool infinite(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    const char *name = pbrt_string(c, "filename", NULL, &good);
    const double lux = pbrt_float(c, "illuminance", -1, &good);
    if (!good || name)
        return good && picture(p, c, name, out);
    pbrt_set_type(p, out, "constant");
    return put_emission(p, c, "L", lux > 0 ? lux / M_PI : 1, out, "radiance");
}

const struct pbrt_row pbrt_lights[] = {
    {"point", "point", point},
    {"distant", "directional", distant},
    {"spot", "spot, with a linear edge", spot},
    {"infinite", "constant; a picture of latitude and longitude: envmap; an equal-area map: refused",
     infinite},
    {"goniometric", "refused", NULL},
    {"projection", "refused", NULL},
    {0},
};

static bool area(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    if (pbrt_bool(c, "twosided", false, &good))
        pbrt_warn(p, c->at, "an area light shines on the side of its normals only");
    if (pbrt_find(c, "float", "power", &good) || pbrt_find(c, "string", "filename", &good))
        return refuse(c, "\"power\" and \"filename\" are not read; expected \"L\" and \"scale\"");
    return good && put_emission(p, c, "L", 1, out, "radiance");
}

const struct pbrt_row pbrt_area_lights[] = {
    {"diffuse", "area, on the side of the normals; power, filename: refused", area},
    {0},
};

// ---- media --------------------------------------------------------------------------------------

static bool homogeneous(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const names[2] = {"sigma_a", "sigma_s"};
    bool good = true;
    const double scale = pbrt_float(c, "scale", 1, &good), g = pbrt_float(c, "g", 0, &good);
    double v[2][3] = {{1, 1, 1}, {1, 1, 1}}; // pbrt's defaults
    if (pbrt_find(c, "string", "preset", &good) || pbrt_find(c, "rgb|spectrum|blackbody", "Le", &good))
        return refuse(c, "\"preset\" and \"Le\" are not read; expected \"sigma_a\" and \"sigma_s\"");
    pbrt_set_type(p, out, "homogeneous");
    for (int i = 0; i < 2; i++) {
        pbrt_read_colour(p, c, names[i], PBRT_UNBOUNDED, v[i], &good);
        for (int k = 0; k < 3; k++)
            v[i][k] *= scale;
        tree_triple(p->r, out, "rgb", names[i], v[i]);
    }
    struct xml_node *phase = pbrt_add(p, out, "phase", g == 0 ? "isotropic" : "hg", NULL, c->at);
    if (g != 0)
        tree_number(p->r, phase, "g", g);
    return good;
}

const struct pbrt_row pbrt_media[] = {
    {"homogeneous", "homogeneous, with isotropic or hg; preset, Le: refused", homogeneous},
    {"uniformgrid", "refused", NULL},
    {"rgbgrid", "refused", NULL},
    {"cloud", "refused", NULL},
    {"nanovdb", "refused", NULL},
    {0},
};
