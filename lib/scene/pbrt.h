// SPDX-License-Identifier: Apache-2.0
// The parts of the pbrt-v4 reader (Pharr, Jakob, Humphreys; "pbrt-v4 Input File Format"), for files of
// scene/ only.
//
// Directives become a tree of the scene language (tree.h), each element with the file and line of its
// directive; the scene reader does the rest. What a type of pbrt becomes stands in one table a
// directive (struct pbrt_row), which the reader goes by and `relume help format pbrt` prints.
//
// Camera space is as ours but for x, which points to the right of the picture.
#pragma once

#include "scene/tree.h"

// ---- pbrt_lex.c ---------------------------------------------------------------------------------

struct pbrt_token {
    enum { PBRT_END, PBRT_WORD, PBRT_STRING, PBRT_OPEN, PBRT_CLOSE } kind;
    const char *text; // into the file; of a string without its quotes
    size_t size;
    struct where at;
};

struct pbrt_file {
    char *bytes; // owned
    const char *next;
    struct where at;
};

// ---- parameters ---------------------------------------------------------------------------------

enum pbrt_target { PBRT_SHAPE, PBRT_LIGHT, PBRT_MATERIAL, PBRT_MEDIUM, PBRT_TEXTURE, PBRT_NO_TARGET };

// "type name" [values], as it stands in the file.
struct pbrt_param {
    const char *type, *name;
    struct where at;
    double *numbers;     // owned; of numbers and of bool
    const char **texts;  // owned; of strings, textures and named spectra
    size_t count;
    bool used;
};

// A directive with a type and parameters.
struct pbrt_call {
    const char *directive, *type;
    struct where at;
    struct list params;               // struct pbrt_param
    const struct pbrt_given *given;   // by Attribute, for this kind of directive
    enum pbrt_target target;
};

// Parameters of Attribute; those of the innermost come first.
struct pbrt_given {
    enum pbrt_target target;
    struct list params;
    struct pbrt_given *outer, *next; // next: for freeing
};

// ---- the reader ---------------------------------------------------------------------------------

struct pbrt_state {
    struct transform ctm;
    bool reversed;
    const char *material;        // id of its bsdf, or NULL: the default one
    const char *inside, *outside; // ids of media, or NULL
    struct pbrt_call *area_light; // or NULL; owned by the reader
    struct pbrt_given *given;
};

// What CoordinateSystem names.
struct pbrt_system {
    const char *name;
    struct transform ctm;
};

struct pbrt {
    struct reader *r;
    struct xml_node *scene;
    struct list files;      // struct pbrt_file, the one being read last
    struct pbrt_token ahead; // a token that was put back
    bool has_ahead;
    struct pbrt_state state;
    struct list stack;      // struct pbrt_state: AttributeBegin, ObjectBegin
    struct list systems;    // struct pbrt_system: CoordinateSystem
    struct list area_lights; // struct pbrt_call *, to be freed
    struct pbrt_given *all_given;
    struct xml_node *object; // the shapegroup that is open, or NULL
    struct transform camera; // world to camera
    const char *camera_medium; // its id, or NULL
    struct xml_node *film, *filter, *sampler, *sensor; // as they come; joined at the end
    bool in_world, has_media, has_integrator;
    int width, height;
    int anonymous;          // materials
    struct list warned;     // const char *
};

// The next token; false after an error message.
bool pbrt_next(struct pbrt *p, struct pbrt_token *t);
void pbrt_put_back(struct pbrt *p, const struct pbrt_token *t);
bool pbrt_open_file(struct pbrt *p, const char *path);
void pbrt_close_files(struct pbrt *p);
// A quoted string, into the arena. NULL after an error message.
const char *pbrt_read_string(struct pbrt *p, const char *what);
// `count` numbers, in brackets or not.
bool pbrt_read_numbers(struct pbrt *p, const char *what, int count, double *out);
bool pbrt_token_is(const struct pbrt_token *t, const char *word);

