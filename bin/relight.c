// SPDX-License-Identifier: Apache-2.0
// relume relight: a picture under other lighting, from a tensor.
#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "replay/measure.h"
#include "replay/picture.h"
#include "replay/relight.h"
#include "replay/replay.h"
#include "replay/save_lights.h"
#include "relight_frames.h"
#include "replay_report.h"
#include "subcommand.h"

struct values {
    const char *tensor, *environment, *save, *scene;
    struct replay_values common;
    double rotate, turn;
    int terms, frames;
    struct option_list lights;
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {"T", AT(tensor), "tensor of `relume precompute relight`", false, false},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(common.output),
     .argument = "OUT.exr", .help = "the picture to write", .endings = ".exr"},
    {.name = "env", .letter = 'e', .type = OPTION_TEXT, .offset = AT(environment), .argument = "FILE",
     .help = "environment, latitude-longitude, in place of the scene's own"},
    {.name = "rotate", .type = OPTION_NUMBER, .offset = AT(rotate), .argument = "DEG", .min = -1e6,
     .max = 1e6, .def = "0", .help = "turn the environment about +y, from +z towards +x"},
    {.name = "light", .letter = 'l', .type = OPTION_TEXTS, .offset = AT(lights),
     .argument = "NAME=R,G,B", .help = "factors of a light or group (basis lights); NAME=X for all three"},
    {.name = "terms", .type = OPTION_INT, .offset = AT(terms), .argument = "N", .min = 0,
     .max = 1 << 28, .def = "0",
     .help = "keep the N largest terms of the lighting; 0: all. With --frames: change N\n"
             "terms a frame, those that matter most"},
    {.name = "frames", .type = OPTION_INT, .offset = AT(frames), .argument = "N", .min = 0,
     .max = 9999, .def = "0",
     .help = "pictures OUT.0001.exr to OUT.N.exr of the environment as it turns;\n"
             "their seconds are told by each"},
    {.name = "turn", .type = OPTION_NUMBER, .offset = AT(turn), .argument = "DEG", .min = -360,
     .max = 360, .help = "from each of them to the next; 0: 5", .def = "0"},
    {.name = "save-scene", .type = OPTION_TEXT, .offset = AT(save), .argument = "OUT.xml",
     .help = "write the scene with this lighting"},
    {.name = "scene", .type = OPTION_TEXT, .offset = AT(scene), .argument = "SCENE.xml",
     .help = "where the tensor's scene is, for --save-scene, if not where it was"},
    REPLAY_OPTIONS(struct values, common),
    OPTION_END,
};

struct evaluation {
    struct replay *replay;
    const float *weights;
    float *frame;
};

static bool product(void *ctx) {
    const struct evaluation *e = ctx;
    return replay_product(e->replay, 0, e->weights) && replay_wait(e->replay);
}

static bool compose(void *ctx) {
    const struct evaluation *e = ctx;
    return replay_frame(e->replay, NULL, e->frame);
}

static bool relight(const struct values *v, const char *command, const struct tensor *t,
                    struct replay *r, const float *weights) {
    const size_t plane = (size_t)t->width * t->height;
    float *frame = mem_array(3 * plane, sizeof *frame), *variance = mem_array(plane, sizeof *variance);
    struct evaluation e = {r, weights, frame};
    struct replay_timing m = {.device = replay_device(r), .bytes = tensor_bytes(&t->blocks[0])};
    const double start = time_seconds();
    bool done = product(&e) && compose(&e);
    m.first = time_seconds() - start;
    replay_count(t, &m);
    done = done && (!v->common.time ||
                    replay_measure(&(struct replay_measured){product, compose, &e}, &m));
    if (done) {
        replay_variance(r, &weights, NULL, variance);
        m.noise = measure_noise(t, frame, variance);
        done = picture_write(v->common.output, t, frame, v->common.variance ? variance : NULL,
                             command, RELUME_VERSION);
    }
    if (done) {
        struct json *j = json_new_object();
        replay_report(&v->common, &m, j);
        if (v->common.json)
            json_print(j, false);
        json_destroy(j);
    }
    mem_free(frame);
    mem_free(variance);
    return done;
}

static bool save(const struct values *v, const struct tensor *t, const struct relight_lighting *l) {
    const char *scene = v->scene ? v->scene : json_text(json_get(t->meta, "scene"));
    if (scene)
        return save_lights(l, t->meta, scene, v->save);
    log_error("%s: does not tell its scene; expected --scene", v->tensor);
    return false;
}

// What was asked for of a lighting.
static bool relight_file(const struct values *v, const char *command, const struct tensor *t) {
    struct relight_lighting lighting = {
        .environment = v->environment, .rotate = v->rotate, .lights = v->lights.items,
        .light_count = v->lights.count, .terms = v->frames ? 0 : (uint32_t)v->terms};
    const struct relight_frames frames = {
        .tensor = t, .path = v->tensor, .output = v->common.output, .command = command,
        .count = v->frames, .terms = (uint32_t)v->terms, .turn = v->turn != 0 ? v->turn : 5,
        .no_device = v->common.no_device, .threads = v->common.threads, .quiet = v->common.quiet,
        .json = v->common.json};
    const size_t count = t->block_count ? t->blocks[0].coefficients : 0;
    float *weights = mem_array(3 * count, sizeof *weights);
    bool done = relight_weights(t, v->tensor, &lighting, weights);
    if (done && v->common.output && !v->frames) {
        struct replay *r = replay_create(t, &(struct replay_options){
            .no_device = v->common.no_device, .threads = v->common.threads});
        done = r && relight(v, command, t, r, weights);
        replay_destroy(r);
    }
    done = done && (!v->frames || relight_frames_write(&frames, &lighting));
    done = done && (!v->save || save(v, t, &lighting));
    mem_free(weights);
    return done;
}

// NULL, or what is wrong with the options together.
static const char *misused(const struct values *v) {
    const bool frames = v->frames > 0;
    if (!v->common.output && !v->save)
        return "expected -o OUT.exr or --save-scene OUT.xml";
    if (!v->common.output && (frames || v->common.time || v->common.variance))
        return "--frames, --time and --variance go with -o OUT.exr";
    if (!frames && v->turn != 0)
        return "--turn goes with --frames; --rotate turns a single picture";
    if (frames && (v->common.time || v->common.variance || v->save))
        return "--time, --variance and --save-scene are of one picture, without --frames";
    return v->scene && !v->save ? "--scene goes with --save-scene" : NULL;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    if (misused(v)) {
        log_error("relight: %s", misused(v));
        return EXIT_USAGE;
    }
    if (v->common.quiet)
        log_set_level(LOG_WARN);
    struct tensor_file *f = tensor_open(v->tensor);
    const bool done = f && relight_file(v, command, tensor_get(f));
    tensor_close(f);
    return done ? EXIT_DONE : EXIT_FAILED;
}

const struct subcommand subcommand_relight = {
    .entry = {.name = "relight", .help = "replay a tensor under other lighting",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Makes the picture of a tensor of `relume precompute relight` under "
                               "other lighting, with all\nthe interreflection that was traced into "
                               "it. Without options: under the scene's own.",
                .examples = "  relume relight room.safetensors -o evening.exr --light lamp=3,2,1 "
                            "--light sky=0.1\n"
                            "  relume relight car.safetensors -o car.exr --env grace.exr --rotate 40\n"
                            "  relume relight car.safetensors -o turn.exr --env grace.exr --frames 3 "
                            "--terms 100\n"},
    .run = run,
};
