// SPDX-License-Identifier: Apache-2.0
// A volume from a file of voxels. They fill the unit cube before to_world, or stand where the file
// says; values stand in the middles of voxels (as Mitsuba 3 has it).
#include "volume/bounds.h"
#include "volume/grid.h"
#include "volume/volume.h"

enum filter { TRILINEAR, NEAREST };
enum wrap { CLAMP, REPEAT, MIRROR };

struct gridvolume {
    const char *filename, *grid_name;
    int filter, wrap;
    bool use_grid_bbox;
    struct transform to_world;
    // made by prepare
    struct grid grid;
    struct affine to_voxels; // world to [0, size] along each axis
    spectrum maximum;
    struct volume_bounds bounds;
};

static const char *const filter_names[] = {"trilinear", "nearest", NULL};
static const char *const wrap_names[] = {"clamp", "repeat", "mirror", NULL};

#define FIELD(name) offsetof(struct gridvolume, name)

static const struct param params[] = {
    {"filename", PARAM_FILE, FIELD(filename), .help = "a .vol (version 3) or .vdb (OpenVDB)"},
    {"grid", PARAM_STRING, FIELD(grid_name), .optional = true,
     .help = "name of the grid, in a file with several"},
    {"filter_type", PARAM_CHOICE, FIELD(filter), .def = "trilinear", .choices = filter_names,
     .help = "between voxels"},
    {"wrap_mode", PARAM_CHOICE, FIELD(wrap), .def = "clamp", .choices = wrap_names,
     .help = "beyond the grid, where this is no density"},
    {"use_grid_bbox", PARAM_BOOL, FIELD(use_grid_bbox), .def = "false",
     .help = "stand where the file says: always so for .vdb, and in scenes before version 2"},
    {"to_world", PARAM_TRANSFORM, FIELD(to_world), .def = "", .help = "volume to world"},
    {"raw", PARAM_IGNORED}, {"accel", PARAM_IGNORED}, {"send_data", PARAM_IGNORED},
    PARAM_END,
};

static int wrap_index(int i, int n, enum wrap wrap) {
    if (i >= 0 && i < n)
        return i;
    if (wrap == CLAMP)
        return i < 0 ? 0 : n - 1;
    const int period = wrap == REPEAT ? n : 2 * n;
    const int k = (i % period + period) % period;
    return k < n ? k : 2 * n - 1 - k;
}

// The voxels on both sides of x, and the weight of the upper one.
static float neighbours(const struct gridvolume *v, int axis, float x, int i[2]) {
    const int n = v->grid.size[axis];
    const float far = 1e6f; // beyond, all wraps look the same to a float
    const float y = clampf(v->filter == TRILINEAR ? x - 0.5f : x, -far, far);
    const float below = floorf(y);
    i[0] = wrap_index((int)below, n, (enum wrap)v->wrap);
    i[1] = wrap_index((int)below + 1, n, (enum wrap)v->wrap);
    return v->filter == TRILINEAR ? y - below : 0;
}

static spectrum load(const struct gridvolume *v, size_t row, int x) {
    const float *p = v->grid.values + (row + (size_t)x) * (size_t)v->grid.channels;
    return v->grid.channels == 1 ? spectrum_grey(p[0]) : spectrum_rgb(p[0], p[1], p[2]);
}

static spectrum eval(const void *data, vec3 p) {
    const struct gridvolume *v = data;
    const vec3 q = affine_point(&v->to_voxels, p);
    int x[2], y[2], z[2];
    const float u = neighbours(v, 0, q[0], x);
    const float t[2] = {neighbours(v, 1, q[1], y), neighbours(v, 2, q[2], z)};
    const size_t nx = (size_t)v->grid.size[0], ny = (size_t)v->grid.size[1];
    spectrum lines[4];
    for (int i = 0; i < 4; i++) {
        const size_t row = ((size_t)z[i >> 1] * ny + (size_t)y[i & 1]) * nx;
        lines[i] = (1 - u) * load(v, row, x[0]) + u * load(v, row, x[1]);
    }
    return (1 - t[1]) * ((1 - t[0]) * lines[0] + t[0] * lines[1]) +
           t[1] * ((1 - t[0]) * lines[2] + t[0] * lines[3]);
}

static spectrum maximum(const void *data) {
    return ((const struct gridvolume *)data)->maximum;
}

static const struct volume_bounds *bounds(const void *data) {
    return &((const struct gridvolume *)data)->bounds;
}

// ---- along a ray --------------------------------------------------------------------------------

