// SPDX-License-Identifier: Apache-2.0
#include "base/mem.h"

#include <stdalign.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

enum { ALIGNMENT = 64, BLOCK_BYTES = 256 * 1024 };
// What is looked up at random in many small pages waits for the table of pages too: large arrays
// ask for huge ones.
enum { HUGE_PAGE = 2 << 20, LEAST_HUGE = 2 * HUGE_PAGE };

struct arena_block {
    alignas(64) struct arena_block *previous;
    size_t used, size; // bytes after this header
};

struct arena_shared {
    const char *kind, *name;
    void *thing;
    struct arena_shared *next;
};

static _Noreturn void out_of_memory(size_t count, size_t size, const char *file, int line) {
    fprintf(stderr, "relume: out of memory: %zu x %zu bytes at %s:%d\n", count, size, file, line);
    abort();
}

// Never zero.
static size_t padded(size_t bytes) {
    return (bytes + ALIGNMENT) & ~(size_t)(ALIGNMENT - 1);
}

void *mem_array_unset_at(size_t count, size_t size, const char *file, int line) {
    if (size && count > (SIZE_MAX - ALIGNMENT) / size)
        out_of_memory(count, size, file, line);
    const size_t bytes = padded(count * size);
    const bool large = bytes >= LEAST_HUGE && bytes <= SIZE_MAX - HUGE_PAGE;
    const size_t unit = large ? HUGE_PAGE : ALIGNMENT;
    void *p = aligned_alloc(unit, (bytes + unit - 1) & ~(unit - 1));
    if (!p)
        out_of_memory(count, size, file, line);
#ifdef MADV_HUGEPAGE
    if (large)
        madvise(p, bytes, MADV_HUGEPAGE); // a wish: what refuses it works without
#endif
    return p;
}

void *mem_array_at(size_t count, size_t size, const char *file, int line) {
    return memset(mem_array_unset_at(count, size, file, line), 0, padded(count * size));
}

void mem_free(void *p) {
    free(p);
}

void mem_grow_at(void **data, size_t *capacity, size_t need, size_t size, const char *file,
                 int line) {
    if (need <= *capacity)
        return;
    size_t wanted = *capacity < 8 ? 8 : *capacity;
    while (wanted < need)
        wanted = wanted > SIZE_MAX / 2 ? need : wanted * 2;
    void *bigger = mem_array_at(wanted, size, file, line);
    if (*capacity)
        memcpy(bigger, *data, *capacity * size);
    mem_free(*data);
    *data = bigger;
    *capacity = wanted;
}

size_t mem_peak(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? (size_t)usage.ru_maxrss * 1024 : 0;
}

size_t mem_of_machine(void) {
    return (size_t)sysconf(_SC_PHYS_PAGES) * (size_t)sysconf(_SC_PAGESIZE);
}

void mem_will_need(const void *p, size_t bytes) {
    const size_t into = (size_t)(uintptr_t)p % (size_t)sysconf(_SC_PAGESIZE); // where pages begin
    if (bytes > 0)
        madvise((char *)(uintptr_t)p - into, bytes + into, MADV_WILLNEED);
}

void *arena_alloc(struct arena *a, size_t size) {
    const size_t align = size >= 64 ? 64 : 16;
    struct arena_block *b = a->last;
    size_t start = b ? (b->used + align - 1) & ~(align - 1) : 0;
    if (!b || start > b->size || size > b->size - start) {
        const size_t bytes = size > BLOCK_BYTES ? size : BLOCK_BYTES;
        if (bytes > SIZE_MAX - 2 * sizeof *b)
            out_of_memory(1, size, __FILE__, __LINE__);
        b = mem_array(1, sizeof *b + bytes);
        b->size = bytes;
        b->previous = a->last;
        a->last = b;
        start = 0;
    }
    b->used = start + size;
    a->total += size;
    return (char *)(b + 1) + start;
}

char *arena_strdup(struct arena *a, const char *s) {
    const size_t n = strlen(s) + 1;
    return memcpy(arena_alloc(a, n), s, n);
}

char *arena_printf(struct arena *a, const char *format, ...) {
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    const int n = vsnprintf(NULL, 0, format, args);
    char *s = arena_alloc(a, (size_t)(n < 0 ? 0 : n) + 1);
    vsnprintf(s, (size_t)(n < 0 ? 0 : n) + 1, format, again);
    va_end(again);
    va_end(args);
    return s;
}

void *arena_find(const struct arena *a, const char *kind, const char *name) {
    for (const struct arena_shared *s = a->shared; s; s = s->next)
        if (strcmp(s->kind, kind) == 0 && strcmp(s->name, name) == 0)
            return s->thing;
    return NULL;
}

void arena_keep(struct arena *a, const char *kind, const char *name, void *thing) {
    struct arena_shared *s = arena_alloc(a, sizeof *s);
    *s = (struct arena_shared){arena_strdup(a, kind), arena_strdup(a, name), thing, a->shared};
    a->shared = s;
}

void arena_finish(struct arena *a) {
    for (struct arena_block *b = a->last; b;) {
        struct arena_block *previous = b->previous;
        mem_free(b);
        b = previous;
    }
    *a = (struct arena){0};
}
