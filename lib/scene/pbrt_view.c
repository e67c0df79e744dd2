// SPDX-License-Identifier: Apache-2.0
// Cameras, films, filters, samplers and integrators of pbrt.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/pbrt.h"

static bool refuse(const struct pbrt_call *c, const char *why) {
    log_error_at(c->at, "%s \"%s\": %s", c->directive, c->type, why);
    return false;
}

// ---- cameras: the transform and the film are put in at the end ------------------------------------

static bool shutter(struct pbrt_call *c) {
    bool good = true;
    pbrt_float(c, "shutteropen", 0, &good);
    pbrt_float(c, "shutterclose", 1, &good);
    if (pbrt_find(c, "float", "screenwindow", &good) ||
        pbrt_find(c, "float", "frameaspectratio", &good))
        return refuse(c, "\"screenwindow\" and \"frameaspectratio\" are not read");
    return good;
}

static bool lens(struct pbrt *p, struct pbrt_call *c, struct xml_node *out, bool *thin) {
    bool good = true;
    const double radius = pbrt_float(c, "lensradius", 0, &good);
    const double distance = pbrt_float(c, "focaldistance", 1e6, &good);
    *thin = radius > 0;
    if (*thin) {
        tree_number(p->r, out, "aperture_radius", radius);
        tree_number(p->r, out, "focus_distance", distance);
    }
    return good;
}

static bool perspective(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool thin, good = shutter(c) && lens(p, c, out, &thin);
    if (!good)
        return false;
    pbrt_set_type(p, out, thin ? "thinlens" : "perspective");
    tree_number(p->r, out, "fov", pbrt_float(c, "fov", 90, &good));
    tree_text(p->r, out, "string", "fov_axis", "smaller");
    tree_number(p->r, out, "near_clip", 1e-3); // pbrt's is 1e-2 of its depth only
    tree_number(p->r, out, "far_clip", 1e30);
    return good;
}

static bool orthographic(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool thin, good = shutter(c) && lens(p, c, out, &thin);
    if (good && thin)
        return refuse(c, "a lens is read for perspective cameras only");
    pbrt_set_type(p, out, "orthographic");
    tree_number(p->r, out, "near_clip", 1e-30);
    tree_number(p->r, out, "far_clip", 1e30);
    return good;
}

const struct pbrt_row pbrt_cameras[] = {
    {"perspective", "perspective, or thinlens where lensradius is above 0; screenwindow: refused",
     perspective},
    {"orthographic", "orthographic; screenwindow: refused", orthographic},
    {"realistic", "refused", NULL},
    {"spherical", "refused", NULL},
    {0},
};

// ---- film -----------------------------------------------------------------------------------------

static bool film(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const nothing[] = {"filename", "savefp16", "sensor", "coordinatesystem", NULL};
    bool good = true;
    p->width = pbrt_integer(c, "xresolution", 1280, &good);
    p->height = pbrt_integer(c, "yresolution", 720, &good);
    for (int i = 0; nothing[i]; i++)
        pbrt_find(c, "string|bool", nothing[i], &good);
    const double ratio = pbrt_float(c, "iso", 100, &good) * pbrt_float(c, "exposuretime", 1, &good) / 100;
    pbrt_float(c, "diagonal", 35, &good);
    pbrt_float(c, "maxcomponentvalue", 1e30, &good);
    const struct pbrt_param *crop = pbrt_find(c, "float", "cropwindow", &good);
    if (!good || p->width < 1 || p->height < 1 || p->width > 65536 || p->height > 65536)
        return good && refuse(c, "the resolution is not within 1 to 65536");
    if (fabs(ratio - 1) > 1e-6)
        pbrt_warn(p, c->at, "the exposure (iso times exposuretime / 100 = %g) is not applied: relume "
                  "tonemap --exposure %.3g", ratio, log2(ratio));
    pbrt_set_type(p, out, "hdrfilm");
    tree_integer(p->r, out, "width", p->width);
    tree_integer(p->r, out, "height", p->height);
    if (!crop)
        return true;
    const double *w = crop->numbers;
    if (crop->count != 4 || !(w[0] >= 0 && w[0] < w[1] && w[1] <= 1 && w[2] >= 0 && w[2] < w[3] &&
                              w[3] <= 1))
        return refuse(c, "\"cropwindow\" is not x0 x1 y0 y1 within 0 to 1");
    const double x0 = ceil(p->width * w[0]), y0 = ceil(p->height * w[2]);
    tree_integer(p->r, out, "crop_offset_x", (int64_t)x0);
    tree_integer(p->r, out, "crop_offset_y", (int64_t)y0);
    tree_integer(p->r, out, "crop_width", (int64_t)(ceil(p->width * w[1]) - x0));
    tree_integer(p->r, out, "crop_height", (int64_t)(ceil(p->height * w[3]) - y0));
    return true;
}

const struct pbrt_row pbrt_films[] = {
    {"rgb", "hdrfilm; sensors and exposure: nothing, with a warning", film},
    {"gbuffer", "hdrfilm (--aov has its layers)", film},
    {"spectral", "hdrfilm", film},
    {0},
};

// ---- filters --------------------------------------------------------------------------------------

