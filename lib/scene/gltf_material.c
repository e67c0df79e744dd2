// SPDX-License-Identifier: Apache-2.0
// Materials of glTF (specification, 3.9, and the KHR_materials extensions) as materials of ours, as
// gltf_table.c says.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "math/ior.h"
#include "scene/format_tables.h"
#include "scene/gltf_making.h"

// ---- parts of the principled material -------------------------------------------------------

// Index whose reflectance at the normal is F0.
static double index_of(double F0) {
    const double root = sqrt(fmin(fmax(F0, 0), 0.98));
    return (1 + root) / (1 - root);
}

// KHR_materials_specular: F0 = ((n - 1) / (n + 1))^2 specularColorFactor specularFactor
static void apply_specular(struct gltf_making *m) {
    const struct json *e = m->specular;
    double colour[3] = {1, 1, 1};
    if (!e)
        return;
    gltf_numbers(e, "specularColorFactor", 3, colour);
    const double mean = 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
    if (colour[0] != colour[1] || colour[1] != colour[2])
        gltf_warn(m->g, "specularColorFactor counts by its luminance");
    if (json_get(e, "specularTexture") || json_get(e, "specularColorTexture"))
        gltf_warn(m->g, "textures of KHR_materials_specular are not used");
    if (m->transmission) {
        gltf_warn(m->g, "KHR_materials_specular is not used with transmission");
        return;
    }
    const double root = (m->eta - 1) / (m->eta + 1);
    m->eta = index_of(root * root * mean * gltf_number(e, "specularFactor", 1));
}

static bool has_coat(const struct gltf_making *m) {
    return gltf_number(m->clearcoat, "clearcoatFactor", 0) > 0;
}

// alpha is the square of the roughness: a product of the texture with itself.
static bool add_coat_roughness(const struct gltf_making *m, struct xml_node *node) {
    const double root = gltf_number(m->clearcoat, "clearcoatRoughnessFactor", 0);
    const struct json *info = gltf_texture_of(m, m->clearcoat, "clearcoatRoughnessTexture");
    if (!info || root == 0) {
        tree_number(m->r, node, "alpha", root * root);
        return true;
    }
    struct xml_node *product = tree_add(m->r, node, "texture", "product", NULL);
    xml_set(product, "name", "alpha", m->r->arena);
    return gltf_add_number(m, product, "texture_0", root, info, "g") &&
           gltf_add_number(m, product, "texture_1", root, info, "g");
}

// F0 = 0.04; without clearcoatNormalTexture a coat is flat also where its base is not.
static bool add_coat(const struct gltf_making *m, struct xml_node *node) {
    const struct json *e = m->clearcoat;
    if (json_get(e, "clearcoatNormalTexture"))
        gltf_warn(m->g, "clearcoatNormalTexture is not used: coats have the normals of the mesh");
    return add_coat_roughness(m, node) && gltf_add_number(m, node, "weight", gltf_number(e, "clearcoatFactor", 0),
                           gltf_texture_of(m, e, "clearcoatTexture"), "r");
}

static void add_sheen(const struct gltf_making *m, struct xml_node *node) {
    double colour[3] = {0, 0, 0};
    if (!gltf_numbers(m->sheen, "sheenColorFactor", 3, colour))
        return;
    const double most = fmax(colour[0], fmax(colour[1], colour[2]));
    gltf_warn(m->g, "KHR_materials_sheen becomes the sheen of principled: white, without roughness");
    if (most > 0)
        tree_number(m->r, node, "sheen", fmin(most, 1));
}

// KHR_materials_anisotropy: alpha along the tangent mix(alpha, 1, strength^2), across it alpha.
static void widths(const struct gltf_making *m, double alpha[2]) {
    const double s = gltf_number(m->anisotropy, "anisotropyStrength", 0);
    alpha[1] = fmax(m->roughness * m->roughness, 1e-3);
    alpha[0] = alpha[1] + (1 - alpha[1]) * s * s;
}

