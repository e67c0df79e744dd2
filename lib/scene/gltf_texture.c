// SPDX-License-Identifier: Apache-2.0
// Textures of glTF (specification, 3.8) as bitmap elements. Row 0 of a picture is at v = 0 in both,
// so texture coordinates stay as they are.
#include <math.h>
#include <string.h>

#include "image/image.h"
#include "scene/gltf.h"

enum { NEAREST = 9728, CLAMP = 33071, MIRROR = 33648, REPEAT = 10497 };

// The name under which the picture is found: a path, or the JSON pointer of an embedded one, whose
// bytes are kept in the arena. NULL after an error message.
static const char *image_name(struct gltf *g, size_t index) {
    const struct json *image = gltf_item(g, "images", index);
    const char *uri = json_text(json_get(image, "uri"));
    const char *at = arena_printf(g->arena, "/images/%zu", index);
    if (uri && !gltf_is_data_uri(uri))
        return gltf_uri_path(g, uri, at);
    const char *name = arena_printf(g->arena, "%s#%s", g->path, at);
    if (arena_find(g->arena, IMAGE_EMBEDDED, name))
        return name;
    struct image_bytes *kept = arena_alloc(g->arena, sizeof *kept);
    struct gltf_buffer bytes = {0};
    if (uri) {
        if (!gltf_load_uri(g, uri, at, &bytes))
            return NULL;
    } else {
        const struct json *view =
            gltf_item(g, "bufferViews", (size_t)gltf_index(image, "bufferView"));
        const struct gltf_buffer *b = &g->buffers[gltf_index(view, "buffer")];
        bytes.size = (size_t)gltf_number(view, "byteLength", 0);
        if (b->data)
            bytes.data = memcpy(arena_alloc(g->arena, bytes.size + 1),
                                b->data + (size_t)gltf_number(view, "byteOffset", 0), bytes.size);
    }
    *kept = (struct image_bytes){bytes.data, bytes.data ? bytes.size : 0};
    arena_keep(g->arena, IMAGE_EMBEDDED, name, kept);
    return name;
}

// KHR_texture_transform: uv' = translation rotation scale uv.
static void add_transform(struct reader *r, struct xml_node *node, const struct json *e) {
    double offset[2] = {0, 0}, scale[2] = {1, 1};
    gltf_numbers(e, "offset", 2, offset);
    gltf_numbers(e, "scale", 2, scale);
    const double angle = gltf_number(e, "rotation", 0), c = cos(angle), s = sin(angle);
    for (int k = 0; k < 2; k++) // a picture squeezed to a line would have no inverse
        scale[k] = fabs(scale[k]) < 1e-9 ? 1e-9 : scale[k];
    struct transform t = transform_identity;
    t.m[0][0] = c * scale[0];
    t.m[0][1] = s * scale[1];
    t.m[1][0] = -s * scale[0];
    t.m[1][1] = c * scale[1];
    t.m[0][3] = offset[0];
    t.m[1][3] = offset[1];
    tree_transform(r, node, "to_uv", &t);
}

static void add_sampler(struct gltf *g, struct reader *r, struct xml_node *node,
                        const struct json *texture) {
    const int64_t index = gltf_index(texture, "sampler");
    const struct json *sampler = index < 0 ? NULL : gltf_item(g, "samplers", (size_t)index);
    const int s = (int)gltf_number(sampler, "wrapS", REPEAT);
    const int t = (int)gltf_number(sampler, "wrapT", REPEAT);
    if (s != t)
        gltf_warn(g, "pictures repeat in both directions as wrapS says; wrapT differs");
    if (s != REPEAT)
        tree_text(r, node, "string", "wrap_mode", s == CLAMP ? "clamp" : "mirror");
    if ((int)gltf_number(sampler, "magFilter", 0) == NEAREST)
        tree_text(r, node, "string", "filter_type", "nearest");
}

// The picture of a texture, webp or the like where the plain one is absent; -1: none.
static int64_t source_of(const struct json *texture) {
    const int64_t source = gltf_index(texture, "source");
    if (source >= 0)
        return source;
    return gltf_index(gltf_extension(texture, "EXT_texture_webp"), "source");
}

int gltf_uv_set(const struct json *info) {
    return (int)gltf_number(gltf_extension(info, "KHR_texture_transform"), "texCoord",
                            gltf_number(info, "texCoord", 0));
}

bool gltf_add_texture(struct gltf *g, struct reader *r, struct xml_node *parent,
                      const struct json *info, const struct gltf_texture_use *use) {
    const struct json *texture = gltf_item(g, "textures", (size_t)gltf_index(info, "index"));
    const int64_t source = source_of(texture);
    if (source < 0) {
        gltf_warn(g, "/textures/%lld: has no picture that can be read: it counts as white",
                  (long long)gltf_index(info, "index"));
        tree_text(r, parent, "rgb", use->name, "1 1 1");
        return true;
    }
    const char *name = image_name(g, (size_t)source);
    if (!name)
        return false;
    const char *parameter = use->name;
    if (gltf_uv_set(info) != use->uv_set) {
        parent = tree_add(r, parent, "texture", "uvmap", NULL);
        xml_set(parent, "name", parameter, r->arena);
        tree_text(r, parent, "string", "attribute",
                  arena_printf(r->arena, "vertex_uv%d", gltf_uv_set(info)));
        parameter = "texture";
    }
    struct xml_node *node = tree_add(r, parent, "texture", "bitmap", NULL);
    xml_set(node, "name", parameter, r->arena);
    tree_text(r, node, "string", "filename", name);
    if (use->channel)
        tree_text(r, node, "string", "channel", use->channel);
    if (use->raw)
        tree_text(r, node, "boolean", "raw", "true");
    add_sampler(g, r, node, texture);
    const struct json *transform = gltf_extension(info, "KHR_texture_transform");
    if (transform)
        add_transform(r, node, transform);
    return true;
}
