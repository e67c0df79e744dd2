// SPDX-License-Identifier: Apache-2.0
#include "base/options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "base/registry.h"

enum { FIRST_LONG = 256, MOST_OPTIONS = 96 };

static size_t option_count(const struct option_table *table) {
    size_t n = 0;
    while (table->options && table->options[n].name)
        n++;
    return n;
}

static bool in_range(const struct option_spec *o, double v) {
    return isfinite(v) && ((o->min == 0 && o->max == 0) || (v >= o->min && v <= o->max));
}

static bool complain(const struct option_spec *o, const char *text, const char *kind) {
    if (o->min == 0 && o->max == 0)
        log_error("--%s: found '%s', expected %s", o->name, text, kind);
    else
        log_error("--%s: found '%s', expected %s from %.10g to %.10g", o->name, text, kind, o->min,
                  o->max);
    return false;
}

static bool parse_integer(const struct option_spec *o, const char *text, void *value) {
    char *end;
    errno = 0;
    const long long v = strtoll(text, &end, 10);
    if (end == text || *end || errno || v < INT32_MIN || v > INT32_MAX || !in_range(o, (double)v))
        return complain(o, text, "a whole number");
    *(int *)value = (int)v;
    return true;
}

static bool parse_count(const struct option_spec *o, const char *text, void *value) {
    char *end;
    errno = 0;
    const unsigned long long v = strtoull(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end || errno || !in_range(o, (double)v))
        return complain(o, text, "a whole number without sign");
    *(uint64_t *)value = v;
    return true;
}

static bool parse_number(const struct option_spec *o, const char *text, void *value) {
    char *end;
    const double v = strtod(text, &end);
    if (end == text || *end || !in_range(o, v))
        return complain(o, text, "a number");
    *(double *)value = v;
    return true;
}

static bool parse_seconds(const struct option_spec *o, const char *text, void *value) {
    char *end;
    double v = strtod(text, &end);
    const bool number = end != text;
    if (*end == 's' || *end == 'm' || *end == 'h')
        v *= *end == 'h' ? 3600 : *end == 'm' ? 60 : 1, end++;
    if (number && !*end && v > 0 && in_range(o, v)) {
        *(double *)value = v;
        return true;
    }
    char most[32] = "";
    if (o->max > 0)
        snprintf(most, sizeof most, ", at most %.10gs", o->max);
    log_error("--%s: found '%s', expected a duration above 0 such as 90, 90s, 15m or 2h%s", o->name,
              text, most);
    return false;
}

static bool parse_choice(const struct option_spec *o, const char *text, void *value) {
    char known[512] = "";
    size_t n = 0;
    for (int i = 0; o->choices[i]; i++) {
        if (strcmp(o->choices[i], text) == 0) {
            *(int *)value = i;
            return true;
        }
        if (n < sizeof known)
            n += (size_t)snprintf(known + n, sizeof known - n, "%s%s", i ? ", " : "",
                                  o->choices[i]);
    }
    log_error("--%s: found '%s', expected one of %s", o->name, text, known);
    return false;
}

static bool parse_ints(const struct option_spec *o, int count, const char *text, void *value) {
    const char *p = text;
    for (int i = 0; i < count; i++) {
        char *end;
        errno = 0;
        const long v = strtol(p, &end, 10);
        const bool last = i == count - 1;
        const bool separated = last ? *end == '\0' : *end == ',' || *end == 'x';
        if (end == p || !separated || errno || v < INT32_MIN || v > INT32_MAX ||
            !in_range(o, (double)v)) {
            char kind[64];
            snprintf(kind, sizeof kind, "%s, whole numbers", o->argument);
            return complain(o, text, kind);
        }
        ((int *)value)[i] = (int)v;
        p = end + 1;
    }
    return true;
}

static bool parse_rectangle(const struct option_spec *o, const char *text, void *value) {
    const int *c = value;
    if (!parse_ints(o, 4, text, value))
        return false;
    if (c[0] < c[2] && c[1] < c[3])
        return true;
    log_error("--%s: found '%s', which holds no pixel; expected %s with X0 below X1, Y0 below Y1",
              o->name, text, o->argument);
    return false;
}

static bool has_ending(const char *endings, const char *path) {
    char ending[16] = ".";
    file_extension(path, ending + 1, sizeof ending - 1);
    const char *found = ending[1] ? strstr(endings, ending) : NULL;
    const char after = found ? found[strlen(ending)] : '?';
    return after == ' ' || after == '\0';
}

