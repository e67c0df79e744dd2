// SPDX-License-Identifier: Apache-2.0
// A group is its parent with one factor more, the largest of its albedos (or the coarse one), so
// groups of one length follow from those of the length before, and a step to an albedo that is not
// the largest goes by way of the parent: parent + albedo + last.
#include "driver/edit_groups.h"

#include <string.h>

#include "base/log.h"
#include "integrator/symbolic.h"

uint64_t edit_groups_count(uint32_t steps, uint32_t bounces, uint64_t coarse) {
    const uint32_t most = coarse ? (bounces > 1 ? bounces - 2 : 0) : bounces - 1;
    double tails = 1; // C(most + steps, steps)
    for (uint32_t i = 1; i <= most; i++)
        tails = tails * (steps + i) / i;
    const double all = coarse && bounces > 1 ? 1 + (double)coarse * tails : tails;
    return all < 0x1p62 ? (uint64_t)(all + 0.5) : UINT64_MAX;
}

// ---- factors --------------------------------------------------------------------------------

// The axis of a term's coarse curve: the first that has several functions.
static enum form_slot_name coarse_slot(const struct form *f, uint32_t term) {
    return symbolic_bins(f, term, SLOT_A) > 1 ? SLOT_A : SLOT_B;
}

// Coefficients of that curve.
static uint32_t coarse_bins(const struct form *f, uint32_t term, uint32_t most) {
    const uint32_t fine = symbolic_bins(f, term, coarse_slot(f, term));
    return fine < most ? fine : most;
}

// Whether highlights are at 0.
static bool has_lobe(const struct gamma *g) {
    return g->kind == GAMMA_THETA_R || (gamma_is_half(g->kind) && g->kind != GAMMA_PHI_H);
}

// The first function of coarse bin k, where each has one at least. A highlight is narrow where the
// later hops of a sharp edit need it to be, so bins widen from 0 on as quadratic knots do.
static uint32_t coarse_first(const struct form *f, uint32_t term, uint32_t bins, uint32_t k) {
    const enum form_slot_name slot = coarse_slot(f, term);
    const uint32_t fine = symbolic_bins(f, term, slot);
    uint64_t n = k, all = bins;
    if (fine > 1 && has_lobe(&f->term[term].slots[slot].gamma) &&
        edit_basis(f, &f->term[term].slots[slot])->spacing == SPACING_UNIFORM) {
        n *= n;
        all *= all;
    }
    const uint32_t at = (uint32_t)((n * fine + all - 1) / all);
    return at < k ? k : at;
}

// The coarse coefficient that a place of a term belongs to.
static uint32_t coarse_of(const struct form *f, uint32_t term, uint32_t place, uint32_t bins) {
    const uint32_t j = coarse_slot(f, term) == SLOT_A ? place / symbolic_bins(f, term, SLOT_B) : place;
    uint32_t k = 0;
    while (k + 1 < bins && coarse_first(f, term, bins, k + 1) <= j)
        k++;
    return k;
}

static uint32_t add_factor(struct edit_groups *g, struct edit_factor f) {
    g->factors[g->factor_count] = f;
    return g->factor_count++;
}

// Of a class its albedo; of an object that is split its terms'.
static void add_steps(struct edit_groups *g, const struct edit_plan *p,
                      const struct edit_classes *classes, const bool *split) {
    const uint32_t count = classes ? classes->count : p->count;
    for (uint32_t c = 0; c < count; c++) {
        const uint32_t first = g->factor_count;
        bool whole = true;
        for (uint32_t i = 0; i < p->count; i++) {
            if ((classes ? classes->of[i] : i) != c)
                continue;
            g->step[i] = first;
            whole = !split || !split[i] || (classes && classes->names[c]);
            for (uint32_t t = 0; !whole && t < p->objects[i].form->terms; t++)
                add_factor(g, (struct edit_factor){i, t, 0});
        }
        if (whole)
            add_factor(g, (struct edit_factor){c, EDIT_ALBEDO, 0});
    }
    g->steps = g->factor_count;
}

