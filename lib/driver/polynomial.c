// SPDX-License-Identifier: Apache-2.0
// A scene made ready for symbolic path tracing: which shape is which object, and who answers how.
#include "driver/precompute_polynomial.h"

#include <string.h>

#include "base/thread.h"
#include "bsdf/diffuse.h"
#include "bsdf/editable_data.h"
#include "curve/form_albedo.h"
#include "driver/polynomial_describe.h"
#include "driver/polynomial_pilot.h"

const char *const polynomial_tails[] = {"none", "frozen", "geometric", NULL};
const char *const polynomial_laters[] = {"lambertian", "kept", "terms", NULL};

// ---- the scene --------------------------------------------------------------------------------

enum { BINS_B = 8 }; // of a second curve, unless the material says how many

// No curve needs more bins than the eye's hop has; one that is constant needs two.
static void limit_bins(struct object *o, uint32_t most) {
    struct editable *e = o->data;
    const int limit = most > 2 ? (int)most : 2;
    if (o->type != &bsdf_editable.entry)
        return;
    e->bins = e->bins < limit ? e->bins : limit;
    e->bins_b = e->bins_b > 1 ? e->bins_b : BINS_B;
    e->bins_b = e->bins_b < limit ? e->bins_b : limit;
    if (e->bins_constant < 0 && !e->edit[SLOT_O] && !e->edit[SLOT_A] && !e->edit[SLOT_B])
        e->bins_constant = 2;
}

struct edit_request {
    const struct polynomial_options *options;
    bool done;
};

static void edit_scene(struct scene *s, void *user) {
    struct edit_request *r = user;
    const struct polynomial_options *o = r->options;
    r->done = edit_convert(s, o->edit, o->edit_count, 0);
    for (uint32_t i = 0; i < s->bsdf_count; i++)
        limit_bins(s->bsdfs[i], o->series[0]);
}

// The editable material of a shape: its own, or that inside a twosided. NULL: it is fixed.
static const struct object *editable_of(const struct object *bsdf, bool *two_sided) {
    const struct param *front = param_find(bsdf->type, "front"), *back;
    const struct object *inside = bsdf, *other = NULL;
    *two_sided = false;
    if (bsdf->type == &bsdf_twosided.entry && front) {
        back = param_find(bsdf->type, "back");
        memcpy(&inside, (const char *)bsdf->data + front->offset, sizeof inside);
        memcpy(&other, (const char *)bsdf->data + back->offset, sizeof other);
        *two_sided = true;
    }
    return inside->type == &bsdf_editable.entry && !other ? inside : NULL;
}

// A Lambertian material of albedo 1, as what is editable answers at later hops.
static struct object *make_white(struct arena *arena, bool two_sided) {
    struct object *o = arena_alloc(arena, sizeof *o), *front = arena_alloc(arena, sizeof *front);
    struct diffuse *d = arena_alloc(arena, sizeof *d);
    d->reflectance.value = spectrum_grey(1);
    *front = (struct object){.type = &bsdf_diffuse.entry, .data = d};
    if (!two_sided)
        return front;
    *o = (struct object){.type = &bsdf_twosided.entry,
                         .data = arena_alloc(arena, bsdf_twosided.entry.size)};
    memcpy((char *)o->data + param_find(o->type, "front")->offset, &front, sizeof front);
    return o;
}

static void shade_white_wide(struct polynomial *p, const int *object, const bool *two_sided) {
    const struct object *white[2] = {make_white(&p->arena, false), make_white(&p->arena, true)};
    for (uint32_t i = 0; i < p->job.scene->shape_count; i++)
        if (object[i] != CHAIN_FIXED)
            world_shade_wide(p->job.world, i, white[two_sided[i]]);
}

static void find_objects(struct polynomial *p) {
    const struct scene *s = p->job.scene;
    int *object = arena_alloc(&p->arena, (s->shape_count + 1) * sizeof *object);
    bool *two_sided = arena_alloc(&p->arena, (s->shape_count + 1) * sizeof *two_sided);
    for (uint32_t i = 0; i < s->shape_count; i++) {
        const struct object *material = editable_of(s->shapes[i].bsdf, &two_sided[i]);
        object[i] = material ? (int)edit_plan_find(&p->plan, material->data) : CHAIN_FIXED;
    }
    shade_white_wide(p, object, two_sided);
    p->response.object_of_shape = object;
    p->response.two_sided = two_sided;
}

// An object that no shape shows but through a wrapper would be edited in vain.
static bool all_are_found(const struct polynomial *p) {
    for (uint32_t i = 0; i < p->plan.count; i++) {
        bool found = false;
        for (uint32_t s = 0; s < p->job.scene->shape_count; s++)
            found = found || p->response.object_of_shape[s] == (int)i;
        if (!found) {
            log_error("%s: editable material \"%s\" is inside another one; with --bounces it may "
                      "stand alone or in a twosided", p->job.scene->path, p->plan.objects[i].name);
            return false;
        }
    }
    return true;
}

