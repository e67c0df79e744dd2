// SPDX-License-Identifier: Apache-2.0
#include "scene/language.h"

#include <stdio.h>
#include <string.h>

#include "scene/params.h"

enum { COLUMN = 24 };

static const char *takes(enum param_type type) {
    switch (type) {
    case PARAM_BOOL: return "true or false";
    case PARAM_INT: return "whole number";
    case PARAM_FLOAT: return "number";
    case PARAM_CHOICE: return "one of";
    case PARAM_STRING: return "text";
    case PARAM_FILE: return "file";
    case PARAM_POINT: return "point";
    case PARAM_VECTOR: return "vector";
    case PARAM_TRANSFORM: return "transform";
    case PARAM_REFLECTANCE:
    case PARAM_EMISSION:
    case PARAM_INDEX: return "colour, spectrum or number";
    case PARAM_TEXTURE:
    case PARAM_TEXTURE_EMISSION: return "colour, spectrum, number or texture";
    case PARAM_TEXTURE_SCALAR: return "number or texture";
    case PARAM_IOR: return "number or material";
    case PARAM_BSDF: return "bsdf";
    case PARAM_INTEGRATOR: return "integrator";
    case PARAM_VOLUME: return "colour, spectrum, number or volume";
    case PARAM_PHASE: return "phase";
    case PARAM_IGNORED: return "";
    }
    return "";
}

static void print_param(const struct param *p) {
    const char *gap = strlen(p->name) < (size_t)COLUMN ? "" : " ";
    printf("  %-*s%s%s", COLUMN, p->name, gap, takes(p->type));
    for (int i = 0; p->type == PARAM_CHOICE && p->choices[i]; i++)
        printf("%s%s", i ? ", " : " ", p->choices[i]);
    if (p->min != 0 || p->max != 0)
        printf(" from %g to %g", p->min, p->max);
    if (p->unit && *p->unit)
        printf(" (%s)", p->unit);
    if (p->type == PARAM_TRANSFORM)
        printf(" [identity]");
    else if (p->def)
        printf(" [%s]", p->def);
    else
        printf(p->optional ? ", may be absent" : ", required");
    if (p->aka)
        printf("; also called %s", p->aka);
    if (p->help && *p->help)
        printf("\n  %*s%s", COLUMN, "", p->help);
    putchar('\n');
}

static bool has_params(const struct entry *e, bool ignored) {
    for (const struct param *p = e->params; p && p->name; p++)
        if ((p->type == PARAM_IGNORED) == ignored)
            return true;
    return false;
}

static void print_ignored(const struct entry *e) {
    printf("\nAccepted without effect:\n");
    for (const struct param *p = e->params; p->name; p++)
        if (p->type == PARAM_IGNORED && p->help && *p->help)
            printf("  %-*s%s\n", COLUMN, p->name, p->help);
        else if (p->type == PARAM_IGNORED)
            printf("  %s\n", p->name);
}

// What stands in an example where the table has no default; out has room for a number.
static const char *placeholder(const struct param *p, char out[32]) {
    switch (p->type) {
    case PARAM_FILE: return "FILE";
    case PARAM_STRING: return "TEXT";
    case PARAM_BSDF: return "diffuse";
    case PARAM_INTEGRATOR: return "path";
    case PARAM_PHASE: return "isotropic";
    case PARAM_POINT:
    case PARAM_VECTOR: return "0 0 1";
    default: snprintf(out, 32, "%g", p->min > 1 ? p->min : 1); return out;
    }
}

static void print_example_param(const struct param *p) {
    char number[32];
    const bool needs_texture = !p->def && param_is_texture(p->type);
    const char *value = needs_texture ? "checkerboard" : p->def ? p->def : placeholder(p, number);
    const char *tag = needs_texture                      ? "texture"
                      : p->type == PARAM_TEXTURE_SCALAR ? "float"
                                                        : param_tag(p, value);
    const bool object = needs_texture || p->type == PARAM_BSDF || p->type == PARAM_INTEGRATOR ||
                        p->type == PARAM_PHASE || strcmp(tag, "spectrum") == 0;
    printf("    <%s name=\"%s\"", tag, p->name);
    if (p->type != PARAM_TRANSFORM)
        printf(" %s=\"%s\"", object ? "type" : "value", value);
    printf("/>\n");
}

static void print_example(const char *element, const struct entry *e) {
    bool empty = true;
    for (const struct param *p = e->params; p && p->name; p++)
        empty &= p->type == PARAM_IGNORED || p->optional;
    printf("\nIn a scene, with defaults:\n\n");
    printf("<%s type=\"%s\"%s>\n", element, e->name, empty ? "/" : "");
    for (const struct param *p = e->params; p && p->name; p++)
        if (p->type != PARAM_IGNORED && !p->optional)
            print_example_param(p);
    if (!empty)
        printf("</%s>\n", element);
}

void scene_print_entry(const char *element, const struct entry *e) {
    printf("<%s type=\"%s\">: %s\n", element, e->name, e->help);
    if (e->aliases && *e->aliases)
        printf("\nOther names:");
    for (const char *const *a = e->aliases; a && *a; a++)
        printf("%s %s", a == e->aliases ? "" : ",", *a);
    if (e->aliases && *e->aliases)
        putchar('\n');
    if (has_params(e, false))
        printf("\nParameters [default]:\n");
    for (const struct param *p = e->params; p && p->name; p++)
        if (p->type != PARAM_IGNORED)
            print_param(p);
    if (has_params(e, true))
        print_ignored(e);
    print_example(element, e);
}
