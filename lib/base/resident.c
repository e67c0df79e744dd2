// SPDX-License-Identifier: Apache-2.0
#include "base/resident.h"

#include <malloc.h>
#include <stdio.h>

// Bytes of a line "VmHWM:  123 kB" of /proc/self/status (proc(5)).
static size_t status_bytes(const char *format) {
    FILE *f = fopen("/proc/self/status", "r");
    char line[256];
    size_t kilobytes = 0;
    while (f && fgets(line, sizeof line, f) && sscanf(line, format, &kilobytes) != 1)
        continue;
    if (f)
        fclose(f);
    return kilobytes * 1024;
}

size_t resident_begin(void) {
    malloc_trim(0);
    FILE *f = fopen("/proc/self/clear_refs", "w");
    if (f) {
        fputs("5", f); // the peak starts from what is in use
        fclose(f);
    }
    return status_bytes("VmRSS: %zu kB");
}

size_t resident_peak(void) {
    return status_bytes("VmHWM: %zu kB");
}
