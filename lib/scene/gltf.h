// SPDX-License-Identifier: Apache-2.0
// The parts of the glTF 2.0 reader (Khronos, glTF 2.0 Specification 2.0.1), for files of scene/ only.
//
// A model becomes a tree of the scene language (tree.h), as if somebody had written it in XML, and
// meshes beside it; the scene reader does the rest. Everything that the specification demands is
// checked first (gltf_schema.c, gltf_check.c), so what comes after believes the file: references
// resolve, numbers are in range, accessors lie in their buffers.
#pragma once

#include "base/json.h"
#include "scene/tree.h"

struct gltf_buffer {
    const unsigned char *data; // NULL: of a kind that is not read (compressed)
    size_t size;
};

struct gltf {
    const char *path;
    struct arena *arena;
    struct json *root;
    char *file; // what buffers and names point into
    struct gltf_buffer *buffers;
    size_t buffer_count;
    struct gltf_buffer chunk; // the binary one of a .glb
    struct list warned;       // const char *: warnings given once
};

// ---- gltf_file.c ----------------------------------------------------------------------------

// Reads and checks a model; strings and external buffers live in the arena. false after an error
// message that names the file and the place in it as a JSON pointer; close in both cases.
bool gltf_open(struct gltf *g, const char *path, struct arena *arena);
void gltf_close(struct gltf *g);
// The bytes of a data URI or of a file beside the model, in the arena. at: its JSON pointer.
bool gltf_load_uri(struct gltf *g, const char *uri, const char *at, struct gltf_buffer *out);
// The path that a relative URI means; NULL after an error message.
const char *gltf_uri_path(struct gltf *g, const char *uri, const char *at);
bool gltf_is_data_uri(const char *uri);

// "relume: error: model.glb: /meshes/0: ..."; returns false.
bool gltf_fail(const struct gltf *g, const char *at, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// The same as a warning, once per text.
void gltf_warn(struct gltf *g, const char *format, ...) __attribute__((format(printf, 2, 3)));

// ---- looking into a checked model -----------------------------------------------------------

const struct json *gltf_item(const struct gltf *g, const char *collection, size_t index);
const struct json *gltf_extension(const struct json *object, const char *name);
int64_t gltf_index(const struct json *object, const char *key); // -1: absent
double gltf_number(const struct json *object, const char *key, double otherwise);
bool gltf_flag(const struct json *object, const char *key);
// Fills out with the numbers of an array where there is one; false: there is none.
bool gltf_numbers(const struct json *object, const char *key, int count, double *out);

// ---- gltf_schema.c, gltf_check*.c ------------------------------------------------------------

// Types, ranges and references of all properties; then the rules that tie objects together.
bool gltf_check_schema(struct gltf *g);
bool gltf_check_rules(struct gltf *g);
bool gltf_check_data(struct gltf *g); // after the buffers are there

// ---- gltf_accessor.c ------------------------------------------------------------------------

int gltf_component_size(int64_t component_type); // 0: there is no such type
int gltf_component_count(const char *type);      // of an element; 0: there is no such type
// Bytes from an element's first byte to its last, with the padding of matrix columns.
size_t gltf_element_size(const struct json *accessor);
size_t gltf_count(const struct json *accessor);
// All elements as floats, `width` a piece (missing components stay zero), normalised where the
// accessor says so, sparse ones put in; owned by the caller (mem_free).
float *gltf_read_floats(const struct gltf *g, const struct json *accessor, int width);
uint32_t *gltf_read_indices(const struct gltf *g, const struct json *accessor);

// ---- gltf_mesh.c ----------------------------------------------------------------------------

// What a material wants of a mesh.
struct gltf_mesh_wants {
    int uv_set;        // TEXCOORD_n that is the mesh's own
    uint64_t more_uvs; // bit n: TEXCOORD_n, as attribute vertex_uvn
};

enum { GLTF_MOST_UV_SETS = 64 };

// The triangles of a primitive. false: there are none to draw (said in a warning), or *failed
// after an error message.
bool gltf_read_primitive(struct gltf *g, const struct json *primitive, const char *at,
                         const struct gltf_mesh_wants *wants, struct mesh *m, bool *failed);

// ---- gltf_texture.c, gltf_material.c --------------------------------------------------------

// What a texture is read for.
struct gltf_texture_use {
    const char *name;    // of the parameter
    const char *channel; // "r", "g", ...: only that one; or NULL
    bool raw;            // numbers, not colours
    int uv_set;          // TEXCOORD_n that is the mesh's own
};

// Number of the set of coordinates that a textureInfo looks up by.
int gltf_uv_set(const struct json *info);

// An element for a textureInfo, appended to parent. false after an error message.
bool gltf_add_texture(struct gltf *g, struct reader *r, struct xml_node *parent,
                      const struct json *info, const struct gltf_texture_use *use);

// What the reader of nodes must know of a material.
struct gltf_material {
    const char *id;               // of its bsdf element
    double emission[3];           // radiance factor
    const struct json *emission_texture; // textureInfo or NULL
    bool emits;
    struct xml_node *interior;    // medium, or NULL; a fresh element for each shape is a ref
    struct gltf_mesh_wants wants;
};

// Makes the bsdf element of a material (index -1: the default one) for meshes with or without
// vertex colours, once, and appends it to the scene.
bool gltf_make_material(struct gltf *g, struct reader *r, struct xml_node *scene, int64_t index,
                        int colour_channels, struct gltf_material *out);
