// SPDX-License-Identifier: Apache-2.0
#include "world/light_lanes.h"

static void set_sample(struct light_lanes *out, int i, const struct light_sample *l) {
    wide3_set_lane(&out->s.wi, i, l->wi);
    wide3_set_lane(&out->s.p, i, l->p);
    wide3_set_lane(&out->s.p_error, i, l->p_error);
    wide3_set_lane(&out->s.n, i, l->n);
    out->s.distance[i] = l->distance;
    out->s.pdf_sa[i] = l->pdf_sa;
    out->emission[i] = l->emission;
    out->delta |= (uint32_t)l->delta << i;
    out->late |= (uint32_t)l->late << i;
}

static void merge(wide_mask m, const struct light_samples *from, struct light_samples *to) {
    to->wi = wide3_select(m, from->wi, to->wi);
    to->p = wide3_select(m, from->p, to->p);
    to->p_error = wide3_select(m, from->p_error, to->p_error);
    to->n = wide3_select(m, from->n, to->n);
    to->distance = wide_select(m, from->distance, to->distance);
    to->pdf_sa = wide_select(m, from->pdf_sa, to->pdf_sa);
}

void light_lanes_merge(uint32_t lanes, const struct light_lanes *from, struct light_lanes *to) {
    merge(wide_mask_of(lanes), &from->s, &to->s);
    to->delta = (to->delta & ~lanes) | (from->delta & lanes);
    to->late = (to->late & ~lanes) | (from->late & lanes);
    for (uint32_t left = lanes; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        to->emission[i] = from->emission[i];
        to->light[i] = from->light[i];
    }
}

static bool is_wide(const struct world_light *l) {
    return l->type->sample_wide && (!l->type->has_wide || l->type->has_wide(l->data));
}

// Lanes that do not sample this light read no memory of their own.
static wide of_lanes(uint32_t lanes, wide u) {
    return wide_select(wide_mask_of(lanes), u, wide_of(u[__builtin_ctz(lanes)]));
}