static bool radius(struct pbrt *p, struct pbrt_call *c, double otherwise, double *r) {
    bool good = true;
    const double x = pbrt_float(c, "xradius", otherwise, &good);
    const double y = pbrt_float(c, "yradius", otherwise, &good);
    if (x != y)
        pbrt_warn(p, c->at, "a filter is as wide as high: %g", x);
    *r = x;
    return good;
}

static bool box(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    double r;
    pbrt_set_type(p, out, "box");
    const bool good = radius(p, c, 0.5, &r);
    tree_number(p->r, out, "radius", r);
    return good;
}

static bool triangle(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    double r;
    pbrt_set_type(p, out, "tent");
    const bool good = radius(p, c, 2, &r);
    tree_number(p->r, out, "radius", r);
    return good;
}

static bool gaussian(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double r;
    pbrt_set_type(p, out, "gaussian");
    tree_number(p->r, out, "stddev", pbrt_float(c, "sigma", 0.5, &good));
    return radius(p, c, 1.5, &r) && good;
}

static bool mitchell(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double r;
    pbrt_set_type(p, out, "mitchell");
    tree_number(p->r, out, "B", pbrt_float(c, "B", 1.0 / 3, &good));
    tree_number(p->r, out, "C", pbrt_float(c, "C", 1.0 / 3, &good));
    return radius(p, c, 2, &r) && good;
}

static bool sinc(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    double r;
    pbrt_set_type(p, out, "lanczos");
    tree_integer(p->r, out, "lobes", (int64_t)pbrt_float(c, "tau", 3, &good));
    return radius(p, c, 4, &r) && good;
}

const struct pbrt_row pbrt_filters[] = {
    {"box", "box", box},
    {"triangle", "tent", triangle},
    {"gaussian", "gaussian: stddev = sigma", gaussian},
    {"mitchell", "mitchell", mitchell},
    {"sinc", "lanczos: lobes = tau", sinc},
    {0},
};

// ---- samplers and integrators -----------------------------------------------------------------------

static bool sampler(struct pbrt *p, struct pbrt_call *c, struct xml_node *out, const char *type,
                    int samples) {
    bool good = true;
    pbrt_integer(c, "seed", 0, &good);
    pbrt_string(c, "randomization", "", &good);
    pbrt_set_type(p, out, type);
    sampler_report(c->type, type, c->at);
    tree_integer(p->r, out, "sample_count", samples > 0 ? samples : 1);
    return good;
}

static bool sobol(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    return sampler(p, c, out, "sobol", pbrt_integer(c, "pixelsamples", 16, &good)) && good;
}

static bool independent(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    return sampler(p, c, out, "independent", pbrt_integer(c, "pixelsamples", 16, &good)) && good;
}

static bool stratified(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    const double x = pbrt_integer(c, "xsamples", 4, &good), y = pbrt_integer(c, "ysamples", 4, &good);
    pbrt_bool(c, "jitter", true, &good);
    if (!(x >= 1 && y >= 1 && x * y < 1e9))
        return refuse(c, "expected xsamples and ysamples from 1 on");
    return sampler(p, c, out, "stratified", (int)(x * y)) && good;
}

const struct pbrt_row pbrt_samplers[] = {
    {"independent", "independent", independent},
    {"stratified", "stratified", stratified},
    {"halton", "sobol", sobol},
    {"sobol", "sobol", sobol},
    {"paddedsobol", "sobol", sobol},
    {"zsobol", "sobol", sobol},
    {"pmj02bn", "sobol", sobol},
    {0},
};

static bool integrator(struct pbrt *p, struct pbrt_call *c, struct xml_node *out, const char *type) {
    bool good = true;
    const int depth = pbrt_integer(c, "maxdepth", 5, &good);
    pbrt_bool(c, "regularize", false, &good);
    pbrt_string(c, "lightsampler", "", &good);
    pbrt_set_type(p, out, type);
    // Scattering events there, edges of the path here.
    tree_integer(p->r, out, "max_depth", depth < 0 ? 1 : depth < 1000000 ? depth + 1 : 1000000);
    return good;
}

static bool volpath(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    return integrator(p, c, out, "volpath");
}

static bool path(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    return integrator(p, c, out, "path");
}

static bool simple(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    pbrt_bool(c, "samplelights", true, &good);
    pbrt_bool(c, "samplebsdf", true, &good);
    return integrator(p, c, out, "path") && good;
}

static bool other(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    pbrt_warn(p, c->at, "the integrator \"%s\" is not there: path tracing takes its place", c->type);
    return integrator(p, c, out, "volpath");
}

const struct pbrt_row pbrt_integrators[] = {
    {"path", "path: max_depth = maxdepth + 1", path},
    {"volpath", "volpath, likewise", volpath},
    {"simplepath", "path", simple},
    {"simplevolpath", "volpath", volpath},
    {"bdpt", "volpath, with a warning", other},
    {"mlt", "volpath, with a warning", other},
    {"sppm", "volpath, with a warning", other},
    {"lightpath", "volpath, with a warning", other},
    {"randomwalk", "volpath, with a warning", other},
    {"ambientocclusion", "refused", NULL},
    {"function", "refused", NULL},
    {0},
};
