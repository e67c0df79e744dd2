// SPDX-License-Identifier: Apache-2.0
// Mesh files, and where everything stands: the scene is moved so that its middle is the origin
// when it lies far away, in double, before positions become floats.
#include <string.h>

#include "base/thread.h"
#include "scene/quadric.h"
#include "scene/reader.h"

struct box {
    double lo[3], hi[3];
};

static const struct box empty_box = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

static void box_add(struct box *b, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        b->lo[k] = fmin(b->lo[k], p[k]);
        b->hi[k] = fmax(b->hi[k], p[k]);
    }
}

static bool box_is_empty(const struct box *b) {
    return !(b->lo[0] <= b->hi[0]);
}

static void box_add_transformed(struct box *b, const struct box *part, const struct transform *t) {
    if (box_is_empty(part))
        return;
    for (int corner = 0; corner < 8; corner++) {
        const double p[3] = {corner & 1 ? part->hi[0] : part->lo[0],
                             corner & 2 ? part->hi[1] : part->lo[1],
                             corner & 4 ? part->hi[2] : part->lo[2]};
        double q[3];
        transform_point(t, p, q);
        box_add(b, q);
    }
}

// Greatest half width, and greatest distance of the middle from the origin along an axis.
static double box_radius(const struct box *b) {
    double r = 0;
    for (int k = 0; k < 3; k++)
        r = fmax(r, (b->hi[k] - b->lo[k]) / 2);
    return r;
}

static double box_offset(const struct box *b) {
    double d = 0;
    for (int k = 0; k < 3; k++)
        d = fmax(d, fabs(b->lo[k] + b->hi[k]) / 2);
    return d;
}

// The point to take for the origin. Zero while the box is at most 4 radii away, so that ordinary
// scenes keep their bits; else the middle rounded to a power of two near the radius, so that
// scaling a scene by a power of two scales the result.
static void choose_centre(const struct box *b, double centre[3]) {
    memset(centre, 0, 3 * sizeof *centre);
    const double radius = box_radius(b), offset = box_offset(b);
    if (box_is_empty(b) || offset <= 4 * radius)
        return;
    const double step = radius > 0 ? exp2(floor(log2(radius))) : exp2(floor(log2(offset)) - 20);
    for (int k = 0; k < 3; k++)
        centre[k] = rint((b->lo[k] + b->hi[k]) / 2 / step) * step;
}

// t after a translation by -centre; unchanged bits when the centre is zero
static void move_by(struct transform *t, const double centre[3]) {
    if (centre[0] == 0 && centre[1] == 0 && centre[2] == 0)
        return;
    const struct transform move = transform_translate(-centre[0], -centre[1], -centre[2]);
    *t = transform_multiply(&move, t);
}

// ---- files ----------------------------------------------------------------------------------

static void read_mesh(void *ctx, size_t item, int worker) {
    struct reader *r = ctx;
    struct mesh_job *job = &LIST_AT(&r->jobs, struct mesh_job, item);
    struct shape *s = &LIST_AT(&r->shapes, struct shape, job->shape);
    (void)worker;
    job->failed = !job->type->read(job->path, &job->options, &s->mesh);
}

static bool read_files(struct reader *r) {
    bool ok = true;
    if (r->jobs.count == 1)
        LIST_AT(&r->jobs, struct mesh_job, 0).options.threads = r->options->threads;
    thread_for(r->options->threads, r->jobs.count, read_mesh, r);
    for (size_t i = 0; i < r->jobs.count; i++)
        ok = ok && !LIST_AT(&r->jobs, struct mesh_job, i).failed;
    return ok;
}

// ---- bounds ---------------------------------------------------------------------------------

struct placing {
    struct reader *r;
    struct box *shape_boxes, *group_boxes; // in the space of the world or of the group
    double (*group_centres)[3];
    double centre[3];
    bool failed;
};

static void bound_shape(void *ctx, size_t item, int worker) {
    struct placing *p = ctx;
    const struct shape *s = &LIST_AT(&p->r->shapes, struct shape, item);
    struct box *b = &p->shape_boxes[item];
    (void)worker;
    *b = empty_box;
    if (s->kind != SHAPE_MESH) {
        struct box own;
        quadric_bounds(s->kind, own.lo, own.hi);
        box_add_transformed(b, &own, &s->to_world);
        return;
    }
    for (uint32_t i = 0; i < s->mesh.vertex_count; i++) {
        const float *v = s->mesh.positions[i];
        const double at[3] = {v[0], v[1], v[2]};
        double q[3];
        transform_point(&s->to_world, at, q);
        box_add(b, q);
    }
}

