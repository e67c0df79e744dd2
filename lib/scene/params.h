// SPDX-License-Identifier: Apache-2.0
// Parameters of tables, read one at a time (params.c) for objects.c.
#pragma once

#include "scene/reader.h"

bool param_is_colour(enum param_type type);
bool param_is_texture(enum param_type type);

// From an element that holds a value. false after an error message, as for all below.
bool param_read_value(struct reader *r, const struct xml_node *node, const struct param *p,
                      void *data);
// From a nested object that is given or referred to at a place; entry: of its id, or NULL.
bool param_read_object(struct reader *r, struct where at, struct xml_node *target,
                       struct id_entry *entry, const struct param *p, void *data);
// From the table's default; an error when there is none and the parameter is not optional.
bool param_read_default(struct reader *r, const struct xml_node *owner, const struct param *p,
                        void *data);
// The element that would give this parameter that value in a file.
const char *param_tag(const struct param *p, const char *value);
// Whether a nested object may fill this parameter.
bool param_accepts(const struct param *p, const struct xml_node *target);