static void warn_of_turn(const struct gltf_making *m) {
    if (gltf_number(m->anisotropy, "anisotropyRotation", 0) != 0 ||
        json_get(m->anisotropy, "anisotropyTexture"))
        gltf_warn(m->g, "anisotropyRotation and anisotropyTexture are not used: highlights stretch "
                  "along u");
}

// principled: alpha = roughness^2 / aspect and times aspect, aspect^2 = 1 - 0.9 anisotropic
static bool add_roughness(const struct gltf_making *m, struct xml_node *node) {
    const struct json *info = gltf_texture_of(m, m->pbr, "metallicRoughnessTexture");
    double roughness = m->roughness;
    if (m->anisotropy) {
        double alpha[2];
        widths(m, alpha);
        const double ratio = fmax(alpha[1] / alpha[0], 0.1);
        roughness = info ? roughness : fmin(sqrt(sqrt(alpha[0] * fmax(alpha[1], 0.1 * alpha[0]))), 1);
        tree_number(m->r, node, "anisotropic", fmin((1 - ratio) / 0.9, 1));
        warn_of_turn(m);
    }
    return gltf_add_number(m, node, "roughness", roughness, info, "g");
}

// ---- whole materials ------------------------------------------------------------------------

static struct xml_node *start(const struct gltf_making *m, struct xml_node *parent,
                              const char *type) {
    return tree_add(m->r, parent, "bsdf", type, NULL);
}

static bool add_thin(const struct gltf_making *m, struct xml_node *parent) {
    struct xml_node *node = start(m, parent, "principledthin");
    if (m->metallic > 0)
        gltf_warn(m->g, "thin sheets that transmit have no metallic part here");
    tree_number(m->r, node, "eta", fmax(m->eta, 0.01));
    const double strength = gltf_number(m->transmission, "transmissionFactor", 0);
    return gltf_add_base_colour(m, node, "base_color") && add_roughness(m, node) &&
           gltf_add_number(m, node, "spec_trans", strength,
                           gltf_texture_of(m, m->transmission, "transmissionTexture"), "r");
}

static bool add_solid(const struct gltf_making *m, struct xml_node *parent) {
    struct xml_node *node = start(m, parent, "principled");
    const struct json *info = gltf_texture_of(m, m->pbr, "metallicRoughnessTexture");
    tree_number(m->r, node, "eta", m->eta);
    add_sheen(m, node);
    const double strength = gltf_number(m->transmission, "transmissionFactor", 0);
    return gltf_add_base_colour(m, node, "base_color") && add_roughness(m, node) &&
           gltf_add_number(m, node, "metallic", m->metallic, info, "b") &&
           (strength == 0 ||
            gltf_add_number(m, node, "spec_trans", strength,
                            gltf_texture_of(m, m->transmission, "transmissionTexture"), "r"));
}

// A stretched metal: principled cannot stretch as far as glTF does.
static bool add_brushed_metal(const struct gltf_making *m, struct xml_node *parent) {
    double alpha[2];
    widths(m, alpha);
    warn_of_turn(m);
    struct xml_node *node = start(m, parent, "roughconductor");
    tree_text(m->r, node, "string", "distribution", "ggx");
    tree_text(m->r, node, "string", "material", "none");
    tree_number(m->r, node, "alpha_u", alpha[0]);
    tree_number(m->r, node, "alpha_v", alpha[1]);
    return gltf_add_base_colour(m, node, "specular_reflectance");
}

// KHR_materials_volume: attenuationColor is what is left after attenuationDistance.
static void make_interior(const struct gltf_making *m) {
    double colour[3] = {1, 1, 1}, absorption[3];
    const double distance = gltf_number(m->volume, "attenuationDistance", INFINITY);
    if (!gltf_numbers(m->volume, "attenuationColor", 3, colour) || !isfinite(distance) ||
        gltf_is_white(colour, 3))
        return;
    for (int k = 0; k < 3; k++)
        absorption[k] = -log(fmax(colour[k], 1e-6)) / distance;
    struct xml_node *medium = tree_add(m->r, NULL, "medium", "homogeneous", NULL);
    xml_set(medium, "name", "interior", m->r->arena);
    tree_triple(m->r, medium, "rgb", "sigma_a", absorption);
    tree_text(m->r, medium, "rgb", "sigma_s", "0 0 0");
    m->out->interior = medium;
}

