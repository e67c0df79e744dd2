// SPDX-License-Identifier: Apache-2.0
#include "mesh/ply_attribute.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"

// Endings of the components of one attribute.
static const char *const endings[] = {"xyzw", "rgba", "0123", "1234"};

static bool group_colour(const char *path, const struct ply_header *h, const struct ply_element *e,
                         const char *prefix, bool *used, struct ply_attribute *out) {
    static const char *const names[2][4] = {{"r", "g", "b", "a"},
                                            {"red", "green", "blue", "alpha"}};
    for (int i = 0; i < 2; i++) {
        int c[4];
        for (int k = 0; k < 4; k++)
            c[k] = ply_find_property(h, e, names[i][k], false);
        if (c[0] < 0 || c[1] < 0 || c[2] < 0 || used[c[0]] || used[c[1]] || used[c[2]])
            continue;
        *out = (struct ply_attribute){.channels = 3, .property = {c[0], c[1], c[2]}};
        snprintf(out->name, sizeof out->name, "%scolor", prefix);
        for (int k = 0; k < 4; k++)
            if (c[k] >= 0)
                used[c[k]] = true;
        if (c[3] >= 0)
            log_warn("%s: %s of element %s is skipped, colours have three components", path,
                     names[i][3], e->name);
        return true;
    }
    return false;
}

// Length of the name before "_" and one more character, or 0.
static size_t stem(const char *name) {
    const char *underscore = strrchr(name, '_');
    return underscore && underscore[1] && !underscore[2] ? (size_t)(underscore - name) : 0;
}

// Number of neighbours from property i on that are components of one attribute; 0: none.
static int run_length(const struct ply_header *h, const struct ply_element *e, const bool *used,
                      int i, const char *ending) {
    const char *name = h->properties[i].name;
    const size_t n = stem(name);
    int k = 0;
    for (; n && k < 4 && i + k < e->first + e->property_count; k++) {
        const struct ply_property *q = &h->properties[i + k];
        if (used[i + k] || q->count_type != PLY_NONE || strncmp(q->name, name, n + 1) != 0 ||
            q->name[n + 1] != ending[k] || q->name[n + 2])
            break;
    }
    return k;
}

static void group_neighbours(const char *path, const struct ply_header *h,
                             const struct ply_element *e, const char *prefix, bool *used, int i,
                             struct ply_attribute *out) {
    const char *name = h->properties[i].name;
    int count = 0;
    size_t kind = 0;
    for (size_t j = 0; count == 0 && j < sizeof endings / sizeof *endings; j++) {
        kind = j;
        count = run_length(h, e, used, i, endings[j]);
    }
    if (count > 3)
        log_warn("%s: %s of element %s is skipped, attributes have at most three components",
                 path, h->properties[i + 3].name, e->name);
    *out = (struct ply_attribute){.channels = count == 0 ? 1 : count > 3 ? 3 : count,
                                  .plain = count == 0};
    for (int k = 0; k < 3; k++)
        out->property[k] = i + k;
    const size_t n = count ? stem(name) : strlen(name);
    const int length = snprintf(out->name, sizeof out->name, "%s%.*s%s", prefix, (int)n, name,
                                count && kind == 1 ? "_color" : "");
    if ((size_t)length >= sizeof out->name)
        log_warn("%s: the name of attribute %s is cut", path, out->name);
    for (int k = 0; k < (count ? count : 1); k++)
        used[i + k] = true;
}

int ply_group_attributes(const char *path, const struct ply_header *h, const struct ply_element *e,
                         const char *prefix, bool *used, struct ply_attribute *out) {
    int count = group_colour(path, h, e, prefix, used, out);
    for (int i = e->first; i < e->first + e->property_count; i++)
        if (!used[i] && h->properties[i].count_type == PLY_NONE)
            group_neighbours(path, h, e, prefix, used, i, &out[count++]);
    return count;
}
