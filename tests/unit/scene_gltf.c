// SPDX-License-Identifier: Apache-2.0
// glTF models from text: instances, cameras, lights, materials and refusals.
#include "scene_text.h"

// Three vertices (0 0 0) (1 0 0) (0 1 0) as floats.
#define TRIANGLE                                                                                   \
    "\"asset\":{\"version\":\"2.0\"},\"scene\":0,"                                                 \
    "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"              \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],"                                        \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"                                          \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","       \
    "\"min\":[0,0,0],\"max\":[1,1,0]}],"
#define MESH                                                                                       \
    "\"meshes\":[{\"name\":\"tri\",\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}],"

static struct scene *read_model(const char *text) {
    const struct scene_options options = scene_real_options();
    scene_write("model.gltf", text);
    capture_begin();
    struct scene *s = scene_read(scene_path("model.gltf"), &options);
    capture_end();
    return s;
}

static void frames_and_lights_a_bare_model(void) {
    struct scene *s = read_model("{" TRIANGLE MESH "\"materials\":[{}],\"nodes\":[{\"mesh\":0}],"
                                 "\"scenes\":[{\"nodes\":[0]}]}");
    CHECK(s);
    if (!s)
        return;
    CHECK(captured_has("has no camera") && captured_has("has no light"));
    CHECK(s->shape_count == 1 && s->shapes[0].mesh.triangle_count == 1);
    CHECK(s->film.width == 1280 && s->film.height == 720);
    CHECK(s->sensor_count == 1 && s->light_count == 2);
    CHECK(strcmp(s->shapes[0].bsdf->type->name, "twosided") == 0);
    scene_destroy(s);
}

static void shares_a_mesh_by_instances(void) {
    struct scene *s = read_model(
        "{" TRIANGLE MESH "\"materials\":[{}],\"nodes\":[{\"mesh\":0,\"translation\":[2,0,0]},"
        "{\"mesh\":0,\"rotation\":[0,0,0.70710678,0.70710678]}],\"scenes\":[{\"nodes\":[0,1]}]}");
    CHECK(s && s->instance_count == 2 && s->group_count == 1 && s->shape_count == 1);
    CHECK(s && s->instances[0].to_world.m[0][3] == 2);
    // a quarter turn about z takes x to y
    CHECK(s && fabs(s->instances[1].to_world.m[1][0] - 1) < 1e-7);
    scene_destroy(s);
}

static void reads_cameras_lights_and_emission(void) {
    struct scene *s = read_model(
        "{" TRIANGLE MESH "\"extensionsUsed\":[\"KHR_lights_punctual\","
        "\"KHR_materials_emissive_strength\"],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":"
        "[{\"type\":\"spot\",\"intensity\":5,\"spot\":{}}]}},\"cameras\":[{\"type\":\"perspective\","
        "\"perspective\":{\"yfov\":1,\"znear\":0.1}}],\"materials\":[{\"emissiveFactor\":[1,0.5,0],"
        "\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":10}}}],"
        "\"nodes\":[{\"mesh\":0},{\"camera\":0},{\"extensions\":{\"KHR_lights_punctual\":"
        "{\"light\":0}}}],\"scenes\":[{\"nodes\":[0,1,2]}]}");
    CHECK(s && s->light_count == 2 && s->sensor_count == 1 && s->shapes[0].light != SCENE_NONE);
    CHECK(!captured_has("has no"));
    scene_destroy(s);
}

// A picture of one white pixel.
#define PIXEL                                                                                      \
    "\"images\":[{\"uri\":\"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAA" \
    "DElEQVR4nGP4//8/AAX+Av4N70a4AAAAAElFTkSuQmCC\"}],\"textures\":[{\"source\":0}],"

static void reads_two_sets_of_coordinates(void) {
    struct scene *s = read_model(
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"buffers\":[{\"byteLength\":36,\"uri\":"
        "\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,"
        "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]},"
        "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"},"
        "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],"
        PIXEL "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,"
        "\"TEXCOORD_1\":2},\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{"
        "\"baseColorTexture\":{\"index\":0},\"metallicRoughnessTexture\":{\"index\":0,\"texCoord\":1}"
        "}}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}");
    CHECK(s && s->shape_count == 1);
    if (!s)
        return;
    const struct mesh *m = &s->shapes[0].mesh;
    const struct mesh_attribute *second = mesh_find_attribute(m, "vertex_uv1");
    CHECK(m->uvs && m->uvs[1][1] == 1); // the fourth number of the buffer
    CHECK(second && second->channels == 2 && second->data[0] == 1 && second->data[5] == 0);
    CHECK(second && second->data[4] == 1);
    CHECK(!captured_has("TEXCOORD"));
    scene_destroy(s);
}