// A picture under the name of another kind of file would take the place of what a slip named.
static bool parse_text(const struct option_spec *o, const char *text, void *value) {
    *(const char **)value = text;
    if (!o->endings || has_ending(o->endings, text))
        return true;
    log_error("--%s: found '%s', expected a name that ends in %s", o->name, text, o->endings);
    return false;
}

static void append(struct option_list *list, const char *text) {
    mem_grow(&list->items, &list->capacity, list->count + 1, sizeof *list->items);
    list->items[list->count++] = text;
}

static bool parse_value(const struct option_spec *o, const char *text, void *values) {
    void *value = (char *)values + o->offset;
    switch (o->type) {
    case OPTION_FLAG: *(bool *)value = true; return true;
    case OPTION_INT: return parse_integer(o, text, value);
    case OPTION_COUNT: return parse_count(o, text, value);
    case OPTION_NUMBER: return parse_number(o, text, value);
    case OPTION_SECONDS: return parse_seconds(o, text, value);
    case OPTION_TEXT: return parse_text(o, text, value);
    case OPTION_CHOICE: return parse_choice(o, text, value);
    case OPTION_INTS: return parse_ints(o, o->values, text, value);
    case OPTION_RECTANGLE: return parse_rectangle(o, text, value);
    case OPTION_TEXTS: append(value, text); return true;
    case OPTION_HEADING: break;
    }
    return false;
}

static void report_unknown(const struct option_table *table, const char *text) {
    char name[64] = "";
    snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
    const char *typed = name + strspn(name, "-"), *nearest = NULL;
    int best = 3 + (int)strlen(typed) / 3;
    for (size_t i = 0; i < option_count(table); i++) {
        const struct option_spec *o = &table->options[i];
        const int d = edit_distance(typed, o->name);
        if (d < best && o->type != OPTION_HEADING)
            best = d, nearest = o->name;
    }
    if (nearest)
        log_error("unknown option '%s'; the nearest is --%s (see --help)", name, nearest);
    else
        log_error("unknown option '%s' (see --help)", name);
}

static const struct option_spec *spec_of(const struct option_table *table, int code) {
    const size_t n = option_count(table);
    if (code >= FIRST_LONG && (size_t)(code - FIRST_LONG) < n)
        return &table->options[code - FIRST_LONG];
    for (size_t i = 0; i < n; i++)
        if (code != 0 && table->options[i].letter == code)
            return &table->options[i];
    return NULL;
}

// The two descriptions that getopt_long wants. The leading ':' makes it tell a missing argument
// from an unknown option; it prints nothing itself.
static void describe(const struct option_table *table, char *letters, struct option *longs) {
    const size_t n = option_count(table);
    if (n > MOST_OPTIONS) {
        log_error("a subcommand has more than %d options", MOST_OPTIONS);
        abort();
    }
    *letters++ = ':';
    for (size_t i = 0; i < n; i++) {
        const struct option_spec *o = &table->options[i];
        const bool takes = o->type != OPTION_FLAG;
        if (o->type == OPTION_HEADING)
            continue;
        *longs++ = (struct option){o->name, takes ? required_argument : no_argument, NULL,
                                   FIRST_LONG + (int)i};
        if (o->letter)
            *letters++ = o->letter;
        if (o->letter && takes)
            *letters++ = ':';
    }
    *letters++ = 'h';
    *letters = '\0';
    longs[0] = (struct option){"help", no_argument, NULL, 'h'};
    longs[1] = (struct option){0};
}

static enum options_result parse_options(const struct option_table *table, int argc, char **argv,
                                         void *values, bool *given) {
    struct option longs[MOST_OPTIONS + 2];
    char letters[2 * MOST_OPTIONS + 3];
    describe(table, letters, longs);
    opterr = 0;
    optind = 0; // GNU and musl: start anew
    for (int code; (code = getopt_long(argc, argv, letters, longs, NULL)) != -1;) {
        const struct option_spec *o = spec_of(table, code == '?' || code == ':' ? optopt : code);
        if (code == 'h' && !o)
            return OPTIONS_HELP;
        if (code == ':' && o) {
            log_error("--%s: found nothing after it, expected %s", o->name, o->argument);
            return OPTIONS_BAD;
        }
        if (code == '?' && o) {
            log_error("--%s takes no value", o->name);
            return OPTIONS_BAD;
        }
        if (!o) {
            const char letter[] = {'-', (char)optopt, '\0'};
            report_unknown(table, optopt ? letter : argv[optind - 1]);
            return OPTIONS_BAD;
        }
        if (!parse_value(o, optarg, values))
            return OPTIONS_BAD;
        given[o - table->options] = true;
    }
    return OPTIONS_OK;
}

