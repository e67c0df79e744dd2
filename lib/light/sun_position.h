// SPDX-License-Identifier: Apache-2.0
// Where the sun stands, by place and time.
#pragma once

#include "math/vec.h"

struct sun_time {
    int year, month, day;
    double hour, minute, second; // local time
    double latitude, longitude;  // degrees, north and east
    double timezone;             // hours ahead of universal time
};

// Unit direction towards the sun, z up. Axes as Mitsuba 3: azimuth counts from south.
vec3 sun_position(const struct sun_time *t);
