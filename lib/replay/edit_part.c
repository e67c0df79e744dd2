// SPDX-License-Identifier: Apache-2.0
#include "replay/edit_part.h"

#include <string.h>

#include "base/mem.h"
#include "base/thread.h"
#include "replay/edit_focus.h"
#include "replay/edit_stage.h"

struct edit_part {
    struct edit_tensor objects;
    struct edit_settings options;
    struct edit_stage whole, rest; // the tensor, and what a focus leaves of it
    struct edit_focus focus;
    bool focused;
    struct focus_curve left;     // where the focus was before, if it was
    bool was_elsewhere;
    struct focus_curve touched[FOCUS_MOST]; // since the last frame
    uint32_t touch_count;
    bool scattered;              // more was touched
    double (*factors)[CURVE_CHANNELS], (*groups)[CURVE_CHANNELS];
    float *scale;
    float **pixel;               // per block, or NULL
    double **pixel_curve;        // values of the curve it belongs to
    double switch_seconds;
};

static struct replay_options replay_options_of(const struct edit_part *e) {
    return (struct replay_options){e->options.no_device, e->options.threads,
                                   e->options.most_memory, e->whole.replay};
}

static void make_room(struct edit_part *e) {
    const struct edit_tensor *o = &e->objects;
    const uint32_t n = o->tensor->block_count;
    e->factors = mem_array(o->factor_count, sizeof *e->factors);
    e->groups = mem_array(o->group_count, sizeof *e->groups);
    e->scale = mem_array(CURVE_CHANNELS * (size_t)n, sizeof *e->scale);
    e->pixel = mem_array(n, sizeof *e->pixel);
    e->pixel_curve = mem_array(n, sizeof *e->pixel_curve);
}

struct edit_part *edit_part_create(const struct tensor *t, const char *path, const struct edit_settings *o) {
    struct edit_part *e = mem_array(1, sizeof *e);
    e->options = *o;
    const struct replay_options replay = replay_options_of(e);
    if (edit_tensor_init(&e->objects, t, path)) {
        make_room(e);
        if (edit_stage_init(&e->whole, t, &replay))
            return e;
    }
    edit_part_destroy(e);
    return NULL;
}

static void drop_focus(struct edit_part *e) {
    edit_stage_finish(&e->rest);
    edit_focus_finish(&e->focus);
    e->focused = false;
}

void edit_part_destroy(struct edit_part *e) {
    if (!e)
        return;
    drop_focus(e);
    for (uint32_t i = 0; e->pixel && i < e->objects.tensor->block_count; i++) {
        mem_free(e->pixel[i]);
        mem_free(e->pixel_curve[i]);
    }
    edit_stage_finish(&e->whole);
    mem_free(e->factors);
    mem_free(e->groups);
    mem_free(e->scale);
    mem_free(e->pixel);
    mem_free(e->pixel_curve);
    if (e->objects.tensor)
        edit_tensor_finish(&e->objects);
    mem_free(e);
}

struct edit_tensor *edit_part_objects(struct edit_part *e) {
    return &e->objects;
}

const char *edit_part_device(const struct edit_part *e) {
    return replay_device(e->whole.replay);
}

bool edit_part_is_exact(const struct edit_part *e) {
    return e->focused ? e->rest.exact : e->whole.exact;
}

struct edit_cost edit_part_last_cost(const struct edit_part *e) {
    const struct edit_stage *s = e->focused ? &e->rest : &e->whole;
    return (struct edit_cost){e->switch_seconds, s->coefficients, s->bytes};
}

void edit_part_forget(struct edit_part *e) {
    struct edit_stage *s = e->focused ? &e->rest : &e->whole;
    for (uint32_t i = 0; i < s->tensor.block_count; i++)
        s->blocks[i].known = false;
}

// ---- changes ------------------------------------------------------------------------------------

// Whether weights of coefficients follow from what was touched, and not the scale or f_o alone.
static bool reaches_weights(const struct edit_tensor *o, const struct edit_touch *t) {
    for (uint32_t i = 0; i < o->factor_count; i++)
        if (edit_factor_has(&o->factors[i], t->object))
            return true;
    for (uint32_t i = 0; i < o->tensor->block_count; i++)
        for (uint32_t a = 0; o->blocks[i].object == t->object &&
                             a < o->tensor->blocks[i].axis_count; a++)
            if (t->several || edit_axis_curve(o, i, a) == t->curve)
                return true;
    return false;
}

static void touch(struct edit_part *e, struct focus_curve c) {
    if (focus_has(e->touched, e->touch_count, c))
        return;
    for (uint32_t k = 0; k < e->touch_count; k++)
        if (focus_has(&c, 1, e->touched[k])) {
            e->touched[k] = c;
            return;
        }
    if (e->touch_count < FOCUS_MOST)
        e->touched[e->touch_count++] = c;
    else
        e->scattered = true;
}

