// SPDX-License-Identifier: Apache-2.0
// Shapes, groups of shapes and their instances.
#include <string.h>

#include "scene/language.h"
#include "scene/reader.h"

struct shape_data {
    const char *filename, *shape_name;
    int shape_index;
    bool face_normals, flip_normals, flip_tex_coords, visible_to_camera;
    const char *set;
    struct transform to_world;
    vec3 point; // read again in double by read_point
    float radius;
};

#define FIELD(name) offsetof(struct shape_data, name)
#define COMMON_PARAMS                                                                              \
    {"to_world", PARAM_TRANSFORM, FIELD(to_world), .def = "", .help = "object to world"},          \
        {"flip_normals", PARAM_BOOL, FIELD(flip_normals), .def = "false",                          \
         .help = "turn the normals round"},                                                        \
        {"visible_to_camera", PARAM_BOOL, FIELD(visible_to_camera), .def = "true",                 \
         .help = "false: rays of the sensor go through it, all others meet it"},                   \
        {"group", PARAM_STRING, FIELD(set), .optional = true,                                      \
         .help = "name under which lights include or exclude it, beside its id"}
#define MESH_PARAMS(flip)                                                                          \
    COMMON_PARAMS,                                                                                 \
        {"filename", PARAM_FILE, FIELD(filename), .help = "the mesh"},                             \
        {"face_normals", PARAM_BOOL, FIELD(face_normals), .def = "false",                          \
         .help = "flat triangles even where the file has normals"},                                \
        {"flip_tex_coords", PARAM_BOOL, FIELD(flip_tex_coords), .def = flip, .help = "v -> 1 - v"}, \
        {"shape_index", PARAM_INT, FIELD(shape_index), .def = "0", .min = 0, .max = 1e6,           \
         .help = "which mesh of a file with several"},                                             \
        {"shape_name", PARAM_STRING, FIELD(shape_name), .optional = true,                          \
         .help = "only this group of an OBJ file"},                                                \
        {"max_smooth_angle", PARAM_IGNORED}, {"collapse", PARAM_IGNORED},                          \
        {"srgb", PARAM_IGNORED}, PARAM_END

static const struct param obj_params[] = {MESH_PARAMS("true")};
static const struct param mesh_params[] = {MESH_PARAMS("false")};
static const struct param plain_params[] = {COMMON_PARAMS, PARAM_END};
static const struct param sphere_params[] = {
    COMMON_PARAMS,
    {"center", PARAM_POINT, FIELD(point), .def = "0 0 0", .unit = "m", .help = "its centre"},
    {"radius", PARAM_FLOAT, FIELD(radius), .def = "1", .min = 1e-30, .max = 1e30, .unit = "m",
     .help = "its radius"},
    PARAM_END,
};
static const struct param cylinder_params[] = {
    COMMON_PARAMS,
    {"p0", PARAM_POINT, FIELD(point), .def = "0 0 0", .unit = "m", .help = "where it begins"},
    {"p1", PARAM_POINT, FIELD(point), .def = "0 0 1", .unit = "m", .help = "where it ends"},
    {"radius", PARAM_FLOAT, FIELD(radius), .def = "1", .min = 1e-30, .max = 1e30, .unit = "m",
     .help = "its radius"},
    PARAM_END,
};
static const struct param group_params[] = {PARAM_END};
static const struct param made_params[] = {
    COMMON_PARAMS,
    {"shape_index", PARAM_INT, FIELD(shape_index), .min = 0, .max = 4e9, .help = "which mesh"},
    PARAM_END,
};

#define SHAPE(name, help, params) {name, help, NULL, params, sizeof(struct shape_data)}

static const struct entry shape_types[] = {
    SHAPE("rectangle", "square [-1,1]^2 at z = 0, normal +z", plain_params),
    SHAPE("cube", "box [-1,1]^3", plain_params),
    SHAPE("sphere", "exact sphere", sphere_params),
    SHAPE("disk", "exact disk of radius 1 at z = 0, normal +z", plain_params),
    SHAPE("cylinder", "exact cylinder from p0 to p1, open ends", cylinder_params),
    SHAPE("shapegroup", "shapes for instances to place, unseen by itself", group_params),
    SHAPE("instance", "a shapegroup, placed without copying it", plain_params),
    SHAPE("obj", "mesh of an OBJ file", obj_params),
    SHAPE("mesh", "mesh of any other file", mesh_params),
    SHAPE("made", "mesh that a reader of another format made", made_params),
};
static const struct entry *const shape_entries[] = {
    &shape_types[0], &shape_types[1], &shape_types[2], &shape_types[3], &shape_types[4],
    &shape_types[5], &shape_types[6], NULL};
const struct registry scene_shapes = {"shape", shape_entries};

