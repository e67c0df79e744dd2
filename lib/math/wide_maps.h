// SPDX-License-Identifier: Apache-2.0
// The functions of vec.h, frame.h, ray.h and warp.h for all lanes, operation by
// operation, so that a lane has the bits of the function of one: tests/render/wide.c holds them to
// that. Derivations stand there.
#pragma once

#include "math/ray.h"
#include "math/wide_elementary.h"

static inline struct wide3 wide_normalize(struct wide3 a) {
    const wide l2 = wide_dot(a, a);
    const wide scale = 1 / wide_sqrt(l2);
    struct wide3 n = {a.x * scale, a.y * scale, a.z * scale};
    const uint32_t extreme = ~wide_bits(wide_both(l2 > 1e-30f, l2 < 1e30f)) & WIDE_ALL;
    for (uint32_t left = extreme; __builtin_expect(left != 0, 0); left &= left - 1) {
        const int i = __builtin_ctz(left);
        wide3_set_lane(&n, i, normalize(wide3_lane(&a, i)));
    }
    return n;
}

static inline struct wide3 wide_reflect(struct wide3 w, struct wide3 n) {
    const wide twice = 2 * wide_dot(w, n);
    return wide3_sub(wide3_scale(twice, n), w);
}

static inline wide_mask wide_is_black(struct wide3 a) {
    return wide_both(a.x == 0, wide_both(a.y == 0, a.z == 0));
}

struct wide_frame {
    struct wide3 s, t, n;
};

static inline struct wide_frame wide_frame_from_normal(struct wide3 n) {
    const wide sign = (wide)(((wide_int)n.z & INT32_MIN) | (wide_int)wide_of(1));
    const wide a = -1 / (sign + n.z);
    const wide b = n.x * n.y * a;
    return (struct wide_frame){{1 + sign * n.x * n.x * a, sign * b, -sign * n.x},
                               {b, sign + n.y * n.y * a, -n.y}, n};
}

static inline struct wide3 wide_to_local(const struct wide_frame *f, struct wide3 w) {
    return (struct wide3){wide_dot(w, f->s), wide_dot(w, f->t), wide_dot(w, f->n)};
}

static inline struct wide3 wide_to_world(const struct wide_frame *f, struct wide3 w) {
    return (struct wide3){w.x * f->s.x + w.y * f->t.x + w.z * f->n.x,
                          w.x * f->s.y + w.y * f->t.y + w.z * f->n.y,
                          w.x * f->s.z + w.y * f->t.z + w.z * f->n.z};
}

static inline wide wide_largest(struct wide3 a) {
    return wide_max(wide_abs(a.x), wide_max(wide_abs(a.y), wide_abs(a.z)));
}

static inline struct wide3 wide_triangle_error(struct wide3 w0, struct wide3 w1, struct wide3 w2,
                                               struct wide3 e1, struct wide3 e2) {
    const float u = 0x1p-24f, gamma = 7 * u / (1 - 7 * u);
    const wide extent = 3 * u * wide_max(wide_largest(e1), wide_largest(e2));
    return (struct wide3){gamma * (wide_abs(w0.x) + wide_abs(w1.x) + wide_abs(w2.x)) + extent,
                          gamma * (wide_abs(w0.y) + wide_abs(w1.y) + wide_abs(w2.y)) + extent,
                          gamma * (wide_abs(w0.z) + wide_abs(w1.z) + wide_abs(w2.z)) + extent};
}

// One axis of offset_point.
static inline wide wide_offset_axis(wide p, wide offset) {
    const wide q = p + offset;
    const wide_int sign = (offset < 0) - (offset > 0);
    return q + 0x1p-23f * (wide_abs(q) + wide_abs(offset)) * __builtin_convertvector(sign, wide);
}

static inline struct wide3 wide_offset_point(struct wide3 p, struct wide3 error, struct wide3 n,
                                             struct wide3 w) {
    const wide d = wide_negate(wide_dot(w, n) < 0, wide_dot(wide3_abs(n), error));
    return (struct wide3){wide_offset_axis(p.x, d * n.x), wide_offset_axis(p.y, d * n.y),
                          wide_offset_axis(p.z, d * n.z)};
}

static inline struct wide3 wide_cosine_hemisphere(const wide u[2]) {
    const wide x = 2 * u[0] - 1, y = 2 * u[1] - 1, none = {0};
    const wide_mask flat = wide_whole(wide_abs(x) > wide_abs(y));
    const wide_mask middle = wide_both(x == 0, y == 0);
    const wide r = wide_select(flat, x, y);
    wide sine, cosine;
    wide_sincos_octant((PI / 4) * (wide_select(flat, y, x) / r), &sine, &cosine);
    const wide dx = wide_select(middle, none, r * wide_select(flat, cosine, sine));
    const wide dy = wide_select(middle, none, r * wide_select(flat, sine, cosine));
    return (struct wide3){dx, dy, wide_sqrt(wide_max(1 - dx * dx - dy * dy, none))};
}