// Ranges of samples of two models are not united, also where only the file of numbers differs.
static void hashes_what_lies_beside_it(void) {
    float numbers[10] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 5}; // the last one is not used
    uint64_t hash[3] = {0};
    for (int i = 0; i < 3; i++) {
        numbers[9] = i < 2 ? 5 : 6;
        CHECK(file_write(scene_path("numbers.bin"), numbers, sizeof numbers));
        struct scene *s = read_model(
            "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"buffers\":[{\"byteLength\":40,\"uri\":"
            "\"numbers.bin\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{"
            "\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],"
            "\"max\":[1,1,0]}]," MESH "\"materials\":[{}],\"nodes\":[{\"mesh\":0}],"
            "\"scenes\":[{\"nodes\":[0]}]}");
        CHECK(s);
        hash[i] = s ? s->hash : 0;
        scene_destroy(s);
    }
    CHECK(hash[0] && hash[0] == hash[1] && hash[1] != hash[2]);
}

// The material that a model's only one becomes; "": none.
static const char *material_of(const char *material) {
    static char name[64];
    char text[2048];
    snprintf(text, sizeof text, "{" TRIANGLE MESH "\"extensionsUsed\":[\"KHR_materials_transmission\"],"
             "\"materials\":[%s],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}", material);
    struct scene *s = read_model(text);
    snprintf(name, sizeof name, "%s", s ? s->shapes[0].bsdf->type->name : "");
    scene_destroy(s);
    return name;
}

static void follows_the_words_of_the_format(void) {
    // "A value greater than 1.0 will render the entire material as transparent" (alphaCutoff)
    CHECK(strcmp(material_of("{\"alphaMode\":\"MASK\"}"), "twosided") == 0);
    CHECK(strcmp(material_of("{\"alphaMode\":\"MASK\",\"alphaCutoff\":1.5}"), "mask") == 0);
    // metals, as all are where nothing is said, do not transmit
    static const char glass[] = "{\"pbrMetallicRoughness\":{\"metallicFactor\":%s},\"extensions\":"
                                "{\"KHR_materials_transmission\":{\"transmissionFactor\":1}}}";
    char text[256];
    snprintf(text, sizeof text, glass, "0");
    CHECK(strcmp(material_of(text), "principledthin") == 0);
    snprintf(text, sizeof text, glass, "0.5");
    CHECK(strcmp(material_of(text), "principledthin") == 0 && captured_has("no metallic part"));
    snprintf(text, sizeof text, glass, "1");
    CHECK(strcmp(material_of(text), "twosided") == 0);
}

static void refuses_with_a_pointer(void) {
    CHECK(!read_model("{" TRIANGLE MESH "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]}"));
    CHECK(captured_has("model.gltf: /meshes/0/primitives/0/material: is 0"));
    CHECK(!read_model("{" TRIANGLE MESH "\"materials\":[{\"alphaCutoff\":-1}],\"scenes\":[{}]}"));
    CHECK(captured_has("/materials/0/alphaCutoff: is -1"));
    CHECK(!read_model("{" TRIANGLE MESH "\"materials\":[{}],\"nodes\":[{\"mesh\":0}],"
                      "\"scenes\":[{\"nodes\":[0,0]}]}"));
    CHECK(captured_has("/scenes/0/nodes/1: is named for the second time"));
    CHECK(!read_model("{" TRIANGLE MESH "\"materials\":[{}],\"nodes\":[{\"mesh\":0},"
                      "{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]}"));
    CHECK(captured_has("/scenes/0/nodes/0: is a child of node 1"));
    CHECK(!read_model("{" TRIANGLE MESH "\"materials\":[{}],\"extensionsUsed\":"
                      "[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":"
                      "[{\"type\":\"spot\",\"spot\":{\"innerConeAngle\":1}}]}},\"scenes\":[{}]}"));
    CHECK(captured_has("/lights/0/spot: has an inner cone of 1"));
    CHECK(!read_model("{" TRIANGLE MESH "\"materials\":[{}],\"nodes\":[{\"mesh\":0,\"matrix\":"
                      "[1,0,0,0,1,1,0,0,0,0,1,0,0,0,0,1]}],\"scenes\":[{\"nodes\":[0]}]}"));
    CHECK(captured_has("/nodes/0/matrix: is sheared"));
    CHECK(!read_model("{\"asset\":{\"version\":\"1.0\"}}") && captured_has("/asset/version"));
}

int main(void) {
    scene_folder_open();
    frames_and_lights_a_bare_model();
    shares_a_mesh_by_instances();
    reads_cameras_lights_and_emission();
    reads_two_sets_of_coordinates();
    hashes_what_lies_beside_it();
    follows_the_words_of_the_format();
    refuses_with_a_pointer();
    scene_folder_close();
    return check_result();
}
