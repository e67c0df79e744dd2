// SPDX-License-Identifier: Apache-2.0
#include "base/param_text.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

bool param_takes_text(const struct param *p) {
    return param_text_size(p) > 0;
}

size_t param_text_size(const struct param *p) {
    switch (p->type) {
    case PARAM_BOOL: return sizeof(bool);
    case PARAM_INT:
    case PARAM_CHOICE: return sizeof(int);
    case PARAM_FLOAT: return sizeof(float);
    case PARAM_STRING:
    case PARAM_FILE: return sizeof(const char *);
    default: return 0;
    }
}

static bool expected(const struct param *p, const char *text, const char *what) {
    log_error("%s is \"%s\", expected %s", p->name, text, what);
    return false;
}

static bool parse_bool(const struct param *p, const char *text, bool *value) {
    *value = strcmp(text, "true") == 0;
    return *value || strcmp(text, "false") == 0 || expected(p, text, "true or false");
}

static bool parse_number(const struct param *p, const char *text, double *value) {
    const char *end = text;
    char range[96];
    const bool any = p->min == 0 && p->max == 0, whole = p->type == PARAM_INT;
    const double lo = any && whole ? INT_MIN : p->min, hi = any && whole ? INT_MAX : p->max;
    if (any && !whole)
        snprintf(range, sizeof range, "a number");
    else
        snprintf(range, sizeof range, "a%s number from %.10g to %.10g", whole ? " whole" : "", lo, hi);
    if (!text_number(&end, value) || *end || (whole && *value != floor(*value)) ||
        !(any && !whole ? *value >= -3e38 && *value <= 3e38 : *value >= lo && *value <= hi))
        return expected(p, text, range);
    return true;
}

static bool parse_choice(const struct param *p, const char *text, int *value) {
    char known[256] = "one of ";
    for (int i = 0; p->choices[i]; i++) {
        if (strcmp(p->choices[i], text) == 0) {
            *value = i;
            return true;
        }
        const size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", p->choices[i]);
    }
    return expected(p, text, known);
}

bool param_parse(const struct param *p, const char *text, void *value) {
    double number;
    if (p->type == PARAM_BOOL)
        return parse_bool(p, text, value);
    if (p->type == PARAM_CHOICE)
        return parse_choice(p, text, value);
    if (p->type == PARAM_STRING || p->type == PARAM_FILE) {
        memcpy(value, &text, sizeof text);
        return true;
    }
    if (!parse_number(p, text, &number))
        return false;
    if (p->type == PARAM_INT)
        *(int *)value = (int)number;
    else
        *(float *)value = (float)number;
    return true;
}