enum { RECTANGLE, CUBE, SPHERE, DISK, CYLINDER, GROUP, INSTANCE, OBJ, MESH, MADE };

const struct param *scene_mesh_params(const struct entry *format) {
    return shape_types[strcmp(format->name, "obj") == 0 ? OBJ : MESH].params;
}

// ---- what stands in a shape -----------------------------------------------------------------

struct contents {
    const struct object *bsdf;
    struct xml_node *emitter;
    struct xml_node *sensor;
    uint32_t group; // of an instance
    uint32_t interior, exterior; // media
};

static const struct contents no_contents = {.group = SCENE_NONE, .interior = SCENE_NONE,
                                            .exterior = SCENE_NONE};

static bool group_read(struct reader *r, struct xml_node *node, struct id_entry *entry,
                       uint32_t *group);

static bool refuse(const struct xml_node *child, const struct xml_node *target) {
    if (strcmp(target->tag, "subsurface") == 0)
        log_error_at(child->at, "<subsurface> is not known: put a medium into the shape, and a "
                     "dielectric onto it");
    else
        log_error_at(child->at, "a <%s> cannot stand in a shape", target->tag);
    return false;
}

static bool shape_medium(struct reader *r, const struct xml_node *child, struct xml_node *target,
                         struct id_entry *entry, struct contents *c) {
    const char *name = xml_get(child, "name");
    const bool inside = name && strcmp(name, "interior") == 0;
    if (!inside && !(name && strcmp(name, "exterior") == 0)) {
        log_error_at(child->at, "a medium in a shape has the name \"%s\", expected \"interior\" or "
                     "\"exterior\"", name ? name : "");
        return false;
    }
    uint32_t *medium = inside ? &c->interior : &c->exterior;
    if (*medium != SCENE_NONE) {
        log_error_at(child->at, "a second %s medium in one shape", name);
        return false;
    }
    *medium = medium_read(r, target, entry);
    return *medium != SCENE_NONE;
}

static bool shape_child(struct reader *r, struct xml_node *child, struct xml_node *target,
                        struct id_entry *entry, void *ctx) {
    struct contents *c = ctx;
    if (strcmp(target->tag, "medium") == 0)
        return shape_medium(r, child, target, entry, c);
    ignore_child_name(r, child, target);
    if (strcmp(target->tag, "bsdf") == 0) {
        if (c->bsdf) {
            log_error_at(child->at, "a second bsdf in one shape");
            return false;
        }
        c->bsdf = object_shared(r, r->options->registries.bsdfs, &r->bsdfs, target, entry);
        return c->bsdf != NULL;
    }
    const bool is_sensor = strcmp(target->tag, "sensor") == 0;
    if (!is_sensor && strcmp(target->tag, "emitter") != 0)
        return refuse(child, target);
    struct xml_node **held = is_sensor ? &c->sensor : &c->emitter;
    if (*held) {
        log_error_at(child->at, "a second %s in one shape", target->tag);
        return false;
    }
    *held = target;
    if (is_sensor)
        return true;
    if (entry)
        entry->state = ID_DONE; // it has a shape: not an emitter of its own
    return true;
}

static bool instance_child(struct reader *r, struct xml_node *child, struct xml_node *target,
                           struct id_entry *entry, void *ctx) {
    struct contents *c = ctx;
    if (strcmp(target->tag, "shape") != 0 ||
        strcmp(xml_get(target, "type"), "shapegroup") != 0 || c->group != SCENE_NONE) {
        log_error_at(child->at, "an instance holds exactly one shapegroup");
        return false;
    }
    return group_read(r, target, entry, &c->group);
}

// Material of shapes that name none: diffuse, black where the shape is a light (as Mitsuba 3); none
// at all around a medium in files of old versions.
static const struct object *default_bsdf(struct reader *r, enum default_bsdf kind, struct where at) {
    if (!r->default_bsdf[kind]) {
        struct xml_node *node = xml_new("bsdf", at, r->arena);
        xml_set(node, "type", kind == DEFAULT_NULL ? "null" : "diffuse", r->arena);
        if (kind == DEFAULT_BLACK) {
            struct xml_node *black = xml_new("float", at, r->arena);
            xml_set(black, "name", "reflectance", r->arena);
            xml_set(black, "value", "0", r->arena);
            xml_append(node, black);
        }
        r->default_bsdf[kind] =
            object_shared(r, r->options->registries.bsdfs, &r->bsdfs, node, NULL);
    }
    return r->default_bsdf[kind];
}

static enum default_bsdf default_kind(const struct xml_node *node, const struct contents *c) {
    if (c->emitter)
        return DEFAULT_BLACK;
    if (c->interior == SCENE_NONE && c->exterior == SCENE_NONE)
        return DEFAULT_DIFFUSE;
    if (!node->old)
        log_warn_at(node->at, "this boundary of a medium has no bsdf, which makes it diffuse; give it "
                    "<bsdf type=\"null\"/> to let light in");
    return node->old ? DEFAULT_NULL : DEFAULT_DIFFUSE;
}

