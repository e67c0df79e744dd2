// SPDX-License-Identifier: Apache-2.0
// Materials that are shaded WIDE_LANES points at once give every lane the bits of one alone: packets of
// random directions and numbers, their lanes mixed of all parameter sets that share a kind.
#include "bsdf/bsdf_wide.h"
#include "check.h"
#include "property/bsdf_cases.h"

enum { MOST = 2000, PACKETS = 4000 };

struct material {
    const struct object *object;
    struct wide_material wide;
};

static struct material all[MOST];
static int count;

static void collect(struct arena *arena) {
    for (int row = 0; row < BSDF_ROWS; row++) {
        const struct entry *e = registry_find(&bsdfs, bsdf_rows[row].name);
        const bool may = ((const struct bsdf_type *)(const void *)e)->widen != NULL;
        for (int i = 0; may && i < bsdf_row_sets(row) && count < MOST; i++) {
            const struct bsdf_case c = bsdf_case_at(arena, row, i);
            struct material m = {.object = bsdf_case_make(arena, &c)};
            if (bsdf_wide(m.object, &m.wide))
                all[count++] = m;
        }
    }
}

// A tenth of them near the horizon.
static vec3 random_direction(struct rng *rng) {
    const float turn = rng_float(rng), height = rng_float(rng);
    const float z = rng_u32(rng) % 10 ? height : 1e-3f * height + 1e-7f;
    const float r = sqrtf(maxf(1 - z * z, 0));
    return v3(r * cosf(TWO_PI * turn), r * sinf(TWO_PI * turn), z);
}

struct packet {
    const struct object *object[WIDE_LANES];
    struct wide_points points;
    struct wide3 wo, wi;
    wide u1, u2[2];
};

static void fill(struct packet *p, const struct wide_bsdf *kind, struct rng *rng) {
    const struct bsdf_point point = bsdf_case_point();
    for (int i = 0; i < WIDE_LANES; i++) {
        const struct material *m;
        do
            m = &all[rng_u32(rng) % (uint32_t)count];
        while (m->wide.kind != kind);
        p->object[i] = m->object;
        p->points.data[i] = m->wide.data;
        p->points.at[i] = point.at;
        wide3_set_lane(&p->wo, i, random_direction(rng));
        wide3_set_lane(&p->wi, i, random_direction(rng));
        if (rng_u32(rng) % 8 == 0)
            p->wi.z[i] = -p->wi.z[i];
        p->u1[i] = rng_float(rng);
        p->u2[0][i] = rng_float(rng);
        p->u2[1][i] = rng_float(rng);
    }
}

static bool same3(const struct wide3 *w, int i, vec3 v) {
    const vec3 a = wide3_lane(w, i);
    return a[0] == v[0] && a[1] == v[1] && a[2] == v[2];
}

// Lanes that differ; `lit` counts those that show something.
static int compare(const struct packet *p, const struct wide_bsdf *kind, int *lit) {
    const struct bsdf_point point = bsdf_case_point();
    struct wide_closures closures;
    struct wide_samples s;
    wide pdf;
    int different = 0;
    kind->resolve(&p->points, &p->wo, &closures);
    const struct wide3 f = kind->eval(&closures, &p->wi, &pdf);
    const uint32_t scattered = wide_bits(kind->sample(&closures, p->u1, p->u2, &s));
    for (int i = 0; i < WIDE_LANES; i++) {
        static struct closure_stack stack;
        struct bsdf_sample one = {.weight = spectrum_grey(0)};
        spectrum value = spectrum_grey(0);
        float density = 0;
        bool ok = false;
        stack.used = 0;
        const struct closure *c =
            bsdf_resolve(p->object[i], &point, wide3_lane(&p->wo, i), &stack);
        if (c) {
            value = closure_eval(c, wide3_lane(&p->wi, i), &density);
            ok = closure_sample(c, p->u1[i], (struct vec2){p->u2[0][i], p->u2[1][i]}, &one);
        }
        bool same = same3(&f, i, value) && (spectrum_is_black(value) || pdf[i] == density);
        if (c)
            same = same && ok == (scattered >> i & 1) && c->lobes == kind->lobes;
        if (ok)
            same = same && same3(&s.wi, i, one.wi) && same3(&s.weight, i, one.weight) &&
                   s.pdf_sa[i] == one.pdf_sa && s.lobe[i] == one.lobe && one.eta == 1;
        *lit += ok && !spectrum_is_black(one.weight);
        different += !same;
    }
    return different;
}

static void check_kind(const struct wide_bsdf *kind, const char *name, int sets) {
    struct rng rng = {(uint64_t)sets};
    int different = 0, lit = 0;
    for (int k = 0; k < PACKETS; k++) {
        struct packet p;
        fill(&p, kind, &rng);
        different += compare(&p, kind, &lit);
    }
    printf("%s: %d sets, %d of %d lanes differ, %d scatter\n", name, sets, different,
           PACKETS * WIDE_LANES, lit);
    CHECK(different == 0 && lit > PACKETS * WIDE_LANES / 10);
}

int main(void) {
    static struct arena arena;
    collect(&arena);
    CHECK(count > 0 && count < MOST);
    for (int i = 0; i < count; i++) {
        int before = 0, sets = 0;
        for (int k = 0; k < count; k++) {
            sets += all[k].wide.kind == all[i].wide.kind;
            before += k < i && all[k].wide.kind == all[i].wide.kind;
        }
        if (before == 0)
            check_kind(all[i].wide.kind, all[i].object->type->name, sets);
    }
    arena_finish(&arena);
    return check_result();
}
