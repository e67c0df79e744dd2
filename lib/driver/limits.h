// SPDX-License-Identifier: Apache-2.0
// When a render stops: at a number of samples, after some seconds, or at a noise, whichever is first.
#pragma once

#include "driver/render.h"

// What the run has come to so far.
struct limits_state {
    double seconds;
    double noise; // of the picture at its last whole block; negative: not known
};

// Whether to go on. The noise is looked at between blocks only: a rule that may stop after any sample
// would favour pictures that look good by chance.
bool limits_go_on(const struct render_options *o, const struct film *film, struct limits_state *s);
// Share of the way to the limit that will be met first. Squared noise falls as one over samples.
double limits_share(const struct render_options *o, const struct film *film,
                    const struct limits_state *s);
// Whether the run ended before any limit, or short of the noise that was asked for.
bool limits_missed(const struct render_options *o, const struct film *film,
                   const struct limits_state *s);