// The share that is there: alpha of colour, texture and vertices.
static bool add_opacity(const struct gltf_making *m, struct xml_node *node) {
    const char *name = "opacity", *mode = json_text(json_get(m->material, "alphaMode"));
    if (strcmp(mode, "MASK") == 0) {
        struct xml_node *step = tree_add(m->r, node, "texture", "step", NULL);
        xml_set(step, "name", name, m->r->arena);
        tree_number(m->r, step, "threshold", gltf_number(m->material, "alphaCutoff", 0.5));
        node = step;
        name = "value";
    }
    if (m->colour_channels == 4)
        node = gltf_under_attribute(m, node, &name, "vertex_alpha");
    return gltf_add_number(m, node, name, m->base[3],
                           gltf_texture_of(m, m->pbr, "baseColorTexture"), "a");
}

// A cutoff above 1 leaves nothing.
static bool has_alpha(const struct gltf_making *m) {
    const char *mode = json_text(json_get(m->material, "alphaMode"));
    const bool masked = mode && strcmp(mode, "MASK") == 0;
    const bool nothing = masked && gltf_number(m->material, "alphaCutoff", 0.5) > 1;
    return (masked || (mode && strcmp(mode, "BLEND") == 0)) &&
           (nothing || m->base[3] != 1 || m->colour_channels == 4 || json_get(m->pbr, "baseColorTexture"));
}

// normalmap with xy scaled about 0.5 where the file asks for that
static bool add_normal_map(const struct gltf_making *m, struct xml_node *node,
                           const struct json *info) {
    const double s = gltf_number(info, "scale", 1);
    struct gltf_texture_use use = {"normalmap", NULL, true, m->out->wants.uv_set};
    if (s == 1 || s < 0)
        return gltf_add_texture(m->g, m->r, node, info, &use);
    const double factor[3] = {s, s, 1}, offset[3] = {(1 - s) / 2, (1 - s) / 2, 0};
    struct xml_node *product = tree_add(m->r, node, "texture", "product", NULL);
    xml_set(product, "name", "normalmap", m->r->arena);
    tree_triple(m->r, product, "rgb", "texture_1", factor);
    tree_triple(m->r, product, "rgb", "offset", offset);
    use.name = "texture_0";
    return gltf_add_texture(m->g, m->r, product, info, &use);
}

static bool is_metal(const struct gltf_making *m) {
    return m->metallic == 1 && !json_get(m->pbr, "metallicRoughnessTexture");
}

// Metals do not, whatever the factor says.
static bool transmits(const struct gltf_making *m) {
    return gltf_number(m->transmission, "transmissionFactor", 0) > 0 && !is_metal(m);
}

static bool add_surface(const struct gltf_making *m, struct xml_node *parent) {
    const bool thick = gltf_number(m->volume, "thicknessFactor", 0) > 0;
    if (transmits(m) && !thick)
        return add_thin(m, parent);
    if (transmits(m))
        make_interior(m);
    if (m->anisotropy && is_metal(m))
        return add_brushed_metal(m, parent);
    return add_solid(m, parent);
}

// mask ( twosided ( coated ( normalmap ( surface ) ) ) ) as far as each is needed
static bool add_layers(const struct gltf_making *m, struct xml_node *outer) {
    struct xml_node *node = outer;
    if (has_alpha(m)) {
        node = start(m, node, "mask");
        if (!add_opacity(m, node))
            return false;
    }
    const bool two_sided = !transmits(m);
    const struct json *normal = gltf_texture_of(m, m->material, "normalTexture");
    if (two_sided)
        node = start(m, node, "twosided");
    if (has_coat(m)) {
        node = start(m, node, "coated");
        if (!add_coat(m, node))
            return false;
    }
    if (normal) {
        node = start(m, node, "normalmap");
        if (!add_normal_map(m, node, normal))
            return false;
    }
    return add_surface(m, node);
}

