// SPDX-License-Identifier: Apache-2.0
// Only what the scene requires: the cheapest integrator that is exact for it.
#pragma once

#include "integrator/integrator.h"

struct method {
    const char *asked, *used; // by name; that inside wrappers (moment, aov)
    const char *why;
};

// Puts another integrator into the scene where it makes the same picture in less time, and warns
// where the one that is asked for does not see all of the scene.
void method_choose(struct scene *s, const struct world *w, struct method *m);
