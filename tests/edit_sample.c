// SPDX-License-Identifier: Apache-2.0
#include "edit_sample.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "curve/form_json.h"
#include "curve/parameters.h"
#include "math/hash.h"
#include "replay/edit_weights.h"

enum { PIXELS = SAMPLE_WIDTH * SAMPLE_HEIGHT, OBJECTS = 2, GROUPS = 6 };

struct builder {
    struct arena *arena;
    const struct sample_options *o;
    struct rng rng;
    struct form form[OBJECTS];
    struct json *meta, *objects;
    struct tensor_block *blocks;
    uint32_t block_count;
};

static double between(struct builder *b, double lo, double hi) {
    return lo + (hi - lo) * (double)rng_float(&b->rng);
}

static void add_albedos(struct builder *b, const struct form *f, struct json *const *terms) {
    for (uint32_t t = 0; t < f->terms; t++) {
        uint32_t n = CURVE_CHANNELS;
        for (int s = SLOT_A; s < SLOTS; s++)
            n *= f->term[t].slots[s].gamma.kind == GAMMA_NONE
                     ? 1 : f->curve[f->term[t].slots[s].curve].f[0].table->basis.count;
        struct json *share = json_add_array(terms[t], "share");
        for (int k = 0; k < CURVE_CHANNELS; k++)
            json_append_number(share, between(b, 0.2, 1));
        struct json *albedo = json_add_array(terms[t], "albedo");
        for (uint32_t i = 0; i < n; i++)
            json_append_number(albedo, between(b, 0, 2.0 / n));
    }
}

static void add_object(struct builder *b, uint32_t index, const char *name, const char *model,
                       const struct model_parameters *p, uint32_t bins, enum basis_kind kind) {
    struct json *j = json_append_object(b->objects), *terms[FORM_TERMS];
    struct form *f = &b->form[index];
    const struct basis basis = basis_make(b->arena, kind, bins, SPACING_UNIFORM);
    CHECK(model_make(model_find(model), p, b->arena, f, name));
    for (uint32_t c = 0; c < f->curves; c++)
        form_tabulate(f, c, &basis, form_filter(f, c), b->arena);
    json_add_text(j, "name", name);
    json_add_text(j, "model", model);
    parameters_to_json(p, json_add_object(j, "parameters"));
    form_to_json(f, json_add_object(j, "form"), terms);
    if (b->o->polynomial)
        add_albedos(b, f, terms);
}

static void *random_values(struct builder *b, const struct tensor_block *t) {
    const size_t n = tensor_bytes(t) / tensor_value_size(t->storage);
    char *memory = arena_alloc(b->arena, tensor_bytes(t) + TENSOR_ALIGN);
    memory += (TENSOR_ALIGN - (uintptr_t)memory % TENSOR_ALIGN) % TENSOR_ALIGN;
    for (size_t i = 0; i < n; i++) {
        // lanes beyond the list are zero
        const size_t pixel = i / TENSOR_LANES / 3 / t->coefficients * TENSOR_LANES + i % TENSOR_LANES;
        const float v = pixel < t->pixel_count ? (float)between(b, -0.1, 1) : 0;
        if (t->storage == TENSOR_F32)
            ((float *)(void *)memory)[i] = v;
        else
            ((uint16_t *)(void *)memory)[i] = bf16_from_float(v);
    }
    return memory;
}

// A block of `pixels` pixels from `first` on, every `step`-th.
static void add_block(struct builder *b, const char *object, uint32_t index, uint32_t term,
                      uint32_t first, uint32_t pixels, uint32_t step) {
    struct tensor_block *t = &b->blocks[b->block_count++];
    const struct form *f = index < OBJECTS ? &b->form[index] : NULL;
    uint32_t *list = arena_alloc(b->arena, (pixels + 1) * sizeof *list);
    for (uint32_t i = 0; i < pixels; i++)
        list[i] = first + step * i;
    *t = (struct tensor_block){.object = object, .term = f ? f->term[term].name : "fixed",
                               .groups = b->o->polynomial ? GROUPS : 1, .channels = 3,
                               .pixel_count = pixels, .pixels = list, .storage = b->o->storage};
    t->coefficients = t->groups;
    for (int s = SLOT_A; f && s < SLOTS; s++) {
        const struct form_slot *slot = &f->term[term].slots[s];
        if (slot->gamma.kind == GAMMA_NONE)
            continue;
        const struct basis *basis = &f->curve[slot->curve].f[0].table->basis;
        t->axes[t->axis_count++] = (struct tensor_axis){
            gamma_names[slot->gamma.kind], basis->kind == BASIS_HAT ? TENSOR_HAT : TENSOR_BOX,
            basis->count, basis->kind == BASIS_BOX ? basis->knots : NULL};
        t->coefficients *= basis->count;
    }
    float *view = arena_alloc(b->arena, (tensor_tiles(t) + 1) * TENSOR_LANES * sizeof *view);
    for (uint32_t i = 0; i < pixels; i++)
        view[i] = (float)between(b, 0, CURVE_END);
    t->view = f && f->term[term].slots[SLOT_O].gamma.kind != GAMMA_NONE ? view : NULL;
    t->values = random_values(b, t);
    t->halves = random_values(b, t);
}