static uint64_t coarse_count(const struct edit_plan *p, uint32_t most) {
    uint64_t n = 0;
    for (uint32_t i = 0; i < p->count; i++)
        for (uint32_t t = 0; t < p->objects[i].form->terms; t++)
            n += coarse_bins(p->objects[i].form, t, most);
    return n;
}

// ---- groups ---------------------------------------------------------------------------------

static uint32_t add_group(struct edit_groups *g, uint32_t parent, uint32_t last) {
    g->parent[g->count] = parent;
    g->last[g->count] = last;
    return g->count++;
}

// The steps from groups [first, end) that lead to a new one, and then those that do not. Albedos
// alone count as factors that are in order; `root` groups have none.
static void extend(struct edit_groups *g, uint32_t first, uint32_t end) {
    const uint32_t m = g->steps;
    for (uint32_t i = first; i < end; i++)
        for (uint32_t o = g->last[i] < m ? g->last[i] : 0; o < m; o++)
            g->next[(size_t)i * m + o] = add_group(g, i, o);
    for (uint32_t i = first; i < end; i++)
        for (uint32_t o = 0; g->last[i] < m && o < g->last[i]; o++) {
            const uint32_t other = g->next[(size_t)g->parent[i] * m + o];
            g->next[(size_t)i * m + o] = g->next[(size_t)other * m + g->last[i]];
        }
}

// A group for each coarse coefficient, and by way of them a step from each place.
static void add_coarse(struct edit_groups *g, const struct edit_plan *p, uint32_t most) {
    for (uint32_t i = 0; i < p->count; i++) {
        const struct form *f = p->objects[i].form;
        uint32_t places = 0, at = 0;
        for (uint32_t t = 0; t < f->terms; t++)
            places += symbolic_places(f, t);
        g->second[i] = mem_array(places, sizeof *g->second[i]);
        for (uint32_t t = 0; t < f->terms; t++) {
            const uint32_t bins = coarse_bins(f, t, most), first = g->count;
            for (uint32_t k = 0; k < bins; k++)
                add_group(g, 0, add_factor(g, (struct edit_factor){i, t, k}));
            for (uint32_t j = 0; j < symbolic_places(f, t); j++)
                g->second[i][at++] = first + coarse_of(f, t, j, bins);
        }
    }
}

static bool check_series(const uint32_t *series, uint32_t bounces) {
    for (uint32_t i = 0; i < bounces; i++)
        if (series[i] < 1 || (i > 0 && series[i] > series[i - 1]) || (i > 1 && series[i] != 1)) {
            log_error("--series: expected numbers of bins that do not grow, of which the third and "
                      "those after it are 1; found %u for hop %u", series[i], i + 1);
            return false;
        }
    return true;
}

static bool check_count(uint64_t count, uint32_t steps, uint32_t bounces) {
    if (count <= EDIT_MOST_GROUPS)
        return true;
    log_error("%u albedos and %u bounces make %.3g products of factors, more than %d; expected fewer "
              "bounces, --group, or fewer bins at the second hop", steps, bounces,
              (double)count, EDIT_MOST_GROUPS);
    return false;
}

bool edit_groups_init(struct edit_groups *g, const struct edit_plan *plan,
                      const struct edit_classes *classes, const bool *split, const uint32_t *series,
                      uint32_t bounces) {
    *g = (struct edit_groups){.objects = plan->count, .bounces = bounces,
                              .coarse = bounces > 1 ? series[1] : 1};
    const uint64_t coarse = g->coarse > 1 ? coarse_count(plan, g->coarse) : 0;
    g->step = mem_array(plan->count, sizeof *g->step);
    g->factors = mem_array((size_t)plan->count * FORM_TERMS + coarse, sizeof *g->factors);
    add_steps(g, plan, classes, split);
    const uint64_t count = edit_groups_count(g->steps, bounces, coarse);
    if (!check_series(series, bounces) || !check_count(count, g->steps, bounces)) {
        edit_groups_finish(g);
        return false;
    }
    const size_t steps = (size_t)count * g->steps;
    g->second = mem_array(plan->count, sizeof *g->second);
    g->parent = mem_array(count, sizeof *g->parent);
    g->last = mem_array(count, sizeof *g->last);
    g->next = mem_array(steps, sizeof *g->next);
    memset(g->next, 0xff, steps * sizeof *g->next);
    add_group(g, 0, UINT32_MAX);
    uint32_t first = 0;
    if (coarse) {
        add_coarse(g, plan, g->coarse);
        first = 1;
    }
    for (uint32_t hop = coarse ? 2 : 1; hop < bounces; hop++) {
        const uint32_t end = g->count;
        extend(g, first, end);
        first = end;
    }
    return true;
}

