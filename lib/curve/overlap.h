// SPDX-License-Identifier: Apache-2.0
// How a spherical triangle of light is dealt to the functions of a curve's basis (Ben-Artzi 2007,
// 4.2.1, eq. 4.9 to 4.12):
//
//     Delta_j = integral of b_j(gamma(w)) dw over the triangle / its solid angle
//
// gamma is taken to be linear over a triangle whose gammas at the corners are g0 <= g1 <= g2. The
// share of the area below t is then
//
//     F(t) = (t - g0)^2 / ((g1 - g0)(g2 - g0))       up to g1
//          = 1 - (g2 - t)^2 / ((g2 - g1)(g2 - g0))   from there
//
// A box has F(upper edge) - F(lower edge), a hat the like with first moments. Where gamma bends the
// triangle is split at the middles of its edges. With two curves a part has the product of its
// shares; parts are split until they lie between two knots of either axis, or `splits` times. What comes
// of that is brought to the sums that each curve alone would have (curve/joint.h), so that a matrix with
// all ones for one curve is the vector of the other.
//
// Conventions: gammas that fold (those of slopes and powers) are signed here, so that they run on
// smoothly where they are 0; a share counts for |gamma|. What lies beyond the last knot belongs to
// the last function, but for theta_r, whose curves end there.
#pragma once

#include "curve/angles.h"
#include "curve/basis.h"

enum { OVERLAP_CORNERS = 3, OVERLAP_NODES = 6, OVERLAP_AXES = 2, OVERLAP_CHANNELS = 3 };

struct overlap_axis {
    struct gamma gamma;
    struct basis basis;
    double per_step; // intervals a radian, of evenly spaced knots; 0: others
};

// The interval between knots that gamma lies in; the last one beyond them.
static inline uint32_t overlap_interval(const struct overlap_axis *a, double gamma) {
    const uint32_t last = basis_intervals(&a->basis) - 1;
    if (!(gamma > 0))
        return 0;
    if (a->per_step > 0) {
        const double place = gamma * a->per_step;
        return place < last ? (uint32_t)place : last;
    }
    return gamma < a->basis.knots[last + 1] ? basis_interval(&a->basis, gamma) : last;
}

// The functions of an axis that a triangle has a share of: first to end.
struct overlap_range {
    uint32_t first, end;
};

// What lights are added to.
struct overlap {
    uint32_t axes; // 0 to 2
    struct overlap_axis axis[OVERLAP_AXES];
    double tolerance; // of a share of the triangle; 1e-3
    int depth;        // most splits; 6
    int splits;       // most further ones for the sake of two curves; 1
    double *share[OVERLAP_AXES]; // scratch, a number for each function
    double *sums;     // [functions of axis 0][of axis 1][channels]
    int channels;     // 3
    // Scratch that is zero between uses: shares of each axis alone, with two curves of both, and where.
    double *margin[OVERLAP_AXES], *joint, *missing;
    struct overlap_range touched[OVERLAP_AXES];
    double wo[3];
    double to_local[3][3]; // rows: the local axes in the space of triangles
};

// A triangle: directions at its corners, then in the middle of the edges from corner i to the next;
// and what of it lies at each corner and between the middles (sum 1). In any space.
struct overlap_triangle {
    double node[OVERLAP_NODES][3];
    double part[4];
};

void overlap_init(struct overlap *o, const struct gamma *const gamma[OVERLAP_AXES],
                  const struct basis *const basis[OVERLAP_AXES], uint32_t axes,
                  struct arena *arena);

// The nodes of a triangle with these corners.
void overlap_triangle_make(struct overlap_triangle *t, const double corner[OVERLAP_CORNERS][3]);

// gamma as used here.
double overlap_gamma(const struct gamma *g, struct angles *a);

// Adds light * Delta to the sums; gamma: overlap_gamma at the nodes, by axis.
void overlap_add(struct overlap *o, const struct overlap_triangle *t, double gamma[OVERLAP_AXES][OVERLAP_NODES],
                 const double light[OVERLAP_CHANNELS]);

// Steps of that with two curves, the first two of which others may do: shares of an axis alone in
// margin[axis]; of both in joint; and light times these, brought to those.
void overlap_add_alone(struct overlap *o, uint32_t axis, const struct overlap_triangle *t,
                       double gamma[OVERLAP_AXES][OVERLAP_NODES]);
void overlap_add_joint(struct overlap *o, const struct overlap_triangle *t,
                       double gamma[OVERLAP_AXES][OVERLAP_NODES]);
void overlap_finish_joint(struct overlap *o, const double light[OVERLAP_CHANNELS]);
// Makes room in the touched range of an axis.
void overlap_touch(struct overlap *o, uint32_t axis, uint32_t first, uint32_t end);

// The same of a point.
void overlap_add_point(struct overlap *o, const double gamma[OVERLAP_AXES],
                       const double light[OVERLAP_CHANNELS]);
