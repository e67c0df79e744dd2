// SPDX-License-Identifier: Apache-2.0
// M. Blanco-Muriel, D. C. Alarcon-Padilla, T. Lopez-Moratalla, M. Lara-Coira 2001, Computing the
// Solar Vector, Solar Energy 70(5). Good to half a minute of arc between 1999 and 2015.
#include "light/sun_position.h"

static const double EARTH_RADIUS = 6371.01, SUN_DISTANCE = 149597890; // km

static double radians(double degrees) {
    return degrees * (M_PI / 180);
}

// Days since noon of 1 January 2000, universal time.
static double elapsed_days(const struct sun_time *t, double hours) {
    const int a = (t->month - 14) / 12;
    const int julian = 1461 * (t->year + 4800 + a) / 4 + 367 * (t->month - 2 - 12 * a) / 12 -
                       3 * ((t->year + 4900 + a) / 100) / 4 + t->day - 32075;
    return julian - 0.5 + hours / 24 - 2451545;
}

vec3 sun_position(const struct sun_time *t) {
    const double hours = t->hour - t->timezone + (t->minute + t->second / 60) / 60;
    const double days = elapsed_days(t, hours);
    // ecliptic
    const double omega = 2.1429 - 0.0010394594 * days;
    const double anomaly = 6.2400600 + 0.0172019699 * days;
    const double longitude = 4.8950630 + 0.017202791698 * days + 0.03341607 * sin(anomaly) +
                             0.00034894 * sin(2 * anomaly) - 0.0001134 - 0.0000203 * sin(omega);
    const double obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * cos(omega);
    // celestial
    const double ascension = atan2(cos(obliquity) * sin(longitude), cos(longitude));
    const double declination = asin(sin(obliquity) * sin(longitude));
    // local
    const double sidereal = 6.6974243242 + 0.0657098283 * days + hours;
    const double hour_angle = radians(sidereal * 15 + t->longitude) - ascension;
    const double latitude = radians(t->latitude);
    double zenith = acos(fmin(fmax(cos(latitude) * cos(hour_angle) * cos(declination) +
                                   sin(declination) * sin(latitude), -1), 1));
    const double azimuth = atan2(-sin(hour_angle), tan(declination) * cos(latitude) -
                                                       sin(latitude) * cos(hour_angle)) - M_PI;
    zenith += EARTH_RADIUS / SUN_DISTANCE * sin(zenith); // parallax
    return v3((float)(cos(azimuth) * sin(zenith)), (float)(sin(azimuth) * sin(zenith)),
              (float)cos(zenith));
}
