// SPDX-License-Identifier: Apache-2.0
// A view of a model that brings none: camera and sky.
#include <math.h>

#include "scene/tree.h"

enum { WIDTH = 1280, HEIGHT = 720 };
static const double HALF_FOV = 20 * 3.14159265358979323846 / 180; // of the picture's height

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Right, up and back of the camera: turned by 20 degrees about y, raised by 15.
static void axes(double x[3], double y[3], double z[3]) {
    const double turn = 20 * 3.14159265358979323846 / 180, raise = 15 * 3.14159265358979323846 / 180;
    const double st = sin(turn), ct = cos(turn), sr = sin(raise), cr = cos(raise);
    const double X[3] = {ct, 0, -st}, Y[3] = {-st * sr, cr, -ct * sr}, Z[3] = {st * cr, sr, ct * cr};
    for (int k = 0; k < 3; k++) {
        x[k] = X[k];
        y[k] = Y[k];
        z[k] = Z[k];
    }
}

// The least distance from the middle at which all corners of the box lie in the picture.
static double distance_to(const double half[3], double aspect) {
    double x[3], y[3], z[3], distance = 0;
    axes(x, y, z);
    const double tan_y = tan(HALF_FOV), tan_x = tan_y * aspect;
    for (int corner = 0; corner < 8; corner++) {
        const double p[3] = {corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1],
                             corner & 4 ? half[2] : -half[2]};
        const double reach = fmax(fabs(dot3(p, x)) / tan_x, fabs(dot3(p, y)) / tan_y);
        distance = fmax(distance, dot3(p, z) + reach);
    }
    return 1.05 * distance;
}

void tree_add_film(struct reader *r, struct xml_node *sensor) {
    struct xml_node *film = tree_add(r, sensor, "film", "hdrfilm", NULL);
    tree_integer(r, film, "width", WIDTH);
    tree_integer(r, film, "height", HEIGHT);
}

void tree_add_view(struct reader *r, struct xml_node *scene, const double lo[3],
                   const double hi[3]) {
    const struct scene_options *o = r->options;
    const double aspect = o->width > 0 && o->height > 0 ? (double)o->width / o->height
                                                        : (double)WIDTH / HEIGHT;
    double half[3], middle[3], x[3], y[3], z[3], origin[3];
    axes(x, y, z);
    for (int k = 0; k < 3; k++) {
        half[k] = (hi[k] - lo[k]) / 2;
        middle[k] = (hi[k] + lo[k]) / 2;
    }
    double distance = distance_to(half, aspect);
    distance = distance > 0 ? distance : 1;
    struct xml_node *sensor = tree_add(r, scene, "sensor", "perspective", NULL);
    for (int k = 0; k < 3; k++)
        origin[k] = middle[k] + distance * z[k];
    struct transform t = transform_identity;
    for (int k = 0; k < 3; k++) { // the camera looks along its +z with x to the left
        t.m[k][0] = -x[k];
        t.m[k][1] = y[k];
        t.m[k][2] = -z[k];
        t.m[k][3] = origin[k];
    }
    tree_transform(r, sensor, "to_world", &t);
    tree_text(r, sensor, "string", "fov_axis", "y");
    tree_number(r, sensor, "fov", 2 * HALF_FOV * 180 / 3.14159265358979323846);
    tree_number(r, sensor, "near_clip", distance * 1e-4);
    tree_number(r, sensor, "far_clip", distance * 1e6);
    tree_add_film(r, sensor);
    log_info("%s: has no camera: the whole model is looked at from the front", r->scene->path);
}

void tree_add_sky(struct reader *r, struct xml_node *scene) {
    static const double sun[3] = {-0.6, 1, 0.8};
    struct xml_node *sky = tree_add(r, scene, "emitter", "sunsky", NULL);
    tree_text(r, sky, "string", "up", "y");
    tree_triple(r, sky, "vector", "sun_direction", sun);
    tree_number(r, sky, "scale", 3);
    struct xml_node *ground = tree_add(r, scene, "emitter", "constant", NULL);
    tree_text(r, ground, "rgb", "radiance", "0.1 0.1 0.1");
    log_info("%s: has no light: a clear sky and grey surroundings light it", r->scene->path);
}
