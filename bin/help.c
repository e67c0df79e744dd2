// SPDX-License-Identifier: Apache-2.0
// relume help: what a scene may hold, from the tables that the scene reader goes by.
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "driver/job.h"
#include "help_materials.h"
#include "mesh/mesh.h"
#include "phase/phase.h"
#include "scene/language.h"
#include "subcommand.h"

struct kind {
    struct entry entry;
    const char *element; // in a scene file
    const struct registry *registry; // NULL: materials by name
};

static const char *const light_aliases[] = {"emitter", NULL};
static const char *const filter_aliases[] = {"rfilter", NULL};

#define KIND(name, help, element, registry) {{name, help, NULL, NULL, 0}, element, registry}
static const struct kind kinds[] = {
    KIND("shape", "surfaces, and groups of them", "shape", &scene_shapes),
    KIND("mesh", "shapes that are files", "shape", &mesh_readers),
    KIND("bsdf", "materials of surfaces", "bsdf", &bsdfs),
    KIND("texture", "values that vary over a surface", "texture", &textures),
    {{"light", "sources of light", light_aliases, NULL, 0}, "emitter", &lights},
    KIND("sensor", "cameras", "sensor", &sensors),
    KIND("medium", "what fills the space between surfaces", "medium", &media),
    KIND("phase", "how media scatter, inside a medium", "phase", &phases),
    KIND("volume", "values that vary in space, inside a medium", "volume", &volumes),
    KIND("film", "the picture, inside a sensor", "film", &scene_films),
    {{"filter", "reconstruction filters, inside a film", filter_aliases, NULL, 0}, "rfilter",
     &filters},
    KIND("sampler", "random numbers, inside a sensor", "sampler", &samplers),
    KIND("integrator", "methods of rendering", "integrator", &integrators),
    KIND("spectrum", "colours by wavelength", "spectrum", &scene_spectra),
    KIND("format", "scenes of other programs", NULL, &scene_formats),
    KIND("material", "indices of refraction by name", NULL, NULL),
    KIND("subcommand", "what the program does", NULL, &subcommands),
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const struct entry *const kind_entries[] = {
    &kinds[0].entry, &kinds[1].entry, &kinds[2].entry, &kinds[3].entry,  &kinds[4].entry,
    &kinds[5].entry, &kinds[6].entry, &kinds[7].entry, &kinds[8].entry,  &kinds[9].entry,
    &kinds[10].entry, &kinds[11].entry, &kinds[12].entry, &kinds[13].entry, &kinds[14].entry,
    &kinds[15].entry, &kinds[16].entry, NULL};
_Static_assert(sizeof kind_entries / sizeof *kind_entries == KINDS + 1, "a kind is not listed");
static const struct registry kind_registry = {"kind", kind_entries};

static void print_names(const struct registry *r) {
    enum { WIDTH = 90 };
    int column = 0;
    for (const struct entry *const *e = r->entries; *e; e++) {
        if (column + (int)strlen((*e)->name) > WIDTH)
            column = 0, putchar('\n');
        column += printf("%s%s", column ? " " : "  ", (*e)->name);
    }
    putchar('\n');
}

static void print_overview(void) {
    printf("usage: relume help [KIND [NAME]]\n");
    for (int i = 0; i < KINDS; i++) {
        printf("\n%s: %s\n", kinds[i].entry.name, kinds[i].entry.help);
        if (kinds[i].registry)
            print_names(kinds[i].registry);
        else
            printf("  see relume help %s\n", kinds[i].entry.name);
    }
}

static void print_kind(const struct kind *k) {
    if (!k->registry) {
        help_list_materials();
        return;
    }
    printf("%s: %s\n\n", k->entry.name, k->entry.help);
    registry_print(k->registry);
    printf("\nrelume help %s NAME explains one of them.\n", k->entry.name);
}

// What the tests hold a material to.
static void print_claims(const struct bsdf_type *type) {
    static const char *const claims[] = {"it is reciprocal", "it scatters no more than arrives",
                                         "without colour it scatters all that arrives"};
    printf("\nClaims, which the tests check:");
    for (int i = 0; i < 3; i++)
        if (type->claims >> i & 1)
            printf("%s %s", type->claims & ((1u << i) - 1) ? ";" : "", claims[i]);
    printf(type->claims ? "\n" : " none\n");
}

static void explain(const struct kind *k, const struct entry *e) {
    if (k->registry == &scene_formats) {
        scene_print_format(e);
    } else if (k->registry == &subcommands) {
        subcommand_print_help((const struct subcommand *)(const void *)e);
    } else if (k->registry == &mesh_readers) {
        struct entry shape = *e;
        shape.params = scene_mesh_params(e);
        scene_print_entry(k->element, &shape);
    } else {
        scene_print_entry(k->element, e);
    }
    if (k->registry == &bsdfs)
        print_claims((const struct bsdf_type *)(const void *)e);
}

static int report_unknown(const char *kind, const char *name, const char *nearest) {
    if (nearest)
        log_error("unknown %s '%s'; the nearest is '%s' (see relume help)", kind, name, nearest);
    else
        log_error("unknown %s '%s' (see relume help)", kind, name);
    return EXIT_USAGE;
}

// A single word: a kind, or an entry of any kind.
static int explain_word(const char *word) {
    const struct kind *k = (const void *)registry_find(&kind_registry, word);
    if (k) {
        print_kind(k);
        return EXIT_DONE;
    }
    const char *nearest = registry_nearest(&kind_registry, word);
    int found = 0;
    for (int i = 0; i < KINDS; i++) {
        const struct registry *r = kinds[i].registry;
        const struct entry *e = r ? registry_find(r, word) : NULL;
        if (e && found++)
            putchar('\n');
        if (e)
            explain(&kinds[i], e);
        if (!nearest && r)
            nearest = registry_nearest(r, word);
    }
    return found ? EXIT_DONE : report_unknown("kind or name", word, nearest);
}

// An entry of the kind, or of another that is the same element of a scene: a mesh is a shape.
static const struct entry *find_entry(const struct kind **k, const char *name) {
    const struct entry *e = registry_find((*k)->registry, name);
    for (int i = 0; !e && (*k)->element && i < KINDS; i++)
        if (kinds[i].element && strcmp(kinds[i].element, (*k)->element) == 0 &&
            (e = registry_find(kinds[i].registry, name)))
            *k = &kinds[i];
    return e;
}

struct help_options {
    const char *kind, *name;
};

static int run(const void *values, const char *command) {
    const struct help_options *o = values;
    (void)command;
    if (!o->kind) {
        print_overview();
        return EXIT_DONE;
    }
    if (!o->name)
        return explain_word(o->kind);
    const struct kind *k = (const void *)registry_find(&kind_registry, o->kind);
    if (!k)
        return report_unknown("kind", o->kind, registry_nearest(&kind_registry, o->kind));
    if (!k->registry)
        return help_material(o->name)
                   ? EXIT_DONE
                   : report_unknown("material", o->name, help_nearest_material(o->name));
    const struct entry *e = find_entry(&k, o->name);
    if (!e)
        return report_unknown(k->entry.name, o->name, registry_nearest(k->registry, o->name));
    explain(k, e);
    return EXIT_DONE;
}

static const struct option_spec options[] = {OPTION_END};

static const struct option_argument arguments[] = {
    {.name = "KIND", .offset = offsetof(struct help_options, kind), .optional = true,
     .help = "shape, mesh, bsdf, texture, light, sensor, medium, phase, volume, film, filter,\n"
             "sampler, integrator, spectrum, format, material or subcommand; or the name of\n"
             "an entry of one of these"},
    {.name = "NAME", .offset = offsetof(struct help_options, name), .optional = true,
     .help = "an entry of that kind"},
    {.name = NULL},
};

const struct subcommand subcommand_help = {
    .entry = {.name = "help", .help = "explain what a scene may hold, and the subcommands",
              .size = sizeof(struct help_options)},
    .options = {.options = options,
                .arguments = arguments,
                .description = "Without KIND: all kinds and their names. With KIND: its entries. "
                               "With NAME: its parameters,\nwhat they take, their units, ranges "
                               "and defaults, and how it stands in a scene.",
                .examples = "  relume help bsdf\n"
                            "  relume help bsdf roughconductor\n"
                            "  relume help render\n"},
    .run = run,
};
