// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_rules.h"

#include <stddef.h>

#define END {.name = NULL}
#define OBJ(text, rule_) {.name = text, .kind = OBJECT, .of = &rule_}
#define LIST(text, rule_) {.name = text, .kind = OBJECTS, .least = 1, .of = &rule_}
#define REF(text, where) {.name = text, .kind = INDEX, .into = where}
#define NUM(text, lo, hi) {.name = text, .kind = NUMBER, .min = lo, .max = hi}
#define NUMS(text, n, lo, hi)                                                                      \
    {.name = text, .kind = NUMBERS, .min = lo, .max = hi, .least = n, .most = n}
#define FREE(text) {.name = text, .kind = TEXT}
#define SWITCH(text) {.name = text, .kind = FLAG}
#define RULES(name, list, extensions) static const struct gltf_object_rule name = {list, extensions}
#define MANDATORY .required = true
#define HUGE_INDEX 9007199254740991.0

// ---- textures and materials -----------------------------------------------------------------

static const struct gltf_rule transform_rules[] = {NUMS("offset", 2, 0, 0), NUMS("scale", 2, 0, 0),
                                              NUM("rotation", 0, 0), NUM("texCoord", 0, 64), END};
RULES(texture_transform, transform_rules, "");
#define INFO_RULES                                                                                 \
    {.name = "index", .kind = INDEX, MANDATORY, .into = "textures"},                               \
        {.name = "texCoord", .kind = COUNT, .min = 0, .max = 64}
static const struct gltf_rule info_rules[] = {INFO_RULES, END};
RULES(texture_info, info_rules, " KHR_texture_transform ");
static const struct gltf_rule normal_rules[] = {INFO_RULES, NUM("scale", 0, 0), END};
RULES(normal_info, normal_rules, " KHR_texture_transform ");
static const struct gltf_rule occlusion_rules[] = {INFO_RULES, NUM("strength", 0, 1), END};
RULES(occlusion_info, occlusion_rules, " KHR_texture_transform ");
static const struct gltf_rule pbr_rules[] = {
    NUMS("baseColorFactor", 4, 0, 1), OBJ("baseColorTexture", texture_info),
    NUM("metallicFactor", 0, 1), NUM("roughnessFactor", 0, 1),
    OBJ("metallicRoughnessTexture", texture_info), END};
RULES(pbr, pbr_rules, "");
static const struct gltf_rule material_rules[] = {
    FREE("name"), OBJ("pbrMetallicRoughness", pbr), OBJ("normalTexture", normal_info),
    OBJ("occlusionTexture", occlusion_info), OBJ("emissiveTexture", texture_info),
    NUMS("emissiveFactor", 3, 0, 1), FREE("alphaMode"), NUM("alphaCutoff", 0, 1e300),
    SWITCH("doubleSided"), END};
RULES(material, material_rules,
      " KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_dispersion"
      " KHR_materials_emissive_strength KHR_materials_ior KHR_materials_iridescence"
      " KHR_materials_pbrSpecularGlossiness KHR_materials_sheen KHR_materials_specular"
      " KHR_materials_transmission KHR_materials_unlit KHR_materials_volume"
      " KHR_materials_diffuse_transmission KHR_materials_volume_scatter ");

static const struct gltf_rule emissive_strength_rules[] = {NUM("emissiveStrength", 0, 1e300), END};
RULES(emissive_strength, emissive_strength_rules, "");
static const struct gltf_rule transmission_rules[] = {NUM("transmissionFactor", 0, 1),
                                                 OBJ("transmissionTexture", texture_info), END};
RULES(transmission, transmission_rules, "");
static const struct gltf_rule ior_rules[] = {NUM("ior", 0, 1e300), END}; // 0, or see gltf_check.c
RULES(ior, ior_rules, "");
static const struct gltf_rule volume_rules[] = {
    NUM("thicknessFactor", 0, 1e300), OBJ("thicknessTexture", texture_info),
    NUM("attenuationDistance", 5e-324, 1e300), NUMS("attenuationColor", 3, 0, 1), END};
RULES(volume, volume_rules, "");
static const struct gltf_rule specular_rules[] = {
    NUM("specularFactor", 0, 1), OBJ("specularTexture", texture_info),
    NUMS("specularColorFactor", 3, 0, 1e300), OBJ("specularColorTexture", texture_info), END};
RULES(specular, specular_rules, "");
static const struct gltf_rule clearcoat_rules[] = {
    NUM("clearcoatFactor", 0, 1), OBJ("clearcoatTexture", texture_info),
    NUM("clearcoatRoughnessFactor", 0, 1), OBJ("clearcoatRoughnessTexture", texture_info),
    OBJ("clearcoatNormalTexture", normal_info), END};