// A weighted sum of the albedos of the first two objects.
static void add_members(struct json *members) {
    for (int i = 0; i < 2; i++) {
        struct json *m = json_append_object(members);
        json_add_count(m, "object", i);
        struct json *weight = json_add_array(m, "weight");
        for (int k = 0; k < CURVE_CHANNELS; k++)
            json_append_number(weight, 0.25 + 0.5 * i + 0.1 * k);
    }
}

static void add_groups(struct builder *b) {
    static const int groups[GROUPS][3] = {{0}, {1, 0}, {1, 1}, {2, 0, 0}, {2, 1, 0}, {2, 2, 1}};
    struct json *factors = json_add_array(b->meta, "factors");
    for (int i = 0; i < OBJECTS; i++)
        if (i == 1)
            add_members(json_add_array(json_append_object(factors), "members"));
        else
            json_add_count(json_append_object(factors), "object", i);
    struct json *coarse = json_append_object(factors);
    json_add_count(coarse, "object", 1);
    json_add_count(coarse, "term", 0);
    json_add_count(coarse, "bin", 1);
    struct json *knots = json_add_array(coarse, "knots");
    for (int i = 0; i < 3; i++)
        json_append_number(knots, CURVE_END * i / 2);
    struct json *list = json_add_array(b->meta, "groups");
    for (int g = 0; g < GROUPS; g++) {
        struct json *one = json_append_array(list);
        for (int i = 0; i < groups[g][0]; i++)
            json_append_count(one, groups[g][i + 1]);
    }
}

struct tensor sample_make(const struct sample_options *o, struct arena *arena) {
    struct builder b = {.arena = arena, .o = o, .rng = {1}};
    struct model_parameters p = model_defaults;
    const uint32_t bins = o->bins ? o->bins : 32;
    float *fixed = arena_alloc(arena, 3 * PIXELS * sizeof *fixed);
    b.meta = json_new_object();
    json_add_text(b.meta, "kind", "edit");
    json_add_text(b.meta, "scene hash", "0123456789abcdef");
    json_add_count(b.meta, "samples", 16 + 16 * (int64_t)o->seed);
    json_add_count(b.meta, "seed", (int64_t)o->seed);
    b.objects = json_add_array(b.meta, "objects");
    b.blocks = arena_alloc(arena, SAMPLE_BLOCKS * sizeof *b.blocks);
    p.exponent_u = 20;
    p.exponent_v = 50;
    add_object(&b, 0, "pot.lid", "ashikhminshirley", &p, bins < 8 ? bins : 8, BASIS_BOX);
    p.fixed_fresnel = true;
    p.diffuse[0] = p.diffuse[1] = p.diffuse[2] = 0.5;
    add_object(&b, 1, "cup", "blinnphong", &p, bins, bins > 1 ? BASIS_HAT : BASIS_BOX);
    b.rng.state += o->seed; // what follows differs from sample to sample
    add_block(&b, "pot.lid", 0, 0, 3, 100, 1);
    add_block(&b, "cup", 1, 0, o->seed % 2, 83, 2); // lists differ, too
    add_block(&b, "cup", 1, 1, 0, 64, 2);
    if (o->polynomial) {
        add_block(&b, "", OBJECTS, 0, 110, 90, 1);
        add_groups(&b);
    }
    for (int i = 0; i < 3 * PIXELS; i++)
        fixed[i] = (float)between(&b, 0, 1);
    return (struct tensor){SAMPLE_WIDTH, SAMPLE_HEIGHT, b.meta, b.block_count, b.blocks, fixed};
}

bool sample_write(const struct sample_options *o, const char *path) {
    struct arena arena = {0};
    const struct tensor t = sample_make(o, &arena);
    struct tensor_writer *w = tensor_create(path, &t);
    for (uint32_t i = 0; w && i < t.block_count; i++) {
        memcpy(tensor_values(w, i), t.blocks[i].values, tensor_bytes(&t.blocks[i]));
        memcpy(tensor_halves(w, i), t.blocks[i].halves, tensor_bytes(&t.blocks[i]));
    }
    if (w)
        memcpy(tensor_fixed(w), t.fixed, 3 * PIXELS * sizeof *t.fixed);
    const bool done = w && tensor_finish(w);
    json_destroy((struct json *)(uintptr_t)t.meta);
    arena_finish(&arena);
    return done;
}

