// SPDX-License-Identifier: Apache-2.0
// The rays of the sensor, as one coherent packet: for integrators that look no further.
#pragma once

#include "integrator/integrator.h"

// What the rays of SINK_LANES paths meet that the sensor sees; counted as rays and paths.
void camera_packet_trace(struct trace_context *ctx, const struct path_start starts[SINK_LANES],
                         struct ray rays[SINK_LANES], struct accel_hit hits[SINK_LANES]);
