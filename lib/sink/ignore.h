// SPDX-License-Identifier: Apache-2.0
// Verbs of a sink that a view has no use for: they do nothing. `surface` may be left out as well
// where the sink does not want it.
#pragma once

#include "sink/sink.h"

void sink_ignore_lane(struct sink *s, int lane); // begin, covered
void sink_ignore_add(struct sink *s, int lane, const struct contribution *c);
void sink_ignore_surface(struct sink *s, int lane, const struct sink_surface *first);
void sink_ignore_end(struct sink *s, int lane, float filter_weight);
void sink_ignore_close(struct sink *s);
