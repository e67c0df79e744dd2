// SPDX-License-Identifier: Apache-2.0
// Points as text, six numbers a line: a position, and a normal or direction of any length.
//
// Reads what has come and no more: a program that writes a line and waits for the answer gets it.
// Empty lines and what follows a # are skipped.
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "sensor/points.h"

struct point_list;

struct point_list *point_list_open(int file, const char *name); // the name is for messages
void point_list_close(struct point_list *l);                    // not the file

// At most `most` points; waits for the first, then takes what is there. 0: the end.
// *good is false after an error message; points before the line at fault are still returned.
uint32_t point_list_read(struct point_list *l, struct sensor_point *points, uint32_t most,
                         bool *good);
