// SPDX-License-Identifier: Apache-2.0
// relume measure: light at points, as numbers.
#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

#include "base/json.h"
#include "base/log.h"
#include "base/mem.h"
#include "driver/measure.h"
#include "driver/point_list.h"
#include "driver/stop.h"
#include "scene_options.h"
#include "subcommand.h"

enum { MOST_POINTS = 4096 }; // of a batch

static const int SPP = 1024, MOST_SPP = 1 << 28;

struct values {
    const char *scene, *integrator, *sampler;
    int spp, max_depth, seed, threads;
    double noise, efficacy;
    bool radiance, lux, candela, lenient, quiet, json;
    struct option_list defines;
};

static const struct option_argument arguments[] = {
    {"SCENE", offsetof(struct values, scene), "scene or model, as relume render takes it", false, false},
    {.name = NULL},
};

#define AT(member) offsetof(struct values, member)

static const struct option_spec options[] = {
    {.name = "radiance", .type = OPTION_FLAG, .offset = AT(radiance),
     .help = "radiance along rays, W/(sr m^2), in place of irradiance, W/m^2"},
    {.name = "lux", .type = OPTION_FLAG, .offset = AT(lux),
     .help = "illuminance, lm/m^2: luminance of the colour (Rec.709) times --efficacy"},
    {.name = "candela", .type = OPTION_FLAG, .offset = AT(candela),
     .help = "the same of radiance: luminance, cd/m^2. Implies --radiance"},
    {.name = "efficacy", .type = OPTION_NUMBER, .offset = AT(efficacy), .argument = "LM_PER_W",
     .min = 1e-6, .max = 1e6, .def = "683",
     .help = "lumens for a watt of luminance; Radiance takes 179"},
    {.name = "spp", .type = OPTION_INT, .offset = AT(spp), .argument = "N", .min = 0, .max = 1 << 28,
     .help = "samples of a point, a multiple of 16; 0: 1024, or what --noise needs", .def = "0"},
    {.name = "noise", .type = OPTION_NUMBER, .offset = AT(noise), .argument = "X", .min = 0,
     .max = 1e3,
     .help = "stop a point when its standard error is no more than X times its value\n"
             "(of the luminance); looked at every 1024 samples"},
    OPTION_INTEGRATOR(struct values, integrator),
    OPTION_SAMPLER(struct values, sampler),
    OPTION_MAX_DEPTH(struct values, max_depth),
    OPTION_SEED(struct values, seed),
    OPTION_DEFINE(struct values, defines),
    OPTION_LENIENT(struct values, lenient),
    OPTION_THREADS(struct values, threads),
    OPTION_QUIET(struct values, quiet),
    {.name = "json", .type = OPTION_FLAG, .offset = AT(json),
     .help = "print an object a line: position, direction, value, error, samples"},
    OPTION_END,
};

static bool is_photometric(const struct values *v) {
    return v->lux || v->candela;
}

static void print_head(const struct values *v) {
    if (v->quiet || v->json)
        return;
    if (is_photometric(v))
        printf("# %s\tstandard error\n", v->candela ? "cd/m^2" : "lux");
    else
        printf("# R\tG\tB [%s]\tstandard errors\n", v->radiance ? "W/(sr m^2)" : "W/m^2");
}

static void print_plain(const struct values *v, const struct meter_reading *r) {
    if (is_photometric(v))
        printf("%.7g\t%.3g\n", v->efficacy * r->luminance, v->efficacy * r->luminance_error);
    else
        printf("%.7g\t%.7g\t%.7g\t%.3g\t%.3g\t%.3g\n", r->mean[0], r->mean[1], r->mean[2],
               r->error[0], r->error[1], r->error[2]);
}

static void add_numbers(struct json *j, const char *key, const double *values, int count) {
    struct json *array = json_add_array(j, key);
    for (int i = 0; i < count; i++)
        json_append_number(array, values[i]);
}

