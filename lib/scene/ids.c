// SPDX-License-Identifier: Apache-2.0
// Names of elements, and references to them.
#include <string.h>

#include "base/file.h"
#include "scene/reader.h"

void *list_add(struct list *l, size_t size) {
    mem_grow(&l->items, &l->capacity, l->count + 1, size);
    return (char *)l->items + size * l->count++;
}

// The slot of an id in the table, taken or free.
static size_t find_slot(const struct reader *r, const char *id) {
    size_t slot = (size_t)file_hash(id, strlen(id), 0) & (r->id_slots - 1);
    while (r->id_table[slot] &&
           strcmp(LIST_AT(&r->ids, struct id_entry, r->id_table[slot] - 1).id, id) != 0)
        slot = (slot + 1) & (r->id_slots - 1);
    return slot;
}

static void grow_table(struct reader *r) {
    if (2 * (r->ids.count + 1) <= r->id_slots)
        return;
    mem_free(r->id_table);
    r->id_slots = r->id_slots ? 2 * r->id_slots : 64;
    r->id_table = mem_array(r->id_slots, sizeof *r->id_table);
    for (size_t i = 0; i < r->ids.count; i++)
        r->id_table[find_slot(r, LIST_AT(&r->ids, struct id_entry, i).id)] = (uint32_t)i + 1;
}

struct id_entry *id_find(struct reader *r, const char *id) {
    if (r->id_slots == 0)
        return NULL;
    const uint32_t index = r->id_table[find_slot(r, id)];
    return index ? &LIST_AT(&r->ids, struct id_entry, index - 1) : NULL;
}

bool id_define(struct reader *r, const char *id, struct xml_node *node, struct where at) {
    grow_table(r);
    const size_t slot = find_slot(r, id);
    if (r->id_table[slot]) {
        const struct where first =
            LIST_AT(&r->ids, struct id_entry, r->id_table[slot] - 1).node->at;
        log_error_at(at, "id \"%s\" is taken: it stands at %s:%d", id, first.file, first.line);
        return false;
    }
    *LIST_ADD(&r->ids, struct id_entry) =
        (struct id_entry){.id = id, .node = node, .group = SCENE_NONE};
    r->id_table[slot] = (uint32_t)r->ids.count;
    return true;
}

static const char *nearest_id(const struct reader *r, const char *id) {
    const char *nearest = NULL;
    int best = 1 << 20;
    for (size_t i = 0; i < r->ids.count; i++) {
        const char *candidate = LIST_AT(&r->ids, struct id_entry, i).id;
        const int d = edit_distance(id, candidate);
        if (d < best && 3 * d <= (int)strlen(candidate) + 2) {
            best = d;
            nearest = candidate;
        }
    }
    return nearest;
}

struct xml_node *id_resolve(struct reader *r, struct xml_node *child, struct id_entry **entry) {
    struct xml_node *target = child;
    const char *id = xml_get(child, "id");
    *entry = id ? id_find(r, id) : NULL;
    while (tag_kind(target) == TAG_REF && *entry) { // an alias names an earlier id: this ends
        target = (*entry)->node;
        id = xml_get(target, "id");
        if (tag_kind(target) == TAG_REF)
            *entry = id_find(r, id);
    }
    if (tag_kind(target) != TAG_REF)
        return target;
    const char *nearest = nearest_id(r, id);
    log_error_at(child->at, "nothing has the id \"%s\"%s%s%s", id, nearest ? "; did you mean \"" : "",
                 nearest ? nearest : "", nearest ? "\"?" : "");
    return NULL;
}
