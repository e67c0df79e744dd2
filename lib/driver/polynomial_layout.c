// SPDX-License-Identifier: Apache-2.0
#include "driver/polynomial_layout.h"

#include <string.h>

#include "driver/ranks.h"

static const float some;
static const double some_sums;

// ---- the survey -------------------------------------------------------------------------------

static struct sink_area area_of(const struct polynomial *p) {
    const struct film_options *f = &p->job.film;
    return (struct sink_area){f->x0, f->y0, f->x1, f->y1};
}

static bool survey(struct polynomial_layout *l, const struct polynomial_range *r) {
    const struct polynomial *p = l->p;
    const struct object plain = {.type = &integrator_survey.entry, .data = (void *)&p->survey};
    struct tracer_options o = p->tracer;
    o.response = &p->survey.response;
    o.integrator = p->job.world->shadow_rays_may_pass ? &integrator_first_hits : &plain;
    l->seen = first_seen_create(area_of(p), p->job.scene->film.width, p->plan.count + 1);
    struct tracer *t = tracer_create(&o, first_seen_sink, l->seen);
    const bool whole =
        tracer_run(t, 0, tile_grid_count(&l->seen->grid), r->first, r->end - r->first) &&
        !(o.stop && *o.stop);
    tracer_destroy(t);
    return whole;
}

// ---- an earlier tensor --------------------------------------------------------------------------

static const char *object_name(const struct polynomial *p, uint32_t object) {
    return object < p->plan.count ? p->plan.objects[object].name : "";
}

// The block of a term (NULL: of the first that is there); NULL: it has none.
static const struct tensor_block *find_block(const struct tensor *t, const char *object,
                                             const char *term) {
    for (uint32_t i = 0; t && i < t->block_count; i++)
        if (strcmp(t->blocks[i].object, object) == 0 && (!term || strcmp(t->blocks[i].term, term) == 0))
            return &t->blocks[i];
    return NULL;
}

// What an earlier tensor knows of an object.
struct known {
    uint64_t count;
    bool has_views;
    const uint32_t *pixels;
    const double *views; // [2][lanes]
};

static struct known known_of(const struct polynomial_layout *l, const struct tensor *base,
                             uint32_t object) {
    const char *name = object_name(l->p, object);
    const struct tensor_block *b = find_block(base, name, NULL);
    struct known k = {.count = 0};
    if (!b)
        return k;
    k = (struct known){b->pixel_count, false, b->pixels, NULL};
    for (uint32_t i = 0; i < base->block_count; i++)
        if (strcmp(base->blocks[i].object, name) == 0 && base->blocks[i].views)
            k.views = base->blocks[i].views;
    k.has_views = k.views != NULL;
    return k;
}

// Rank 0 has the earlier tensor; sums of all ranks must lie alike.
static void know_base(struct polynomial_layout *l, const struct tensor *base) {
    for (uint32_t i = 0; i <= l->p->plan.count; i++) {
        struct known k = known_of(l, base, i);
        ranks_broadcast(&k, sizeof k);
        const size_t lanes = (k.count + TENSOR_LANES - 1) / TENSOR_LANES * TENSOR_LANES;
        uint32_t *pixels = mem_array(k.count + 1, sizeof *pixels);
        double *views = mem_array(2 * lanes + 1, sizeof *views);
        if (ranks_index() == 0 && k.count > 0)
            memcpy(pixels, k.pixels, k.count * sizeof *pixels);
        if (ranks_index() == 0 && k.has_views)
            memcpy(views, k.views, 2 * lanes * sizeof *views);
        ranks_broadcast(pixels, k.count * sizeof *pixels);
        ranks_broadcast(views, k.has_views ? 2 * lanes * sizeof *views : 0);
        first_seen_know(l->seen, i, pixels, k.count, k.has_views ? views : NULL);
        mem_free(pixels);
        mem_free(views);
    }
}

// ---- the blocks -------------------------------------------------------------------------------

static void add_block(struct polynomial_layout *l, const struct polynomial_range *r,
                      struct tensor_block b, uint32_t object, uint32_t term) {
    struct edit_sums_object *o = &l->objects[object];
    const struct seen_list *list = &l->seen->lists[object];
    o->first[term] = o->places;
    o->bins[term] = b.coefficients;
    o->places += b.coefficients;
    o->terms = term + 1;
    o->base[term] = find_block(r->base, b.object, b.term);
    b.groups = l->p->groups.count;
    b.coefficients *= b.groups;
    b.channels = CURVE_CHANNELS;
    b.pixel_count = list->count;
    b.pixels = list->pixels;
    b.storage = r->storage;
    b.halves = &some;
    b.sums = r->keep_sums ? &some_sums : NULL;
    b.views = b.view && r->keep_sums ? list->views : NULL;
    l->owner[l->tensor.block_count][0] = object;
    l->owner[l->tensor.block_count][1] = term;
    l->blocks[l->tensor.block_count++] = b;
}

