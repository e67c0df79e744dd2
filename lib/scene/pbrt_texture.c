// SPDX-License-Identifier: Apache-2.0
// Textures of pbrt. Its v runs upwards in pictures, ours downwards.
#include <math.h>
#include <string.h>

#include "scene/pbrt.h"

static bool is_scalar(const struct xml_node *out) {
    return strncmp(xml_get(out, "id"), "float", 5) == 0;
}

static bool refuse(const struct pbrt_call *c, const char *why) {
    log_error_at(c->at, "Texture \"%s\": %s", c->type, why);
    return false;
}

// The lookup of (u, v), times `repeat`; `flip` turns v round for pictures.
static bool put_mapping(struct pbrt *p, struct pbrt_call *c, struct xml_node *out, double repeat,
                        bool flip) {
    bool good = true;
    const char *mapping = pbrt_string(c, "mapping", "uv", &good);
    const double su = pbrt_float(c, "uscale", 1, &good), sv = pbrt_float(c, "vscale", 1, &good);
    const double du = pbrt_float(c, "udelta", 0, &good), dv = pbrt_float(c, "vdelta", 0, &good);
    if (good && strcmp(mapping, "uv") != 0)
        return refuse(c, "the only mapping that is read is \"uv\"");
    struct transform t = transform_scale(repeat * su, repeat * (flip ? -sv : sv), 1);
    t.m[0][3] = repeat * du;
    t.m[1][3] = flip ? 1 - dv : repeat * dv;
    tree_transform(p->r, out, "to_uv", &t);
    return good;
}

static bool constant(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    pbrt_set_type(p, out, "product");
    const struct xml_node *last = out->last;
    if (!pbrt_put_texture(p, c, "value", out, "texture_0", is_scalar(out)))
        return false;
    if (out->last == last)
        tree_number(p->r, out, "texture_0", 1);
    return true;
}

static bool scale(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    pbrt_set_type(p, out, "product");
    const struct pbrt_param *factor = pbrt_find(c, "texture|float", "scale", &good);
    const struct xml_node *last = out->last;
    if (!good || !pbrt_put_texture(p, c, "tex", out, "texture_0", is_scalar(out)))
        return false;
    if (out->last == last)
        tree_number(p->r, out, "texture_0", 1);
    return !factor || pbrt_put_texture(p, c, "scale", out, "texture_1", true);
}

static bool checkerboard(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    bool good = true;
    if (pbrt_integer(c, "dimension", 2, &good) != 2)
        return good && refuse(c, "the only \"dimension\" that is read is 2");
    pbrt_set_type(p, out, "checkerboard");
    const char *const names[2] = {"tex1", "tex2"}, *const ours[2] = {"color0", "color1"};
    for (int i = 0; i < 2; i++) {
        const struct xml_node *last = out->last;
        if (!pbrt_put_texture(p, c, names[i], out, ours[i], is_scalar(out)))
            return false;
        if (out->last == last)
            tree_number(p->r, out, ours[i], i ? 0 : 1);
    }
    return good && put_mapping(p, c, out, 0.5, false); // a period there is two fields
}

static bool imagemap(struct pbrt *p, struct pbrt_call *c, struct xml_node *out) {
    static const char *const wraps[][2] = {{"repeat", "repeat"}, {"clamp", "clamp"},
                                           {"black", "zero"}, {"octahedralsphere", NULL}};
    bool good = true;
    const char *name = pbrt_string(c, "filename", NULL, &good);
    const char *wrap = pbrt_string(c, "wrap", "repeat", &good);
    const char *encoding = pbrt_string(c, "encoding", "sRGB", &good), *ours = NULL;
    const char *filter = pbrt_string(c, "filter", "bilinear", &good);
    const double factor = pbrt_float(c, "scale", 1, &good);
    if (!good || !name)
        return good && refuse(c, "\"string filename\" is missing");
    for (size_t i = 0; i < sizeof wraps / sizeof *wraps; i++)
        if (strcmp(wraps[i][0], wrap) == 0)
            ours = wraps[i][1];
    if (!ours || pbrt_bool(c, "invert", false, &good))
        return refuse(c, "expected the wrap repeat, clamp or black, and no \"invert\"");
    struct xml_node *map = out;
    if (factor != 1) {
        pbrt_set_type(p, out, "product");
        tree_number(p->r, out, "texture_1", factor);
        map = pbrt_add(p, out, "texture", NULL, NULL, c->at);
        xml_set(map, "name", "texture_0", p->r->arena);
    }
    pbrt_set_type(p, map, "bitmap");
    tree_text(p->r, map, "string", "filename", name);
    tree_text(p->r, map, "string", "wrap_mode", ours);
    if (strcmp(encoding, "linear") == 0)
        tree_text(p->r, map, "boolean", "raw", "true");
    else if (strncmp(encoding, "gamma ", 6) == 0)
        tree_text(p->r, map, "float", "gamma", encoding + 6);
    if (strcmp(filter, "point") == 0)
        tree_text(p->r, map, "string", "filter_type", "nearest");
    return good && put_mapping(p, c, map, 1, true);
}

const struct pbrt_row pbrt_textures[] = {
    {"constant", "product of it and 1", constant},
    {"scale", "product", scale},
    {"checkerboard", "checkerboard; mapping uv", checkerboard},
    {"imagemap", "bitmap, v upwards; mapping uv; encodings sRGB, linear, gamma", imagemap},
    {"mix", "refused", NULL},
    {"directionmix", "refused", NULL},
    {"bilerp", "refused", NULL},
    {"dots", "refused", NULL},
    {"fbm", "refused", NULL},
    {"marble", "refused", NULL},
    {"windy", "refused", NULL},
    {"wrinkled", "refused", NULL},
    {"ptex", "refused", NULL},
    {0},
};