// ---- the response -----------------------------------------------------------------------------

static bool is_flat(const struct curve *c) {
    for (uint32_t i = 1; i < c->channels * c->basis.count; i++)
        if (c->values[i] != c->values[0])
            return false;
    return true;
}

static bool is_lambertian(const struct edit_object *o) {
    bool even = true;
    for (uint32_t t = 0; t < o->form->terms; t++)
        even = even && o->form->term[t].quotient.kind == QUOTIENT_ONE &&
               !o->form->term[t].quotient.has_fresnel && !editable_texture(o->material, t)->texture;
    for (uint32_t c = 0; c < o->form->curves; c++)
        even = even && is_flat(o->form->curve[c].f[0].table);
    return even;
}

// Lambertian surfaces are shaded faster without, and an albedo of nearly 0 has no shape.
static bool has_shape(const struct edit_object *o, const double albedo[CURVE_CHANNELS]) {
    return !is_lambertian(o) && albedo[0] > 1e-3 && albedo[1] > 1e-3 && albedo[2] > 1e-3;
}

// The terms of an object at later hops, over the values that their factors have as it is.
static void split_later(struct polynomial *p, uint32_t object) {
    struct symbolic_object *o = &p->objects[object];
    for (uint32_t t = 0; t < o->form->terms; t++) {
        const double *e = p->albedos[object][t];
        double value[CURVE_CHANNELS];
        form_term_albedo(o->form, t, e, value);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++) {
            double all = 0;
            for (uint32_t j = 0; j < symbolic_places(o->form, t); j++)
                all += e[j * CURVE_CHANNELS + k];
            value[k] = value[k] > 1e-3 ? o->form->term[t].scale[k] * all / value[k] : 0;
        }
        const bool keeps = value[0] > 0 && value[1] > 0 && value[2] > 0;
        o->lacks = o->lacks || !keeps;
        o->part[t] = keeps ? spectrum_rgb((float)value[0], (float)value[1], (float)value[2])
                           : spectrum_grey(0);
    }
}

// What an object answers at later hops.
static void choose_later(struct polynomial *p, uint32_t object, enum polynomial_later later) {
    struct symbolic_object *o = &p->objects[object];
    const double *b = p->classes.base[object];
    double albedo[CURVE_CHANNELS];
    o->factor = p->groups.step[object];
    o->splits = p->groups.factors[o->factor].term != EDIT_ALBEDO;
    o->scale = spectrum_rgb((float)b[0], (float)b[1], (float)b[2]);
    if (o->splits)
        split_later(p, object);
    if (o->splits || later == LATER_LAMBERTIAN)
        return;
    edit_plan_albedo(&p->plan, object, p->albedos[object], albedo);
    o->keeps = has_shape(&p->plan.objects[object], albedo);
    if (o->keeps)
        o->scale = spectrum_rgb((float)(b[0] / albedo[0]), (float)(b[1] / albedo[1]),
                                (float)(b[2] / albedo[2]));
}

// Draws the bins that the second hop tells apart, all as likely, so that a narrow one is not left
// to the few samples of few fine bins.
static void init_coarse(struct polynomial *p, struct symbolic_object *o) {
    struct form coarse = *o->form;
    for (uint32_t t = 0; t < coarse.terms; t++) {
        enum form_slot_name slot;
        double *knots = arena_alloc(&p->arena, (p->groups.coarse + 1) * sizeof *knots);
        const uint32_t bins = edit_groups_coarse(&p->groups, o->form, t, &slot, knots);
        if (!edit_term_has(&coarse.term[t], slot) || bins < 2)
            continue;
        struct curve *table = arena_alloc(&p->arena, sizeof *table);
        const struct basis basis = {BASIS_BOX, SPACING_ANY, bins, knots};
        *table = curve_make(&p->arena, &basis, 1);
        for (uint32_t k = 0; k < CURVE_CHANNELS; k++)
            coarse.curve[coarse.term[t].slots[slot].curve].f[k] =
                (struct curve_function){.kind = FUNCTION_TABLE, .table = table};
    }
    bin_sampler_init(&o->coarse, &coarse, &p->arena);
}

static void make_response(struct polynomial *p, const struct polynomial_options *options) {
    p->objects = arena_alloc(&p->arena, p->plan.count * sizeof *p->objects);
    for (uint32_t i = 0; i < p->plan.count; i++) {
        struct symbolic_object *o = &p->objects[i];
        symbolic_object_init(o, p->plan.objects[i].form, &p->arena);
        for (uint32_t t = 0; t < o->form->terms; t++)
            o->texture[t] = editable_texture(p->plan.objects[i].material, t);
        symbolic_object_ready(o);
        o->second = p->groups.second[i];
        if (o->second)
            init_coarse(p, o);
        choose_later(p, i, options->later);
    }
    symbolic_init(&p->response);
    p->response.objects = p->objects;
    p->response.factors = p->groups.steps;
    p->response.bounces = options->bounces;
    p->response.next = p->groups.next;
    p->survey = p->response;
    p->survey.survey = true;
}

