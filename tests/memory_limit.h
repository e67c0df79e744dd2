// SPDX-License-Identifier: Apache-2.0
// How much memory a hostile file may cost the process that reads it: 1 GiB. Under
// AddressSanitizer, which maps far more than any limit, no allocation may ask for more than that,
// and one that does ends the process. To be included by the file of main.
#pragma once

#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#define ADDRESS_SANITIZER true
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZER true
#endif
#endif
#ifndef ADDRESS_SANITIZER
#define ADDRESS_SANITIZER false
#endif

enum { MEMORY_LIMIT_MEBIBYTES = 1024 };

#if ADDRESS_SANITIZER
// What the environment says comes on top.
const char *__asan_default_options(void);
const char *__asan_default_options(void) {
    return "max_allocation_size_mb=1024:allocator_may_return_null=0:new_delete_type_mismatch=0";
}
#endif

// Of this process and its children, beyond what is mapped now (libraries, mostly).
static inline void memory_limit(void) {
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (!f || fscanf(f, "%lu", &pages) != 1) {
        perror("/proc/self/statm");
        _exit(2);
    }
    fclose(f);
    const rlim_t bytes =
        pages * (rlim_t)sysconf(_SC_PAGESIZE) + ((rlim_t)MEMORY_LIMIT_MEBIBYTES << 20);
    if (!ADDRESS_SANITIZER && setrlimit(RLIMIT_AS, &(struct rlimit){bytes, bytes}) != 0) {
        perror("setrlimit");
        _exit(2);
    }
}