RULES(clearcoat, clearcoat_rules, "");
static const struct gltf_rule sheen_rules[] = {
    NUMS("sheenColorFactor", 3, 0, 1), OBJ("sheenColorTexture", texture_info),
    NUM("sheenRoughnessFactor", 0, 1), OBJ("sheenRoughnessTexture", texture_info), END};
RULES(sheen, sheen_rules, "");
static const struct gltf_rule anisotropy_rules[] = {
    NUM("anisotropyStrength", 0, 1), NUM("anisotropyRotation", 0, 0),
    OBJ("anisotropyTexture", texture_info), END};
RULES(anisotropy, anisotropy_rules, "");
static const struct gltf_rule dispersion_rules[] = {NUM("dispersion", 0, 1e300), END};
RULES(dispersion, dispersion_rules, "");

static const struct gltf_rule texture_rules[] = {FREE("name"), REF("sampler", "samplers"),
                                            REF("source", "images"), END};
RULES(texture, texture_rules, " EXT_texture_webp KHR_texture_basisu MSFT_texture_dds ");
static const struct gltf_rule webp_rules[] = {REF("source", "images"), END};
RULES(webp, webp_rules, "");
static const struct gltf_rule sampler_rules[] = {
    FREE("name"), {.name = "magFilter", .kind = COUNT}, {.name = "minFilter", .kind = COUNT},
    {.name = "wrapS", .kind = COUNT}, {.name = "wrapT", .kind = COUNT}, END};
RULES(sampler, sampler_rules, "");
static const struct gltf_rule image_rules[] = {FREE("name"), FREE("uri"), FREE("mimeType"),
                                          REF("bufferView", "bufferViews"), END};
RULES(image, image_rules, "");

// ---- data -----------------------------------------------------------------------------------

static const struct gltf_rule buffer_rules[] = {
    FREE("name"), FREE("uri"),
    {.name = "byteLength", .kind = COUNT, MANDATORY, .min = 1, .max = HUGE_INDEX}, END};
RULES(buffer, buffer_rules, " EXT_meshopt_compression ");
static const struct gltf_rule view_rules[] = {
    FREE("name"), {.name = "buffer", .kind = INDEX, MANDATORY, .into = "buffers"},
    {.name = "byteOffset", .kind = COUNT, .min = 0, .max = HUGE_INDEX},
    {.name = "byteLength", .kind = COUNT, MANDATORY, .min = 1, .max = HUGE_INDEX},
    {.name = "byteStride", .kind = COUNT, .min = 4, .max = 252},
    {.name = "target", .kind = COUNT, .min = 0, .max = 65535}, END};
RULES(view, view_rules, " EXT_meshopt_compression ");
#define SPARSE_PART                                                                                \
    {.name = "bufferView", .kind = INDEX, MANDATORY, .into = "bufferViews"},                       \
        {.name = "byteOffset", .kind = COUNT, .min = 0, .max = HUGE_INDEX}
static const struct gltf_rule sparse_index_rules[] = {
    SPARSE_PART, {.name = "componentType", .kind = COUNT, MANDATORY, .min = 0, .max = 65535}, END};
RULES(sparse_indices, sparse_index_rules, "");
static const struct gltf_rule sparse_value_rules[] = {SPARSE_PART, END};
RULES(sparse_values, sparse_value_rules, "");
static const struct gltf_rule sparse_rules[] = {
    {.name = "count", .kind = COUNT, MANDATORY, .min = 1, .max = 4294967295.0},
    {.name = "indices", .kind = OBJECT, MANDATORY, .of = &sparse_indices},
    {.name = "values", .kind = OBJECT, MANDATORY, .of = &sparse_values}, END};
RULES(sparse, sparse_rules, "");
static const struct gltf_rule accessor_rules[] = {
    FREE("name"), REF("bufferView", "bufferViews"),
    {.name = "byteOffset", .kind = COUNT, .min = 0, .max = HUGE_INDEX},
    {.name = "componentType", .kind = COUNT, MANDATORY, .min = 0, .max = 65535},
    SWITCH("normalized"),
    {.name = "count", .kind = COUNT, MANDATORY, .min = 1, .max = 4294967294.0},
    {.name = "type", .kind = TEXT, MANDATORY},
    {.name = "min", .kind = NUMBERS, .least = 1, .most = 16},
    {.name = "max", .kind = NUMBERS, .least = 1, .most = 16}, OBJ("sparse", sparse), END};