static void scatter_emission(uint32_t lit, const struct wide3 *emission, struct light_lanes *out) {
    const wide rows[4] = {emission->x, emission->y, emission->z, (wide){0}};
    float spare[4], *to[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        to[i] = lit >> i & 1 ? (float *)(void *)&out->emission[i] : spare;
    wide_scatter4(rows, to);
}

// One light for many lanes.
static uint32_t sample_together(const struct world_light *l, uint32_t lanes, const struct wide3 *p,
                                const wide u[2], wide pmf, struct light_lanes *out) {
    struct light_samples s;
    const wide theirs[2] = {of_lanes(lanes, u[0]), of_lanes(lanes, u[1])};
    const uint32_t lit = lanes & wide_bits(l->type->sample_wide(l->data, p, theirs, &s));
    s.pdf_sa *= pmf;
    merge(wide_mask_of(lit), &s, &out->s);
    scatter_emission(lit, &s.emission, out);
    out->late |= l->type->aim ? lit : 0;
    return lit;
}

static uint32_t sample_alone(const struct world_light *l, uint32_t lanes, const struct wide3 *p,
                             const wide u[2], wide pmf, struct light_lanes *out) {
    uint32_t lit = 0;
    for (uint32_t left = lanes; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        struct light_sample s;
        if (!light_chosen_sample(l, l->first_part, NULL, wide3_lane(p, i),
                                 (struct vec2){u[0][i], u[1][i]}, pmf[i], &s))
            continue;
        set_sample(out, i, &s);
        lit |= 1u << i;
    }
    return lit;
}

// The only light.
static uint32_t sample_only(const struct world *w, uint32_t wanted, const struct wide3 *p,
                            const wide u2[2], struct light_lanes *out) {
    const struct world_light *l = &w->lights[0];
    memset(out->light, 0, sizeof out->light);
    return is_wide(l) ? sample_together(l, wanted, p, u2, wide_of(1), out)
                      : sample_alone(l, wanted, p, u2, wide_of(1), out);
}

// Lights chosen by a table: light by light, with all lanes that chose it.
static uint32_t sample_chosen(const struct world *w, uint32_t wanted, const struct wide3 *p,
                              wide u1, const wide u2[2], struct light_lanes *out) {
    float pmfs[WIDE_LANES] = {0};
    uint32_t lit = 0;
    for (uint32_t left = wanted; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        out->light[i] = light_choice_of_all(&w->choice, w->light_count, u1[i], &pmfs[i]);
    }
    const wide pmf = wide_load(pmfs);
    for (uint32_t left = wanted; left;) {
        const uint32_t light = out->light[__builtin_ctz(left)];
        uint32_t lanes = 0;
        for (uint32_t rest = left; rest; rest &= rest - 1)
            lanes |= (uint32_t)(out->light[__builtin_ctz(rest)] == light) << __builtin_ctz(rest);
        const struct world_light *l = &w->lights[light];
        lit |= is_wide(l) ? sample_together(l, lanes, p, u2, pmf, out)
                          : sample_alone(l, lanes, p, u2, pmf, out);
        left &= ~lanes;
    }
    return lit;
}

// Lights chosen by part, for which the lanes wait together.
static uint32_t sample_parts(const struct world *w, uint32_t wanted, const struct wide3 *p,
                             const struct wide3 *side, wide u1, const wide u2[2],
                             struct light_lanes *out) {
    struct light_place at[WIDE_LANES];
    struct light_parts chosen;
    uint32_t lit = 0;
    for (int i = 0; i < WIDE_LANES; i++)
        at[i] = (struct light_place){wide3_lane(p, i), wide3_lane(side, i)};
    uint32_t left = light_choice_parts(&w->choice, w->lights, wanted, at, u1, u2, &chosen);
    for (; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const struct vec2 u = {u2[0][i], u2[1][i]};
        struct light_sample l;
        out->light[i] = chosen.light[i];
        if (!light_chosen_sample(&w->lights[chosen.light[i]], chosen.part[i], chosen.leaf[i],
                                 at[i].p, u, chosen.pmf[i], &l))
            continue;
        set_sample(out, i, &l);
        lit |= 1u << i;
    }
    return lit;
}

uint32_t world_sample_lights(const struct world *w, uint32_t wanted, const struct wide3 *p,
                             const struct wide3 *side, wide u1, const wide u2[2],
                             struct light_lanes *out) {
    out->delta = out->late = 0;
    if (w->light_count == 0)
        return 0;
    if (w->choice.by_part)
        return sample_parts(w, wanted, p, side, u1, u2, out);
    return w->light_count == 1 ? sample_only(w, wanted, p, u2, out)
                               : sample_chosen(w, wanted, p, u1, u2, out);
}

bool world_has_only_a_sky(const struct world *w) {
    return w->light_count == 1 && w->lights[0].type->infinite && !w->lights[0].type->delta;
}

bool world_lights_are_far(const struct world *w) {
    return world_has_only_a_sky(w) && !w->choice.by_part && is_wide(&w->lights[0]);
}

void world_sample_far(const struct world *w, int groups, const wide u[][2],
                      struct light_samples s[], wide_mask lit[]) {
    const struct world_light *l = &w->lights[0];
    const struct wide3 anywhere = {0};
    if (l->type->sample_groups)
        l->type->sample_groups(l->data, groups, u, s, lit);
    else
        for (int g = 0; g < groups; g++)
            lit[g] = l->type->sample_wide(l->data, &anywhere, u[g], &s[g]);
}

void world_shadow_rays(const struct surfaces *s, const struct light_samples *l, struct wide3 *o,
                       struct wide3 *d, wide *tmax) {
    *o = surfaces_offset(s, l->wi);
    const struct wide3 straight = wide3_sub(l->p, *o);
    const wide reach = 4 * 0x1p-24f * wide_largest(straight);
    const struct wide3 error = {l->p_error.x + reach, l->p_error.y + reach, l->p_error.z + reach};
    const struct wide3 back = {-l->wi.x, -l->wi.y, -l->wi.z};
    const struct wide3 target = wide_offset_point(l->p, error, l->n, back);
    const wide_mask faces = wide_dot(l->n, l->n) > 0, near = l->distance < INFINITY;
    *d = wide3_select(near, wide3_select(faces, wide3_sub(target, *o), straight), l->wi);
    *tmax = wide_select(near, wide_of(1), wide_of(INFINITY));
}
