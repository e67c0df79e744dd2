// SPDX-License-Identifier: Apache-2.0
// relume SUBCOMMAND ...: finds the subcommand, fills its options and runs it.
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "subcommand.h"

#define X(name) &subcommand_##name.entry,
static const struct entry *const entries[] = {
#include "sub/list.h"
    NULL,
};
#undef X

const struct registry subcommands = {"subcommand", entries};

static void print_help(void) {
    printf("usage: relume SUBCOMMAND [arguments] [options]\n\n"
           "An offline path tracer with precomputation tools.\n\nSubcommands:\n");
    registry_print(&subcommands);
    printf("\nOptions:\n"
           "  -h, --help     print this text; relume SUBCOMMAND --help explains one subcommand\n"
           "      --version  print the version\n\n"
           "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 valid output but the stop criterion was\n"
           "not reached.\n");
}

void subcommand_print_help(const struct subcommand *s) {
    char program[64];
    snprintf(program, sizeof program, "relume %s", s->entry.name);
    options_help(&s->options, program, s->entry.help);
}

// The command line in one string, arguments with unusual characters in single quotes.
static char *join(struct arena *a, int argc, char **argv) {
    char *line = arena_strdup(a, "relume");
    for (int i = 1; i < argc; i++) {
        const bool plain = argv[i][0] && !strpbrk(argv[i], " \t\n\"'\\$`*?[]{}()<>|&;#~!");
        line = arena_printf(a, plain ? "%s %s" : "%s '%s'", line, argv[i]);
    }
    return line;
}

static int run(const struct subcommand *s, int argc, char **argv, const char *command) {
    void *values = mem_array(1, s->entry.size);
    int code = EXIT_USAGE;
    const enum options_result result = options_parse(&s->options, argc, argv, values);
    if (result == OPTIONS_OK) {
        code = s->run(values, command);
    } else if (result == OPTIONS_HELP) {
        subcommand_print_help(s);
        code = EXIT_DONE;
    }
    options_finish(&s->options, values);
    mem_free(values);
    return code;
}

static int report_unknown(const char *name) {
    const char *nearest = registry_nearest(&subcommands, name);
    if (nearest)
        log_error("unknown subcommand '%s'; the nearest is '%s' (see relume --help)", name, nearest);
    else
        log_error("unknown subcommand '%s' (see relume --help)", name);
    return EXIT_USAGE;
}

int main(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : "";
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        print_help();
        return EXIT_DONE;
    }
    if (strcmp(name, "--version") == 0) {
        printf("relume %s\n", RELUME_VERSION);
        return EXIT_DONE;
    }
    if (argc < 2) {
        log_error("no subcommand given (see relume --help)");
        return EXIT_USAGE;
    }
    const struct entry *e = registry_find(&subcommands, name);
    if (!e)
        return report_unknown(name);
    signal(SIGXFSZ, SIG_IGN); // a file that may not grow is told of like a full disk
    struct arena arena = {0};
    int code = run((const struct subcommand *)e, argc - 1, argv + 1, join(&arena, argc, argv));
    arena_finish(&arena);
    // A full disk or a closed pipe shows only when the buffer is flushed, now or earlier.
    if ((fflush(stdout) != 0 || ferror(stdout)) && code == EXIT_DONE) {
        log_error("standard output: cannot be written");
        code = EXIT_FAILED;
    }
    return code;
}