// ---- shapes ---------------------------------------------------------------------------------

// A point in double, which parameter tables have in float.
static bool read_point(const struct xml_node *node, const char *name, double out[3]) {
    for (const struct xml_node *c = node->first; c; c = c->next) {
        const char *child_name = xml_get(c, "name");
        if (child_name && strcmp(child_name, name) == 0)
            return value_vector(c, 0, out);
    }
    return true; // keeps the default
}

// The unit cylinder about z onto one from a to b.
static bool cylinder_transform(const struct xml_node *node, double radius, struct transform *t) {
    double a[3] = {0, 0, 0}, b[3] = {0, 0, 1}, z[3];
    if (!read_point(node, "p0", a) || !read_point(node, "p1", b))
        return false;
    for (int k = 0; k < 3; k++)
        z[k] = b[k] - a[k];
    const double length = sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
    if (!(length > 0)) {
        log_error_at(node->at, "cylinder: p0 and p1 coincide");
        return false;
    }
    for (int k = 0; k < 3; k++)
        z[k] /= length;
    // axes in double after Duff et al. 2017, as math/frame.h
    const double sign = copysign(1, z[2]), c = -1 / (sign + z[2]), d = z[0] * z[1] * c;
    const double x[3] = {1 + sign * z[0] * z[0] * c, sign * d, -sign * z[0]};
    const double y[3] = {d, sign + z[1] * z[1] * c, -z[1]};
    *t = transform_identity;
    for (int k = 0; k < 3; k++) {
        t->m[k][0] = radius * x[k];
        t->m[k][1] = radius * y[k];
        t->m[k][2] = length * z[k];
        t->m[k][3] = a[k];
    }
    return true;
}

static bool place_quadric(const struct xml_node *node, int type, const struct shape_data *d,
                          struct shape *s) {
    double centre[3] = {0, 0, 0};
    struct transform own = transform_identity;
    s->kind = type == SPHERE ? SHAPE_SPHERE : type == DISK ? SHAPE_DISK : SHAPE_CYLINDER;
    if (type == CYLINDER && !cylinder_transform(node, d->radius, &own))
        return false;
    if (type == SPHERE) {
        if (!read_point(node, "center", centre))
            return false;
        const struct transform move = transform_translate(centre[0], centre[1], centre[2]);
        const struct transform size = transform_scale(d->radius, d->radius, d->radius);
        own = transform_multiply(&move, &size);
    }
    s->to_world = transform_multiply(&d->to_world, &own);
    return true;
}

static void queue_mesh(struct reader *r, const struct shape_data *d, const struct entry *reader,
                       bool flip_default) {
    struct mesh_job *job = LIST_ADD(&r->jobs, struct mesh_job);
    job->shape = (uint32_t)r->shapes.count - 1;
    job->type = (const struct mesh_reader_type *)(const void *)reader;
    job->path = d->filename;
    job->options = (struct mesh_options){
        .shape_index = d->shape_index, .face_normals = d->face_normals,
        .flip_uvs = d->flip_tex_coords != flip_default, .shape_name = d->shape_name, .threads = 1};
}

// Each mesh has one taker.
static void take_made(struct reader *r, int index, struct mesh *m) {
    struct mesh *made = &LIST_AT(&r->made, struct mesh, index);
    *m = *made;
    *made = (struct mesh){0};
}

// A sensor in a shape looks from its surface, through the medium before it.
static bool meter_read(struct reader *r, struct xml_node *node, uint32_t shape) {
    const bool first = r->sensors.count == 0;
    if (!sensor_read(r, node, shape))
        return false;
    const uint32_t medium = LIST_AT(&r->shapes, struct shape, shape).exterior;
    if (first && medium != SCENE_NONE)
        r->scene->sensor_medium = medium;
    return true;
}

// The sensor's rays would be in a medium that they never entered.
static bool may_be_hidden(const struct shape *s) {
    const bool may = !s->hidden || (s->interior == SCENE_NONE && s->exterior == SCENE_NONE);
    if (!may)
        log_error_at(s->at, "a shape that bounds a medium cannot be hidden from the camera");
    return may;
}