void edit_groups_finish(struct edit_groups *g) {
    for (uint32_t i = 0; g->second && i < g->objects; i++)
        mem_free(g->second[i]);
    mem_free(g->second);
    mem_free(g->step);
    mem_free(g->factors);
    mem_free(g->parent);
    mem_free(g->last);
    mem_free(g->next);
    *g = (struct edit_groups){.count = 0};
}

uint32_t edit_group_factors(const struct edit_groups *g, uint32_t group,
                            uint32_t factors[EDIT_MOST_BOUNCES]) {
    uint32_t n = 0;
    for (uint32_t i = group; i != 0; i = g->parent[i])
        factors[n++] = g->last[i];
    for (uint32_t i = 0; 2 * i + 1 < n; i++) {
        const uint32_t swap = factors[i];
        factors[i] = factors[n - 1 - i];
        factors[n - 1 - i] = swap;
    }
    return n;
}

// ---- metadata -------------------------------------------------------------------------------

// The lower border of where function j of a basis lies: its bin, or half way to its neighbour.
static double border(const struct basis *b, uint32_t j) {
    if (b->kind == BASIS_BOX || j == 0)
        return b->knots[j];
    return j < b->count ? 0.5 * (b->knots[j - 1] + b->knots[j]) : b->knots[j - 1];
}

// knots of a term's curve over at most that many bins.
static uint32_t find_knots(const struct form *f, uint32_t term, uint32_t most,
                           enum form_slot_name *slot, double *knots) {
    const uint32_t bins = coarse_bins(f, term, most);
    *slot = coarse_slot(f, term);
    const uint32_t fine = symbolic_bins(f, term, *slot);
    for (uint32_t k = 0; k <= bins; k++)
        knots[k] = fine > 1 ? border(edit_basis(f, &f->term[term].slots[*slot]),
                                     coarse_first(f, term, bins, k))
                            : CURVE_END * k;
    return bins;
}

uint32_t edit_groups_coarse(const struct edit_groups *g, const struct form *f, uint32_t term,
                            enum form_slot_name *slot, double *knots) {
    return find_knots(f, term, g->coarse, slot, knots);
}

void edit_groups_describe(const struct edit_groups *g, const struct edit_plan *plan,
                          const struct edit_classes *classes, struct json *meta) {
    struct json *factors = json_add_array(meta, "factors"), *groups = json_add_array(meta, "groups");
    double *knots = mem_array(g->coarse + 1, sizeof *knots);
    for (uint32_t i = 0; i < g->factor_count; i++) {
        const struct edit_factor *f = &g->factors[i];
        struct json *j = json_append_object(factors);
        if (f->term == EDIT_ALBEDO) {
            edit_classes_describe(classes, plan, f->object, j);
            continue;
        }
        const struct form *form = plan->objects[f->object].form;
        json_add_count(j, "object", f->object);
        json_add_count(j, "term", f->term);
        json_add_count(j, "bin", f->bin);
        enum form_slot_name slot;
        const uint32_t bins = find_knots(form, f->term, i < g->steps ? 1 : g->coarse, &slot, knots);
        struct json *list = json_add_array(j, "knots");
        for (uint32_t k = 0; k <= bins; k++)
            json_append_number(list, knots[k]);
    }
    mem_free(knots);
    for (uint32_t i = 0; i < g->count; i++) {
        uint32_t list[EDIT_MOST_BOUNCES];
        const uint32_t n = edit_group_factors(g, i, list);
        struct json *j = json_append_array(groups);
        for (uint32_t k = 0; k < n; k++)
            json_append_count(j, list[k]);
    }
}
