// SPDX-License-Identifier: Apache-2.0
// relume relight: a picture under other lighting, from a tensor.
#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "replay/measure.h"
#include "replay/picture.h"
#include "replay/relight.h"
#include "replay/replay.h"
#include "replay_report.h"
#include "subcommand.h"

struct values {
    const char *tensor, *environment;
    struct replay_values common;
    double rotate;
    int terms;
    struct option_list lights;
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {"T", AT(tensor), "tensor of `relume precompute relight`", false, false},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(common.output),
     .argument = "OUT.exr",
     .help = "the picture to write", .required = true},
    {.name = "env", .letter = 'e', .type = OPTION_TEXT, .offset = AT(environment), .argument = "FILE",
     .help = "environment, latitude-longitude, in place of the scene's own"},
    {.name = "rotate", .type = OPTION_NUMBER, .offset = AT(rotate), .argument = "DEG", .min = -1e6,
     .max = 1e6, .def = "0", .help = "turn it about +y, from +z towards +x"},
    {.name = "light", .letter = 'l', .type = OPTION_TEXTS, .offset = AT(lights),
     .argument = "NAME=R,G,B", .help = "factors of a light or group (basis lights); NAME=X for all three"},
    {.name = "terms", .type = OPTION_INT, .offset = AT(terms), .argument = "N", .min = 0,
     .max = 1 << 28, .def = "0", .help = "keep the N largest terms of the lighting; 0: all"},
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

static int run(const void *values, const char *command) {
    const struct values *v = values;
    const struct relight_lighting lighting = {
        .environment = v->environment, .rotate = v->rotate, .lights = v->lights.items,
        .light_count = v->lights.count, .terms = (uint32_t)v->terms};
    if (v->common.quiet)
        log_set_level(LOG_WARN);
    struct tensor_file *f = tensor_open(v->tensor);
    if (!f)
        return EXIT_FAILED;
    const struct tensor *t = tensor_get(f);
    const size_t count = t->block_count ? t->blocks[0].coefficients : 0;
    float *weights = mem_array(3 * count, sizeof *weights);
    struct replay *r = NULL;
    bool done = relight_weights(t, v->tensor, &lighting, weights);
    if (done)
        r = replay_create(t, &(struct replay_options){.no_device = v->common.no_device,
                                                          .threads = v->common.threads});
    done = r && relight(v, command, t, r, weights);
    replay_destroy(r);
    mem_free(weights);
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
                            "  relume relight car.safetensors -o car.exr --env grace.exr --rotate 40\n"},
    .run = run,
};