static void print_json(const struct values *v, const struct sensor_point *p,
                       const struct measure_result *m) {
    const struct meter_reading *r = &m->reading;
    const double d[3] = {(double)p->d[0], (double)p->d[1], (double)p->d[2]};
    struct json *j = json_new_object();
    add_numbers(j, "position", p->p, 3);
    add_numbers(j, "direction", d, 3);
    if (is_photometric(v)) {
        json_add_text(j, "unit", v->candela ? "cd/m^2" : "lux");
        json_add_number(j, "value", v->efficacy * r->luminance);
        json_add_number(j, "error", v->efficacy * r->luminance_error);
    } else {
        json_add_text(j, "unit", v->radiance ? "W/(sr m^2)" : "W/m^2");
        add_numbers(j, "value", r->mean, 3);
        add_numbers(j, "error", r->error, 3);
    }
    json_add_count(j, "samples", (int64_t)m->samples);
    json_print(j, false);
    json_destroy(j);
}

// Batch after batch until the list ends.
static int measure_list(const struct values *v, struct measure *m, struct point_list *list) {
    struct sensor_point *points = mem_array(MOST_POINTS, sizeof *points);
    struct measure_result *results = mem_array(MOST_POINTS, sizeof *results);
    int code = EXIT_DONE;
    bool good = true;
    print_head(v);
    while (good) {
        const uint32_t count = point_list_read(list, points, MOST_POINTS, &good);
        if (good && count == 0)
            break;
        if (!measure_points(m, points, count, results)) {
            code = EXIT_UNCONVERGED;
            break;
        }
        for (uint32_t i = 0; i < count; i++) {
            if (v->json)
                print_json(v, &points[i], &results[i]);
            else
                print_plain(v, &results[i].reading);
            code = results[i].noisy ? EXIT_UNCONVERGED : code;
        }
        if (fflush(stdout) != 0)
            break; // main says so
    }
    mem_free(points);
    mem_free(results);
    return good ? code : EXIT_FAILED;
}

static int run_job(const struct values *v, const struct scene_define *defines) {
    struct job job;
    const struct job_options job_options = {
        .scene = v->scene, .spp = v->spp, .max_depth = v->max_depth, .seed = (uint32_t)v->seed,
        .threads = v->threads, .stop = stop_on_signals(),
        .reading = {.defines = defines, .define_count = v->defines.count, .lenient = v->lenient,
                    .integrator = v->integrator, .sampler = v->sampler, .sensorless = true}};
    const struct measure_options measuring = {
        .radiance = v->radiance || v->candela, .noise = v->noise,
        .samples = (uint64_t)(v->spp ? v->spp : v->noise > 0 ? MOST_SPP : SPP)};
    if (!job_open(&job, &job_options))
        return EXIT_FAILED;
    int code = EXIT_FAILED;
    struct measure *m = measure_create(&job, &measuring);
    if (m) {
        struct point_list *list = point_list_open(STDIN_FILENO, "standard input");
        code = measure_list(v, m, list);
        if (measure_rejected(m))
            log_warn("%" PRIu64 " samples were not finite and count as black", measure_rejected(m));
        point_list_close(list);
        measure_destroy(m);
    }
    job_close(&job);
    return code;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    (void)command;
    if (v->lux && (v->radiance || v->candela)) {
        log_error("--lux is of irradiance; expected --candela with radiance");
        return EXIT_USAGE;
    }
    if (v->quiet)
        log_set_level(LOG_WARN);
    struct arena arena = {0};
    const struct scene_define *defines = defines_parse(&v->defines, &arena);
    const int code = defines ? run_job(v, defines) : EXIT_USAGE;
    arena_finish(&arena);
    return code;
}

const struct subcommand subcommand_measure = {
    .entry = {.name = "measure", .help = "irradiance or radiance at points, with standard errors",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description =
                    "Reads points from standard input, six numbers a line: position and normal, or "
                    "with\n--radiance position and direction. Prints a line for each as soon as it "
                    "is known: red,\ngreen, blue and their standard errors, or one number and its "
                    "error with --lux or\n--candela. The scene needs no sensor. Exit code 3: some "
                    "point is noisier than --noise.",
                .examples = "  echo 0 0 0  0 1 0 | relume measure room.xml --lux\n"
                            "  cat desk.txt | relume measure room.xml --lux --noise 0.01\n"
                            "  cat views.txt | relume measure room.xml --candela --json\n"},
    .run = run,
};
