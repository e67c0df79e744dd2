// SPDX-License-Identifier: Apache-2.0
#include "light/light_tree.h"

#include "base/mem.h"

// Cosines below come from square roots and can be wrong by the root of the rounding: nothing is
// excluded, nor counted less, than with this much to spare.
static const float SLACK = 2e-3f;
// Share that light from behind the receiver's normal counts: a guide only, since a material may
// have tilted the normal it really uses.
static const float LEAST_COSINE = 0.0625f;

// Cosine of max(0, a - b), for angles in [0, pi] by cosine and sine.
static inline float4 cos_beyond(float4 cos_a, float4 sin_a, float4 cos_b, float4 sin_b) {
    return lanes_select(cos_a > cos_b, lanes_all(1), cos_a * cos_b + sin_a * sin_b);
}

static inline float4 sine(float4 cosine) {
    return lanes_sqrt(1.0f - cosine * cosine);
}

// Upper bounds of what the children give: intensity x cosines / distance^2 over all points and
// normals of a child. The distance is that of the middle, but at least the child's own size.
static inline float4 importance(const struct light_node *node, const struct light_place *at) {
    const float4 x = node->centre[0] - at->p[0], y = node->centre[1] - at->p[1],
                 z = node->centre[2] - at->p[2];
    const float4 d2 = x * x + y * y + z * z, r2 = node->radius * node->radius;
    const ivec4 inside = d2 <= r2;
    const float4 far2 = lanes_select(inside, r2, d2);
    const float4 near = 1.0f / lanes_sqrt(far2);
    // the angle that the child fills
    const float4 sin2_b = r2 / far2;
    const float4 cos_b = lanes_sqrt(1.0f - sin2_b), sin_b = lanes_sqrt(sin2_b);
    // from the cone of normals to the place, at least
    const float4 cos_w = -near * (x * node->axis[0] + y * node->axis[1] + z * node->axis[2]);
    const float4 sin_w = sine(cos_w), sin_o = sine(node->cos_o);
    const float4 cos_x = cos_beyond(cos_w, sin_w, node->cos_o, sin_o);
    const ivec4 all = inside | (node->cos_o <= -1.0f);
    const float4 cos_l = lanes_select(all, lanes_all(1), cos_beyond(cos_x, sine(cos_x), cos_b, sin_b));
    float4 value = node->intensity * lanes_max(cos_l, lanes_all(SLACK));
    if (length2(at->n) > 0) {
        const float4 cos_n = near * (x * at->n[0] + y * at->n[1] + z * at->n[2]);
        const float4 cos_i = cos_beyond(cos_n, sine(cos_n), cos_b, sin_b);
        value *= lanes_select(inside, lanes_all(1), lanes_max(cos_i, lanes_all(LEAST_COSINE)));
    }
    const ivec4 dark = (cos_l < node->cos_e - SLACK) | (node->intensity <= 0.0f);
    // Divided twice: the square alone may leave the range of float. At the very point of a light
    // without size the quotient is infinite.
    return lanes_select(dark, lanes_all(0), lanes_min(value * near * near, lanes_all(1e36f)));
}

static inline float sum_of(float4 v) {
    return (v[0] + v[1]) + (v[2] + v[3]);
}

bool light_tree_choose(const struct light_tree *t, const struct light_place *at, double u,
                       uint32_t *item, float *pmf) {
    double probability = 1;
    if (t->node_count == 0)
        return false;
    for (uint32_t child = 0; !(child & LIGHT_TREE_LEAF); *item = child) {
        const struct light_node *node = &t->nodes[child];
        const float4 v = importance(node, at);
        const float sum = sum_of(v);
        if (!(sum > 0))
            return false;
        double rest = u * (double)sum;
        int chosen = -1;
        for (int i = 0; i < 4; i++) {
            if (!(v[i] > 0))
                continue;
            if (chosen >= 0)
                rest -= (double)v[chosen];
            chosen = i;
            if (rest < (double)v[i])
                break;
        }
        u = fmin(fmax(rest / (double)v[chosen], 0), 0x1.fffffffffffffp-1);
        probability *= (double)(v[chosen] / sum);
        child = node->child[chosen];
    }
    *item -= LIGHT_TREE_LEAF;
    *pmf = (float)probability;
    return *pmf > 0;
}

float light_tree_pmf(const struct light_tree *t, const struct light_place *at, uint32_t item) {
    double probability = 1;
    if (t->slots[item] == LIGHT_TREE_NONE)
        return 0;
    for (uint32_t slot = t->slots[item]; slot != LIGHT_TREE_LEAF;) {
        const struct light_node *node = &t->nodes[slot / 4];
        const float4 v = importance(node, at);
        const float sum = sum_of(v);
        if (!(v[slot % 4] > 0))
            return 0;
        probability *= (double)(v[slot % 4] / sum);
        slot = node->parent;
    }
    return (float)probability;
}

void light_tree_finish(struct light_tree *t) {
    mem_free(t->nodes);
    mem_free(t->slots);
    *t = (struct light_tree){0};
}

size_t light_tree_bytes(const struct light_tree *t) {
    return t->node_count * sizeof *t->nodes + t->item_count * sizeof *t->slots;
}
