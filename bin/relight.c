// SPDX-License-Identifier: Apache-2.0
// relume relight: a picture under other lighting, from a tensor.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/log.h"
#include "base/mem.h"
#include "base/thread.h"
#include "image/image.h"
#include "replay/relight.h"
#include "replay/replay.h"
#include "subcommand.h"

struct values {
    const char *tensor, *output, *environment;
    double rotate;
    int terms, threads;
    bool variance, no_device, time, quiet, json;
    struct option_list lights;
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {"T", AT(tensor), "tensor of `relume precompute relight`", false, false},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(output), .argument = "OUT.exr",
     .help = "the picture to write", .required = true},
    {.name = "env", .letter = 'e', .type = OPTION_TEXT, .offset = AT(environment), .argument = "FILE",
     .help = "environment, latitude-longitude, in place of the scene's own"},
    {.name = "rotate", .type = OPTION_NUMBER, .offset = AT(rotate), .argument = "DEG", .min = -1e6,
     .max = 1e6, .def = "0", .help = "turn it about +y, from +z towards +x"},
    {.name = "light", .letter = 'l', .type = OPTION_TEXTS, .offset = AT(lights),
     .argument = "NAME=R,G,B", .help = "factors of a light or group (basis lights); NAME=X for all three"},
    {.name = "terms", .type = OPTION_INT, .offset = AT(terms), .argument = "N", .min = 0,
     .max = 1 << 28, .def = "0", .help = "keep the N largest terms of the lighting; 0: all"},
    {.name = "variance", .type = OPTION_FLAG, .offset = AT(variance),
     .help = "write what the tensor's noise makes of this lighting as layer `variance`"},
    {.name = "no-device", .type = OPTION_FLAG, .offset = AT(no_device), .help = "do without OpenCL"},
    {.name = "time", .type = OPTION_FLAG, .offset = AT(time),
     .help = "measure: seconds per frame and bytes per second"},
    OPTION_THREADS(struct values, threads),
    OPTION_QUIET(struct values, quiet),
    OPTION_JSON(struct values, json),
    OPTION_END,
};

// The picture, as layers R G B and variance.Y.
static bool write_picture(const struct values *v, const char *command, const struct tensor *t,
                          const float *frame, const float *variance) {
    struct image im;
    const size_t plane = (size_t)t->width * t->height;
    const int channels = variance ? 4 : 3;
    if (!image_init(&im, (int)t->width, (int)t->height, channels))
        return false;
    for (size_t i = 0; i < plane; i++) {
        for (size_t k = 0; k < 3; k++)
            im.pixels[i * (size_t)channels + k] = frame[k * plane + i];
        if (variance)
            im.pixels[i * (size_t)channels + 3] = variance[i];
    }
    if (variance)
        snprintf(im.channel_names[3], IMAGE_NAME_SIZE, "variance.Y");
    image_set_text(&im, "relume.command", command);
    image_set_text(&im, "relume.version", RELUME_VERSION);
    image_set_text(&im, "relume.colourSpace", "linear Rec.709");
    const bool written = image_write_exr(v->output, &im, NULL);
    image_finish(&im);
    return written;
}

struct timing {
    double first, product, frame; // seconds; product and frame: medians
    uint64_t bytes;               // read by a product
};

enum { REPEATS = 15 };

static int by_value(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double *values, size_t n) {
    qsort(values, n, sizeof *values, by_value);
    return values[n / 2];
}

static bool measure(struct replay *r, const struct tensor *t, const float *weights, float *frame,
                    struct timing *m) {
    double product[REPEATS], whole[REPEATS];
    for (int i = 0; i < REPEATS; i++) {
        const double start = time_seconds();
        if (!replay_product(r, 0, weights) || !replay_wait(r))
            return false;
        product[i] = time_seconds() - start;
        if (!replay_frame(r, NULL, frame))
            return false;
        whole[i] = time_seconds() - start;
    }
    m->product = median(product, REPEATS);
    m->frame = median(whole, REPEATS);
    m->bytes = tensor_bytes(&t->blocks[0]);
    return true;
}

static void report(const struct values *v, const struct tensor *t, struct replay *r,
                   const struct timing *m, double noise) {
    const double gb = (double)m->bytes * 1e-9;
    if (!v->quiet)
        log_info("%s: %u coefficients on %s, first frame %.1f ms, noise %.2f %%", v->output,
                 t->blocks[0].coefficients, replay_device(r), m->first * 1e3, noise * 100);
    if (!v->quiet && v->time)
        log_info("product %.2f ms (%.1f GB/s), frame %.2f ms", m->product * 1e3, gb / m->product,
                 m->frame * 1e3);
    if (v->json) {
        struct json *j = json_new_object();
        json_add_text(j, "output", v->output);
        json_add_text(j, "device", replay_device(r));
        json_add_count(j, "pixels", (int64_t)t->blocks[0].pixel_count);
        json_add_count(j, "coefficients", t->blocks[0].coefficients);
        json_add_number(j, "noise", noise);
        json_add_number(j, "first_frame_seconds", m->first);
        if (v->time) {
            json_add_count(j, "bytes", (int64_t)m->bytes);
            json_add_number(j, "product_seconds", m->product);
            json_add_number(j, "frame_seconds", m->frame);
            json_add_number(j, "gigabytes_per_second", gb / m->product);
        }
        json_print(j, false);
        json_destroy(j);
    }
}

// Root of the mean of relative variances: what `render` calls noise.
static double noise_of(const struct tensor *t, const float *frame, const float *variance) {
    const size_t plane = (size_t)t->width * t->height;
    double mean = 0, sum = 0;
    for (size_t i = 0; i < 3 * plane; i++)
        mean += (double)frame[i] / (3 * (double)plane);
    for (size_t i = 0; i < plane; i++) {
        const double b = ((double)frame[i] + (double)frame[plane + i] + (double)frame[2 * plane + i]) / 3;
        const double scale = b * b + 1e-3 * mean * mean;
        sum += scale > 0 ? (double)variance[i] / scale / (double)plane : 0;
    }
    return sqrt(sum);
}

static bool relight(const struct values *v, const char *command, const struct tensor *t,
                    struct replay *r, const float *weights) {
    const size_t plane = (size_t)t->width * t->height;
    float *frame = mem_array(3 * plane, sizeof *frame), *variance = mem_array(plane, sizeof *variance);
    struct timing m = {0};
    const double start = time_seconds();
    bool done = replay_product(r, 0, weights) && replay_frame(r, NULL, frame);
    m.first = time_seconds() - start;
    done = done && (!v->time || measure(r, t, weights, frame, &m));
    if (done) {
        replay_variance(r, &weights, NULL, variance);
        done = write_picture(v, command, t, frame, v->variance ? variance : NULL);
    }
    if (done)
        report(v, t, r, &m, noise_of(t, frame, variance));
    mem_free(frame);
    mem_free(variance);
    return done;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    const struct relight_lighting lighting = {
        .environment = v->environment, .rotate = v->rotate, .lights = v->lights.items,
        .light_count = v->lights.count, .terms = (uint32_t)v->terms};
    if (v->quiet)
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
        r = replay_create(t, &(struct replay_options){v->no_device, v->threads});
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