// ---- reading --------------------------------------------------------------------------------

static void warn_of_extensions(const struct gltf_making *m) {
    for (const struct gltf_row *r = gltf_rows; r->name; r++)
        if (!r->here && gltf_extension(m->material, r->name))
            gltf_warn(m->g, "%s is not used", r->name);
}

static void read_factors(struct gltf_making *m) {
    const struct json *material = m->material;
    m->pbr = json_get(material, "pbrMetallicRoughness");
    m->transmission = gltf_extension(material, "KHR_materials_transmission");
    m->volume = gltf_extension(material, "KHR_materials_volume");
    m->clearcoat = gltf_extension(material, "KHR_materials_clearcoat");
    m->sheen = gltf_extension(material, "KHR_materials_sheen");
    m->anisotropy = gltf_extension(material, "KHR_materials_anisotropy");
    m->specular = gltf_extension(material, "KHR_materials_specular");
    for (int k = 0; k < 4; k++)
        m->base[k] = 1;
    gltf_numbers(m->pbr, "baseColorFactor", 4, m->base);
    m->metallic = gltf_number(m->pbr, "metallicFactor", 1);
    m->roughness = gltf_number(m->pbr, "roughnessFactor", 1);
    m->eta = gltf_number(gltf_extension(material, "KHR_materials_ior"), "ior", 1.5);
    if (m->eta == 0) // a reflectance of 1 for old workflows
        m->eta = index_of(0.98);
    m->eta = fmin(m->eta, (double)IOR_MOST);
    apply_specular(m);
}

static void read_emission(const struct gltf_making *m) {
    struct gltf_material *out = m->out;
    gltf_numbers(m->material, "emissiveFactor", 3, out->emission);
    out->emission_texture = gltf_texture_of(m, m->material, "emissiveTexture");
    const double strength = gltf_number(
        gltf_extension(m->material, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
    for (int k = 0; k < 3; k++) {
        out->emission[k] = fmin(out->emission[k] * strength, 1e30);
        out->emits |= out->emission[k] > 0;
    }
}

// The set that the base colour is looked up by, else that of the first other texture.
static int main_uv_set(const struct json *material) {
    const struct json *pbr = json_get(material, "pbrMetallicRoughness");
    const struct json *infos[] = {json_get(pbr, "baseColorTexture"),
                                  json_get(material, "emissiveTexture"),
                                  json_get(material, "normalTexture"),
                                  json_get(pbr, "metallicRoughnessTexture")};
    for (size_t i = 0; i < sizeof infos / sizeof *infos; i++)
        if (infos[i])
            return gltf_uv_set(infos[i]);
    return 0;
}

bool gltf_make_material(struct gltf *g, struct reader *r, struct xml_node *scene, int64_t index,
                        int colour_channels, struct gltf_material *out) {
    const struct json *material = index < 0 ? NULL : gltf_item(g, "materials", (size_t)index);
    struct gltf_making m = {.g = g, .r = r, .material = material, .colour_channels = colour_channels,
                       .out = out};
    *out = (struct gltf_material){.wants.uv_set = main_uv_set(material)};
    read_factors(&m);
    read_emission(&m);
    warn_of_extensions(&m);
    const char *kind = arena_printf(g->arena, "glTF material with %d vertex colours",
                                    colour_channels);
    const char *key = arena_printf(g->arena, "%lld", (long long)index);
    struct gltf_material *known = arena_find(g->arena, kind, key);
    if (known) {
        *out = *known;
        return true;
    }
    struct xml_node holder = {0};
    if (!add_layers(&m, &holder))
        return false;
    const char *name = json_text(json_get(material, "name"));
    out->id = tree_free_id(r, name, index < 0 ? "default material"
                                              : arena_printf(g->arena, "materials.%s", key));
    xml_set(holder.first, "id", out->id, r->arena);
    xml_append(scene, holder.first);
    if (!id_define(r, out->id, holder.first, holder.first->at))
        return false;
    known = arena_alloc(g->arena, sizeof *known);
    *known = *out;
    arena_keep(g->arena, kind, key, known);
    return true;
}
