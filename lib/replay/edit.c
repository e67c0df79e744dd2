// SPDX-License-Identifier: Apache-2.0
#include "replay/edit.h"

#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/mem.h"
#include "replay/light_factor.h"

struct edit {
    struct edit_settings options;
    struct edit_part *parts[EDIT_MOST_LIGHTS];
    struct edit_light lights[EDIT_MOST_LIGHTS];
    const struct tensor *tensors[EDIT_MOST_LIGHTS];
    uint32_t count;
    float *single; // the picture of one of them; of a session with one alone: NULL
};

static size_t plane_of(const struct edit *e) {
    return (size_t)e->tensors[0]->width * e->tensors[0]->height;
}

static bool take(struct edit *e, const struct tensor *t, const char *path) {
    const uint32_t k = e->count;
    e->parts[k] = edit_part_create(t, path, &e->options);
    e->tensors[k] = t;
    e->lights[k] = (struct edit_light){json_text(json_get(t->meta, "light")), {1, 1, 1}};
    e->count += e->parts[k] != NULL;
    return e->parts[k] != NULL;
}

struct edit *edit_create(const struct tensor *t, const char *path, const struct edit_settings *o) {
    struct edit *e = mem_array(1, sizeof *e);
    e->options = *o;
    if (take(e, t, path))
        return e;
    edit_destroy(e);
    return NULL;
}

void edit_destroy(struct edit *e) {
    if (!e)
        return;
    for (uint32_t k = 0; k < e->count; k++)
        edit_part_destroy(e->parts[k]);
    mem_free(e->single);
    mem_free(e);
}

// Index of the tensor of a light; UINT32_MAX: none.
static uint32_t find(const struct edit *e, const char *name, size_t length) {
    for (uint32_t k = 0; k < e->count; k++)
        if (e->lights[k].name && strlen(e->lights[k].name) == length &&
            strncmp(e->lights[k].name, name, length) == 0)
            return k;
    return UINT32_MAX;
}

// What is wrong with a tensor beside the first; NULL: nothing.
static const char *misfit(const struct edit *e, const struct tensor *t) {
    const struct tensor *first = e->tensors[0];
    const char *light = json_text(json_get(t->meta, "light"));
    const char *hash = json_text(json_get(t->meta, "scene hash"));
    const char *own = json_text(json_get(first->meta, "scene hash"));
    if (t->width != first->width || t->height != first->height)
        return "it has another size";
    if (!hash || !own || strcmp(hash, own) != 0)
        return "it is of another scene";
    if (!light || !e->lights[0].name)
        return "both must be of one light, made with --light NAME";
    if (find(e, light, strlen(light)) != UINT32_MAX)
        return "there is one of the same light";
    return e->count == EDIT_MOST_LIGHTS ? "there are too many" : NULL;
}

bool edit_add(struct edit *e, const struct tensor *t, const char *path) {
    const char *wrong = misfit(e, t);
    if (wrong) {
        log_error("%s: cannot be added to the tensors before it: %s", path, wrong);
        return false;
    }
    if (!e->single)
        e->single = mem_array(3 * plane_of(e), sizeof *e->single);
    if (!take(e, t, path))
        return false;
    struct edit_tensor *o = edit_part_objects(e->parts[e->count - 1]);
    for (uint32_t i = 0; i < o->object_count; i++)
        o->objects[i].told_sharp = true; // what is told of the first tensor holds for all
    return true;
}

const struct edit_light *edit_lights(const struct edit *e, uint32_t *count) {
    *count = e->count;
    return e->lights;
}

struct edit_tensor *edit_objects(struct edit *e) {
    return edit_part_objects(e->parts[0]);
}

const char *edit_device(const struct edit *e) {
    return edit_part_device(e->parts[0]);
}

// ---- changes ------------------------------------------------------------------------------------

static bool no_light(const struct edit *e, const char *text, const char *at) {
    char known[400] = "";
    size_t used = 0;
    for (uint32_t k = 0; k < e->count && used < sizeof known; k++)
        used += (size_t)snprintf(known + used, sizeof known - used, " %s",
                                 e->lights[k].name ? e->lights[k].name : "(all together)");
    log_error("%s: light %s: there is no tensor of that light; there are:%s", at, text, known);
    return false;
}

static bool change_light(struct edit *e, const char *text, const char *at) {
    float factor[CURVE_CHANNELS];
    const size_t length = light_factor_parse(text, at, factor);
    const uint32_t k = length ? find(e, text, length) : UINT32_MAX;
    if (length && k == UINT32_MAX)
        return no_light(e, text, at);
    if (length)
        memcpy(e->lights[k].factor, factor, sizeof factor);
    return length > 0;
}

bool edit_change(struct edit *e, enum edit_kind kind, const char *text, const char *at) {
    bool good = true;
    if (kind == EDIT_LIGHT)
        return change_light(e, text, at);
    for (uint32_t k = 0; k < e->count && good; k++)
        good = edit_part_change(e->parts[k], kind, text, at);
    return good;
}

// ---- frames -------------------------------------------------------------------------------------

bool edit_is_exact(const struct edit *e) {
    bool exact = true;
    for (uint32_t k = 0; k < e->count; k++)
        exact = exact && edit_part_is_exact(e->parts[k]);
    return exact;
}

struct edit_cost edit_last_cost(const struct edit *e) {
    struct edit_cost all = {0};
    for (uint32_t k = 0; k < e->count; k++) {
        const struct edit_cost c = edit_part_last_cost(e->parts[k]);
        all.switch_seconds += c.switch_seconds;
        all.coefficients += c.coefficients;
        all.bytes += c.bytes;
    }
    return all;
}

void edit_forget(struct edit *e) {
    for (uint32_t k = 0; k < e->count; k++)
        edit_part_forget(e->parts[k]);
}

bool edit_follow(struct edit *e) {
    bool good = true;
    for (uint32_t k = 0; k < e->count && good; k++)
        good = edit_part_follow(e->parts[k]);
    return good;
}

bool edit_compose(struct edit *e, float *frame) {
    const size_t plane = plane_of(e);
    bool good = true;
    for (uint32_t k = 0; k < e->count && good; k++) {
        float *own = k ? e->single : frame;
        const float *factor = e->lights[k].factor;
        good = edit_part_compose(e->parts[k], own);
        const bool as_it_is = k == 0 && factor[0] == 1 && factor[1] == 1 && factor[2] == 1;
        for (size_t i = 0; i < 3 * plane && good && !as_it_is; i++)
            frame[i] = (k ? frame[i] : 0) + factor[i / plane] * own[i];
    }
    return good;
}

bool edit_frame(struct edit *e, float *frame) {
    return edit_follow(e) && edit_compose(e, frame);
}

bool edit_settle(struct edit *e, float *frame) {
    bool good = edit_follow(e);
    while (good && !edit_is_exact(e))
        good = edit_follow(e);
    return good && edit_compose(e, frame);
}

void edit_variance(struct edit *e, float *variance) {
    const size_t plane = plane_of(e);
    for (uint32_t k = 0; k < e->count; k++) {
        float *own = k ? e->single : variance;
        edit_part_variance(e->parts[k], e->lights[k].factor, own);
        for (size_t i = 0; i < plane && k; i++)
            variance[i] += own[i];
    }
}
