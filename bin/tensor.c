// SPDX-License-Identifier: Apache-2.0
// relume tensor: the toolbox of tensor files.
#include <string.h>

#include "base/log.h"
#include "budget.h"
#include "replay/export.h"
#include "subcommand.h"
#include "transport/tensor_remake.h"

struct values {
    const char *verb, *output, *budget;
    struct option_list files;
    int crop[4];
    int threads;
    bool half, drop_zeros, no_halves, quiet, json;
};

#define AT(member) offsetof(struct values, member)

static const struct option_argument arguments[] = {
    {"VERB", AT(verb), "info: what it holds; check: whether all of it is sound;\n"
     "merge: the mean of tensors with different seeds; crop: a part of the\n"
     "picture; requantise: other storage (--half: 16 bits; --budget; else 32);\n"
     "export: of relighting, a layer of an EXR for each coefficient", false, false},
    {"T", AT(files), "tensors", false, true},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = AT(output),
     .argument = "OUT.safetensors", .help = "the tensor to write; export: OUT.exr"},
    {.name = "crop", .type = OPTION_RECTANGLE, .offset = AT(crop), .argument = "X0,Y0,X1,Y1",
     .min = 0, .max = 65536, .help = "these pixels only; X1 and Y1 are just past the last"},
    {.name = "half", .type = OPTION_FLAG, .offset = AT(half),
     .help = "store 16 bits (bfloat16) a coefficient"},
    {.name = "budget", .type = OPTION_TEXT, .offset = AT(budget), .argument = "relmse=X",
     .help = "requantise: " BUDGET_HELP},
    {.name = "no-halves", .type = OPTION_FLAG, .offset = AT(no_halves),
     .help = "--budget: leave out the half-sums, which tell of noise"},
    {.name = "drop-zeros", .type = OPTION_FLAG, .offset = AT(drop_zeros),
     .help = "pixels whose coefficients are all zero leave the lists"},
    OPTION_THREADS(struct values, threads),
    OPTION_QUIET(struct values, quiet),
    OPTION_JSON(struct values, json),
    OPTION_END,
};

static void print(const struct values *v, struct json *out) {
    if (v->json)
        json_print(out, true);
    else
        json_print_lines(out);
}

static bool inform(const struct values *v) {
    bool good = true;
    for (size_t i = 0; i < v->files.count && good; i++) {
        struct json *out = json_new_object();
        struct tensor_file *f = tensor_open(v->files.items[i]);
        good = f != NULL;
        json_add_text(out, "file", v->files.items[i]);
        if (good) {
            tensor_describe(tensor_get(f), out);
            print(v, out);
        }
        json_destroy(out);
        tensor_close(f);
    }
    return good;
}

static bool check(const struct values *v) {
    bool good = true;
    for (size_t i = 0; i < v->files.count; i++) {
        struct tensor_file *f = tensor_open(v->files.items[i]);
        const bool sound = f && tensor_check_values(f);
        if (sound && !v->quiet)
            log_info("%s: sound", v->files.items[i]);
        good = good && sound;
        tensor_close(f);
    }
    return good;
}

static bool remake(const struct values *v, const char *command) {
    const bool requantise = strcmp(v->verb, "requantise") == 0;
    struct tensor_remake o = {
        .paths = v->files.items, .count = v->files.count, .drop_zeros = v->drop_zeros,
        .new_storage = v->half || requantise, .storage = v->half ? TENSOR_BF16 : TENSOR_F32,
        .command = command};
    struct tensor_remade r;
    for (int i = 0; i < 4; i++)
        o.crop[i] = (uint32_t)v->crop[i];
    if (!tensor_remake(&o, v->output, &r))
        return false;
    if (!v->quiet)
        log_info("%s: %llu pixels in lists (%llu dropped), %.1f MB; storage changes coefficients by at "
                 "most %.2g of the largest", v->output, (unsigned long long)r.pixels,
                 (unsigned long long)r.dropped, (double)r.bytes * 1e-6, r.worst);
    if (v->json) {
        struct json *out = json_new_object();
        json_add_text(out, "output", v->output);
        json_add_count(out, "samples", (int64_t)r.samples);
        json_add_count(out, "pixels", (int64_t)r.pixels);
        json_add_count(out, "dropped", (int64_t)r.dropped);
        json_add_count(out, "bytes", (int64_t)r.bytes);
        json_add_number(out, "worst_change", r.worst);
        json_print(out, false);
        json_destroy(out);
    }
    return true;
}

