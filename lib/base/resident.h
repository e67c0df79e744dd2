// SPDX-License-Identifier: Apache-2.0
// Memory of this process that is in use, and the most since a moment of the caller's choice.
#pragma once

#include <stddef.h>

// Gives back what the heap has free and begins anew; the bytes in use now.
size_t resident_begin(void);
// The most bytes in use since resident_begin; 0: the system does not tell.
size_t resident_peak(void);
