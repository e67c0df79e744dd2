// SPDX-License-Identifier: Apache-2.0
// Each kind of file has a function that reads the file in full and tells its content as a JSON
// object; without --json the same object is printed as lines.
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "driver/mesh_info.h"
#include "driver/scene_info.h"
#include "image/summary.h"
#include "mesh/mesh.h"
#include "scene_options.h"
#include "subcommand.h"
#include "transport/tensor_remake.h"

enum { MOST_ROWS = 64 }; // of meshes of one file, for people

struct info_options {
    const char *file;
    struct option_list defines;
    int threads;
    bool lenient, json;
};

static int tell_scene(const struct info_options *o, struct json *out) {
    struct arena arena = {0};
    struct job job;
    const struct scene_define *defines = defines_parse(&o->defines, &arena);
    const struct job_options job_options = {
        .scene = o->file, .threads = o->threads,
        .reading = {.defines = defines, .define_count = o->defines.count, .lenient = o->lenient}};
    const bool good = defines && job_open(&job, &job_options);
    if (good) {
        scene_info_add(&job, out);
        job_close(&job);
    }
    arena_finish(&arena);
    return good ? EXIT_DONE : defines ? EXIT_FAILED : EXIT_USAGE;
}

static void tell_channel(const struct image *im, int c, struct json *out) {
    struct channel_summary s;
    image_summarize_channel(im, c, &s);
    json_add_text(out, "name", im->channel_names[c]);
    json_add_number(out, "mean", s.mean);
    json_add_number(out, "min", (double)s.smallest);
    json_add_number(out, "max", (double)s.largest);
    json_add_count(out, "nan", (int64_t)s.nans);
    json_add_count(out, "inf", (int64_t)s.infinities);
    json_add_count(out, "negative", (int64_t)s.negatives);
}

static bool tell_image(const char *path, struct json *out) {
    struct image im;
    if (!image_read(path, &im))
        return false;
    json_add_text(out, "kind", "image");
    json_add_count(out, "width", im.width);
    json_add_count(out, "height", im.height);
    json_add_count(out, "bits", im.bits);
    json_add_text(out, "encoding", im.srgb_encoded ? "sRGB" : "linear");
    if (im.full_width) {
        const int crop[] = {im.crop_x, im.crop_y, im.full_width, im.full_height};
        struct json *window = json_add_array(out, "crop_x_y_of_width_height");
        for (int i = 0; i < 4; i++)
            json_append_number(window, crop[i]);
    }
    struct json *attributes = json_add_object(out, "attributes");
    for (int i = 0; i < im.attribute_count; i++)
        if (im.attributes[i].text)
            json_add_text(attributes, im.attributes[i].name, im.attributes[i].text);
        else
            json_add_number(attributes, im.attributes[i].name, im.attributes[i].number);
    struct json *channels = json_add_array(out, "channels");
    for (int c = 0; c < im.channels; c++)
        tell_channel(&im, c, json_append_object(channels));
    image_finish(&im);
    return true;
}

static bool is_mesh(const char *extension) {
    for (const struct entry *const *e = mesh_readers.entries; *e; e++)
        for (const char *const *x = ((const struct mesh_reader_type *)*e)->extensions; *x; x++)
            if (strcmp(*x, extension) == 0)
                return true;
    return false;
}

static bool tell_tensor(const char *path, struct json *out) {
    struct tensor_file *f = tensor_open(path);
    if (f)
        tensor_describe(tensor_get(f), out);
    tensor_close(f);
    return f != NULL;
}

static int run(const void *values, const char *command) {
    const struct info_options *o = values;
    char extension[16];
    int code;
    (void)command;
    file_extension(o->file, extension, sizeof extension);
    struct json *out = json_new_object();
    json_add_text(out, "file", o->file);
    if (scene_is_format(o->file) && !is_mesh(extension))
        code = tell_scene(o, out);
    else if (is_mesh(extension))
        code = mesh_info_add(o->file, o->json ? INT_MAX : MOST_ROWS, out) ? EXIT_DONE : EXIT_FAILED;
    else if (strcmp(extension, "safetensors") == 0)
        code = tell_tensor(o->file, out) ? EXIT_DONE : EXIT_FAILED;
    else
        code = tell_image(o->file, out) ? EXIT_DONE : EXIT_FAILED;
    if (code == EXIT_DONE && o->json)
        json_print(out, true);
    else if (code == EXIT_DONE)
        json_print_lines(out);
    json_destroy(out);
    return code;
}

#define AT(member) offsetof(struct info_options, member)
static const struct option_spec options[] = {
    OPTION_DEFINE(struct info_options, defines),
    OPTION_LENIENT(struct info_options, lenient),
    OPTION_THREADS(struct info_options, threads),
    OPTION_JSON(struct info_options, json),
    OPTION_END,
};

static const struct option_argument arguments[] = {
    {.name = "FILE", .offset = AT(file),
     .help = "a scene (.xml, .pbrt, .gltf, .glb), a mesh (OBJ, PLY, ...), a picture (EXR, PNG, HDR, JPEG, ...)\n"
             "or a tensor (.safetensors)"},
    {.name = NULL},
};

const struct subcommand subcommand_info = {
    .entry = {.name = "info", .help = "read a file in full and say what it holds",
              .size = sizeof(struct info_options)},
    .options = {.options = options,
                .arguments = arguments,
                .description = "Of a scene: what it holds, what rendering it requires and does "
                               "not, and the memory it takes.\nOf a picture: size, layers, "
                               "attributes, the range of each channel, NaN and infinities.\n"
                               "Of a file of several meshes: their sums and each.",
                .examples = "  relume info scene.xml -D spp=64\n"
                            "  relume info room.exr\n  relume info bunny.ply --json\n"},
    .run = run,
};
