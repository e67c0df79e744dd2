// SPDX-License-Identifier: Apache-2.0
// What becomes of each part of a glTF file.
#include <stdio.h>

#include "scene/format_tables.h"

const struct gltf_row gltf_rows[] = {
    {"pbrMetallicRoughness", "principled: base_color, metallic, roughness"},
    {"COLOR_0", "base_color times mesh_attribute vertex_color"},
    {"normalTexture (scale)", "normalmap"},
    {"occlusionTexture", "nothing: light is traced"},
    {"emissiveFactor, emissiveTexture", "area light on the side of the normals"},
    {"alphaMode MASK, BLEND", "mask (MASK: opaque where alpha reaches alphaCutoff)"},
    {"doubleSided", "opaque materials are twosided either way: nothing is culled"},
    {"KHR_materials_emissive_strength", "factor of the light's radiance"},
    {"KHR_materials_ior", "eta"},
    {"KHR_materials_specular", "eta with the same reflectance at the normal"},
    {"KHR_materials_transmission", "principledthin: spec_trans (a thin sheet)"},
    {"the same with KHR_materials_volume",
     "principled: spec_trans (a solid), and a homogeneous medium inside"},
    {"KHR_materials_clearcoat",
     "coated: weight, alpha; the texture of its normals: nothing"},
    {"KHR_materials_sheen", "principled: sheen"},
    {"KHR_materials_anisotropy", "principled: anisotropic; a metal: roughconductor"},
    {"KHR_materials_dispersion", NULL},
    {"KHR_materials_iridescence", NULL},
    {"KHR_materials_unlit", NULL},
    {"KHR_materials_pbrSpecularGlossiness", NULL},
    {"KHR_materials_diffuse_transmission", NULL},
    {"KHR_texture_transform", "to_uv of the bitmap"},
    {"texCoord other than the material's first", "uvmap: vertex_uvN"},
    {"`KHR_lights_punctual`",
     "point, directional, spot: candela and lux are taken for W/sr and W/m^2"},
    {"cameras", "perspective, orthographic"},
    {"sparse and normalised accessors, `KHR_mesh_quantization`", "read"},
    {"skins, morph targets, animations", "the first pose: one warning"},
    {NULL, NULL},
};

void gltf_print_table(void) {
    printf("| glTF | here |\n|---|---|\n");
    for (const struct gltf_row *r = gltf_rows; r->name; r++)
        if (r->here)
            printf("| %s | %s |\n", r->name, r->here);
    printf("|");
    for (const struct gltf_row *r = gltf_rows; r->name; r++)
        if (!r->here)
            printf(" %s", r->name);
    printf(" | nothing: one warning |\n");
}