// What is not seen lights others only, and has no block; but samples to come may see it.
static bool needs_block(const struct polynomial_layout *l, const struct polynomial_range *r,
                        uint32_t object) {
    return l->seen->lists[object].count > 0 || r->keep_sums;
}

static void make_blocks(struct polynomial_layout *l, const struct polynomial_range *r) {
    const struct edit_plan *plan = &l->p->plan;
    l->objects = mem_array(plan->count + 1, sizeof *l->objects);
    l->blocks = mem_array(plan->count * FORM_TERMS + 1, sizeof *l->blocks);
    l->owner = mem_array(plan->count * FORM_TERMS + 1, sizeof *l->owner);
    for (uint32_t i = 0; i < plan->count; i++)
        for (uint32_t t = 0; t < plan->objects[i].form->terms; t++) {
            struct tensor_block b;
            if (!needs_block(l, r, i))
                continue;
            edit_plan_block(plan, i, t, &b);
            if (edit_term_has(&plan->objects[i].form->term[t], SLOT_O))
                b.view = l->seen->lists[i].view;
            add_block(l, r, b, i, t);
        }
    if (l->p->groups.count > 1 && needs_block(l, r, plan->count))
        add_block(l, r, (struct tensor_block){.object = "", .term = "fixed", .coefficients = 1},
                  plan->count, 0);
}

// Whether the earlier tensor has these blocks and no others.
static bool fits(const struct polynomial_layout *l, const struct tensor *base) {
    bool same = !base || (base->block_count == l->tensor.block_count && tensor_has_sums(base) &&
                          base->width == l->tensor.width && base->height == l->tensor.height);
    for (uint32_t i = 0; same && base && i < l->tensor.block_count; i++) {
        const struct tensor_block *a = &l->blocks[i];
        const struct tensor_block *b = l->objects[l->owner[i][0]].base[l->owner[i][1]];
        same = b && a->coefficients == b->coefficients && a->groups == b->groups &&
               a->axis_count == b->axis_count && !a->views == !b->views;
        for (uint32_t k = 0; same && k < a->axis_count; k++)
            same = strcmp(a->axes[k].name, b->axes[k].name) == 0 && a->axes[k].bins == b->axes[k].bins;
    }
    return same;
}

bool polynomial_layout_init(struct polynomial_layout *l, const struct polynomial *p,
                            const struct polynomial_range *r) {
    *l = (struct polynomial_layout){.p = p};
    const bool whole = survey(l, r);
    know_base(l, r->base); // also where it is not: others wait
    if (!whole)
        return false;
    first_seen_list(l->seen);
    l->tensor = (struct tensor){
        .width = (uint32_t)p->job.scene->film.width, .height = (uint32_t)p->job.scene->film.height,
        .fixed = &some, .fixed_sums = r->keep_sums ? &some_sums : NULL};
    make_blocks(l, r);
    l->tensor.blocks = l->blocks;
    l->sums = (struct edit_sums_options){
        .area = area_of(p), .width = (int)l->tensor.width, .height = (int)l->tensor.height,
        .samples = r->before + r->end - r->first, .quantum = r->quantum, .groups = p->groups.count,
        .objects = l->objects, .seen = l->seen, .storage = r->storage, .parts = 1,
        .fixed_base = r->base ? r->base->fixed_sums : NULL};
    l->sums.last = p->path.max_depth > 0 ? (uint32_t)p->path.max_depth - 1 : 0;
    for (int k = 0; k < CURVE_CHANNELS; k++)
        l->sums.gain[k] = (float)(1 / (1 - p->radius[k]));
    return fits(l, r->base);
}

void polynomial_layout_finish(struct polynomial_layout *l) {
    first_seen_destroy(l->seen);
    mem_free(l->objects);
    mem_free(l->blocks);
    mem_free(l->owner);
}

void polynomial_layout_tie(struct polynomial_layout *l, struct tensor_writer *w) {
    for (uint32_t i = 0; i < l->tensor.block_count; i++) {
        struct edit_sums_object *o = &l->objects[l->owner[i][0]];
        const uint32_t term = l->owner[i][1];
        o->values[term] = tensor_values(w, i);
        o->halves[term] = tensor_halves(w, i);
        o->sums[term] = l->blocks[i].sums ? tensor_sums(w, i) : NULL;
    }
    l->sums.fixed = tensor_fixed(w);
    l->sums.fixed_sums = l->tensor.fixed_sums ? tensor_fixed_sums(w) : NULL;
}

uint64_t polynomial_layout_bytes(const struct polynomial_layout *l) {
    const bool keep = tensor_has_sums(&l->tensor);
    uint64_t bytes = (uint64_t)l->tensor.width * l->tensor.height * (keep ? 36 : 12);
    for (uint32_t i = 0; i < l->tensor.block_count; i++) {
        const struct tensor_block *b = &l->blocks[i];
        const uint64_t values = tensor_bytes(b) / tensor_value_size(b->storage);
        bytes += 2 * tensor_bytes(b) + 4 * b->pixel_count + (keep ? 16 * values : 0);
    }
    return bytes;
}
