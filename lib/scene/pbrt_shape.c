// SPDX-License-Identifier: Apache-2.0
// Shapes of pbrt: exact quadrics, triangle meshes and PLY files.
//
// Normals are those of pbrt: by the winding or the vertex normals in object space, turned round by
// ReverseOrientation; a mirroring transform does not turn them.
#include <math.h>
#include <string.h>

#include "mesh/reader.h"
#include "scene/pbrt.h"

static bool refuse(const struct pbrt_call *c, const char *why) {
    log_error_at(c->at, "Shape \"%s\": %s", c->type, why);
    return false;
}

// ---- meshes -------------------------------------------------------------------------------------

// The numbers of a list of points; *count is that of points, of `width` numbers each.
static const double *points_of(struct pbrt_call *c, const char *types, const char *name, int width,
                               size_t *count, bool *good) {
    const struct pbrt_param *a = pbrt_find(c, types, name, good);
    *count = a ? a->count / (size_t)width : 0;
    if (a && a->count % (size_t)width != 0) {
        log_error_at(a->at, "\"%s\" has %zu numbers, expected a multiple of %d", name, a->count, width);
        *good = false;
    }
    return a ? a->numbers : NULL;
}

static bool copy_vertices(struct pbrt_call *c, struct mesh *m) {
    bool good = true;
    size_t n, normals, uvs;
    const double *p = points_of(c, "point3", "P", 3, &n, &good);
    const double *normal = points_of(c, "normal", "N", 3, &normals, &good);
    const double *uv = points_of(c, "point2|float|vector2", "uv", 2, &uvs, &good);
    if (!uv)
        uv = points_of(c, "point2|float|vector2", "st", 2, &uvs, &good);
    if (!good || !p || n > UINT32_MAX / 4)
        return good && refuse(c, "\"point3 P\" is missing, or has too many points");
    if ((normal && normals != n) || (uv && uvs != n))
        return refuse(c, "\"N\" or \"uv\" has another number of values than \"P\"");
    m->vertex_count = (uint32_t)n;
    m->positions = mesh_alloc_positions(n);
    m->normals = normal ? mem_array(n, sizeof *m->normals) : NULL;
    m->uvs = uv ? mem_array(n, sizeof *m->uvs) : NULL;
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < 3; k++) {
            m->positions[i][k] = (float)p[3 * i + k];
            good = good && fabsf(m->positions[i][k]) < 1e30f;
            if (normal)
                m->normals[i][k] = (float)normal[3 * i + k];
        }
        for (size_t k = 0; uv && k < 2; k++)
            m->uvs[i][k] = (float)uv[2 * i + k];
    }
    return good || refuse(c, "a point is too far away");
}

static bool copy_indices(struct pbrt_call *c, int corners, struct mesh *m) {
    bool good = true;
    size_t faces;
    const double *indices = points_of(c, "integer", "indices", corners, &faces, &good);
    static const double first[4] = {0, 1, 2, 3};
    if (!indices && m->vertex_count != (uint32_t)corners)
        return refuse(c, "\"integer indices\" is missing");
    if (!indices) {
        indices = first;
        faces = 1;
    }
    if (!good || faces > UINT32_MAX / 8)
        return false;
    // A bilinear patch has its corners at uv 00, 10, 01, 11.
    static const int split[2][2][3] = {{{0, 1, 2}, {0, 0, 0}}, {{0, 1, 3}, {0, 3, 2}}};
    const size_t each = corners == 4 ? 2 : 1;
    m->triangle_count = (uint32_t)(faces * each);
    m->indices = mem_array(m->triangle_count, sizeof *m->indices);
    for (size_t f = 0; f < faces; f++)
        for (size_t t = 0; t < each; t++)
            for (int k = 0; k < 3; k++) {
                const double v = indices[f * (size_t)corners + (size_t)split[corners == 4][t][k]];
                if (!(v >= 0 && v < m->vertex_count && v == floor(v)))
                    return refuse(c, "an index is not that of a point");
                m->indices[f * each + t][k] = (uint32_t)v;
            }
    return true;
}

static bool make_mesh(struct pbrt *p, struct pbrt_call *c, struct xml_node *out, int corners) {
    struct mesh m = {0};
    if (!copy_vertices(c, &m) || !copy_indices(c, corners, &m) || m.triangle_count == 0) {
        mesh_finish(&m);
        return false;
    }
    pbrt_set_type(p, out, "made");
    tree_integer(p->r, out, "shape_index", tree_keep_mesh(p->r, &m));
    return true;
}

static bool trianglemesh(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    return make_mesh(p, c, out, 3);
}

static bool bilinearmesh(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    return make_mesh(p, c, out, 4);
}

static bool plymesh(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    const char *name = pbrt_string(c, "filename", NULL, &good);
    if (!good || !name)
        return good && refuse(c, "\"string filename\" is missing");
    const size_t n = strlen(name);
    if (n > 3 && strcmp(name + n - 3, ".gz") == 0)
        return refuse(c, "compressed files are not read; expected a .ply (gunzip it)");
    pbrt_set_type(p, out, "ply");
    tree_text(p->r, out, "string", "filename", name);
    return true;
}

// ---- quadrics -----------------------------------------------------------------------------------

// Whether the shape is whole; parts of it are not made here.
static bool is_whole(struct pbrt_call *c, const char *const *names, const double *whole,
                     bool *good) {
    bool same = true;
    for (int i = 0; names[i]; i++) {
        const double v = pbrt_float(c, names[i], whole[i], good);
        same = same && fabs(v - whole[i]) <= 1e-6 * fabs(whole[i]);
    }
    return same;
}