// Path tracing, with what the scene says of it where it asks for that.
static void make_integrator(struct polynomial *p, const struct polynomial_options *o) {
    const struct object *given = p->job.scene->integrator;
    p->path = (struct path){.max_depth = -1, .rr_depth = 3, .shading_samples = 1};
    if (given->type == &integrator_path.entry)
        p->path = *(const struct path *)given->data;
    if (o->tail != TAIL_FROZEN)
        p->path.max_depth = (int)o->bounces + 1;
    p->integrator = (struct object){.type = &integrator_path.entry, .data = &p->path};
    p->tracer = p->job.render.tracer;
    p->tracer.integrator = &p->integrator;
    p->tracer.response = &p->response.response;
    p->tracer.spp = (p->tracer.spp + 1) / 2 * 2;
    p->tracer.replicates = 2; // the half-sums
}

// What objects pass on need not be known where each is alone.
static bool make_classes(struct polynomial *p, const struct polynomial_options *o) {
    double(*passed)[CURVE_CHANNELS] = mem_array(p->plan.count, sizeof *passed);
    if (o->group_count > 0)
        polynomial_passed(p, o->bounces, passed);
    const bool done = edit_classes_init(&p->classes, &p->plan, p->albedos,
                                        (const double(*)[CURVE_CHANNELS])passed, o->group,
                                        o->group_count);
    mem_free(passed);
    return done;
}

static bool scene_fits(const struct scene *s) {
    if (s->medium_count == 0)
        return true;
    log_error("%s: found participating media; materials are edited in scenes without", s->path);
    return false;
}

// Objects whose terms differ, by object, where that is asked for; NULL: none.
static const bool *find_split(struct polynomial *p, enum polynomial_later later) {
    bool *split = arena_alloc(&p->arena, p->plan.count * sizeof *split);
    for (uint32_t i = 0; i < p->plan.count; i++)
        split[i] = p->plan.objects[i].form->terms > 1 && !is_lambertian(&p->plan.objects[i]);
    return later == LATER_TERMS ? split : NULL;
}

// A path's marks multiply at hops whose terms have factors. Two of a term's coarse coefficients can be
// met at once, that of a hat and its neighbour's.
static bool marks_fit(const struct polynomial *p, const struct polynomial_options *o) {
    uint64_t all = 1, terms = 1, marks = 1; // all: split or not
    for (uint32_t i = 0; i < p->plan.count; i++) {
        const uint32_t own = p->plan.objects[i].form->terms;
        all = own > all ? own : all;
        if (p->groups.factors[p->groups.step[i]].term != EDIT_ALBEDO)
            terms = own > terms ? own : terms;
    }
    for (uint32_t hop = 1; hop < o->bounces && marks <= CHAIN_MARKS; hop++)
        marks *= hop == 1 && o->series[1] > 1 ? 2 * all : terms;
    if (terms == 1 || marks <= CHAIN_MARKS)
        return true;
    log_error("--later terms: %u terms of a material and %u bounces make more than %d products on a "
              "path; expected fewer bounces, or --later kept", (uint32_t)terms, o->bounces, CHAIN_MARKS);
    return false;
}

bool polynomial_open(struct polynomial *p, const struct polynomial_options *o) {
    struct edit_request request = {.options = o, .done = true};
    struct job_options job = o->job;
    job.edit_scene = edit_scene;
    job.edit_user = &request;
    *p = (struct polynomial){.path = {.max_depth = -1}};
    if (!job_open(&p->job, &job))
        return false;
    bool done = request.done && scene_fits(p->job.scene) && edit_plan_init(&p->plan, p->job.scene);
    if (done)
        find_objects(p);
    if (done)
        make_integrator(p, o);
    if (done)
        polynomial_albedos(p, o->job.threads > 0 ? o->job.threads : thread_default_count());
    if (done && all_are_found(p) && make_classes(p, o) &&
        edit_groups_init(&p->groups, &p->plan, &p->classes, find_split(p, o->later), o->series,
                         o->bounces) && marks_fit(p, o)) {
        make_response(p, o);
        return true;
    }
    polynomial_close(p);
    return false;
}

void polynomial_close(struct polynomial *p) {
    edit_groups_finish(&p->groups);
    edit_classes_finish(&p->classes);
    edit_plan_finish(&p->plan);
    arena_finish(&p->arena);
    job_close(&p->job);
}
