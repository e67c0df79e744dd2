// SPDX-License-Identifier: Apache-2.0
// Materials of Wavefront MTL files, for obj.c of this folder only.
#pragma once

#include "scene/tree.h"

struct mtl {
    const char *name;
    double Kd[3], Ks[3], Ke[3], Tf[3];
    double Ns, Ni, d, Pr, Pm;
    bool has_Ks, has_Pr, has_Pm, glass; // glass: illum 4, 6, 7 or 9
    const char *map_Kd, *map_d, *map_Ke, *map_Pr, *map_Pm, *norm, *bump;
};

// Reads a file and appends its materials to list (struct mtl). false after an error message.
bool mtl_read(struct reader *r, const char *path, struct list *materials);
// The bsdf element of a material, appended to the scene with an id, which is returned; NULL after
// an error message.
const char *mtl_add_bsdf(struct reader *r, struct xml_node *scene, const struct mtl *m);
bool mtl_emits(const struct mtl *m);
void mtl_add_emitter(struct reader *r, struct xml_node *shape, const struct mtl *m);
