// SPDX-License-Identifier: Apache-2.0
// Materials that can be shaded WIDE_LANES points at once.
//
// A material that can names a kind (bsdf_type.widen): resolve, eval and sample of all lanes, the
// operations of those for one, lane by lane and with their bits (tests/render/wide.c). The lanes of
// a call share the kind, not the material. Kinds reflect by lobes that are not delta, from the side
// of the normal; who calls them mirrors directions for materials with two sides.
#pragma once

#include "bsdf/bsdf.h"
#include "math/wide_maps.h"

// The points of all lanes.
struct wide_points {
    const void *data[WIDE_LANES];        // wide_material.data of each
    struct texture_point at[WIDE_LANES]; // filled where the material is textured
};

// What resolve leaves for eval and sample.
struct wide_closures {
    _Alignas(64) unsigned char bytes[32 * sizeof(wide)];
};

struct wide_samples {
    struct wide3 wi, weight;
    wide pdf_sa;
    wide_uint lobe;
};

struct wide_bsdf {
    uint32_t lobes;  // of the closures: all the same
    bool draws_lobe; // sample needs u1
    // wo above the surface
    void (*resolve)(const struct wide_points *points, const struct wide3 *wo,
                    struct wide_closures *c);
    struct wide3 (*eval)(const struct wide_closures *c, const struct wide3 *wi, wide *pdf_sa);
    // The lanes that were scattered.
    wide_mask (*sample)(const struct wide_closures *c, wide u1, const wide u2[2],
                        struct wide_samples *s);
};

// A texture parameter of each lane's data.
struct wide3 wide_textures(const struct wide_points *points, size_t offset);
// Four numbers that lie together in each lane's data.
static inline void wide_data4(const struct wide_points *points, size_t offset, wide out[4]) {
    const float *row[WIDE_LANES];
    for (int i = 0; i < WIDE_LANES; i++)
        row[i] = (const float *)(const void *)((const char *)points->data[i] + offset);
    wide_gather4(row, out);
}
