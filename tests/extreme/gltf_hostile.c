// SPDX-License-Identifier: Apache-2.0
// Models made to break glTF readers. Where a report of the Khronos validator lies beside one, its
// errors decide: a model with errors is refused, one without is taken. All others are read as
// scenes, or refused with a message that names them.
#include <ftw.h>

#include "base/json.h"
#include "scene/gltf.h"
#include "scene_text.h"

// Where reader and validator differ on purpose. Type names that a later version may bring cannot
// be read here, nor a picture that is not among the data; pictures are decoded when a material uses
// them, not before.
static const char *const refused_anyway[] = {"accessor/unknown_type.gltf",
                                             "EXT_texture_webp/data/image/valid.gltf"};
static const char *const taken_anyway[] = {"image/invalid_image_data.gltf"};

static int judged, invalid, taken, refused;

static bool is_listed(const char *path, const char *const *list, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const size_t n = strlen(list[i]), m = strlen(path);
        if (m >= n && strcmp(path + m - n, list[i]) == 0)
            return true;
    }
    return false;
}

// Errors in the validator's report; -1: there is none.
static int reported_errors(const char *path) {
    char name[4096];
    size_t size;
    double errors = -1;
    snprintf(name, sizeof name, "%s.report.json", path);
    if (!file_exists(name))
        return -1;
    char *text = file_read(name, 0, &size);
    struct json *report = json_parse(text, size, name);
    json_read_number(json_get(json_get(report, "issues"), "numErrors"), &errors);
    json_destroy(report);
    mem_free(text);
    return (int)errors;
}

static void judge(const char *path, bool bad) {
    struct arena arena = {0};
    struct gltf g;
    capture_begin();
    const bool ok = gltf_open(&g, path, &arena);
    gltf_close(&g);
    arena_finish(&arena);
    capture_end();
    const bool expected = bad ? is_listed(path, taken_anyway, 1)
                              : !is_listed(path, refused_anyway, 2);
    if (ok != expected)
        printf("WRONG: %s was %s: %s\n", path, ok ? "taken" : "refused", captured);
    CHECK(ok == expected);
    CHECK(ok || captured_has(path));
    judged++;
    invalid += bad;
}

static int visit(const char *path, const struct stat *st, int type, struct FTW *position) {
    char extension[8];
    (void)st;
    (void)position;
    file_extension(path, extension, sizeof extension);
    if (type != FTW_F || (strcmp(extension, "gltf") != 0 && strcmp(extension, "glb") != 0))
        return 0;
    const int errors = reported_errors(path);
    if (errors >= 0)
        judge(path, errors > 0);
    const struct scene_options options = scene_real_options();
    capture_begin();
    struct scene *s = scene_read(path, &options);
    capture_end();
    if (errors < 0)
        printf("%s: %s %s", path, s ? "read" : "refused", *captured ? captured : "\n");
    CHECK(s || captured_has(path));
    taken += s != NULL;
    refused += !s;
    scene_destroy(s);
    return 0;
}

int main(void) {
    static const char *const folders[] = {"gltf-validator", "assimp", "magnum-gltf"};
    const char *data = getenv("RELUME_SHARED_DATA");
    if (!data)
        return 77;
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/hostile/%s", data, folders[i]);
        CHECK(nftw(path, visit, 16, FTW_PHYS) == 0);
    }
    printf("%d models judged by the validator, %d of them invalid; as scenes %d read, %d refused\n",
           judged, invalid, taken, refused);
    CHECK(judged == 182 && invalid == 115);
    return check_result();
}
