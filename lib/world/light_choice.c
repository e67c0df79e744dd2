// SPDX-License-Identifier: Apache-2.0
#include "world/light_choice.h"

#include <float.h>
#include <string.h>

#include "base/mem.h"
#include "math/hash.h"

// Measured with tests/bench/many_lights.py: with 4 triangles the tree is as good as choice by power,
// with 8 it is three times faster to equal error.
enum { LEAST_FOR_TREE = 8 };

// A light is found from its part by a table of every 64th, which stays in the cache, and a search.
enum { BLOCK = 64 };

// Of what choose_part gives: it is a light, of the table.
#define FROM_TABLE 0x80000000u

const char *const light_choice_modes[] = {"auto", "tree", "power", "uniform", NULL};

// ---- tables

static float power_of(const struct world_light *l) {
    const float power = l->type->power(l->data);
    return power > 0 ? minf(power, FLT_MAX) : 0;
}

// Half of the choice is uniform: power alone can starve a weak light that stands near.
static void init_by_light(struct light_choice *c, struct world_light *all, uint32_t count) {
    float *weights = mem_array(count, sizeof *weights);
    double total = 0;
    for (uint32_t i = 0; i < count; i++) {
        weights[i] = power_of(&all[i]);
        total += (double)weights[i];
    }
    const double uniform = total > 0 ? total / count : 1;
    for (uint32_t i = 0; i < count; i++)
        weights[i] = (float)(((double)weights[i] + uniform) / (total > 0 ? 2 * total : 1));
    alias_init(&c->table, weights, count);
    for (uint32_t i = 0; i < count; i++)
        all[i].pmf = c->table.entries[i].pmf;
    mem_free(weights);
}

static uint32_t count_parts(struct world_light *all, uint32_t count, bool *places) {
    uint64_t parts = 0;
    *places = false;
    for (uint32_t i = 0; i < count; i++) {
        const struct light_type *type = all[i].type;
        const uint32_t n = type->parts ? type->parts(all[i].data) : 1;
        all[i].first_part = (uint32_t)parts;
        all[i].parts = n > 1 ? n : 0;
        *places |= type->bounds != NULL;
        parts += n;
    }
    return parts < FROM_TABLE ? (uint32_t)parts : 0;
}

static size_t block_count(uint32_t parts) {
    return (size_t)parts / BLOCK + 2;
}

// Bounds of every part; those of lights without a place are dark.
static struct light_bounds *list_parts(struct light_choice *c, const struct world_light *all,
                                       uint32_t count, uint32_t parts) {
    struct light_bounds *bounds = mem_array(parts, sizeof *bounds);
    c->block_light = mem_array(block_count(parts), sizeof *c->block_light);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < (all[i].parts ? all[i].parts : 1); k++) {
            const uint32_t part = all[i].first_part + k;
            if (part % BLOCK == 0)
                c->block_light[part / BLOCK] = i;
            if (all[i].type->bounds)
                all[i].type->bounds(all[i].data, k, &bounds[part]);
        }
    c->block_light[parts / BLOCK + 1] = count - 1;
    if (parts % BLOCK == 0)
        c->block_light[parts / BLOCK] = count - 1;
    return bounds;
}

// A part's power: that of its light, shared by intensity.
static void init_by_part(struct light_choice *c, bool uniform, const struct world_light *all,
                         uint32_t count, const struct light_bounds *bounds, uint32_t parts) {
    float *weights = mem_array(parts, sizeof *weights);
    double total = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct light_bounds *b = &bounds[all[i].first_part];
        double sum = 0;
        for (uint32_t k = 0; k < all[i].parts; k++)
            sum += (double)b[k].intensity;
        const double power = (double)power_of(&all[i]);
        for (uint32_t k = 0; k < all[i].parts; k++)
            weights[all[i].first_part + k] = (float)(power * (double)b[k].intensity / sum);
        if (all[i].parts == 0)
            weights[all[i].first_part] = (float)power;
        total += power;
    }
    // nothing that shines is out of reach, not even what has no power by rounding
    const float least = (float)(1e-6 * total / parts);
    for (uint32_t i = 0; i < parts; i++)
        weights[i] = uniform ? 1 : (float)((double)maxf(weights[i], least) / (total > 0 ? total : 1));
    alias_init(&c->table, weights, parts);
    mem_free(weights);
}

// ---- the tree and, apart, the lights without a place

static void tell_shapes(struct light_tree *t, const struct world_light *all, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < all[i].parts; k++) {
            const uint32_t part = all[i].first_part + k;
            struct light_leaf *leaf = light_tree_leaf(t, part);
            if (!leaf)
                continue;
            all[i].type->part_shape(all[i].data, k, leaf);
            t->slots[part].inv_area = leaf->inv_area;
        }
}

