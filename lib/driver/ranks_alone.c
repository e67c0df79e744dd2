// SPDX-License-Identifier: Apache-2.0
// Built without MPI: there is one rank.
#include "driver/ranks.h"

void ranks_start(void) {
}

void ranks_finish(void) {
}

int ranks_index(void) {
    return 0;
}

int ranks_count(void) {
    return 1;
}

void ranks_render(struct film *film, const struct render_options *options,
                  struct render_result *result) {
    render(film, options, result);
}
