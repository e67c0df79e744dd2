// SPDX-License-Identifier: Apache-2.0
#include "base/registry.h"

#include <stdio.h>
#include <string.h>

static int min3(int a, int b, int c) {
    const int m = a < b ? a : b;
    return m < c ? m : c;
}

int edit_distance(const char *a, const char *b) {
    enum { MOST = 63 };
    int row[MOST + 1];
    size_t n = strlen(b);
    n = n > MOST ? MOST : n;
    for (size_t j = 0; j <= n; j++)
        row[j] = (int)j;
    for (size_t i = 0; a[i] && i < MOST; i++) {
        int diagonal = row[0];
        row[0] = (int)i + 1;
        for (size_t j = 0; j < n; j++) {
            const int above = row[j + 1];
            row[j + 1] = min3(above + 1, row[j] + 1, diagonal + (a[i] != b[j]));
            diagonal = above;
        }
    }
    return row[n];
}

void name_consider(const char *candidate, const char *answer, const char *name, int *best,
                   const char **nearest) {
    const int d = edit_distance(name, candidate);
    if (d < *best && 3 * d <= (int)strlen(candidate) + 2) {
        *best = d;
        *nearest = answer;
    }
}

static bool has_alias(const struct entry *e, const char *name) {
    for (const char *const *a = e->aliases; a && *a; a++)
        if (strcmp(*a, name) == 0)
            return true;
    return false;
}

const struct entry *registry_find(const struct registry *r, const char *name) {
    for (const struct entry *const *e = r->entries; *e; e++)
        if (strcmp((*e)->name, name) == 0 || has_alias(*e, name))
            return *e;
    return NULL;
}

const char *registry_nearest(const struct registry *r, const char *name) {
    int best = 1 << 20;
    const char *nearest = NULL;
    for (const struct entry *const *e = r->entries; *e; e++) {
        name_consider((*e)->name, (*e)->name, name, &best, &nearest);
        for (const char *const *a = (*e)->aliases; a && *a; a++)
            name_consider(*a, (*e)->name, name, &best, &nearest);
    }
    return nearest;
}

void registry_print(const struct registry *r) {
    for (const struct entry *const *e = r->entries; *e; e++)
        printf("  %-18s%s\n", (*e)->name, (*e)->help);
}

const struct param *param_find(const struct entry *e, const char *name) {
    for (const struct param *p = e->params; p && p->name; p++)
        if (strcmp(p->name, name) == 0 || (p->aka && strcmp(p->aka, name) == 0))
            return p;
    return NULL;
}

const char *param_nearest(const struct entry *e, const char *name) {
    int best = 1 << 20;
    const char *nearest = NULL;
    for (const struct param *p = e->params; p && p->name; p++)
        name_consider(p->name, p->name, name, &best, &nearest);
    return nearest;
}
