// SPDX-License-Identifier: Apache-2.0
#include "math/warp.h"
#include "table/window.h"

// Inverse of the concentric map.
static struct vec2 disk_to_square(float x, float y) {
    float a, b;
    if (x == 0 && y == 0)
        return (struct vec2){0.5f, 0.5f};
    const float r = sqrtf(x * x + y * y);
    if (fabsf(x) > fabsf(y)) {
        a = copysignf(r, x);
        b = a * atanf(y / x) * (4 / PI);
    } else {
        b = copysignf(r, y);
        a = b * atanf(x / y) * (4 / PI);
    }
    return (struct vec2){clampf(0.5f * (a + 1), 0, 1), clampf(0.5f * (b + 1), 0, 1)};
}

// The ring of a cell, and its number in the ring.
static int ring_of(const struct window_cells *c, int cell, int *sector) {
    int ring = 0;
    while (ring + 1 < c->rings && cell >= c->sectors[ring])
        cell -= c->sectors[ring++];
    *sector = cell;
    return ring;
}

int window_cell_of(const struct window_cells *c, vec3 w) {
    if (c->side) {
        const struct vec2 s = disk_to_square(w[0], w[1]);
        const int x = (int)(s.x * (float)c->side), y = (int)(s.y * (float)c->side);
        return (y < c->side ? y : c->side - 1) * c->side + (x < c->side ? x : c->side - 1);
    }
    const double theta = atan2(sqrt((double)(w[0] * w[0] + w[1] * w[1])), (double)w[2]) * 180 / M_PI;
    const double turns = atan2((double)w[1], (double)w[0]) / (2 * M_PI);
    int ring = 0, before = 0;
    while (ring + 1 < c->rings && theta >= c->theta[ring + 1])
        before += c->sectors[ring++];
    const int sectors = c->sectors[ring];
    const int sector = (int)((turns < 0 ? turns + 1 : turns) * sectors + 0.5);
    return before + (sector < sectors ? sector : 0);
}

double window_cell_psa(const struct window_cells *c, int cell) {
    if (c->side)
        return M_PI / c->side / c->side;
    int sector;
    const int ring = ring_of(c, cell, &sector);
    const double a = sin(c->theta[ring] * M_PI / 180), b = sin(c->theta[ring + 1] * M_PI / 180);
    return M_PI * (b * b - a * a) / c->sectors[ring];
}

vec3 window_cell_sample(const struct window_cells *c, int cell, struct vec2 u) {
    if (c->side) {
        const struct vec2 s = {((float)(cell % c->side) + u.x) / (float)c->side,
                               ((float)(cell / c->side) + u.y) / (float)c->side};
        const struct vec2 d = warp_disk(s);
        return v3(d.x, d.y, safe_sqrt(1 - d.x * d.x - d.y * d.y));
    }
    int sector;
    const int ring = ring_of(c, cell, &sector);
    const double a = sin(c->theta[ring] * M_PI / 180), b = sin(c->theta[ring + 1] * M_PI / 180);
    const float r2 = (float)(a * a + (b * b - a * a) * (double)u.x);
    float sine, cosine;
    sincos_turn(((float)sector + u.y - 0.5f) / (float)c->sectors[ring], &sine, &cosine);
    const float r = sqrtf(r2);
    return v3(r * cosine, r * sine, safe_sqrt(1 - r2));
}

// The matrix counts incident patches by where light goes on to: azimuths turned by pi.
static float look_matrix(const struct window_part *p, vec3 in, vec3 out) {
    const int i = window_cell_of(&p->in, v3(-in[0], -in[1], in[2]));
    const int o = window_cell_of(&p->out, out);
    return p->values[o * p->in.count + i];
}

// Coordinates of the tree: squares of both directions, the incident one turned by pi; for rank 3 the
// incident direction's distance to the rim (0 to 1/2), and the outgoing one turned with it to -x.
static void tree_position(const struct window_part *p, vec3 in, vec3 out, float x[4]) {
    struct vec2 s;
    if (p->rank == 3) {
        const float r = sqrtf(in[0] * in[0] + in[1] * in[1]);
        const float c = r > 0 ? -in[0] / r : 1, d = r > 0 ? -in[1] / r : 0;
        s = disk_to_square(out[0] * c + out[1] * d, out[1] * c - out[0] * d);
        x[0] = maxf(0.4999999f - 0.5f * r, 0);
        x[1] = s.x;
        x[2] = s.y;
        return;
    }
    s = disk_to_square(-in[0], -in[1]);
    x[0] = s.x;
    x[1] = s.y;
    s = disk_to_square(out[0], out[1]);
    x[2] = s.x;
    x[3] = s.y;
}

// In a branch bit k of a child's number is dimension k; in a grid the last dimension runs fastest.
static float look_tree(const struct window_part *p, vec3 in, vec3 out) {
    float x[4];
    const struct window_node *node = p->nodes;
    tree_position(p, in, out, x);
    for (int k = 0; k < p->rank; k++)
        x[k] = clampf(x[k], 0, 1 - 0x1p-24f);
    while (node->children >= 0) {
        int child = 0;
        for (int k = 0; k < p->rank; k++) {
            const int upper = x[k] >= 0.5f;
            child |= upper << k;
            x[k] = 2 * x[k] - (float)upper;
        }
        node = &p->nodes[node->children + child];
    }
    size_t index = 0;
    for (int k = 0; k < p->rank; k++)
        index = (index << node->log2) + (size_t)(x[k] * (float)(1 << node->log2));
    return p->values[node->values + index];
}

float window_look(const struct window_part *p, vec3 in, vec3 out) {
    return p->rank == 2 ? look_matrix(p, in, out) : look_tree(p, in, out);
}
