// SPDX-License-Identifier: Apache-2.0
#include "driver/merge.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/log.h"
#include "base/mem.h"
#include "driver/film_head.h"
#include "sink/journal.h"

struct part {
    char path[4096]; // of the journal
    struct json *head;
    struct film_options options;
    struct sums sums;
};

static void close_parts(struct part *parts, size_t count) {
    for (size_t i = 0; i < count; i++) {
        json_destroy(parts[i].head);
        sums_finish(&parts[i].sums);
    }
    mem_free(parts);
}

// Of a picture, or of a journal itself.
static bool find_journal(const char *path, char *out, size_t size) {
    char extension[16];
    file_extension(path, extension, sizeof extension);
    const bool is_journal = strcmp(extension, "journal") == 0 && strlen(path) < size;
    if (is_journal)
        strcpy(out, path);
    else if (!journal_path(path, out, size))
        return false;
    if (file_exists(out))
        return true;
    log_error("%s: has no journal (%s); render it with --samples, --checkpoint or --resume", path, out);
    return false;
}

// A film of the part's shape, to ask where its values lie.
static bool sums_fit(const struct part *p) {
    struct film *film = film_create(&p->options);
    const bool fit = film_values(film) == p->sums.values;
    film_destroy(film);
    if (!fit)
        log_error("%s: the size of its sums is not that of its picture", p->path);
    return fit;
}

static bool open_part(struct part *p, const char *path, const struct part *first,
                      struct arena *arena) {
    return find_journal(path, p->path, sizeof p->path) &&
           journal_read(p->path, &p->head, &p->sums) &&
           film_head_options(p->head, p->path, &p->options, arena) && sums_fit(p) &&
           (p == first || film_head_agrees(first->head, first->path, p->head, p->path, false));
}

// ---- samples ------------------------------------------------------------------------------------

static bool same_crop(const struct film_options *a, const struct film_options *b) {
    return a->x0 == b->x0 && a->y0 == b->y0 && a->x1 == b->x1 && a->y1 == b->y1;
}

static bool move_nodes(struct part *to, struct part *from) {
    for (size_t i = 0; i < from->sums.count; i++) {
        const struct sums_node *n = &from->sums.nodes[i];
        const uint64_t first = sums_node_first(n);
        if (sums_overlap(&to->sums, n)) {
            log_error("%s: samples %" PRIu64 ":%" PRIu64 " of seed %u are in %s or in another one "
                      "too; every sample may be given once", from->path, first,
                      first + sums_node_samples(n), n->seed, to->path);
            return false;
        }
        sums_add(&to->sums, *n);
        from->sums.nodes[i].values = NULL;
    }
    return true;
}

// Unites parts of the same crop in the first of them; returns how many parts are left, 0 after an
// error message.
static size_t unite_samples(struct part *parts, size_t count) {
    size_t left = 0;
    for (size_t i = 0; i < count; i++) {
        size_t k = 0;
        while (k < left && !same_crop(&parts[k].options, &parts[i].options))
            k++;
        if (k < left) {
            if (!move_nodes(&parts[k], &parts[i]))
                return 0;
        } else if (left++ != i) {
            const struct part swap = parts[k];
            parts[k] = parts[i];
            parts[i] = swap;
        }
    }
    return left;
}

// ---- crops --------------------------------------------------------------------------------------

static bool same_samples(const struct sums *a, const struct sums *b) {
    bool same = a->count == b->count;
    for (size_t i = 0; i < a->count && same; i++) {
        const struct sums_node *m = &a->nodes[i], *n = &b->nodes[i];
        same = m->seed == n->seed && m->level == n->level && m->index == n->index &&
               m->missing == n->missing;
    }
    return same;
}

static bool intersect(const struct film_options *a, const struct film_options *b) {
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static int64_t area(const struct film_options *o) {
    return (int64_t)(o->x1 - o->x0) * (o->y1 - o->y0);
}

// The rectangle of all crops, when they tile it and have the same samples.
static bool unite_crops(const struct part *parts, size_t count, struct film_options *whole) {
    int64_t sum = 0;
    *whole = parts[0].options;
    for (size_t i = 0; i < count; i++) {
        const struct film_options *o = &parts[i].options;
        if (!same_samples(&parts[0].sums, &parts[i].sums)) {
            log_error("%s: its crop has other samples than that of %s", parts[i].path, parts[0].path);
            return false;
        }
        for (size_t k = 0; k < i; k++)
            if (intersect(o, &parts[k].options)) {
                log_error("%s: its crop overlaps that of %s", parts[i].path, parts[k].path);
                return false;
            }
        whole->x0 = o->x0 < whole->x0 ? o->x0 : whole->x0;
        whole->y0 = o->y0 < whole->y0 ? o->y0 : whole->y0;
        whole->x1 = o->x1 > whole->x1 ? o->x1 : whole->x1;
        whole->y1 = o->y1 > whole->y1 ? o->y1 : whole->y1;
        sum += area(o);
    }
    if (sum == area(whole))
        return true;
    log_error("the crops leave %" PRId64 " pixels of the rectangle %d,%d,%d,%d empty",
              area(whole) - sum, whole->x0, whole->y0, whole->x1, whole->y1);
    return false;
}

// Sums of the whole from those of the crops.
static void assemble(const struct film *whole, struct part *parts, size_t count, struct sums *sums) {
    sums_init(sums, film_values(whole));
    for (size_t n = 0; n < parts[0].sums.count; n++) {
        struct sums_node node = parts[0].sums.nodes[n];
        node.values = mem_array(sums->values, sizeof *node.values);
        for (size_t i = 0; i < count; i++) {
            struct film *part = film_create(&parts[i].options);
            film_add_part(whole, node.values, part, parts[i].sums.nodes[n].values);
            film_destroy(part);
        }
        sums_add(sums, node);
    }
}

// ---- all ----------------------------------------------------------------------------------------

static bool build_union(struct film_union *u, struct part *parts, size_t count) {
    struct film_options whole;
    struct sums sums;
    const size_t crops = unite_samples(parts, count);
    if (crops == 0 || !unite_crops(parts, crops, &whole))
        return false;
    whole.seed = parts[0].sums.count ? parts[0].sums.nodes[0].seed : 0;
    whole.first = parts[0].sums.count ? sums_node_first(&parts[0].sums.nodes[0]) : 0;
    u->film = film_create(&whole);
    if (crops == 1) {
        film_restore(u->film, &parts[0].sums);
    } else {
        assemble(u->film, parts, crops, &sums);
        film_restore(u->film, &sums);
    }
    u->head = parts[0].head;
    parts[0].head = NULL;
    film_head_set_crop(u->head, u->film, &whole);
    return true;
}

bool merge_films(struct film_union *u, const char *const *paths, size_t count) {
    struct part *parts = mem_array(count, sizeof *parts);
    bool sound = count > 0;
    *u = (struct film_union){0};
    for (size_t i = 0; i < count && sound; i++)
        sound = open_part(&parts[i], paths[i], parts, &u->arena);
    sound = sound && build_union(u, parts, count);
    close_parts(parts, count);
    if (!sound)
        film_union_finish(u);
    return sound;
}

void film_union_finish(struct film_union *u) {
    film_destroy(u->film);
    json_destroy(u->head);
    arena_finish(&u->arena);
    *u = (struct film_union){0};
}
