// SPDX-License-Identifier: Apache-2.0
// State of reading one scene, shared by the files of this folder that read it.
//
// A scene is read in two steps: load.c makes one tree of all files (includes, $names, aliases),
// then the others turn elements of that tree into objects, shapes and settings.
#pragma once

#include "base/xml.h"
#include "scene/scene.h"

// ---- growing arrays -------------------------------------------------------------------------

struct list {
    void *items;
    size_t count, capacity;
};

#define LIST_ADD(l, type) ((type *)list_add((l), sizeof(type)))
#define LIST_AT(l, type, i) (((type *)(l)->items)[i])
void *list_add(struct list *l, size_t size); // a new zeroed item at the end

// A mesh file to read for a shape.
struct mesh_job {
    uint32_t shape;
    const struct mesh_reader_type *type;
    const char *path;
    struct mesh_options options;
    bool failed;
};

// Materials of shapes that name none.
enum default_bsdf {
    DEFAULT_DIFFUSE,
    DEFAULT_BLACK,
    DEFAULT_NULL,
    DEFAULT_BSDFS,
};

// ---- the reader -----------------------------------------------------------------------------

struct id_entry {
    const char *id;
    struct xml_node *node;
    enum { ID_NEW, ID_OPEN, ID_DONE } state;
    struct object *object; // textures and materials, which are made once
    uint32_t group;        // of a shapegroup
};

struct reader {
    const struct scene_options *options;
    struct scene *scene;
    struct arena *arena; // of the scene

    // load.c
    size_t node_count, file_count;
    struct list directories; // const char *: <path> and the scene's own, latest last
    struct list variables;   // struct variable
    struct list ids;         // struct id_entry
    uint32_t *id_table;      // hash table of indices into ids, plus one; 0 is free
    size_t id_slots;
    struct list hashed;      // const char *: files that are part of the hash
    struct list ignored;     // struct ignored_name

    // what is made
    struct list textures, bsdfs, sensors; // struct object *
    struct list volumes, phases, media;   // struct object *
    struct list shapes, instances, lights, jobs;
    struct list made; // struct mesh: by readers of other formats, until a shape takes it
    struct object *default_bsdf[DEFAULT_BSDFS];
    uint32_t group_count;
    int depth; // of objects being made inside objects
    struct where place; // of elements that a reader of another format adds; file NULL: the scene's
};

// ---- load.c: files to one tree --------------------------------------------------------------

// The root element with everything included, or NULL after an error message.
struct xml_node *load_scene_tree(struct reader *r, const char *path);
// The path of a file named in the scene: beside the file that names it, along <path>s, beside the
// scene. NULL after an error message.
const char *load_find_file(struct reader *r, const char *name, struct where at);
// Adds a file's contents to the scene's hash, once. false after an error message.
bool load_hash_file(struct reader *r, const char *path);

// ---- dialect.c: what elements exist, and the names of older versions -------------------------

enum tag_kind {
    TAG_UNKNOWN,
    TAG_VALUE,     // boolean, float, rgb, ...
    TAG_OBJECT,    // bsdf, shape, ...: has a type
    TAG_REF,
    TAG_STRUCTURE, // include, default, path, alias
    TAG_SKIPPED,   // accepted without effect
};

enum tag_kind tag_kind(const struct xml_node *node);
const char *tag_nearest(const char *tag);
// Renames an element of a file before version 2, and checks its attributes.
bool dialect_check(struct reader *r, struct xml_node *node);
// A parameter's name as the file of that element would spell it.
const char *dialect_spelling(const struct xml_node *node, const char *name, struct arena *arena);
// Of an object of an old file, once its children have been checked: as version 3 would write it,
// with what the old version takes for parameters that are not given.
bool dialect_upgrade_object(struct reader *r, struct xml_node *node);

// ---- ids.c ----------------------------------------------------------------------------------

bool id_define(struct reader *r, const char *id, struct xml_node *node, struct where at);
struct id_entry *id_find(struct reader *r, const char *id);
// The element a child means: itself, or what its ref names. NULL after an error message.
// *entry: the id's entry, or NULL for an element without id.
struct xml_node *id_resolve(struct reader *r, struct xml_node *child, struct id_entry **entry);