RULES(accessor, accessor_rules, "");

// ---- meshes and nodes -----------------------------------------------------------------------

static const struct gltf_rule mapping_rules[] = {
    {.name = "material", .kind = INDEX, MANDATORY, .into = "materials"},
    {.name = "variants", .kind = INDICES, MANDATORY, .least = 1,
     .into = "KHR_materials_variants/variants"}, END};
RULES(mapping, mapping_rules, "");
static const struct gltf_rule mappings_rules[] = {
    {.name = "mappings", .kind = OBJECTS, MANDATORY, .least = 1, .of = &mapping}, END};
RULES(mappings, mappings_rules, "");
static const struct gltf_rule variant_rules[] = {{.name = "name", .kind = TEXT, MANDATORY}, END};
RULES(variant, variant_rules, "");
static const struct gltf_rule variants_rules[] = {
    {.name = "variants", .kind = OBJECTS, MANDATORY, .least = 1, .of = &variant}, END};
RULES(variants, variants_rules, "");
static const struct gltf_rule primitive_rules[] = {
    {.name = "attributes", .kind = ANY, MANDATORY}, REF("indices", "accessors"),
    REF("material", "materials"), {.name = "mode", .kind = COUNT, .min = 0, .max = 6},
    {.name = "targets", .kind = ANY}, END};
RULES(primitive, primitive_rules,
      " KHR_draco_mesh_compression KHR_materials_variants FB_ngon_encoding ");
static const struct gltf_rule mesh_rules[] = {
    FREE("name"),
    {.name = "primitives", .kind = OBJECTS, MANDATORY, .least = 1, .of = &primitive},
    {.name = "weights", .kind = NUMBERS, .least = 1}, END};
RULES(mesh, mesh_rules, " ");
static const struct gltf_rule node_rules[] = {
    FREE("name"), REF("camera", "cameras"), REF("mesh", "meshes"), REF("skin", "skins"),
    {.name = "children", .kind = INDICES, .least = 1, .into = "nodes"},
    NUMS("matrix", 16, -1e300, 1e300), NUMS("translation", 3, -1e300, 1e300),
    NUMS("rotation", 4, -1, 1), NUMS("scale", 3, -1e300, 1e300),
    {.name = "weights", .kind = NUMBERS, .least = 1}, END};
RULES(node, node_rules, " KHR_lights_punctual KHR_node_visibility EXT_mesh_gpu_instancing"
                        " EXT_lights_ies KHR_node_hoverability KHR_node_selectability ");
static const struct gltf_rule node_light_rules[] = {
    {.name = "light", .kind = INDEX, MANDATORY, .into = "KHR_lights_punctual/lights"}, END};
RULES(node_light, node_light_rules, "");
static const struct gltf_rule spot_rules[] = {NUM("innerConeAngle", 0, 1.5707963267948967),
                                         NUM("outerConeAngle", 5e-324, 1.5707963267948967), END};
RULES(spot, spot_rules, "");
static const struct gltf_rule light_rules[] = {
    FREE("name"), {.name = "type", .kind = TEXT, MANDATORY}, NUMS("color", 3, 0, 1),
    NUM("intensity", 0, 1e300), NUM("range", 5e-324, 1e300), OBJ("spot", spot), END};
RULES(light, light_rules, "");
static const struct gltf_rule lights_rules[] = {
    {.name = "lights", .kind = OBJECTS, MANDATORY, .least = 1, .of = &light}, END};
RULES(lights, lights_rules, "");
static const struct gltf_rule scene_rules[] = {
    FREE("name"), {.name = "nodes", .kind = INDICES, .least = 1, .into = "nodes"}, END};
RULES(scene, scene_rules, " EXT_lights_image_based KHR_xmp_json_ld ");
static const struct gltf_rule skin_rules[] = {
    FREE("name"), REF("inverseBindMatrices", "accessors"), REF("skeleton", "nodes"),
    {.name = "joints", .kind = INDICES, MANDATORY, .least = 1, .into = "nodes"}, END};
RULES(skin, skin_rules, "");
static const struct gltf_rule perspective_rules[] = {
    NUM("aspectRatio", 5e-324, 1e300),
    {.name = "yfov", .kind = NUMBER, MANDATORY, .min = 5e-324, .max = 1e300},
    {.name = "znear", .kind = NUMBER, MANDATORY, .min = 5e-324, .max = 1e300},
    NUM("zfar", 5e-324, 1e300), END};
