// SPDX-License-Identifier: Apache-2.0
// Tables of options: values, defaults, and every kind of mistake with its message.
#include "check.h"

#include <stdint.h>
#include <string.h>

#include "base/options.h"
#include "capture.h"

struct values {
    bool flag;
    int number, size[2], crop[4], choice;
    uint64_t seed;
    double real, seconds;
    const char *text, *first;
    struct option_list defines, rest;
};

#define AT(member) offsetof(struct values, member)
static const char *const colours[] = {"red", "green", NULL};
static const struct option_spec specs[] = {
    {.name = "flag", .letter = 'f', .type = OPTION_FLAG, .offset = AT(flag), .help = "a flag"},
    {.name = "number", .letter = 'n', .type = OPTION_INT, .offset = AT(number), .argument = "N",
     .help = "a number", .def = "7", .min = 1, .max = 10},
    OPTION_GROUP("Sizes"), // in the midst of the others, and no option itself
    {.name = "size", .type = OPTION_INTS, .offset = AT(size), .argument = "WxH", .values = 2,
     .min = 1, .max = 65536, .help = "a size"},
    {.name = "crop", .type = OPTION_RECTANGLE, .offset = AT(crop), .argument = "X0,Y0,X1,Y1",
     .help = "a part"},
    {.name = "colour", .type = OPTION_CHOICE, .offset = AT(choice), .argument = "NAME",
     .choices = colours, .def = "green", .help = "a colour"},
    {.name = "seed", .type = OPTION_COUNT, .offset = AT(seed), .argument = "N", .help = "a seed"},
    {.name = "real", .type = OPTION_NUMBER, .offset = AT(real), .argument = "X", .help = "a real"},
    {.name = "time", .type = OPTION_SECONDS, .offset = AT(seconds), .argument = "T", .min = 0, .max = 3600,
     .help = "a time"},
    {.name = "text", .type = OPTION_TEXT, .offset = AT(text), .argument = "T", .help = "a text"},
    {.name = "define", .letter = 'D', .type = OPTION_TEXTS, .offset = AT(defines),
     .argument = "K=V", .help = "definitions"},
    OPTION_END,
};
static const struct option_argument arguments[] = {
    {.name = "FIRST", .offset = AT(first), .help = "the first"},
    {.name = "REST", .offset = AT(rest), .help = "the rest", .optional = true, .repeated = true},
    {.name = NULL},
};
static const struct option_table table = {.options = specs, .arguments = arguments};

enum { MOST = 24 };

// Parses the words of a line; values are for the caller to finish.
static enum options_result parse(const char *line, struct values *v) {
    static char copy[1024];
    char *argv[MOST + 1] = {(char[]){"program"}};
    int argc = 1;
    snprintf(copy, sizeof copy, "%s", line);
    for (char *w = strtok(copy, " "); w && argc < MOST; w = strtok(NULL, " "))
        argv[argc++] = w;
    *v = (struct values){0};
    capture_begin();
    const enum options_result result = options_parse(&table, argc, argv, v);
    capture_end();
    return result;
}

static void values_and_defaults_arrive(void) {
    struct values v;
    CHECK(parse("a", &v) == OPTIONS_OK);
    CHECK(!v.flag && v.number == 7 && v.choice == 1 && !v.text && strcmp(v.first, "a") == 0);
    CHECK(v.rest.count == 0 && v.defines.count == 0);
    options_finish(&table, &v);
    CHECK(parse("a -f --number=3 b --size 640x480 -D x=1 -Dy=2 --seed 18446744073709551615 "
                "--real -1.5e-3 --time 0.5h --text --odd c --colour red",
                &v) == OPTIONS_OK);
    CHECK(v.flag && v.number == 3 && v.size[0] == 640 && v.size[1] == 480 && v.choice == 0);
    CHECK(v.seed == UINT64_MAX && v.real == -1.5e-3 && v.seconds == 1800);
    CHECK(v.text && strcmp(v.text, "--odd") == 0);
    CHECK(v.defines.count == 2 && strcmp(v.defines.items[1], "y=2") == 0);
    CHECK(v.rest.count == 2 && strcmp(v.rest.items[0], "b") == 0);
    options_finish(&table, &v);
    CHECK(parse("a -n 2 -n 9 --num 4", &v) == OPTIONS_OK && v.number == 4); // the last one wins
    options_finish(&table, &v);
    CHECK(parse("a -- -f", &v) == OPTIONS_OK && !v.flag && v.rest.count == 1);
    options_finish(&table, &v);
}

static void mistakes_are_named(void) {
    static const char *const cases[][2] = {
        {"a --nmber 3", "the nearest is --number"},
        {"a --flagg", "the nearest is --flag"},
        {"a --zzzzzzzzzz", "unknown option '--zzzzzzzzzz'"},
        {"a -z", "unknown option '-z'"},
        {"a --Sizes", "the nearest is --size"},
        {"a --number", "--number: found nothing"},
        {"a -n", "--number: found nothing"},
        {"a --flag=1", "--flag takes no value"},
        {"a --number 0", "from 1 to 10"},
        {"a --number 11", "'11'"},
        {"a --number 3x", "'3x'"},
        {"a --number 99999999999", "whole number"},
        {"a --size 640", "WxH"},
        {"a --size 640x0", "WxH"},
        {"a --size 640x480x3", "WxH"},
        {"a --size 70000x2", "found '70000x2', expected WxH, whole numbers from 1 to 65536"},
        {"a --crop 0,0,0,0", "holds no pixel"},
        {"a --crop 0,5,4,5", "holds no pixel"},
        {"a --crop 0,0,4", "X0,Y0,X1,Y1"},
        {"a --colour blue", "one of red, green"},
        {"a --seed -1", "without sign"},
        {"a --real nan", "a number"},
        {"a --real 1e999", "a number"},
        {"a --time 5d", "15m"},
        {"a --time -5", "15m"},
        {"a --time 0", "found '0', expected a duration above 0 such as 90, 90s, 15m or 2h, at most 3600s"},
        {"a --time 2h", "at most 3600s"},
        {"-f", "FIRST is missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct values v;
        CHECK(parse(cases[i][0], &v) == OPTIONS_BAD);
        if (!captured_has(cases[i][1]))
            printf("%s: %s", cases[i][0], captured);
        CHECK(captured_has(cases[i][1]));
        options_finish(&table, &v);
    }
}

// What a subcommand needs to refuse options that have no effect.
static void changes_are_told(void) {
    static const char *const cases[][2] = {
        {"a -f -n 3", ""},           {"a --colour green --seed 0 --real 0", ""},
        {"a --size 2x2", "size"},    {"a --crop 0,0,1,1", "crop"},
        {"a --colour red", "colour"}, {"a --seed 4294967296", "seed"},
        {"a --real -1", "real"},     {"a --time 2m", "time"},
        {"a --text 0", "text"},      {"a -D x=1", "define"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct values v;
        CHECK(parse(cases[i][0], &v) == OPTIONS_OK);
        const char *name = options_changed(&table, "Sizes", &v);
        CHECK(strcmp(name ? name : "", cases[i][1]) == 0);
        CHECK(!options_changed(&table, "Other", &v));
        options_finish(&table, &v);
    }
}

static void help_wins(void) {
    struct values v;
    CHECK(parse("--number 3 --help", &v) == OPTIONS_HELP);
    CHECK(parse("-h", &v) == OPTIONS_HELP);
}

int main(void) {
    values_and_defaults_arrive();
    mistakes_are_named();
    changes_are_told();
    help_wins();
    return check_result();
}