static bool sphere(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const names[] = {"zmin", "zmax", "phimax", NULL};
    bool good = true;
    const double radius = pbrt_float(c, "radius", 1, &good);
    const double low = fmax(pbrt_float(c, "zmin", -radius, &good), -radius);
    const double high = fmin(pbrt_float(c, "zmax", radius, &good), radius);
    const double whole[] = {low, high, 360};
    if (good && !(low <= -radius && high >= radius && is_whole(c, names + 2, whole + 2, &good)))
        return refuse(c, "only whole spheres are made");
    pbrt_set_type(p, out, "sphere");
    tree_number(p->r, out, "radius", radius);
    return good;
}

static bool disk(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const names[] = {"innerradius", "phimax", NULL};
    static const double whole[] = {0, 360};
    bool good = true;
    const double radius = pbrt_float(c, "radius", 1, &good);
    const double height = pbrt_float(c, "height", 0, &good);
    if (!is_whole(c, names, whole, &good))
        return refuse(c, "only whole disks are made");
    if (!(radius > 0))
        return good && refuse(c, "the radius is not above 0");
    const struct transform size = transform_scale(radius, radius, radius);
    const struct transform up = transform_translate(0, 0, height);
    const struct transform own = transform_multiply(&up, &size);
    p->state.ctm = transform_multiply(&p->state.ctm, &own); // of this shape: the caller restores it
    pbrt_set_type(p, out, "disk");
    return good;
}

static bool cylinder(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const names[] = {"phimax", NULL};
    static const double whole[] = {360};
    bool good = true;
    const double low[3] = {0, 0, pbrt_float(c, "zmin", -1, &good)};
    const double high[3] = {0, 0, pbrt_float(c, "zmax", 1, &good)};
    const double radius = pbrt_float(c, "radius", 1, &good);
    if (!is_whole(c, names, whole, &good))
        return refuse(c, "only whole cylinders are made");
    pbrt_set_type(p, out, "cylinder");
    tree_triple(p->r, out, "point", "p0", low);
    tree_triple(p->r, out, "point", "p1", high);
    tree_number(p->r, out, "radius", radius);
    return good;
}

const struct pbrt_row pbrt_shapes[] = {
    {"sphere", "sphere; a part of one: refused", sphere},
    {"disk", "disk; a part of one: refused", disk},
    {"cylinder", "cylinder; a part of one: refused", cylinder},
    {"trianglemesh", "mesh", trianglemesh},
    {"bilinearmesh", "mesh: two triangles a patch, exact where it is flat", bilinearmesh},
    {"plymesh", "ply; not compressed", plymesh},
    {"curve", "refused", NULL},
    {"loopsubdiv", "refused", NULL},
    {0},
};

// ---- what all shapes have -----------------------------------------------------------------------

// The state's material, behind the mask of "alpha" where there is one.
static bool add_bsdf(struct pbrt *p, struct pbrt_call *c, struct xml_node *shape) {
    bool good = true;
    if (!p->state.material) { // pbrt's default
        struct pbrt_call plain = {.directive = "Material", .type = "diffuse", .at = c->at,
                                  .target = PBRT_NO_TARGET};
        p->state.material = "default material";
        if (!id_find(p->r, p->state.material) &&
            !pbrt_add_material(p, &plain, p->state.material))
            return false;
    }
    struct xml_node *out = shape;
    if (pbrt_find(c, "texture|float", "alpha", &good)) {
        out = pbrt_add(p, shape, "bsdf", "mask", NULL, c->at);
        if (!pbrt_put_texture(p, c, "alpha", out, "opacity", true))
            return false;
    }
    pbrt_ref(p, out, NULL, p->state.material);
    return good;
}

static bool add_media(struct pbrt *p, struct pbrt_call *c, struct xml_node *shape) {
    const char *const ids[2] = {p->state.inside, p->state.outside};
    for (int i = 0; i < 2; i++) {
        if (!ids[i])
            continue;
        if (!id_find(p->r, ids[i])) {
            log_error_at(c->at, "there is no medium \"%s\" before this line", ids[i] + 7);
            return false;
        }
        pbrt_ref(p, shape, i ? "exterior" : "interior", ids[i]);
    }
    return true;
}

static bool add_emitter(struct pbrt *p, struct pbrt_call *c, struct xml_node *shape) {
    if (!p->state.area_light)
        return true;
    if (p->object) {
        pbrt_warn(p, c->at, "shapes of an object do not emit, here as in pbrt");
        return true;
    }
    struct xml_node *light = pbrt_add(p, shape, "emitter", "area", NULL, p->state.area_light->at);
    return pbrt_make(p, pbrt_area_lights, p->state.area_light, light);
}

bool pbrt_add_shape(struct pbrt *p, struct pbrt_call *c) {
    const struct transform ctm = p->state.ctm;
    struct transform inverse;
    struct xml_node *shape =
        pbrt_add(p, p->object ? p->object : p->scene, "shape", NULL, NULL, c->at);
    bool good = add_bsdf(p, c, shape) && add_media(p, c, shape) && add_emitter(p, c, shape);
    good = good && pbrt_make(p, pbrt_shapes, c, shape);
    if (good && (!transform_is_finite(&p->state.ctm) || !transform_invert(&p->state.ctm, &inverse)))
        good = refuse(c, "its transform has no inverse");
    if (good && !transform_is_identity(&p->state.ctm))
        tree_transform(p->r, shape, "to_world", &p->state.ctm);
    if (good && p->state.reversed)
        tree_text(p->r, shape, "boolean", "flip_normals", "true");
    p->state.ctm = ctm;
    return good;
}