static bool export(const struct values *v, const char *command) {
    struct tensor_file *f = tensor_open(v->files.items[0]);
    const bool good = f && export_coefficients(tensor_get(f), v->files.items[0], v->output, command,
                                               RELUME_VERSION);
    tensor_close(f);
    return good;
}

static int store(const struct values *v, const char *command) {
    struct budget_run b = {.tensor = v->files.items[0], .output = v->output, .command = command,
                           .threads = v->threads, .no_halves = v->no_halves, .quiet = v->quiet,
                           .json = v->json};
    if (!budget_parse(v->budget, &b.relmse))
        return EXIT_USAGE;
    return budget_run(&b) ? EXIT_DONE : EXIT_FAILED;
}

enum verb { INFO, CHECK, MERGE, CROP, REQUANTISE, EXPORT };
static const char *const verbs[] = {"info", "check", "merge", "crop", "requantise", "export", NULL};

// NULL, or what is wrong with the options together.
static const char *misused(const struct values *v, enum verb verb) {
    const bool changes = v->half || v->drop_zeros || v->crop[2];
    if (verb <= CHECK && (v->output || changes || v->budget || v->no_halves))
        return "writes no tensor; expected no -o and nothing about storage or --crop";
    if (verb >= MERGE && !v->output)
        return "expected -o OUT";
    if (verb == MERGE && v->files.count < 2)
        return "expected two tensors or more";
    if (verb > MERGE && v->files.count != 1)
        return "expected one tensor";
    if (verb == CROP && !v->crop[2])
        return "expected --crop";
    if (verb == EXPORT && (changes || v->budget || v->no_halves))
        return "writes coefficients as they are; expected nothing about storage or --crop";
    if ((v->budget || v->no_halves) && (!v->budget || verb != REQUANTISE || changes))
        return "--budget goes with requantise, alone; --no-halves with --budget";
    return NULL;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    int verb = 0;
    while (verbs[verb] && strcmp(verbs[verb], v->verb) != 0)
        verb++;
    if (!verbs[verb]) {
        log_error("tensor %s: expected info, check, merge, crop, requantise or export", v->verb);
        return EXIT_USAGE;
    }
    const char *wrong = misused(v, (enum verb)verb);
    if (wrong) {
        log_error("tensor %s: %s", v->verb, wrong);
        return EXIT_USAGE;
    }
    if (v->quiet)
        log_set_level(LOG_WARN);
    if (v->budget)
        return store(v, command);
    const bool done = verb == INFO ? inform(v) : verb == CHECK ? check(v)
                      : verb == EXPORT ? export(v, command) : remake(v, command);
    return done ? EXIT_DONE : EXIT_FAILED;
}

const struct subcommand subcommand_tensor = {
    .entry = {.name = "tensor", .help = "inspect, check, merge, crop, requantise and export tensors",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Merging gives the exact mean of tensors of one scene that were "
                               "precomputed with\ndifferent --seed, weighted by their samples, and of ranges "
                               "(--samples) the bits of\none run over all of them.",
                .examples = "  relume tensor info tea.safetensors\n"
                            "  relume tensor check tea.safetensors\n"
                            "  relume tensor requantise tea.safetensors -o small.safetensors --half\n"
                            "  relume tensor requantise tea.safetensors -o small.safetensors --budget "
                            "relmse=1e-4\n"
                            "  relume tensor crop tea.safetensors -o part.safetensors --crop 2,2,9,8\n"
                            "  relume tensor merge tea.safetensors more.safetensors -o all.safetensors "
                            "--drop-zeros\n"
                            "  relume tensor export room.safetensors -o lights.exr\n"},
    .run = run,
};
