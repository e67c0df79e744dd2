// SPDX-License-Identifier: Apache-2.0
// relume edit: a picture with other materials, from a tensor.
#include <stdio.h>

#include "base/log.h"
#include "base/mem.h"
#include "edit_picture.h"
#include "replay/edit_change.h"
#include "replay/edit_list.h"
#include "replay/save_scene.h"
#include "replay_report.h"
#include "subcommand.h"

struct values {
    const char *script, *save, *scene;
    struct option_list tensors; // the first, and those of other lights
    struct replay_values common;
    int terms;
    bool list;
    struct option_list changes[5]; // by enum edit_kind
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {"T", AT(tensors), "tensor of `relume precompute edit`, or one for each light (--light there)",
     false, true},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(common.output),
     .argument = "OUT.exr", .help = "the picture to write", .endings = ".exr"},
    {.name = "list", .type = OPTION_FLAG, .offset = AT(list),
     .help = "print what can be edited: objects, terms, numbers and curves, as the changes\n"
             "leave them; no picture"},
    {.name = "set", .letter = 's', .type = OPTION_TEXTS, .offset = AT(changes[EDIT_SET]),
     .argument = "OBJECT.PARAM=V", .help = "a number of an object's model: its curves are made anew.\n"
     "OBJECT.TERM.scale=V is a term's factor. V: a number or R,G,B. Lobes sharper than\n"
     "the curve's J bins carry (about cos^n with n = (J / 5.2)^2) are warned of"},
    {.name = "curve", .letter = 'c', .type = OPTION_TEXTS, .offset = AT(changes[EDIT_CURVE]),
     .argument = "OBJECT.TERM.f_A=FILE.csv", .help = "a curve from a file; f_A.rg: these channels only"},
    {.name = "op", .type = OPTION_TEXTS, .offset = AT(changes[EDIT_OPERATE]),
     .argument = "OBJECT.TERM.f_A:OPERATORS", .help = "change a curve in place (see below)"},
    {.name = "light", .type = OPTION_TEXTS, .offset = AT(changes[EDIT_LIGHT]),
     .argument = "NAME=R,G,B", .help = "factor of a light that has a tensor of its own; NAME=X: of all channels"},
    {.name = "script", .type = OPTION_TEXT, .offset = AT(script), .argument = "EDITS.json",
     .help = "play an editing session after these (see below)"},
    {.name = "save-scene", .type = OPTION_TEXT, .offset = AT(save), .argument = "OUT.xml",
     .help = "write the scene with the edited materials, their curves in files beside it"},
    {.name = "scene", .type = OPTION_TEXT, .offset = AT(scene), .argument = "SCENE.xml",
     .help = "where the tensor's scene is, for --save-scene, if not where it was"},
    {.name = "terms", .type = OPTION_INT, .offset = AT(terms), .argument = "N", .min = 0,
     .max = 1 << 28, .def = "0",
     .help = "of a session: most coefficients a frame may change; 0: as the script says"},
    REPLAY_OPTIONS(struct values, common),
    OPTION_END,
};

static void more_help(void) {
    printf(
        "\nOperators on curves (angles in degrees, full effect from b to c, none outside a to d):\n"
        "  amplify-y,a,b,c,d,FACTOR[,BASE]   translate-y,a,b,c,d,WAY   values\n"
        "  amplify-x,a,b,c,d,FACTOR[,BASE]   translate-x,a,b,c,d,WAY   angles\n"
        "  several are separated by `;`\n");
    edit_session_help();
}

// ---- changes --------------------------------------------------------------------------------------

// One change of the command line.
typedef bool change_fn(void *edited, enum edit_kind kind, const char *text, const char *at);

static bool change_all(const struct values *v, change_fn *change, void *edited) {
    static const struct {
        enum edit_kind kind;
        const char *at;
    } order[] = {{EDIT_SET, "--set"}, {EDIT_CURVE, "--curve"}, {EDIT_OPERATE, "--op"},
                 {EDIT_LIGHT, "--light"}};
    bool good = true;
    for (size_t k = 0; k < sizeof order / sizeof *order; k++)
        for (size_t i = 0; i < v->changes[order[k].kind].count && good; i++)
            good = change(edited, order[k].kind, v->changes[order[k].kind].items[i], order[k].at);
    return good;
}

static bool change_picture(void *edited, enum edit_kind kind, const char *text, const char *at) {
    return edit_change(edited, kind, text, at);
}

static bool change_objects(void *edited, enum edit_kind kind, const char *text, const char *at) {
    struct edit_touch touch;
    return edit_apply(edited, kind, text, at, &touch);
}

static bool save(const struct values *v, struct edit *e) {
    const struct edit_tensor *objects = edit_objects(e);
    const char *scene = v->scene ? v->scene : json_text(json_get(objects->tensor->meta, "scene"));
    uint32_t count;
    const struct edit_light *lights = edit_lights(e, &count);
    if (scene)
        return save_scene(objects, lights, count, scene, v->save);
    log_error("%s: does not tell its scene; expected --scene", objects->path);
    return false;
}

