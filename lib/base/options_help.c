// SPDX-License-Identifier: Apache-2.0
#include "base/options.h"

#include <stdio.h>
#include <string.h>

enum { HELP_COLUMN = 26 };

// Prints a term and its explanation beside it, further lines of the explanation below.
static void print_entry(const char *term, const char *help, const char *def) {
    printf("  %-*s", HELP_COLUMN, term);
    if (strlen(term) >= HELP_COLUMN)
        printf("\n  %*s", HELP_COLUMN, "");
    for (const char *c = help; *c; c++) {
        if (*c == '\n')
            printf("\n  %*s", HELP_COLUMN, "");
        else
            putchar(*c);
    }
    if (def && *def)
        printf(" [%s]", def);
    putchar('\n');
}

static void print_option(const struct option_spec *o) {
    char term[96];
    if (o->type == OPTION_HEADING) {
        printf("\n%s:\n", o->name);
        return;
    }
    const char letter[] = {'-', o->letter ? o->letter : ' ', ',', ' ', '\0'};
    snprintf(term, sizeof term, "%s--%s%s%s", o->letter ? letter : "    ", o->name,
             o->argument ? " " : "", o->argument ? o->argument : "");
    char help[1024];
    size_t n = (size_t)snprintf(help, sizeof help, "%s", o->help);
    for (int i = 0; o->type == OPTION_CHOICE && o->choices[i] && n < sizeof help; i++)
        n += (size_t)snprintf(help + n, sizeof help - n, "%s%s", i ? ", " : ": ", o->choices[i]);
    if (o->type == OPTION_TEXTS && n < sizeof help)
        snprintf(help + n, sizeof help - n, "%s", " (may be repeated)");
    print_entry(term, help, o->def);
}

static void print_usage(const struct option_table *table, const char *program) {
    printf("usage: %s", program);
    for (const struct option_argument *a = table->arguments; a && a->name; a++)
        printf(a->optional ? " [%s%s]" : " %s%s", a->name, a->repeated ? "..." : "");
    for (const struct option_spec *o = table->options; o && o->name; o++)
        if (o->required && o->letter)
            printf(" -%c %s", o->letter, o->argument);
        else if (o->required)
            printf(" --%s %s", o->name, o->argument);
    printf(" [options]\n");
}

void options_help(const struct option_table *table, const char *program, const char *summary) {
    print_usage(table, program);
    printf("\n%s\n", summary);
    if (table->description)
        printf("\n%s\n", table->description);
    if (table->arguments && table->arguments->name)
        printf("\nArguments:\n");
    for (const struct option_argument *a = table->arguments; a && a->name; a++)
        print_entry(a->name, a->help, NULL);
    printf("\nOptions [default]:\n");
    for (const struct option_spec *o = table->options; o && o->name; o++)
        print_option(o);
    print_entry("-h, --help", "print this text", NULL);
    if (table->more_help)
        table->more_help();
    if (table->examples)
        printf("\nExamples:\n%s", table->examples);
}
