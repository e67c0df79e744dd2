// SPDX-License-Identifier: Apache-2.0
// Verbs of a sink that a view has no use for.
#include "sink/ignore.h"

void sink_ignore_lane(struct sink *s, int lane) {
    (void)s, (void)lane;
}

void sink_ignore_add(struct sink *s, int lane, const struct contribution *c) {
    (void)s, (void)lane, (void)c;
}

void sink_ignore_surface(struct sink *s, int lane, const struct sink_surface *first) {
    (void)s, (void)lane, (void)first;
}

void sink_ignore_end(struct sink *s, int lane, float filter_weight) {
    (void)s, (void)lane, (void)filter_weight;
}

void sink_ignore_close(struct sink *s) {
    (void)s;
}