bool edit_part_change(struct edit_part *e, enum edit_kind kind, const char *text, const char *at) {
    struct edit_touch t;
    if (!edit_apply(&e->objects, kind, text, at, &t))
        return false;
    if (!reaches_weights(&e->objects, &t))
        return true;
    touch(e, (struct focus_curve){t.object, t.curve});
    e->scattered = e->scattered || t.several;
    return true;
}

// ---- focus --------------------------------------------------------------------------------------

// Whether a block stays as it is: nothing to multiply out or to sum up.
static bool stays(const struct edit_part *e, uint32_t block) {
    const struct tensor_block *b = &e->objects.tensor->blocks[block];
    return b->groups == 1 && e->objects.groups[0].count == 0 && e->focus.power_count == 1 &&
           edit_focus_axes(&e->focus, &e->objects, block) == (1u << b->axis_count) - 1;
}

static bool contract_block(struct edit_part *e, uint32_t block, struct tensor_block *out) {
    struct arena arena = {0};
    const struct tensor_block *b = &e->objects.tensor->blocks[block];
    *out = *b;
    out->coefficients = edit_focus_coefficients(&e->focus, &e->objects, block);
    out->halves = NULL;
    out->weights = NULL;
    if (b->pixel_count == 0 || (stays(e, block) && !e->options.terms))
        return true;
    out->storage = TENSOR_F32;
    float *values = edit_stage_values(&e->rest.blocks[block], tensor_bytes(out) / sizeof *values);
    out->values = values;
    const struct contraction c =
        edit_focus_contraction(&e->focus, &e->objects, block,
                               (const double(*)[CURVE_CHANNELS])e->factors, &arena);
    const bool done = replay_contract(e->whole.replay, block, &c, values);
    arena_finish(&arena);
    return done;
}

// Updates are for blocks with one axis left and more coefficients than a frame may change.
static void prepare_updates(struct edit_part *e) {
    const struct edit_tensor *o = &e->objects;
    e->rest.terms = e->options.terms;
    for (uint32_t i = 0; i < o->tensor->block_count && e->options.terms; i++) {
        const struct tensor_block *b = &e->rest.tensor.blocks[i];
        const unsigned axes = edit_focus_axes(&e->focus, o, i);
        if (b->pixel_count == 0 || b->coefficients <= e->options.terms)
            continue;
        const uint32_t bins = axes == 1 ? b->axes[0].bins : axes == 2 ? b->axes[1].bins : 0;
        edit_stage_transform(&e->rest, i, bins ? b->coefficients / bins : 1, bins,
                             e->options.threads);
    }
}

static bool move_focus(struct edit_part *e, const struct focus_curve *curves, uint32_t count) {
    const struct tensor *t = e->objects.tensor;
    const struct replay_options replay = replay_options_of(e);
    const double start = time_seconds();
    struct tensor rest = *t;
    drop_focus(e);
    edit_focus_init(&e->focus, &e->objects, curves, count);
    rest.blocks = arena_alloc(&e->focus.arena, (t->block_count + 1) * sizeof *rest.blocks);
    e->rest.tensor = rest;
    e->rest.blocks = mem_array(t->block_count, sizeof *e->rest.blocks);
    bool good = true;
    for (uint32_t i = 0; i < t->block_count && good; i++)
        good = contract_block(e, i, &rest.blocks[i]);
    if (good)
        prepare_updates(e);
    good = good && edit_stage_init(&e->rest, &rest, &replay);
    e->focused = good;
    e->switch_seconds = time_seconds() - start;
    return good;
}

// To what was touched; to both where that is the curve which the focus has just left.
static bool follow_touch(struct edit_part *e) {
    const struct edit_focus *f = &e->focus;
    struct focus_curve to[FOCUS_MOST] = {e->touched[0], e->touched[1]};
    uint32_t count = e->touch_count;
    const bool alone = e->focused && f->curve_count == 1 && count == 1;
    const struct focus_curve from = f->curves[0];
    if (alone && e->was_elsewhere && focus_has(&e->left, 1, to[0]) && !focus_has(to, 1, from))
        to[count++] = from;
    e->was_elsewhere = alone && count == 1;
    e->left = from;
    return move_focus(e, to, count);
}

// The focus goes to what was touched since the last frame, if that is no more than two curves.
static bool choose_focus(struct edit_part *e) {
    bool same = e->focused, good = true;
    if (!e->options.focus || (e->touch_count == 0 && !e->scattered))
        return true;
    for (uint32_t k = 0; k < e->touch_count; k++)
        same = same && focus_has(e->focus.curves, e->focus.curve_count, e->touched[k]);
    if (e->scattered)
        drop_focus(e);
    else if (!same)
        good = follow_touch(e);
    e->touch_count = 0;
    e->scattered = false;
    return good;
}

// ---- frames -------------------------------------------------------------------------------------