static void bound_scene(struct placing *p, struct box *all) {
    struct reader *r = p->r;
    thread_for(r->options->threads, r->shapes.count, bound_shape, p);
    for (uint32_t g = 0; g < r->group_count; g++)
        p->group_boxes[g] = empty_box;
    *all = empty_box;
    for (size_t i = 0; i < r->shapes.count; i++) {
        const uint32_t group = LIST_AT(&r->shapes, struct shape, i).group;
        const struct box *b = &p->shape_boxes[i];
        if (box_is_empty(b))
            continue;
        box_add(group == SCENE_NONE ? all : &p->group_boxes[group], b->lo);
        box_add(group == SCENE_NONE ? all : &p->group_boxes[group], b->hi);
    }
    for (size_t i = 0; i < r->instances.count; i++) {
        const struct instance *n = &LIST_AT(&r->instances, struct instance, i);
        box_add_transformed(all, &p->group_boxes[n->group], &n->to_world);
    }
}

// Vertices that a file gives far from its own origin have lost digits before we see them.
static void warn_of_lost_digits(const struct shape *s, double size) {
    float far = 0;
    for (uint32_t i = 0; i < s->mesh.vertex_count; i++)
        for (int k = 0; k < 3; k++)
            far = maxf(far, fabsf(s->mesh.positions[i][k]));
    const double scale = cbrt(fabs(transform_determinant3(&s->to_world)));
    if (far * scale > 1e4 * size)
        log_warn_at(s->at, "vertices stand %g scene sizes from the origin of their file, where "
                    "floats resolve only %.2g of that size; move the mesh by its transform instead",
                    far * scale / size, far * scale * 0x1p-24 / size);
}

// ---- placing --------------------------------------------------------------------------------

static void place_shape(void *ctx, size_t item, int worker) {
    struct placing *p = ctx;
    struct shape *s = &LIST_AT(&p->r->shapes, struct shape, item);
    (void)worker;
    move_by(&s->to_world, s->group == SCENE_NONE ? p->centre : p->group_centres[s->group]);
    if (s->kind != SHAPE_MESH)
        return;
    if (!transform_is_identity(&s->to_world) && !mesh_transform(&s->mesh, &s->to_world)) {
        log_error_at(s->at, "its transform has no inverse");
        p->failed = true;
    }
    s->to_world = transform_identity;
}

static void place_instances(struct placing *p) {
    for (size_t i = 0; i < p->r->instances.count; i++) {
        struct instance *n = &LIST_AT(&p->r->instances, struct instance, i);
        const double *c = p->group_centres[n->group];
        if (c[0] != 0 || c[1] != 0 || c[2] != 0) {
            const struct transform back = transform_translate(c[0], c[1], c[2]);
            n->to_world = transform_multiply(&n->to_world, &back);
        }
        move_by(&n->to_world, p->centre);
    }
}

static float round_down(double v) {
    const float f = (float)v;
    return (double)f > v ? nextafterf(f, -INFINITY) : f;
}

static bool set_bounds(struct scene *s, const struct box *all) {
    float lo[3] = {0}, hi[3] = {0};
    for (int k = 0; k < 3 && !box_is_empty(all); k++) {
        lo[k] = round_down(all->lo[k] - s->centre[k]);
        hi[k] = -round_down(s->centre[k] - all->hi[k]);
    }
    s->bounds_min = v3_load(lo);
    s->bounds_max = v3_load(hi);
    // squares of distances must stay finite
    for (int k = 0; k < 3; k++)
        if (!(lo[k] > -1e18f && hi[k] < 1e18f)) {
            log_error("%s: shapes reach beyond 1e18", s->path);
            return false;
        }
    return true;
}

bool meshes_load(struct reader *r) {
    if (!read_files(r))
        return false;
    struct box all;
    struct placing p = {.r = r};
    p.shape_boxes = mem_array(r->shapes.count, sizeof *p.shape_boxes);
    p.group_boxes = mem_array(r->group_count, sizeof *p.group_boxes);
    p.group_centres = mem_array(r->group_count, sizeof *p.group_centres);
    bound_scene(&p, &all);
    choose_centre(&all, p.centre);
    for (uint32_t g = 0; g < r->group_count; g++)
        choose_centre(&p.group_boxes[g], p.group_centres[g]);
    memcpy(r->scene->centre, p.centre, sizeof p.centre);
    for (size_t i = 0; i < r->jobs.count; i++) {
        const struct mesh_job *job = &LIST_AT(&r->jobs, struct mesh_job, i);
        warn_of_lost_digits(&LIST_AT(&r->shapes, struct shape, job->shape), box_radius(&all));
    }
    bool ok = set_bounds(r->scene, &all);
    if (ok) {
        thread_for(r->options->threads, r->shapes.count, place_shape, &p);
        place_instances(&p);
    }
    mem_free(p.shape_boxes);
    mem_free(p.group_boxes);
    mem_free(p.group_centres);
    return ok && !p.failed;
}
