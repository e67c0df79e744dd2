// SPDX-License-Identifier: Apache-2.0
// A large table of a sky makes a single sample wait for memory several times. Samples of a sky that
// is the only light need no place, so those of many lanes can wait together.
#include "integrator/path.h"

// Whether the lane will need a sample, as far as is known before its material is evaluated.
static bool is_wanted(const struct path *p, const struct world *w, const struct lane *l,
                      const struct accel_hit *hit) {
    if (hit->shape == SCENE_NONE || !path_may_contribute(p, l->events + 1))
        return false;
    return w->shapes[hit->shape].smooth || w->shapes[hit->shape].wide_kind;
}

static void draw(struct lane *lanes, const uint16_t *list, uint32_t count, wide u[2]) {
    struct lane *from[WIDE_LANES];
    struct lane_state state;
    for (uint32_t i = 0; i < WIDE_LANES; i++)
        from[i] = &lanes[list[i < count ? i : 0]];
    path_gather_state(from, &state);
    path_draw(from, &state, DRAW_LIGHT_POINT, u);
}

static void keep(const struct light_samples *s, wide_mask lit, const uint16_t *list, uint32_t count,
                 uint32_t k, struct step *out) {
    const wide none = {0}, pdf_sa = wide_select(lit, s->pdf_sa, none);
    const wide of[4] = {s->wi.x, s->wi.y, s->wi.z, pdf_sa};
    const wide emission[4] = {s->emission.x, s->emission.y, s->emission.z, none};
    struct light_ahead spare;
    float *to[2][WIDE_LANES];
    for (uint32_t i = 0; i < WIDE_LANES; i++) {
        struct light_ahead *l = &spare;
        if (i < count)
            l = k ? &out->more[list[i]][k - 1] : &out->lights[list[i]];
        to[0][i] = l->wi;
        to[1][i] = (float *)(void *)&l->emission;
    }
    wide_scatter4(of, to[0]);
    wide_scatter4(emission, to[1]);
}

// Candidates [first, end) of `all` of the lanes listed, LIGHT_GROUPS groups at most.
static void take(const struct world *w, struct lane *lanes, const uint16_t *list, uint32_t count,
                 uint32_t first, uint32_t end, uint32_t all, struct step *out) {
    wide u[LIGHT_GROUPS][2], shifted[LIGHT_GROUPS][2];
    struct light_samples s[LIGHT_GROUPS];
    wide_mask lit[LIGHT_GROUPS];
    const uint32_t groups = (count + WIDE_LANES - 1) / WIDE_LANES;
    for (uint32_t g = 0; g < groups; g++)
        draw(lanes, list + g * WIDE_LANES, count - g * WIDE_LANES, u[g]);
    for (uint32_t k = first; k < end; k++) {
        const struct candidate_shift shift = candidate_shift(k, all);
        for (uint32_t g = 0; g < groups; g++) {
            shifted[g][0] = candidate_numbers(u[g][0], shift.x);
            shifted[g][1] = candidate_numbers(u[g][1], shift.y);
        }
        world_sample_far(w, (int)groups, (const wide(*)[2])shifted, s, lit);
        for (uint32_t g = 0; g < groups; g++)
            keep(&s[g], lit[g], list + g * WIDE_LANES, count - g * WIDE_LANES, k, out);
    }
}

static void take_all(const struct world *w, struct lane *lanes, const uint16_t *list, uint32_t count,
                     uint32_t first, uint32_t end, uint32_t all, struct step *out) {
    const uint32_t most = LIGHT_GROUPS * WIDE_LANES;
    for (uint32_t i = 0; i < count; i += most)
        take(w, lanes, list + i, count - i < most ? count - i : most, first, end, all, out);
}

void path_sample_ahead(const struct path *p, const struct trace_context *ctx, struct lane *lanes,
                       const uint16_t *list, uint32_t count, struct step *step) {
    const struct world *w = ctx->world;
    const uint32_t candidates = path_candidates(p, ctx, LOBE_GLOSSY);
    uint16_t wanted[MOST_LANES], glossy[MOST_LANES];
    uint32_t n = 0, several = 0;
    step->ahead = world_lights_are_far(w);
    for (uint32_t k = 0; step->ahead && k < count; k++) {
        const struct accel_hit *hit = &step->hits[list[k]];
        const bool wants = is_wanted(p, w, &lanes[list[k]], hit);
        wanted[n] = list[k];
        glossy[several] = list[k];
        n += wants;
        several += wants && candidates > 1 && w->shapes[hit->shape].glossy;
        step->lights[list[k]].pdf_sa = -1;
    }
    take_all(w, lanes, wanted, n, 0, 1, candidates, step);
    take_all(w, lanes, glossy, several, 1, candidates, candidates, step);
}

struct light_sample path_light_ahead(const struct world *w, const struct light_ahead *l) {
    return (struct light_sample){.wi = v3(l->wi[0], l->wi[1], l->wi[2]), .distance = INFINITY,
                                 .pdf_sa = l->pdf_sa, .emission = l->emission,
                                 .late = w->lights[0].type->aim != NULL};
}

uint32_t path_lights_ahead(const struct world *w, const struct light_ahead *const l[WIDE_LANES],
                           uint32_t wanted, struct light_lanes *out) {
    const float *row[WIDE_LANES];
    wide of[4];
    for (int i = 0; i < WIDE_LANES; i++) {
        row[i] = l[i]->wi;
        out->emission[i] = l[i]->emission;
        out->light[i] = 0;
    }
    wide_gather4(row, of);
    out->s = (struct light_samples){.wi = {of[0], of[1], of[2]}, .pdf_sa = of[3],
                                    .distance = wide_of(INFINITY)};
    out->delta = 0;
    out->late = w->lights[0].type->aim ? wanted : 0;
    return wanted & wide_bits(of[3] > 0);
}