// Tensors of the other lights join.
static bool add_lights(const struct values *v, struct tensor_file *const *files, struct edit *e,
                       struct replay_timing *timing) {
    bool good = true;
    for (size_t i = 1; i < v->tensors.count && good; i++) {
        good = edit_add(e, tensor_get(files[i]), v->tensors.items[i]);
        replay_count(tensor_get(files[i]), timing);
    }
    return good;
}

static bool evaluate(const struct values *v, struct tensor_file *const *files, struct edit_session *s,
                     const struct edit_script *script, struct json *out) {
    const size_t plane = (size_t)s->tensor->width * s->tensor->height;
    const struct edit_settings o = {
        .no_device = v->common.no_device, .threads = v->common.threads, .focus = script->focus,
        .terms = v->terms ? (uint32_t)v->terms : script->terms};
    struct edit *e = edit_create(s->tensor, v->tensors.items[0], &o);
    float *frame = mem_array(3 * plane, sizeof *frame), *variance = mem_array(plane, sizeof *frame);
    struct replay_timing timing = {0};
    bool good = e && add_lights(v, files, e, &timing) && change_all(v, change_picture, e) &&
                edit_script_play(script, e, v->script, frame, edit_session_frame, s);
    good = good && (!v->common.output || edit_picture(&v->common, s, e, frame, &timing, variance));
    good = good && (!v->save || save(v, e));
    if (good && v->common.output)
        replay_report(&v->common, &timing, out);
    edit_destroy(e);
    mem_free(frame);
    mem_free(variance);
    return good;
}

// ---- all ----------------------------------------------------------------------------------------

static bool list(const struct values *v, const struct edit_script *script, const struct tensor *t,
                 struct json *out) {
    struct edit_tensor e;
    if (!edit_tensor_init(&e, t, v->tensors.items[0]))
        return false;
    const bool good = change_all(v, change_objects, &e) && edit_script_apply(script, &e, v->script);
    if (good && v->common.json)
        edit_list(&e, out);
    else if (good)
        edit_list_print(&e);
    edit_tensor_finish(&e);
    return good;
}

static bool edit_files(const struct values *v, const char *command, struct tensor_file *const *files) {
    const struct tensor *t = tensor_get(files[0]);
    struct json *out = json_new_object();
    struct edit_session s = {v->script, v->common.output, command, t, v->common.quiet,
                             v->common.json, json_new_array()};
    struct edit_script script = {0};
    bool good = !v->script || edit_script_read(&script, v->script);
    good = good && (v->list ? list(v, &script, t, out) : evaluate(v, files, &s, &script, out));
    for (size_t i = 0; i < json_count(s.frames) && good && v->common.json; i++)
        json_print(json_at(s.frames, i), false);
    if (good && v->common.json)
        json_print(out, false);
    edit_script_finish(&script);
    json_destroy(s.frames);
    json_destroy(out);
    return good;
}

// NULL, or what is wrong with the options together.
static const char *misused(const struct values *v) {
    if (!v->list && !v->script && !v->common.output && !v->save)
        return "expected --list, -o OUT.exr, --script EDITS.json or --save-scene OUT.xml";
    if (v->list && (v->common.output || v->save))
        return "--list makes no picture and no scene; expected no -o and no --save-scene beside it";
    if (!v->common.output && (v->common.time || v->common.variance))
        return "--time and --variance go with -o OUT.exr";
    if (v->terms && !v->script)
        return "--terms goes with --script EDITS.json";
    return v->scene && !v->save ? "--scene goes with --save-scene" : NULL;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    if (misused(v)) {
        log_error("edit: %s", misused(v));
        return EXIT_USAGE;
    }
    if (v->common.quiet)
        log_set_level(LOG_WARN);
    const size_t count = v->tensors.count;
    struct tensor_file **files = mem_array(count, sizeof *files);
    bool done = true;
    for (size_t i = 0; i < count && done; i++)
        done = (files[i] = tensor_open(v->tensors.items[i])) != NULL;
    done = done && edit_files(v, command, files);
    for (size_t i = 0; i < count; i++)
        tensor_close(files[i]);
    mem_free(files);
    return done ? EXIT_DONE : EXIT_FAILED;
}

const struct subcommand subcommand_edit = {
    .entry = {.name = "edit", .help = "replay a tensor with other materials",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Makes the picture of a tensor of `relume precompute edit` with "
                               "edited materials. Without\nchanges: as the scene is.",
                .examples =
                    "  relume edit tea.safetensors --list\n"
                    "  relume edit tea.safetensors -o dull.exr --set cup.exponent=20 --time\n"
                    "  relume edit tea.safetensors -o haze.exr "
                    "--op cup.specular.f_A:amplify-y,4,8,20,30,3\n"
                    "  relume edit tea.safetensors -o last.exr --script session.json --json\n",
                .more_help = more_help},
    .run = run,
};