static const char relight_basis[] = "{\"kind\": \"relight\", \"scene hash\": \"0\", \"basis\": "
                                    "{\"type\": \"haar\", \"width\": 4, \"height\": 2}}";

bool sample_write_relight(const char *path) {
    enum { COEFFICIENTS = 8 };
    static float weights[3 * COEFFICIENTS], some;
    struct json *meta = json_parse(relight_basis, strlen(relight_basis), path);
    uint32_t pixels[70];
    for (uint32_t i = 0; i < 70; i++)
        pixels[i] = 2 * i;
    for (int i = 0; i < 3 * COEFFICIENTS; i++)
        weights[i] = (float)(i % 5) - 1;
    struct tensor_block b = {.object = "", .term = "", .axis_count = 1, .groups = 1,
                             .axes = {{"cell", TENSOR_BOX, COEFFICIENTS, NULL}},
                             .coefficients = COEFFICIENTS, .channels = 3, .pixel_count = 70,
                             .pixels = pixels, .halves = &some, .weights = weights};
    const struct tensor t = {SAMPLE_WIDTH, SAMPLE_HEIGHT, meta, 1, &b, NULL};
    struct tensor_writer *w = tensor_create(path, &t);
    for (size_t i = 0; w && i < tensor_bytes(&b) / 4; i++)
        ((float *)tensor_values(w, 0))[i] = (float)(i % 7);
    json_destroy(meta);
    return w && tensor_finish(w);
}

// ---- truth ----------------------------------------------------------------------------------

static double value_at(const struct tensor_block *t, uint64_t pixel, uint32_t coefficient,
                       uint32_t channel) {
    const size_t i = ((pixel / TENSOR_LANES * t->coefficients + coefficient) * 3 + channel) *
                         TENSOR_LANES + pixel % TENSOR_LANES;
    return t->storage == TENSOR_F32 ? (double)((const float *)t->values)[i]
                                    : (double)bf16_to_float(((const uint16_t *)t->values)[i]);
}

static double curve_of(const struct edited_object *o, const struct form_slot *s, uint32_t channel,
                       uint32_t bin) {
    return s->gamma.kind == GAMMA_NONE ? 1 : curve_values(o->curve[s->curve], channel)[bin];
}

static uint32_t bins_of(const struct edited_object *o, const struct form_slot *s) {
    return s->gamma.kind == GAMMA_NONE ? 1 : o->curve[s->curve]->basis.count;
}

static double group_of(const struct edit_tensor *e, uint32_t group, uint32_t channel) {
    double product = 1;
    for (uint32_t i = 0; i < e->groups[group].count; i++) {
        double value[CURVE_CHANNELS];
        edit_factor_value(e, &e->factors[e->groups[group].factors[i]], value);
        product *= value[channel];
    }
    return product;
}

static double pixel_of(const struct edit_tensor *e, const double (*groups)[3], uint32_t block,
                       uint64_t pixel, uint32_t channel) {
    const struct tensor_block *t = &e->tensor->blocks[block];
    const struct edited_block *own = &e->blocks[block];
    const struct edited_object *o = own->object == EDIT_NOTHING ? NULL : &e->objects[own->object];
    const struct form_term *term = o ? &o->form.term[own->term] : NULL;
    const uint32_t rows = o ? bins_of(o, &term->slots[SLOT_A]) : 1;
    const uint32_t columns = o ? bins_of(o, &term->slots[SLOT_B]) : 1;
    double sum = 0;
    for (uint32_t g = 0; g < t->groups; g++) {
        const double group = groups[g][channel];
        for (uint32_t j = 0; j < rows; j++)
            for (uint32_t k = 0; k < columns; k++)
                sum += group * value_at(t, pixel, (g * rows + j) * columns + k, channel) *
                       (o ? curve_of(o, &term->slots[SLOT_A], channel, j) *
                                curve_of(o, &term->slots[SLOT_B], channel, k) : 1);
    }
    if (o)
        sum *= term->scale[channel];
    if (o && edit_has_slot(term, SLOT_O))
        sum *= curve_at(o->curve[term->slots[SLOT_O].curve], channel, (double)t->view[pixel]);
    return sum;
}

void sample_truth(const struct edit_tensor *e, double *frame) {
    double groups[GROUPS][3];
    for (uint32_t g = 0; g < e->group_count; g++)
        for (uint32_t c = 0; c < 3; c++)
            groups[g][c] = group_of(e, g, c);
    for (int i = 0; i < 3 * PIXELS; i++)
        frame[i] = (double)e->tensor->fixed[i];
    for (uint32_t i = 0; i < e->tensor->block_count; i++)
        for (uint64_t p = 0; p < e->tensor->blocks[i].pixel_count; p++)
            for (uint32_t c = 0; c < 3; c++)
                frame[c * PIXELS + e->tensor->blocks[i].pixels[p]] +=
                    pixel_of(e, (const double(*)[3])groups, i, p, c);
}