RULES(perspective, perspective_rules, "");
static const struct gltf_rule orthographic_rules[] = {
    {.name = "xmag", .kind = NUMBER, MANDATORY}, {.name = "ymag", .kind = NUMBER, MANDATORY},
    {.name = "znear", .kind = NUMBER, MANDATORY, .min = 0, .max = 1e300},
    {.name = "zfar", .kind = NUMBER, MANDATORY, .min = 5e-324, .max = 1e300}, END};
RULES(orthographic, orthographic_rules, "");
static const struct gltf_rule camera_rules[] = {
    FREE("name"), {.name = "type", .kind = TEXT, MANDATORY}, OBJ("perspective", perspective),
    OBJ("orthographic", orthographic), END};
RULES(camera, camera_rules, "");

// ---- animations -----------------------------------------------------------------------------

static const struct gltf_rule target_rules[] = {REF("node", "nodes"),
                                           {.name = "path", .kind = TEXT, MANDATORY}, END};
RULES(target, target_rules, " KHR_animation_pointer ");
static const struct gltf_rule channel_rules[] = {
    {.name = "sampler", .kind = COUNT, MANDATORY, .min = 0, .max = HUGE_INDEX},
    {.name = "target", .kind = OBJECT, MANDATORY, .of = &target}, END};
RULES(channel, channel_rules, "");
static const struct gltf_rule animation_sampler_rules[] = {
    {.name = "input", .kind = INDEX, MANDATORY, .into = "accessors"},
    {.name = "output", .kind = INDEX, MANDATORY, .into = "accessors"}, FREE("interpolation"), END};
RULES(animation_sampler, animation_sampler_rules, "");
static const struct gltf_rule animation_rules[] = {
    FREE("name"), {.name = "channels", .kind = OBJECTS, MANDATORY, .least = 1, .of = &channel},
    {.name = "samplers", .kind = OBJECTS, MANDATORY, .least = 1, .of = &animation_sampler}, END};
RULES(animation, animation_rules, "");

// ---- the file -------------------------------------------------------------------------------

static const struct gltf_rule asset_rules[] = {{.name = "version", .kind = TEXT, MANDATORY},
                                          FREE("minVersion"), FREE("generator"),
                                          FREE("copyright"), END};
RULES(asset, asset_rules, " KHR_xmp_json_ld ");
static const struct gltf_rule root_rules[] = {
    {.name = "asset", .kind = OBJECT, MANDATORY, .of = &asset}, REF("scene", "scenes"),
    {.name = "extensionsUsed", .kind = TEXTS, .least = 1},
    {.name = "extensionsRequired", .kind = TEXTS, .least = 1}, LIST("accessors", accessor),
    LIST("animations", animation), LIST("buffers", buffer), LIST("bufferViews", view),
    LIST("cameras", camera), LIST("images", image), LIST("materials", material),
    LIST("meshes", mesh), LIST("nodes", node), LIST("samplers", sampler), LIST("scenes", scene),
    LIST("skins", skin), LIST("textures", texture), END};
const struct gltf_object_rule gltf_root_rule = {
    root_rules, " KHR_lights_punctual KHR_materials_variants EXT_lights_image_based EXT_lights_ies"
                " KHR_xmp_json_ld "};

const struct gltf_extension_rule gltf_extension_rules[] = {
    {"KHR_texture_transform", &texture_info, &texture_transform},
    {"KHR_texture_transform", &normal_info, &texture_transform},
    {"KHR_texture_transform", &occlusion_info, &texture_transform},
    {"KHR_materials_emissive_strength", &material, &emissive_strength},
    {"KHR_materials_transmission", &material, &transmission},
    {"KHR_materials_ior", &material, &ior},
    {"KHR_materials_volume", &material, &volume},
    {"KHR_materials_specular", &material, &specular},
    {"KHR_materials_clearcoat", &material, &clearcoat},
    {"KHR_materials_sheen", &material, &sheen},
    {"KHR_materials_anisotropy", &material, &anisotropy},
    {"KHR_materials_dispersion", &material, &dispersion},
    {"KHR_materials_variants", &primitive, &mappings},
    {"KHR_materials_variants", &gltf_root_rule, &variants},
    {"KHR_lights_punctual", &node, &node_light},
    {"KHR_lights_punctual", &gltf_root_rule, &lights},
    {"EXT_texture_webp", &texture, &webp},
    {NULL, NULL, NULL},
};

const struct gltf_object_rule *const gltf_extensible_rules[] = {
    &texture_info, &material, &texture, &buffer, &view, &primitive, &node, &scene, &target,
    &asset, &gltf_root_rule, NULL};