static void init_tree(struct light_choice *c, const struct world_light *all, uint32_t count,
                      const struct light_bounds *bounds, uint32_t parts) {
    float *weights = mem_array(count, sizeof *weights);
    c->table_light = mem_array(count, sizeof *c->table_light);
    double apart = 0, total = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double power = (double)power_of(&all[i]);
        total += power;
        if (all[i].type->bounds)
            continue;
        apart += power;
        weights[n] = (float)power;
        c->table_light[n++] = i;
    }
    for (uint32_t i = 0; i < n; i++)
        weights[i] = apart > 0 ? (float)((0.5 * (double)weights[i] + 0.5 * apart / n) / apart) : 1;
    // By power and by number, half and half; the tree counts as one, and so always has its share.
    if (n > 0) {
        c->table_share = (float)(0.5 * n / (n + 1) + (total > 0 ? 0.5 * apart / total : 0));
        alias_init(&c->table, weights, n);
    }
    light_tree_init(&c->tree, bounds, parts);
    tell_shapes(&c->tree, all, count);
    c->has_tree = true;
    mem_free(weights);
}

void light_choice_init(struct light_choice *c, enum light_choice_mode mode,
                       struct world_light *all, uint32_t count) {
    bool places;
    *c = (struct light_choice){.draws = count > 1};
    for (uint32_t i = 0; i < count; i++)
        all[i].pmf = 1;
    const uint32_t parts = count_parts(all, count, &places);
    const bool many = mode != LIGHT_CHOICE_AUTO || parts >= LEAST_FOR_TREE;
    c->by_part = many && places && parts > 1;
    if (!c->by_part) {
        for (uint32_t i = 0; i < count; i++)
            all[i].parts = 0;
        if (count > 1)
            init_by_light(c, all, count);
        return;
    }
    c->draws = true;
    struct light_bounds *bounds = list_parts(c, all, count, parts);
    if (mode == LIGHT_CHOICE_AUTO || mode == LIGHT_CHOICE_TREE)
        init_tree(c, all, count, bounds, parts);
    else
        init_by_part(c, mode == LIGHT_CHOICE_UNIFORM, all, count, bounds, parts);
    for (uint32_t i = 0; i < c->table.count && c->has_tree; i++)
        all[c->table_light[i]].pmf = c->table.entries[i].pmf * c->table_share;
    mem_free(bounds);
}

void light_choice_finish(struct light_choice *c) {
    alias_finish(&c->table);
    light_tree_finish(&c->tree);
    mem_free(c->table_light);
    mem_free(c->block_light);
    *c = (struct light_choice){0};
}

size_t light_choice_bytes(const struct light_choice *c) {
    return c->table.count * sizeof *c->table.entries + light_tree_bytes(&c->tree) +
           (c->has_tree ? block_count(c->tree.item_count) * sizeof *c->block_light : 0);
}

const char *light_choice_name(const struct light_choice *c) {
    return !c->draws ? "none" : c->has_tree ? "tree" : c->by_part ? "parts" : "lights";
}

// ---- sampling

// A float has 24 bits, too few for a million parts: the ones below come from the other numbers.
static double more_bits(float u1, struct vec2 u2) {
    uint32_t x, y;
    memcpy(&x, &u2.x, sizeof x);
    memcpy(&y, &u2.y, sizeof y);
    return (double)u1 + 0x1p-24 * (0x1p-32 * (double)hash_u32(x ^ hash_u32(y)));
}

struct chosen {
    uint32_t part;
    const struct light_leaf *leaf; // NULL: it is not from the tree
    float pmf;
};

static bool choose_part(const struct light_choice *c, const struct light_place *at, float u1,
                        struct vec2 u2, struct chosen *out) {
    const double u = more_bits(u1, u2), share = (double)c->table_share;
    out->leaf = NULL;
    if (!c->has_tree) {
        out->part = alias_sample_fine(&c->table, u, &out->pmf);
        return true;
    }
    if (u >= share) {
        if (!light_tree_choose(&c->tree, at, (u - share) / (1 - share), &out->leaf, &out->pmf))
            return false;
        out->part = out->leaf->item;
        out->pmf *= 1 - c->table_share;
        return true;
    }
    out->part = FROM_TABLE | c->table_light[alias_sample_fine(&c->table, u / share, &out->pmf)];
    out->pmf *= c->table_share;
    return true;
}

static void set_part(struct light_parts *out, int i, const struct chosen *one) {
    out->part[i] = one->part;
    out->leaf[i] = one->leaf;
    out->pmf[i] = one->pmf;
}

