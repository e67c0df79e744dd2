// SPDX-License-Identifier: Apache-2.0
#include "mutate.h"

#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

// Uniform in 0 .. n-1.
static size_t below(struct rng *rng, size_t n) {
    return n ? (size_t)(((uint64_t)rng_u32(rng) << 32 | rng_u32(rng)) % n) : 0;
}

// Replaces `old` bytes at `at` by n others.
static void splice(struct mutant *m, size_t at, size_t old, const void *bytes, size_t n) {
    unsigned char *data = mem_array(m->size - old + n + 1, 1);
    memcpy(data, m->data, at);
    if (n)
        memcpy(data + at, bytes, n);
    memcpy(data + at + n, m->data + at + old, m->size - at - old);
    mem_free(m->data);
    m->data = data;
    m->size = m->size - old + n;
}

// A place, every other time near the beginning, where headers are.
static size_t place(const struct mutant *m, struct rng *rng) {
    const size_t head = m->size < 512 ? m->size : 512;
    return below(rng, rng_u32(rng) & 1 ? head : m->size);
}

static void flip_bit(struct mutant *m, struct rng *rng) {
    m->data[place(m, rng)] ^= (unsigned char)(1u << (rng_u32(rng) & 7));
}

static void set_byte(struct mutant *m, struct rng *rng) {
    static const unsigned char bytes[] = {0, 1, 0x7f, 0x80, 0xff, '\n', ' ', '"', '<', '/', '-'};
    const size_t i = below(rng, sizeof bytes + 1);
    m->data[place(m, rng)] = i < sizeof bytes ? bytes[i] : (unsigned char)rng_u32(rng);
}

// Extreme integers and floating point numbers, in either byte order.
static void set_value(struct mutant *m, struct rng *rng) {
    static const uint64_t values[] = {
        0, 1, 0x7f, 0xff, 0x7fff, 0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffe,
        0x40000000, 0x100000000, 0x7fffffffffffffff, 0x8000000000000000, 0xffffffffffffffff,
        0x7f800000 /* inf */, 0x7fc00000 /* nan */, 0x7f7fffff /* FLT_MAX */, 1 /* denormal */,
        0x7ff0000000000000, 0x7ff8000000000000};
    const uint64_t v = values[below(rng, sizeof values / sizeof *values)];
    const size_t n = (size_t)1 << below(rng, 4), at = place(m, rng);
    const bool big = rng_u32(rng) & 1;
    for (size_t i = 0; i < n && at + i < m->size; i++)
        m->data[at + i] = (unsigned char)(v >> 8 * (big ? n - 1 - i : i));
}

static void truncate_end(struct mutant *m, struct rng *rng) {
    m->size = place(m, rng) + 1;
}

static size_t chunk(const struct mutant *m, size_t at, struct rng *rng) {
    const size_t most = (size_t)1 << below(rng, 13), left = m->size - at;
    return 1 + below(rng, most < left ? most : left);
}

static void delete_chunk(struct mutant *m, struct rng *rng) {
    const size_t at = place(m, rng), n = chunk(m, at, rng);
    if (n < m->size)
        splice(m, at, n, NULL, 0);
}

static void insert_copy(struct mutant *m, size_t from, size_t n, size_t to) {
    unsigned char *copy = mem_array(n, 1);
    memcpy(copy, m->data + from, n);
    splice(m, to, 0, copy, n);
    mem_free(copy);
}

static void double_chunk(struct mutant *m, struct rng *rng) {
    const size_t at = place(m, rng), n = chunk(m, at, rng);
    insert_copy(m, at, n, place(m, rng));
}

static void swap_chunks(struct mutant *m, struct rng *rng) {
    const size_t a = place(m, rng), b = place(m, rng);
    const size_t n = chunk(m, a > b ? a : b, rng);
    for (size_t i = 0; i < n; i++) {
        const unsigned char t = m->data[a + i];
        m->data[a + i] = m->data[b + i];
        m->data[b + i] = t;
    }
}

static bool in_number(unsigned char c) {
    return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+';
}

// The first number in text from a random place on becomes another word.
static void replace_number(struct mutant *m, struct rng *rng) {
    static const char *const words[] = {
        "nan", "-nan", "inf", "-inf", "1e39", "-1e39", "1e-50", "1e400", "-1", "0", "-0", "1",
        "255", "256", "65536", "2147483647", "2147483648", "-2147483649", "4294967295",
        "4294967296", "18446744073709551616", "1e10", "0x10", "1.5", ".", "-", "", "1,5",
        "1e", "1e+", "99999999999999999999999999999999999999999999999999", "1.#QNAN",
        "%s%n", "\xc3\xa9"};
    size_t begin = place(m, rng);
    while (begin < m->size && !in_number(m->data[begin]))
        begin++;
    size_t end = begin;
    while (end < m->size && in_number(m->data[end]))
        end++;
    const char *word = words[below(rng, sizeof words / sizeof *words)];
    splice(m, begin, end - begin, word, strlen(word));
}

static void change_line(struct mutant *m, struct rng *rng) {
    size_t begin = place(m, rng), end = begin;
    while (begin > 0 && m->data[begin - 1] != '\n')
        begin--;
    while (end < m->size && m->data[end] != '\n')
        end++;
    const size_t n = end - begin + (end < m->size);
    if (rng_u32(rng) & 1)
        insert_copy(m, begin, n, begin);
    else if (n < m->size)
        splice(m, begin, n, NULL, 0);
}

struct mutant mutate(const unsigned char *data, size_t size, struct rng *rng) {
    static void (*const changes[])(struct mutant *, struct rng *) = {
        flip_bit, set_byte, set_value, truncate_end, delete_chunk, double_chunk, swap_chunks,
        replace_number, replace_number, change_line};
    struct mutant m = {mem_array(size + 1, 1), size};
    memcpy(m.data, data, size);
    const int count = 1 << below(rng, 6) / 2; // 1, 2 or 4
    for (int i = 0; i < count && m.size > 0; i++)
        changes[below(rng, sizeof changes / sizeof *changes)](&m, rng);
    return m;
}
