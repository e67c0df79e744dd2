// SPDX-License-Identifier: Apache-2.0
#include <stdio.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/log.h"
#include "driver/brdf.h"
#include "driver/job.h"
#include "subcommand.h"

struct brdf_options {
    const char *what, *id, *to, *plot, *angles;
    struct option_list defines;
    int kind;
    bool quiet, json;
};

enum { MOST_ANGLES = 16 };

// "0,30,60" in degrees from 0 to below 90; their number, or 0 after an error message.
static int parse_angles(const char *text, double *degrees) {
    int n = 0;
    for (const char *p = text; n < MOST_ANGLES; p++) {
        char *end;
        degrees[n] = strtod(p, &end);
        if (end == p || !(degrees[n] >= 0) || !(degrees[n] < 90) || (*end && *end != ','))
            break;
        n++;
        p = end;
        if (!*p)
            return n;
    }
    log_error("--angles %s: expected up to %d angles from 0 to below 90 degrees, as 0,30,60", text,
              MOST_ANGLES);
    return 0;
}

static void report(const struct brdf_options *o, const struct material *m) {
    struct json *out = json_new_object();
    json_add_text(out, "material", o->what);
    brdf_report(m, out);
    if (o->json)
        json_print(out, true);
    else
        json_print_lines(out);
    json_destroy(out);
}

static int run(const void *values, const char *command) {
    const struct brdf_options *o = values;
    struct material_request request = {.what = o->what, .id = o->id,
                                       .define_count = o->defines.count,
                                       .editable = o->to && brdf_wants_curves(o->to)};
    struct arena arena = {0};
    struct material m;
    double degrees[MOST_ANGLES];
    const int count = parse_angles(o->angles, degrees);
    (void)command;
    request.defines = defines_parse(&o->defines, &arena);
    int code = count && request.defines ? EXIT_FAILED : EXIT_USAGE;
    if (o->quiet)
        log_set_level(LOG_WARN);
    if (code == EXIT_FAILED && material_open(&m, &request)) {
        bool good = !o->to || brdf_convert(&m, o->to);
        good = good && (!o->plot || brdf_draw(&m, (enum brdf_plot)o->kind, degrees, count, o->plot));
        if (good && ((!o->to && !o->plot) || o->json))
            report(o, &m);
        material_close(&m);
        code = good ? EXIT_DONE : EXIT_FAILED;
    }
    arena_finish(&arena);
    return code;
}

#define AT(member) offsetof(struct brdf_options, member)
static const struct option_spec options[] = {
    {.name = "define", .letter = 'D', .type = OPTION_TEXTS, .offset = AT(defines),
     .argument = "NAME=VALUE", .help = "parameter of the model, or variable of the scene"},
    {.name = "id", .type = OPTION_TEXT, .offset = AT(id), .argument = "ID",
     .help = "which material of the scene"},
    {.name = "to", .type = OPTION_TEXT, .offset = AT(to), .argument = "OUT",
     .help = "convert: OUT.binary is a MERL table, OUT.transfer one of transfer\n"
             "probabilities, every 5 degrees of incidence; OUT.csv are its curves in\n"
             "the editable form, a file each, OUT.json all in one, for `edited`\n"
             "(measured ones become factors, for the model `halfdifference`)"},
    {.name = "plot", .type = OPTION_TEXT, .offset = AT(plot), .argument = "OUT.svg",
     .help = "draw the material, as SVG or PNG", .endings = ".svg or .png"},
    {.name = "kind", .type = OPTION_CHOICE, .offset = AT(kind), .argument = "KIND",
     .help = "of the drawing: in-plane cut or net of f cos (its cube root is the\n"
             "radius), or curve of f against the angle of the half vector", .def = "cut",
     .choices = brdf_plot_names},
    {.name = "angles", .type = OPTION_TEXT, .offset = AT(angles), .argument = "LIST",
     .help = "of the eye to the normal, in degrees, for drawings", .def = "0,30,60"},
    OPTION_QUIET(struct brdf_options, quiet),
    OPTION_JSON(struct brdf_options, json),
    OPTION_END,
};

static const struct option_argument arguments[] = {
    {.name = "MATERIAL", .offset = AT(what),
     .help = "FILE of a measured material (.binary, .bsdf, .brdf, .dat, .transfer, .xml),\n"
             "SCENE.xml, or a model's name (relume help bsdf)"},
    {.name = NULL},
};

const struct subcommand subcommand_brdf = {
    .entry = {.name = "brdf", .help = "inspect, draw and convert a material",
              .size = sizeof(struct brdf_options)},
    .options = {.options = options,
                .arguments = arguments,
                .description =
                    "Prints the albedo (of energy) for several directions of the eye and over all "
                    "of them, how\nfar the material is from reciprocal, and by how much it returns more light "
                    "than arrives.",
                .examples = "  relume brdf gold.binary\n"
                            "  relume brdf roughconductor -D material=Au -D alpha=0.2 --json\n"
                            "  relume brdf room.xml --id floor --to floor.binary\n"
                            "  relume brdf phong -D exponent=40 --to phong.csv\n"
                            "  relume brdf film.bsdf --plot film.svg --kind lobe --angles 45\n"},
    .run = run,
};
