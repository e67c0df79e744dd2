// SPDX-License-Identifier: Apache-2.0
#include "replay/light_factor.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"

size_t light_factor_parse(const char *text, const char *at, float rgb[3]) {
    const char *equals = strchr(text, '=');
    char rest;
    const int n = equals ? sscanf(equals + 1, "%f,%f,%f%c", &rgb[0], &rgb[1], &rgb[2], &rest) : 0;
    if (n == 1)
        rgb[1] = rgb[2] = rgb[0];
    if ((n == 1 || n == 3) && equals > text &&
        fabsf(rgb[0]) + fabsf(rgb[1]) + fabsf(rgb[2]) < INFINITY)
        return (size_t)(equals - text);
    log_error("%s %s: expected NAME=R,G,B or NAME=FACTOR", at, text);
    return 0;
}