// As choose_part, lane by lane.
static uint32_t choose_parts(const struct light_choice *c, uint32_t wanted,
                             const struct light_place at[WIDE_LANES], wide u1, const wide u2[2],
                             struct light_parts *out) {
    const double share = (double)c->table_share;
    double u[WIDE_LANES] = {0};
    uint32_t in_tree = 0, found = 0;
    for (uint32_t left = wanted; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        const struct vec2 two = {u2[0][i], u2[1][i]};
        struct chosen one;
        u[i] = more_bits(u1[i], two);
        if (c->has_tree && u[i] >= share) {
            u[i] = (u[i] - share) / (1 - share);
            in_tree |= 1u << i;
        } else if (choose_part(c, &at[i], u1[i], two, &one)) {
            set_part(out, i, &one);
            found |= 1u << i;
        }
    }
    in_tree = light_tree_choose_lanes(&c->tree, in_tree, at, u, out->leaf, out->pmf);
    for (uint32_t left = in_tree; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        out->part[i] = out->leaf[i]->item;
        out->pmf[i] *= 1 - c->table_share;
    }
    return found | in_tree;
}

// Of what choose_part gives.
static uint32_t light_of(const struct light_choice *c, const struct world_light *all,
                         uint32_t part) {
    if (part & FROM_TABLE)
        return part & ~FROM_TABLE;
    uint32_t low = c->block_light[part / BLOCK], high = c->block_light[part / BLOCK + 1];
    while (low < high) {
        const uint32_t middle = low + (high - low + 1) / 2;
        if (all[middle].first_part <= part)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

bool light_chosen_sample(const struct world_light *l, uint32_t part, const struct light_leaf *leaf,
                         vec3 p, struct vec2 u2, float pmf, struct light_sample *s) {
    bool lit;
    if (l->type->aim) {
        lit = l->type->aim(l->data, u2, s);
    } else if (l->parts) {
        struct light_leaf own;
        if (!leaf)
            l->type->part_shape(l->data, part - l->first_part, &own);
        lit = l->type->part_sample(l->data, part - l->first_part, leaf ? leaf : &own, p, u2, s);
    } else {
        lit = l->type->sample(l->data, p, u2, s);
    }
    s->late = l->type->aim != NULL;
    s->pdf_sa *= pmf;
    return lit && s->pdf_sa > 0;
}

uint32_t light_choice_of_all(const struct light_choice *c, uint32_t count, float u1, float *pmf) {
    *pmf = 1;
    return count > 1 ? alias_sample(&c->table, u1, pmf, NULL) : 0;
}

uint32_t light_choice_parts(const struct light_choice *c, const struct world_light *all,
                            uint32_t wanted, const struct light_place at[WIDE_LANES], wide u1,
                            const wide u2[2], struct light_parts *out) {
    const uint32_t found = choose_parts(c, wanted, at, u1, u2, out);
    for (uint32_t left = found; left; left &= left - 1) {
        const int i = __builtin_ctz(left);
        out->light[i] = light_of(c, all, out->part[i]);
    }
    return found;
}

bool light_choice_sample(const struct light_choice *c, const struct world_light *all,
                         uint32_t count, const struct light_place *at, float u1, struct vec2 u2,
                         uint32_t *light, struct light_sample *s) {
    struct chosen one = {.pmf = 1};
    *light = 0;
    if (count == 0)
        return false;
    if (c->by_part) {
        if (!choose_part(c, at, u1, u2, &one))
            return false;
        *light = light_of(c, all, one.part);
    } else {
        *light = light_choice_of_all(c, count, u1, &one.pmf);
    }
    return light_chosen_sample(&all[*light], one.part, one.leaf, at->p, u2, one.pmf, s);
}

// As sampled; of a triangle that is not in the tree none.
static float part_pdf_sa(const struct light_choice *c, const struct world_light *light,
                         uint32_t part, const struct light_hit *hit) {
    struct light_leaf own;
    if (c->has_tree)
        return light->type->part_pdf_sa(c->tree.slots[part].inv_area, hit);
    light->type->part_shape(light->data, hit->at.triangle, &own);
    return light->type->part_pdf_sa(own.inv_area, hit);
}

float light_choice_pdf_sa(const struct light_choice *c, const struct world_light *light,
                          const struct light_place *at, const struct light_hit *hit) {
    const uint32_t part = light->first_part + (light->parts ? hit->at.triangle : 0);
    const float pdf = light->parts ? part_pdf_sa(c, light, part, hit)
                                   : light->type->pdf_sa(light->data, at->p, hit);
    if (!c->by_part || (c->has_tree && !light->type->bounds))
        return light->pmf * pdf;
    const float pmf = c->has_tree ? (1 - c->table_share) * light_tree_pmf(&c->tree, at, part)
                                  : c->table.entries[part].pmf;
    return pmf * pdf;
}

void light_choice_prefetch(const struct light_choice *c, const struct world_light *all,
                           const uint32_t *found, const uint32_t *triangles, int count) {
    uint32_t parts[WIDE_LANES];
    int n = 0;
    if (!c->has_tree)
        return;
    for (int i = 0; i < count; i++) {
        const struct world_light *l = &all[found[i]];
        if (l->type->bounds)
            parts[n++] = l->first_part + (l->parts ? triangles[i] : 0);
    }
    light_tree_prefetch(&c->tree, parts, n);
}