struct pbrt_directive {
    const char *name;
    bool (*run)(struct pbrt *p, struct where at);
};

// Each ends with a row without name.
extern const struct pbrt_directive pbrt_calls[], pbrt_transforms[];

// A warning once per text.
void pbrt_warn(struct pbrt *p, struct where at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// ---- pbrt_params.c ------------------------------------------------------------------------------

// The parameters that follow a directive. false after an error message; free in both cases.
bool pbrt_read_params(struct pbrt *p, struct list *params);
void pbrt_free_params(struct list *params);
// The parameter of that name; marks it. NULL: not given. *good turns false after an error message
// where its type is another than those listed ("float", "texture|float").
const struct pbrt_param *pbrt_find(struct pbrt_call *c, const char *types, const char *name,
                                   bool *good);
double pbrt_float(struct pbrt_call *c, const char *name, double otherwise, bool *good);
int pbrt_integer(struct pbrt_call *c, const char *name, int otherwise, bool *good);
bool pbrt_bool(struct pbrt_call *c, const char *name, bool otherwise, bool *good);
const char *pbrt_string(struct pbrt_call *c, const char *name, const char *otherwise, bool *good);
// x y z; false: not given.
bool pbrt_triple(struct pbrt_call *c, const char *types, const char *name, double out[3], bool *good);
// Warns of the parameters that nothing has asked for.
void pbrt_report_unused(struct pbrt *p, struct pbrt_call *c);

// ---- pbrt_colour.c ------------------------------------------------------------------------------

enum pbrt_colour { PBRT_REFLECTANCE, PBRT_UNBOUNDED, PBRT_ILLUMINANT };

// "rgb", "spectrum" or "blackbody" as Rec.709; illuminants but rgb have luminance 1, as pbrt scales
// them. False where it is not given, or after an error message, which *good then says.
bool pbrt_read_colour(struct pbrt *p, struct pbrt_call *c, const char *name, enum pbrt_colour kind,
                      double out[3], bool *good);
// A parameter that may be textured, under our name; nothing is put where it is not given.
bool pbrt_put_texture(struct pbrt *p, struct pbrt_call *c, const char *name, struct xml_node *out,
                      const char *ours, bool scalar);
// The element of a texture; NULL after an error message.
const char *pbrt_texture_id(struct pbrt *p, const char *name, bool scalar, struct where at);

// ---- tables -------------------------------------------------------------------------------------

struct pbrt_row {
    const char *type; // of pbrt
    const char *here; // what becomes of it
    // Fills an element whose tag is set. false after an error message. NULL: it is not read.
    bool (*make)(struct pbrt *p, struct pbrt_call *c, struct xml_node *out);
};

// Each ends with a row without type.
extern const struct pbrt_row pbrt_shapes[], pbrt_materials[], pbrt_lights[], pbrt_area_lights[],
    pbrt_textures[], pbrt_media[], pbrt_cameras[], pbrt_films[], pbrt_filters[], pbrt_samplers[],
    pbrt_integrators[];

// Makes an element by the table and reports what it does not know.
bool pbrt_make(struct pbrt *p, const struct pbrt_row *table, struct pbrt_call *c,
               struct xml_node *out);

// A new element at the place of a directive.
struct xml_node *pbrt_add(struct pbrt *p, struct xml_node *parent, const char *tag, const char *type,
                          const char *id, struct where at);
void pbrt_set_type(struct pbrt *p, struct xml_node *node, const char *type);
void pbrt_ref(struct pbrt *p, struct xml_node *parent, const char *name, const char *id);

// ---- pbrt_shape.c -------------------------------------------------------------------------------

// A shape of the state, into the scene or the open object.
bool pbrt_add_shape(struct pbrt *p, struct pbrt_call *c);
bool pbrt_add_material(struct pbrt *p, struct pbrt_call *c, const char *id);
