// SPDX-License-Identifier: Apache-2.0
// Command-line options of a subcommand as a table: parsing, checking and --help come from it.
//
// Values are written into a struct of the caller by offset: first every option's default `def`, as
// if it had been typed, then what the user gives; a later one wins. Strings point into argv (or
// into the table). Long options may be shortened as getopt_long has it.
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum option_type {
    OPTION_FLAG,     // bool; takes no argument
    OPTION_INT,      // int
    OPTION_COUNT,    // uint64_t, from 0
    OPTION_NUMBER,   // double
    OPTION_SECONDS,  // double: 90, 90s, 15m, 2h
    OPTION_TEXT,     // const char *; stays NULL when absent and without default
    OPTION_CHOICE,   // int: index into choices
    OPTION_INTS,     // int[values], separated by ',' or 'x': 640x480, 0,0,16,16
    OPTION_RECTANGLE, // int[4]: X0,Y0,X1,Y1 as above, X0 < X1, Y0 < Y1
    OPTION_TEXTS,    // struct option_list: may be repeated, each adds one text
    OPTION_HEADING,  // no option: --help prints the name above those that follow
};

// Texts of an option or argument that may be repeated; options_finish frees the list.
struct option_list {
    const char **items;
    size_t count, capacity;
};

struct option_spec {
    const char *name;       // long name without "--"
    char letter;            // short name, 0: none
    enum option_type type;
    size_t offset;          // of the value in the caller's struct
    const char *argument;   // placeholder in --help, as "FILE"; flags: NULL
    const char *help;       // one sentence; a newline starts another line
    const char *def;        // default as typed, shown by --help; NULL: value stays zero
    double min, max;        // range of numbers, inclusive; min == max == 0: any
    const char *const *choices; // OPTION_CHOICE: NULL-terminated names
    const char *endings;    // OPTION_TEXT: those a file's name may have, as ".svg or .png"; NULL: any
    int values;             // OPTION_INTS: how many
    bool required;
};

struct option_argument {    // a positional one
    const char *name;       // placeholder, as "SCENE"
    size_t offset;          // const char *, or struct option_list if repeated
    const char *help;
    bool optional, repeated; // none follows a repeated one, only optional ones an optional one
};

struct option_table {
    const struct option_spec *options;       // ends with OPTION_END; NULL: none
    const struct option_argument *arguments; // ends with a NULL name; NULL: none
    const char *description; // paragraph under the synopsis, or NULL
    const char *examples;    // lines, each "relume ...", or NULL
    void (*more_help)(void); // prints further sections (lists of a registry, ...), or NULL
};

#define OPTION_END {.name = NULL}
#define OPTION_GROUP(heading) {.name = heading, .type = OPTION_HEADING}

// The three that every subcommand which computes something has.
#define OPTION_THREADS(values, member)                                                             \
    {.name = "threads", .type = OPTION_INT, .offset = offsetof(values, member), .argument = "N",   \
     .help = "number of threads; 0: all processors. Results do not depend on it", .def = "0",      \
     .min = 0, .max = 4096}
#define OPTION_QUIET(values, member)                                                               \
    {.name = "quiet", .letter = 'q', .type = OPTION_FLAG, .offset = offsetof(values, member),      \
     .help = "print errors and warnings only"}
#define OPTION_JSON(values, member)                                                                \
    {.name = "json", .type = OPTION_FLAG, .offset = offsetof(values, member),                      \
     .help = "print results as JSON on standard output"}

enum options_result { OPTIONS_OK, OPTIONS_HELP, OPTIONS_BAD };

// argv[0] is skipped. OPTIONS_HELP: --help or -h was given, and nothing was checked; OPTIONS_BAD:
// after one error message that names the option, what was found and what was expected.
enum options_result options_parse(const struct option_table *table, int argc, char **argv,
                                  void *values);
void options_finish(const struct option_table *table, void *values);

// The name of an option below the heading whose value is not its default; NULL: there is none.
const char *options_changed(const struct option_table *table, const char *heading,
                            const void *values);

// Prints usage, description, arguments, options and examples on standard output.
void options_help(const struct option_table *table, const char *program, const char *summary);
