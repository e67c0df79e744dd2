// SPDX-License-Identifier: Apache-2.0
// Which lights share a layer: by their `group` name, else each by itself; the last layer takes
// the rest.
#pragma once

#include "scene/scene.h"

struct light_groups {
    uint32_t count;
    const char **names;
    uint32_t *of_light; // by light index
};

// false after an error message when there are more groups than a film keeps.
bool light_groups_init(struct light_groups *g, const struct scene *s);
// Whether their names can be those of layers of a picture, beside all others that it may have; false
// after an error message.
bool light_groups_check(const struct light_groups *g, const struct scene *s);
void light_groups_finish(struct light_groups *g);

// Leaves a scene the lights of one group alone ("rest": of none); shapes whose light goes are dark. The world comes
// later. false after an error message.
bool light_groups_keep(struct scene *s, const char *group);
