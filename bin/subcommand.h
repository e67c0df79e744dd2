// SPDX-License-Identifier: Apache-2.0
// A subcommand of the program: bin/NAME.c defines `const struct subcommand subcommand_NAME`, one
// line X(NAME) in bin/sub/list.h adds it. There is no algorithm in these files.
#pragma once

#include "base/options.h"
#include "base/registry.h"

enum exit_code {
    EXIT_DONE = 0,
    EXIT_FAILED = 1,      // after an error message, or a limit the user set was exceeded
    EXIT_USAGE = 2,
    EXIT_UNCONVERGED = 3, // valid output, but the stop criterion was not reached
};

struct subcommand {
    struct entry entry;          // name, one-line help, size of the struct the options fill
    struct option_table options;
    // values: the filled struct, zero where nothing was given and there is no default.
    // command: the whole command line as typed, for the attributes of what is written.
    int (*run)(const void *values, const char *command);
};

#define X(name) extern const struct subcommand subcommand_##name;
#include "sub/list.h"
#undef X

extern const struct registry subcommands;

// What `relume NAME --help` prints.
void subcommand_print_help(const struct subcommand *s);