// ---- values.c: text to numbers --------------------------------------------------------------

// "1", "1 2 3", "1, 2, 3": the number of finite values, or -1; at most `most` are stored.
int value_numbers(const char *text, double *out, int most);
bool value_number(const struct xml_node *node, double *out); // attribute value; reports
bool value_integer(const struct xml_node *node, long long *out);
bool value_boolean(const struct xml_node *node, bool *out);
// x/y/z or value; missing components get `missing`.
bool value_vector(const struct xml_node *node, double missing, double out[3]);
bool value_transform(const struct xml_node *node, struct transform *out);

// ---- spectra.c ------------------------------------------------------------------------------

// <rgb>, <srgb>, <spectrum>, <float>, <blackbody> as a parameter of the kind PARAM_REFLECTANCE,
// PARAM_EMISSION or PARAM_INDEX.
bool spectrum_read(struct reader *r, const struct xml_node *node, enum param_type use,
                   spectrum *out);
// Whether an object element is a spectrum (d65, blackbody, ...) rather than a texture.
bool spectrum_is_type(const char *type);

// ---- objects.c: parameter tables ------------------------------------------------------------

// Called for a nested object that fills no slot. false after an error message.
typedef bool (*child_fn)(struct reader *r, struct xml_node *child, struct xml_node *target,
                         struct id_entry *entry, void *ctx);

// Fills data (e->size bytes) from the children of node, then from defaults.
bool object_fill(struct reader *r, const struct xml_node *node, const struct entry *e, void *data,
                 bool drop_unknown, child_fn other, void *ctx);
// The entry that node's type names; NULL after an error message.
const struct entry *object_entry(const struct registry *registry, const struct xml_node *node);
// A new object of the arena, filled. NULL after an error message.
struct object *object_make(struct reader *r, const struct registry *registry,
                           const struct xml_node *node, child_fn other, void *ctx);
struct object *object_make_as(struct reader *r, const struct entry *e, const struct xml_node *node,
                              bool drop_unknown, child_fn other, void *ctx);
// A texture or material: made once per id.
struct object *object_shared(struct reader *r, const struct registry *registry,
                             struct list *list, struct xml_node *target, struct id_entry *entry);
// Around the making of an object: refuses cycles and deep nesting.
bool object_enter(struct reader *r, const struct xml_node *target, struct id_entry *entry);
void object_leave(struct reader *r, struct id_entry *entry);
// Takes a value element out of an object (the reader itself uses it) and returns its value, also
// when asked again. NULL: there is none.
const char *node_take_value(struct reader *r, struct xml_node *node, const char *name);
void ignore_name(struct reader *r, const char *name, struct where at);
// The name of a place that an object does not take: it goes where its kind belongs.
void ignore_child_name(struct reader *r, const struct xml_node *child,
                       const struct xml_node *target);
void ignored_report(const struct reader *r);

// ---- media.c, shapes.c, lights.c, meshes.c, view.c ---------------------------------------------------

// A <medium> that stands in a shape, a sensor or the scene; its index. SCENE_NONE after an error
// message.
uint32_t medium_read(struct reader *r, struct xml_node *target, struct id_entry *entry);
bool shape_read(struct reader *r, struct xml_node *node, struct id_entry *entry);
bool emitter_read(struct reader *r, struct xml_node *node, uint32_t shape);
// links.c: the lists of lights, when all shapes are known.
bool links_resolve(struct reader *r);
// Reads the mesh files of all shapes, recentres the scene and brings vertices into the world.
bool meshes_load(struct reader *r);
// shape: the one it stands in, or SCENE_NONE.
bool sensor_read(struct reader *r, struct xml_node *node, uint32_t shape);
// Says that another sampler than a file asks for is taken, if it is.
void sampler_report(const char *asked, const char *taken, struct where at);
bool integrator_read(struct reader *r, struct xml_node *node);
// An integrator inside another. NULL after an error message.
struct object *integrator_make(struct reader *r, struct xml_node *node);
// What the file leaves out: sensor settings, sampler, filter, integrator.
bool view_defaults(struct reader *r);
