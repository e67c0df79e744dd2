// SPDX-License-Identifier: Apache-2.0
#include "transport/tensor_meaning.h"

#include <string.h>

#include "base/mem.h"

bool tensor_same_value(const struct json *a, const struct json *b) {
    if (!a || !b)
        return a == b;
    char *x = json_to_text(a), *y = json_to_text(b);
    const bool same = strcmp(x, y) == 0;
    mem_free(x);
    mem_free(y);
    return same;
}

const char *tensor_other_meaning(const struct json *a, const struct json *b) {
    static const char *const free_keys[] = {"samples", "seed", "command", "program", "scene", "blocks",
                                            "merged", "packets", "ranges", "range", "lights",
                                            NULL};
    for (int side = 0; side < 2; side++) {
        const struct json *x = side ? b : a, *y = side ? a : b;
        for (size_t i = 0; i < json_count(x); i++) {
            const char *key = json_key(x, i);
            bool free = false;
            for (int k = 0; free_keys[k]; k++)
                free = free || strcmp(free_keys[k], key) == 0;
            if (!free && !tensor_same_value(json_get(x, key), json_get(y, key)))
                return key;
        }
    }
    return NULL;
}

static bool same_axis(const struct tensor_axis *a, const struct tensor_axis *b) {
    return strcmp(a->name, b->name) == 0 && a->basis == b->basis && a->bins == b->bins &&
           !a->edges == !b->edges &&
           (!a->edges || memcmp(a->edges, b->edges, tensor_edges(a) * sizeof *a->edges) == 0);
}

bool tensor_same_block(const struct tensor_block *a, const struct tensor_block *b) {
    bool same = strcmp(a->object, b->object) == 0 && strcmp(a->term, b->term) == 0 &&
                a->axis_count == b->axis_count && a->groups == b->groups &&
                a->coefficients == b->coefficients && !a->view == !b->view;
    for (uint32_t i = 0; i < a->axis_count && same; i++)
        same = same_axis(&a->axes[i], &b->axes[i]);
    return same;
}
