// SPDX-License-Identifier: Apache-2.0
// relume merge: the exact union of pictures that were rendered apart.
#include "driver/merge.h"
#include "driver/merge_matte.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/log.h"
#include "driver/film_head.h"
#include "image/primaries.h"
#include "sink/journal.h"
#include "subcommand.h"

struct values {
    struct option_list inputs;
    const char *output;
    int space;
    bool half, quiet, json;
};

static const struct option_argument arguments[] = {
    {"PART.exr", offsetof(struct values, inputs), "pictures with their journals beside them", false,
     true},
    {.name = NULL},
};

static const struct option_spec options[] = {
    {.name = "output", .letter = 'o', .type = OPTION_TEXT, .offset = offsetof(struct values, output),
     .argument = "OUT.exr", .help = "the picture to write, with a journal of its own",
     .endings = ".exr", .required = true},
    {.name = "colour-space", .type = OPTION_CHOICE, .offset = offsetof(struct values, space),
     .argument = "NAME", .help = "primaries of the picture, as for render, whatever those of the parts",
     .def = "rec709", .choices = image_space_names},
    {.name = "half", .type = OPTION_FLAG, .offset = offsetof(struct values, half),
     .help = "write 16-bit channels, but for numbers that name objects"},
    OPTION_QUIET(struct values, quiet),
    OPTION_JSON(struct values, json),
    OPTION_END,
};

static bool write_journal(const char *output, const struct film_union *u) {
    char path[4096];
    struct sums_node node;
    const bool is_short = film_short_block(u->film, &node);
    if (!journal_path(output, path, sizeof path))
        return false;
    struct journal *j = journal_create(path, u->head, film_sums(u->film), is_short ? &node : NULL);
    journal_close(j);
    return j != NULL;
}

// Values that the picture's numbers do not hold.
struct overflows {
    uint64_t all, half;
};

static bool write_picture(const struct values *v, const struct film_union *u, struct overflows *over) {
    struct image im = {0};
    const struct image_exr_options exr = {.half = v->half, .half_overflows = &over->half,
                                          .overflows = &over->all};
    bool written = film_image(u->film, &im);
    if (written) {
        film_head_label(u->head, u->film, film_noise(u->film), &im);
        image_from_rec709(&im, (enum image_space)v->space);
        written = merge_mattes(v->inputs.items, v->inputs.count, &im) &&
                  image_write_exr(v->output, &im, &exr);
    }
    image_finish(&im);
    return written;
}

static void report(const struct values *v, const struct film_union *u, const struct overflows *over) {
    const uint64_t samples = film_samples(u->film);
    if (film_clamped(u->film) >= 0)
        log_warn("a clamp removed %.3g %% of the picture's light (layer clamped)",
                 100 * film_clamped(u->film));
    image_warn_overflows(over->all, over->half);
    if (!v->quiet)
        log_info("%s: %zu parts, %" PRIu64 " samples per pixel", v->output, v->inputs.count, samples);
    if (v->json) {
        struct json *j = json_new_object();
        json_add_text(j, "output", v->output);
        json_add_count(j, "parts", (int64_t)v->inputs.count);
        json_add_count(j, "samples", (int64_t)samples);
        json_add_count(j, "overflows", (int64_t)over->all);
        json_add_count(j, "half_overflows", (int64_t)over->half);
        if (film_noise(u->film) >= 0)
            json_add_number(j, "noise", film_noise(u->film));
        if (film_clamped(u->film) >= 0)
            json_add_number(j, "clamped_share", film_clamped(u->film));
        json_print(j, false);
        json_destroy(j);
    }
}

// Errors of channels are those of the primaries in which they were summed.
static bool may_convert(const struct values *v, const struct film_union *u) {
    const bool may = v->space == SPACE_REC709 || film_noise(u->film) < 0;
    if (!may)
        log_error("--colour-space %s: the parts have errors of channels (layer variance), which are "
                  "those of rec709", image_space_names[v->space]);
    return may;
}

static int run(const void *values, const char *command) {
    const struct values *v = values;
    struct film_union u;
    struct overflows over = {0};
    if (v->quiet)
        log_set_level(LOG_WARN);
    if (!merge_films(&u, v->inputs.items, v->inputs.count))
        return EXIT_FAILED;
    json_add_text(u.head, "command", command);
    const bool written = may_convert(v, &u) && write_journal(v->output, &u) &&
                         write_picture(v, &u, &over);
    if (written)
        report(v, &u, &over);
    film_union_finish(&u);
    return written ? EXIT_DONE : EXIT_FAILED;
}

const struct subcommand subcommand_merge = {
    .entry = {.name = "merge", .help = "unite sample ranges, seeds and crops of one picture exactly",
              .size = sizeof(struct values)},
    .options = {.options = options, .arguments = arguments,
                .description = "Unites pictures of one scene that were rendered with --samples, "
                               "--seed or --crop, each\nwith its journal (render --samples, "
                               "--checkpoint or --resume). The result has the\nsame bits as one "
                               "run of all of it.",
                .examples = "  relume render scene.xml -o a.exr --samples 0:128\n"
                            "  relume render scene.xml -o b.exr --samples 128:256\n"
                            "  relume merge a.exr b.exr -o whole.exr\n"},
    .run = run,
};
