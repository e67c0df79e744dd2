// SPDX-License-Identifier: Apache-2.0
// Memory. Running out prints size and place and aborts, so no caller carries a fake error path.
//
// An arena owns many small objects that live and die together (a scene); nothing in it is freed
// alone. Sizes that come from files are checked by the reader before they reach these functions.
#pragma once

#include <stddef.h>

// Zeroed memory for `count` objects of `size` bytes, 64-byte aligned; free with mem_free.
// count * size == 0 gives a valid pointer. Overflow of the product aborts. Behind the end a byte at
// least, and what is left of 64, may be read: four bytes behind numbers of four.
#define mem_array(count, size) mem_array_at((count), (size), __FILE__, __LINE__)
void *mem_array_at(size_t count, size_t size, const char *file, int line);
// The same, not zeroed: for what is written before it is read. Its pages come as they are written, to
// the threads that do.
#define mem_array_unset(count, size) mem_array_unset_at((count), (size), __FILE__, __LINE__)
void *mem_array_unset_at(size_t count, size_t size, const char *file, int line);
void mem_free(void *p); // NULL is fine

// Grows *data so that it holds at least `need` objects of `size` bytes (doubling); *capacity is
// the number it holds now. New memory is zero. *data may be NULL with *capacity == 0.
#define mem_grow(data, capacity, need, size)                                                       \
    mem_grow_at((void **)(data), (capacity), (need), (size), __FILE__, __LINE__)
void mem_grow_at(void **data, size_t *capacity, size_t need, size_t size, const char *file,
                 int line);

// Most bytes that were ever resident in this process.
size_t mem_peak(void);
// Bytes of memory that the machine has.
size_t mem_of_machine(void);
// Asks for a part of a mapped file to be read while something else is done. A wish.
void mem_will_need(const void *p, size_t bytes);

struct arena {
    struct arena_block *last; // zero-initialise: an empty arena
    size_t total;             // bytes handed out
    struct arena_shared *shared;
};

// Zeroed memory, 64-byte aligned for objects of 64 bytes and more, else 16; owned by the arena.
void *arena_alloc(struct arena *a, size_t size);
char *arena_strdup(struct arena *a, const char *s);
char *arena_printf(struct arena *a, const char *format, ...) __attribute__((format(printf, 2, 3)));
// A thing that several objects of the arena share, such as the table of a file: what was kept under
// that kind (a string constant, say) and name, or NULL. The thing lives in the arena.
void *arena_find(const struct arena *a, const char *kind, const char *name);
void arena_keep(struct arena *a, const char *kind, const char *name, void *thing);
void arena_finish(struct arena *a); // frees everything, leaves an empty arena
