// SPDX-License-Identifier: Apache-2.0
// A row of a tile, times its weights, added to sums: what all products of tiles are made of.
//
// While a row is added a later one can be sent for. A processor does that by itself where rows follow one
// another, and 32 bits a value come no faster so; but 16 bits are half as many lines in flight.
#pragma once

#define TILE_INLINE static inline __attribute__((always_inline))

// Rows between the one that is added and the one that is sent for.
#define TILE_AHEAD 4

// OpenCL's own prefetch does nothing in PoCL, and the compiler's wants an address without a space.
#if defined(__x86_64__) || defined(__aarch64__)
#define TILE_PREFETCH(p) __builtin_prefetch((const void *)(size_t)(p))
#else
#define TILE_PREFETCH(p) (void)(p)
#endif

#define LOAD_F32(p, i) (p)[i]
#define LOAD_BF16(p, i) as_float16(convert_uint16((p)[i]) << 16)

// Vectors of `type` that a line of the cache, 64 bytes, holds.
#define TILE_LINE(type) (64 / sizeof(type))

// sum += weight * row; later NULL: nothing is sent for.
#define TILE_DEFINE_ADD(name, type, LOAD, space)                                                   \
    TILE_INLINE void name(global const type *row, global const type *later,                        \
                          global const float *weight, space float16 *sum) {                        \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++) {                                    \
            if (later && v % TILE_LINE(type) == 0)                                                 \
                TILE_PREFETCH(later + v);                                                          \
            sum[v] += weight[v / TILE_VECTORS] * LOAD(row, v);                                     \
        }                                                                                          \
    }

TILE_DEFINE_ADD(add_row_f32, float16, LOAD_F32, private)
TILE_DEFINE_ADD(add_row_bf16, ushort16, LOAD_BF16, private)
TILE_DEFINE_ADD(add_row_to_f32, float16, LOAD_F32, global)
TILE_DEFINE_ADD(add_row_to_bf16, ushort16, LOAD_BF16, global)