static bool parse_arguments(const struct option_table *table, int count, char **texts,
                            void *values) {
    const struct option_argument *a = table->arguments;
    int i = 0;
    for (; a && a->name; a++) {
        void *value = (char *)values + a->offset;
        if (i == count && !a->optional) {
            log_error("%s is missing: %s (see --help)", a->name, a->help);
            return false;
        }
        if (!a->repeated && i < count)
            *(const char **)value = texts[i++];
        while (a->repeated && i < count)
            append(value, texts[i++]);
    }
    if (i < count) {
        log_error("found '%s', expected no further argument (see --help)", texts[i]);
        return false;
    }
    return true;
}

enum options_result options_parse(const struct option_table *table, int argc, char **argv,
                                  void *values) {
    bool given[MOST_OPTIONS] = {false};
    for (size_t i = 0; i < option_count(table); i++)
        if (table->options[i].def && !parse_value(&table->options[i], table->options[i].def, values))
            return OPTIONS_BAD;
    const enum options_result result = parse_options(table, argc, argv, values, given);
    if (result != OPTIONS_OK)
        return result;
    if (!parse_arguments(table, argc - optind, argv + optind, values))
        return OPTIONS_BAD;
    for (size_t i = 0; i < option_count(table); i++) {
        const struct option_spec *o = &table->options[i];
        if (o->required && !given[i]) {
            log_error("--%s %s is missing: %s (see --help)", o->name, o->argument, o->help);
            return OPTIONS_BAD;
        }
    }
    return OPTIONS_OK;
}

void options_finish(const struct option_table *table, void *values) {
    for (size_t i = 0; i < option_count(table); i++)
        if (table->options[i].type == OPTION_TEXTS)
            mem_free(((struct option_list *)((char *)values + table->options[i].offset))->items);
    for (const struct option_argument *a = table->arguments; a && a->name; a++)
        if (a->repeated)
            mem_free(((struct option_list *)((char *)values + a->offset))->items);
}

// ---- what was given -----------------------------------------------------------------------------

static bool same_text(const char *a, const char *b) {
    return a == b || (a && b && strcmp(a, b) == 0);
}

// Whether two values of the option are alike; no list has a default.
static bool same_value(const struct option_spec *o, const void *a, const void *b) {
    switch (o->type) {
    case OPTION_FLAG: return *(const bool *)a == *(const bool *)b;
    case OPTION_INT:
    case OPTION_CHOICE: return *(const int *)a == *(const int *)b;
    case OPTION_COUNT: return *(const uint64_t *)a == *(const uint64_t *)b;
    case OPTION_NUMBER:
    case OPTION_SECONDS: return memcmp(a, b, sizeof(double)) == 0;
    case OPTION_TEXT: return same_text(*(const char *const *)a, *(const char *const *)b);
    case OPTION_INTS: return memcmp(a, b, sizeof(int) * (size_t)o->values) == 0;
    case OPTION_RECTANGLE: return memcmp(a, b, 4 * sizeof(int)) == 0;
    case OPTION_TEXTS: return ((const struct option_list *)a)->count == 0;
    case OPTION_HEADING: break;
    }
    return true;
}

static bool is_default(const struct option_spec *o, const void *values) {
    enum { MOST_VALUES = 16 };
    int64_t zero[MOST_VALUES] = {0}; // room for any one value
    struct option_spec alone = *o;
    alone.offset = 0;
    if (o->def && o->type != OPTION_TEXTS)
        parse_value(&alone, o->def, zero);
    return same_value(o, (const char *)values + o->offset, zero);
}

const char *options_changed(const struct option_table *table, const char *heading,
                            const void *values) {
    bool below = false;
    for (size_t i = 0; i < option_count(table); i++) {
        const struct option_spec *o = &table->options[i];
        if (o->type == OPTION_HEADING)
            below = strcmp(o->name, heading) == 0;
        else if (below && !is_default(o, values))
            return o->name;
    }
    return NULL;
}