static bool make_shape(struct reader *r, struct xml_node *node, int type,
                       const struct entry *mesh_reader, uint32_t group) {
    const struct entry *e = type == MESH
                                ? &shape_types[strcmp(mesh_reader->name, "obj") == 0 ? OBJ : MESH]
                                : &shape_types[type];
    struct shape_data d;
    struct contents contents = no_contents;
    memset(&d, 0, sizeof d);
    if (!object_fill(r, node, e, &d, false, shape_child, &contents))
        return false;
    struct shape *s = LIST_ADD(&r->shapes, struct shape);
    const char *id = xml_get(node, "id");
    *s = (struct shape){.kind = SHAPE_MESH, .name = id ? id : "", .type = xml_get(node, "type"),
                        .at = node->at, .to_world = d.to_world, .flip_normals = d.flip_normals,
                        .set = d.set, .hidden = !d.visible_to_camera,
                        .bsdf = contents.bsdf, .light = SCENE_NONE, .group = group,
                        .interior = contents.interior, .exterior = contents.exterior};
    const uint32_t index = (uint32_t)r->shapes.count - 1;
    if (type == RECTANGLE)
        mesh_make_rectangle(&s->mesh);
    else if (type == CUBE)
        mesh_make_cube(&s->mesh);
    else if (type == MADE)
        take_made(r, d.shape_index, &s->mesh);
    else if (type == MESH)
        queue_mesh(r, &d, mesh_reader, e == &shape_types[OBJ]);
    else if (!place_quadric(node, type, &d, s))
        return false;
    if (!may_be_hidden(s))
        return false;
    if (!s->bsdf)
        s->bsdf = default_bsdf(r, default_kind(node, &contents), node->at);
    if (!s->bsdf || (contents.sensor && !meter_read(r, contents.sensor, index)))
        return false;
    s = &LIST_AT(&r->shapes, struct shape, index);
    if (!contents.emitter)
        return true;
    if (group != SCENE_NONE) {
        log_error_at(contents.emitter->at, "an emitter in a shapegroup: instances cannot emit");
        return false;
    }
    s->light = (uint32_t)r->lights.count;
    return emitter_read(r, contents.emitter, index) &&
           may_be_hidden(&LIST_AT(&r->shapes, struct shape, index));
}

static bool make_instance(struct reader *r, struct xml_node *node) {
    struct shape_data d;
    struct contents contents = no_contents;
    memset(&d, 0, sizeof d);
    if (!object_fill(r, node, &shape_types[INSTANCE], &d, false, instance_child, &contents))
        return false;
    if (contents.group == SCENE_NONE) {
        log_error_at(node->at, "an instance holds exactly one shapegroup");
        return false;
    }
    const char *id = xml_get(node, "id");
    *LIST_ADD(&r->instances, struct instance) =
        (struct instance){contents.group, id ? id : "", d.to_world, !d.visible_to_camera};
    return true;
}

// The type of a shape, and its mesh reader where it is a file. -1 after an error message.
static int shape_type(const struct reader *r, const struct xml_node *node,
                      const struct entry **mesh_reader) {
    const char *type = xml_get(node, "type");
    *mesh_reader = registry_find(&mesh_readers, type);
    if (*mesh_reader)
        return MESH;
    const struct entry *e = registry_find(&scene_shapes, type);
    if (e)
        return (int)(e - shape_types);
    if (r->made.count > 0 && strcmp(type, shape_types[MADE].name) == 0)
        return MADE; // no file can say so: its tree has no such meshes
    const char *nearest = registry_nearest(&scene_shapes, type);
    nearest = nearest ? nearest : registry_nearest(&mesh_readers, type);
    log_error_at(node->at, "shape \"%s\" is not known%s%s%s", type,
                 nearest ? "; did you mean \"" : "", nearest ? nearest : "",
                 nearest ? "\"?" : "");
    return -1;
}

static bool group_child(struct reader *r, struct xml_node *child, struct xml_node *target,
                        struct id_entry *entry, void *ctx) {
    const struct entry *mesh_reader;
    (void)entry;
    if (strcmp(target->tag, "shape") != 0)
        return refuse(child, target);
    const int type = shape_type(r, target, &mesh_reader);
    if (type == GROUP || type == INSTANCE) {
        log_error_at(child->at, "a shapegroup cannot hold a %s", shape_types[type].name);
        return false;
    }
    return type >= 0 && make_shape(r, target, type, mesh_reader, *(uint32_t *)ctx);
}

static bool group_read(struct reader *r, struct xml_node *node, struct id_entry *entry,
                       uint32_t *group) {
    if (entry && entry->group != SCENE_NONE) {
        *group = entry->group;
        return true;
    }
    *group = r->group_count++;
    if (entry)
        entry->group = *group;
    struct shape_data unused;
    return object_fill(r, node, &shape_types[GROUP], &unused, false, group_child, group);
}

bool shape_read(struct reader *r, struct xml_node *node, struct id_entry *entry) {
    const struct entry *mesh_reader;
    uint32_t group;
    const int type = shape_type(r, node, &mesh_reader);
    if (type == GROUP)
        return group_read(r, node, entry, &group);
    if (type == INSTANCE)
        return make_instance(r, node);
    return type >= 0 && make_shape(r, node, type, mesh_reader, SCENE_NONE);
}