// The planes between which the interpolation is smooth: at distance `first` from 0 and every 1 on.
struct planes {
    double o, d;  // voxel coordinate o + t d
    double first;
    int next;     // plane `first + next` comes next; counted downwards where d < 0
};

static double plane_t(const struct planes *p) {
    return p->d == 0 ? (double)INFINITY : (p->first + p->next - p->o) / p->d;
}

static void pieces(const void *data, vec3 o, vec3 d, float t0, float t1,
                   void (*visit)(void *user, double a, double b), void *user) {
    const struct gridvolume *v = data;
    const vec3 vo = affine_point(&v->to_voxels, o), vd = affine_vector(&v->to_voxels, d);
    struct planes axes[3];
    double a = (double)t0, end = (double)t1;
    for (int k = 0; k < 3; k++) {
        struct planes *p = &axes[k];
        *p = (struct planes){(double)vo[k], (double)vd[k], v->filter == TRILINEAR ? 0.5 : 0, 0};
        const double lo = (0 - p->o) / p->d, hi = (v->grid.size[k] - p->o) / p->d;
        if (p->d == 0 && !(p->o >= 0 && p->o <= v->grid.size[k]))
            return;
        if (p->d != 0) {
            a = fmax(a, fmin(lo, hi));
            end = fmin(end, fmax(lo, hi));
        }
    }
    for (int k = 0; k < 3; k++) {
        struct planes *p = &axes[k];
        const double x = p->o + a * p->d - p->first;
        p->next = p->d > 0 ? (int)floor(x) + 1 : (int)ceil(x) - 1;
    }
    while (a < end) {
        int nearest = 0;
        for (int k = 1; k < 3; k++)
            if (plane_t(&axes[k]) < plane_t(&axes[nearest]))
                nearest = k;
        const double b = fmin(plane_t(&axes[nearest]), end);
        if (b > a)
            visit(user, a, b);
        a = fmax(a, b);
        axes[nearest].next += axes[nearest].d > 0 ? 1 : -1;
    }
}

// ---- preparation --------------------------------------------------------------------------------

static bool place(struct gridvolume *v, const double origin[3], struct where at) {
    struct transform inverse, unit = v->to_world;
    if (v->use_grid_bbox || v->grid.placed)
        unit = transform_multiply(&v->to_world, &v->grid.to_file);
    const struct transform move = transform_translate(-origin[0], -origin[1], -origin[2]);
    unit = transform_multiply(&move, &unit);
    if (!transform_invert(&unit, &inverse)) {
        log_error_at(at, "the volume's transform has no inverse");
        return false;
    }
    const struct transform size =
        transform_scale(v->grid.size[0], v->grid.size[1], v->grid.size[2]);
    const struct transform to_voxels = transform_multiply(&size, &inverse);
    v->to_voxels = affine_from(&to_voxels);
    return true;
}

static void voxel_range(const void *grid, int axis, float lo, float hi, int range[2]) {
    const struct gridvolume *v = grid;
    const float half = v->filter == TRILINEAR ? 0.5f : 0, slack = 1e-3f;
    range[0] = (int)floorf(lo - half - slack);
    range[1] = (int)floorf(hi - half + slack) + (v->filter == TRILINEAR);
    (void)axis;
}

static int voxel_index(const void *grid, int axis, int i) {
    const struct gridvolume *v = grid;
    return wrap_index(i, v->grid.size[axis], (enum wrap)v->wrap);
}

static bool prepare(struct object *self, const double origin[3], struct arena *arena) {
    struct gridvolume *v = self->data;
    if (!grid_read(v->filename, v->grid_name, &v->grid) || !place(v, origin, self->at))
        return false;
    const struct bounds_source source = {&v->grid, v, voxel_range, voxel_index};
    bounds_build(&v->bounds, &source, &v->to_voxels, arena);
    v->maximum = bounds_maximum(&v->bounds);
    return true;
}

static size_t bytes(const void *data) {
    const struct gridvolume *v = data;
    const int *cells = v->bounds.cells;
    return grid_values(&v->grid) * sizeof(float) +
           (size_t)cells[0] * (size_t)cells[1] * (size_t)cells[2] * (size_t)v->bounds.lanes *
               sizeof(float);
}

static void finish(void *data) {
    grid_finish(&((struct gridvolume *)data)->grid);
}

const struct volume_type volume_gridvolume = {
    .entry = {.name = "gridvolume", .help = "voxels from a file", .params = params,
              .size = sizeof(struct gridvolume)},
    .prepare = prepare, .eval = eval, .maximum = maximum, .bounds = bounds, .pieces = pieces,
    .bytes = bytes, .finish = finish,
};
