// SPDX-License-Identifier: Apache-2.0
// relume study: what accuracy costs, for methods and settings.
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/progress.h"
#include "base/text.h"
#include "driver/stop.h"
#include "driver/study_report.h"
#include "scene_options.h"
#include "subcommand.h"

struct values {
    const char *scene, *directory, *reference, *target;
    int repeat, reference_spp, size[2], seed, threads;
    bool even, lenient, quiet, json;
    struct option_list factors, defines;
};

static const struct option_argument arguments[] = {
    {"SCENE", offsetof(struct values, scene), "scene (.xml, .pbrt) or model (.gltf, .glb, .obj)", false, false},
    {.name = NULL},
};

#define AT(member) offsetof(struct values, member)

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(directory), .argument = "DIR",
     .help = "folder for study.html, study.csv, study.json and the plots; is made", .required = true},
    {.name = "vary", .type = OPTION_TEXTS, .offset = AT(factors), .argument = "NAME=A,B,...",
     .help = "a setting and its values: integrator, sampler, spp, time, clamp,\n"
             "adaptive, or a parameter of an integrator or sampler\n"
             "(max-depth=2,4,8); all combinations run; one value fixes a setting", .required = true},
    {.name = "repeat", .type = OPTION_INT, .offset = AT(repeat), .argument = "N", .min = 2, .max = STUDY_MOST_RUNS,
     .def = "5", .help = "runs of each combination; 3 and more give confidence intervals"},
    {.name = "even", .type = OPTION_FLAG, .offset = AT(even),
     .help = "run settings of fewer samples more often, so that all take as many:\n"
             "where rare bright samples make the error, few runs do not meet them"},
    {.name = "reference", .type = OPTION_TEXT, .offset = AT(reference), .argument = "REF.exr",
     .help = "the truth (best with a layer `variance`); without, it is rendered"},
    {.name = "reference-spp", .type = OPTION_INT, .offset = AT(reference_spp), .argument = "N",
     .min = 0, .max = 1 << 30, .def = "0",
     .help = "samples of the reference that is rendered to DIR/reference.exr; 0: 16\n"
             "times the most of the study, at least 1024"},
    {.name = "target", .type = OPTION_TEXT, .offset = AT(target), .argument = "METRIC=X",
     .help = "name the cheapest setting with relmse, variance or bias2 at most X;\n"
             "exit 3 if there is none"},
    OPTION_SIZE(struct values, size),
    OPTION_SEED(struct values, seed),
    OPTION_DEFINE(struct values, defines),
    OPTION_LENIENT(struct values, lenient),
    OPTION_THREADS(struct values, threads),
    OPTION_QUIET(struct values, quiet),
    OPTION_JSON(struct values, json),
    OPTION_END,
};

static void update(void *user, double done, const char *note) {
    progress_update(user, done, note);
}

static bool parse_target(const char *text, struct study_options *o) {
    const char *equals = text ? strchr(text, '=') : NULL, *number = equals ? equals + 1 : "";
    if (!text)
        return true;
    for (int i = 0; equals && study_metric_names[i]; i++)
        if (strncmp(study_metric_names[i], text, (size_t)(equals - text)) == 0 &&
            strlen(study_metric_names[i]) == (size_t)(equals - text) &&
            text_number(&number, &o->target) && !*number && o->target > 0) {
            o->metric = (enum study_metric)i;
            return o->has_target = true;
        }
    log_error("--target %s: expected relmse=X, variance=X or bias2=X with X above 0", text);
    return false;
}

static int report(const struct values *v, const struct study *study) {
    if (study->point_count == 0) {
        log_error("stopped before any setting had two runs: there is nothing to write");
        return EXIT_FAILED;
    }
    if (study->noisy_reference)
        log_warn("the reference is noisy: its relMSE of %.2g is more than a fifth of the least error; "
                 "--reference-spp asks for more samples", study->reference.noise);
    if (!study_write(study))
        return EXIT_FAILED;
    if (v->json) {
        struct json *j = study_json(study);
        json_print(j, false);
        json_destroy(j);
    } else if (!v->quiet) {
        study_print(study);
    }
    if (!v->quiet)
        log_info("%s/study.html: %zu settings", v->directory, study->point_count);
    const bool missed = study->options->has_target && study->cheapest == study->point_count;
    return study->stopped || missed ? EXIT_UNCONVERGED : EXIT_DONE;
}

static int run_study(const struct values *v, const char *command, struct arena *arena) {
    struct progress progress;
    struct study_factors factors;
    struct study study;
    const struct scene_define *defines = defines_parse(&v->defines, arena);
    struct study_options o = {
        .job = {.scene = v->scene, .seed = (uint32_t)v->seed, .threads = v->threads,
                .stop = stop_on_signals(),
                .reading = {.defines = defines, .define_count = v->defines.count,
                            .width = v->size[0], .height = v->size[1], .lenient = v->lenient}},
        .factors = &factors, .repeat = v->repeat, .even = v->even, .reference = v->reference,
        .reference_spp = v->reference_spp, .directory = v->directory, .command = command,
        .version = RELUME_VERSION, .progress = update, .user = &progress};
    if (!defines || !parse_target(v->target, &o) || !study_factors_parse(&v->factors, arena, &factors))
        return EXIT_USAGE;
    progress_begin(&progress, "study", v->quiet);
    const bool ran = study_run(&o, &study);
    progress_end(&progress);
    if (!ran)
        return study.misused ? EXIT_USAGE : EXIT_FAILED;
    const int code = report(v, &study);
    study_finish(&study);
    return code;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    struct arena arena = {0};
    if (v->quiet)
        log_set_level(LOG_WARN);
    const int code = run_study(v, command, &arena);
    arena_finish(&arena);
    return code;
}

static void print_registries(void) {
    printf("\nIntegrators:\n");
    registry_print(&integrators);
    printf("\nSamplers:\n");
    registry_print(&samplers);
    printf("\nrelume help integrator path, for instance, lists the parameters of path; each that is a\n"
           "number, a truth value or a choice may be varied.\n");
}

const struct subcommand subcommand_study = {
    .entry = {.name = "study", .help = "measure what accuracy costs, for methods and settings",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Renders SCENE with every combination of settings, several times, and "
                               "compares with a\nreference. Squared bias and variance are told apart by "
                               "products of different runs.\nWrites tables and one page with plots of "
                               "error against seconds, memory and samples, fitted\nexponents and the "
                               "Pareto front. Ctrl-C writes what there is (exit code 3).",
                .examples = "  relume study scene.xml --vary sampler=independent,sobol "
                            "--vary spp=4,16,64,256 -o samplers\n"
                            "  relume study scene.xml --reference-spp 4096 --vary spp=16,64,256 "
                            "--target relmse=1e-3 -o samples\n"
                            "  relume study scene.xml --size 160x90 --vary integrator=path,direct "
                            "--vary time=0.5,1 --repeat 3 -o methods\n",
                .more_help = print_registries},
    .run = run,
};