static void value_groups(struct edit_part *e, const struct edited_group *groups, uint32_t count) {
    for (uint32_t g = 0; g < count; g++)
        edit_group_value(&groups[g], (const double(*)[CURVE_CHANNELS])e->factors, NULL, e->groups[g]);
}

static bool follow(struct edit_part *e, struct edit_stage *s) {
    const struct edit_tensor *o = &e->objects;
    bool good = true;
    edit_stage_begin(s);
    for (uint32_t i = 0; i < o->tensor->block_count && good; i++) {
        const struct tensor_block *b = &s->tensor.blocks[i];
        if (b->pixel_count == 0)
            continue;
        double *weights = mem_array(CURVE_CHANNELS * (size_t)b->coefficients, sizeof *weights);
        edit_weights(o, i, (const double(*)[CURVE_CHANNELS])e->groups,
                     e->focused ? e->focus.power_count : b->groups,
                     e->focused ? edit_focus_axes(&e->focus, o, i) : EDIT_ALL_AXES, weights);
        good = edit_stage_follow(s, i, weights);
        mem_free(weights);
    }
    return good;
}

// f_o of a block's pixels, where its curve changed.
static void update_pixels(struct edit_part *e, uint32_t block) {
    const struct edit_tensor *o = &e->objects;
    const struct edited_block *b = &o->blocks[block];
    const struct form_term *t = b->object == EDIT_NOTHING
                                    ? NULL : &o->objects[b->object].form.term[b->term];
    if (!t || !edit_has_slot(t, SLOT_O) || o->tensor->blocks[block].pixel_count == 0)
        return;
    const struct curve *c = o->objects[b->object].curve[t->slots[SLOT_O].curve];
    const size_t n = (size_t)CURVE_CHANNELS * c->basis.count;
    if (e->pixel[block] && memcmp(e->pixel_curve[block], c->values, n * sizeof *c->values) == 0)
        return;
    if (!e->pixel[block]) {
        const size_t lanes = tensor_tiles(&o->tensor->blocks[block]) * TENSOR_LANES;
        e->pixel[block] = mem_array(lanes * CURVE_CHANNELS, sizeof(float));
        e->pixel_curve[block] = mem_array(n, sizeof *c->values);
    }
    memcpy(e->pixel_curve[block], c->values, n * sizeof *c->values);
    edit_view_factor(o, block, e->pixel[block]);
}

static void value_factors(struct edit_part *e) {
    const struct edit_tensor *o = &e->objects;
    for (uint32_t i = 0; i < o->factor_count; i++)
        edit_factor_value(o, &o->factors[i], e->factors[i]);
    for (uint32_t i = 0; i < o->tensor->block_count; i++) {
        edit_scale(o, i, e->scale + CURVE_CHANNELS * (size_t)i);
        update_pixels(e, i);
    }
}

static struct replay_factors factors_of(const struct edit_part *e) {
    return (struct replay_factors){e->scale, (const float *const *)e->pixel};
}

bool edit_part_follow(struct edit_part *e) {
    value_factors(e);
    if (!choose_focus(e))
        return false;
    struct edit_stage *s = e->focused ? &e->rest : &e->whole;
    value_groups(e, e->focused ? e->focus.powers : e->objects.groups,
                 e->focused ? e->focus.power_count : e->objects.group_count);
    return follow(e, s) && replay_wait(s->replay);
}

bool edit_part_compose(struct edit_part *e, float *frame) {
    const struct replay_factors factors = factors_of(e);
    return replay_frame(e->focused ? e->rest.replay : e->whole.replay, &factors, frame);
}

void edit_part_variance(struct edit_part *e, const float factor[CURVE_CHANNELS], float *variance) {
    const struct edit_tensor *o = &e->objects;
    const struct replay_factors factors = factors_of(e);
    const uint32_t n = o->tensor->block_count;
    float **weights = mem_array(n, sizeof *weights);
    value_factors(e);
    for (uint32_t k = 0; k < CURVE_CHANNELS * n; k++)
        e->scale[k] *= factor[k % CURVE_CHANNELS];
    value_groups(e, o->groups, o->group_count);
    for (uint32_t i = 0; i < n; i++) {
        const struct tensor_block *b = &o->tensor->blocks[i];
        const size_t count = CURVE_CHANNELS * (size_t)(b->pixel_count ? b->coefficients : 0);
        double *exact = mem_array(count, sizeof *exact);
        weights[i] = mem_array(count, sizeof **weights);
        if (count)
            edit_weights(o, i, (const double(*)[CURVE_CHANNELS])e->groups, b->groups, EDIT_ALL_AXES,
                         exact);
        for (size_t k = 0; k < count; k++)
            weights[i][k] = (float)exact[k];
        mem_free(exact);
    }
    replay_variance(e->whole.replay, (const float *const *)weights, &factors, variance);
    for (uint32_t i = 0; i < n; i++)
        mem_free(weights[i]);
    mem_free(weights);
}
