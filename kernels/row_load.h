// SPDX-License-Identifier: Apache-2.0
// Rows of coefficients as they are stored (lib/transport/rows.h): for each way, what adds a row
// times weights to sums. All is inlined and unrolled, so that sums stay in registers.
//
// What rows have in common is added up apart, and brought to the lanes once a tile: what all lanes of
// a channel share (means, lowest values), and what four lanes share (half resolution). Up to 64 rows
// are sorted by their ways first: a branch on the way of each would be guessed wrongly most of the time.
#pragma once

#define ROW_INLINE static inline __attribute__((always_inline))

// The ways by their numbers; row_zero, 0, adds nothing.
#define ROW_WAYS(X)                                                                                \
    X(1, row_float32) X(2, row_bfloat16) X(3, row_rgbe) X(4, row_int8) X(5, row_int4)              \
    X(6, row_int2) X(7, row_half8) X(8, row_half4) X(9, row_mean)
#define ROW_WAY(entry) ((entry) & 15)
#define ROW_OFFSET(entry) ((size_t)((entry) >> 4) * 16)
#define ROW_MOST_WAYS 16
#define ROWS_AT_ONCE 64

struct row_sums {
    float16 lane[TILE_ROW];
    float16 mean[TILE_CHANNELS]; // for four lanes each
    float4 base;                 // by channel
};

ROW_INLINE float4 row_weight(global const float *weight) {
    return (float4)(weight[0], weight[1], weight[2], 0);
}

// A way whose vector number v of 12 is `value`.
#define ROW_DEFINE(name, value)                                                                    \
    ROW_INLINE void name(global const uchar *p, global const float *weight, struct row_sums *s) {  \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)                                      \
            s->lane[v] += weight[v / TILE_VECTORS] * (value);                                      \
    }

ROW_DEFINE(row_float32, vload16(v, (global const float *)p))
ROW_DEFINE(row_bfloat16,
           as_float16(convert_uint16(vload16(v, (global const ushort *)p)) << 16))

// The exponent in plane 3 as a factor, 2^(E - 136).
ROW_INLINE float16 row_exponent(global const uchar *p, uint v) {
    const uint16 e = convert_uint16(vload16(TILE_ROW + v % TILE_VECTORS, p));
    return as_float16((max(e, (uint16)9) - 9) << 23);
}
ROW_DEFINE(row_rgbe, convert_float16(vload16(v, p)) * row_exponent(p, v))

ROW_INLINE void row_mean(global const uchar *p, global const float *weight, struct row_sums *s) {
    s->base += row_weight(weight) * vload4(0, (global const float *)p);
}

// Whole numbers: adds the lowest values; returns the steps. Both are times weights.
ROW_INLINE float4 row_head(global const uchar *p, global const float *weight, struct row_sums *s) {
    const uint4 h = vload4(0, (global const uint *)p);
    const float4 w = row_weight(weight);
    s->base += w * as_float4(h << 16);
    return w * as_float4(h & 0xffff0000);
}

ROW_INLINE float row_step(float4 step, uint channel) {
    return channel == 0 ? step.x : channel == 1 ? step.y : step.z;
}

// step times the low bits of q.
ROW_INLINE float16 row_times(float step, int16 q, int bits) {
    return step * convert_float16(q & ((1 << bits) - 1));
}

// The same of two bits: one of four products, by an instruction that looks at no other bits.
#if defined(__AVX__)
typedef float row_floats __attribute__((vector_size(32)));
typedef int row_ints __attribute__((vector_size(32)));

ROW_INLINE float8 row_choose(float4 products, int8 q) {
    return __builtin_astype(
        __builtin_ia32_vpermilvarps256(__builtin_astype((float8)(products, products), row_floats),
                                       __builtin_astype(q, row_ints)), float8);
}

ROW_INLINE float16 row_times2(float step, int16 q, int bits) {
    const float4 products = step * (float4)(0, 1, 2, 3);
    (void)bits;
    return (float16)(row_choose(products, q.lo), row_choose(products, q.hi));
}
#else
#define row_times2 row_times
#endif

// A vector of bytes holds 8 / bits vectors of values.
#define ROW_DEFINE_INT(name, bits, times)                                                          \
    ROW_INLINE void name(global const uchar *p, global const float *weight, struct row_sums *s) {  \
        const float4 step = row_head(p, weight, s);                                                \
        _Pragma("unroll") for (uint i = 0; i < TILE_ROW * bits / 8; i++) {                         \
            const int16 q = convert_int16(vload16(i, p + 16));                                     \
            _Pragma("unroll") for (uint j = 0; j < 8 / bits; j++) {                                \
                const uint v = j * (TILE_ROW * bits / 8) + i;                                      \
                s->lane[v] += times(row_step(step, v / TILE_VECTORS), q >> (int)(j * bits), bits); \
            }                                                                                      \
        }                                                                                          \
    }

ROW_DEFINE_INT(row_int8, 8, row_times)
ROW_DEFINE_INT(row_int4, 4, row_times)
ROW_DEFINE_INT(row_int2, 2, row_times2)

ROW_INLINE void row_half8(global const uchar *p, global const float *weight, struct row_sums *s) {
    const float4 step = row_head(p, weight, s);
    _Pragma("unroll") for (uint c = 0; c < TILE_CHANNELS; c++)
        s->mean[c] += row_step(step, c) * convert_float16(vload16(c, p + 16));
}

// 24 bytes: the low bits of all, then the high ones.
ROW_INLINE void row_half4(global const uchar *p, global const float *weight, struct row_sums *s) {
    const float4 step = row_head(p, weight, s);
    const uchar16 a = vload16(0, p + 16), b = vload16(0, p + 24);
    s->mean[0] += step.x * convert_float16(a & (uchar)15);
    s->mean[1] += step.y * convert_float16((uchar16)(b.hi & (uchar)15, a.lo >> (uchar)4));
    s->mean[2] += step.z * convert_float16(b >> (uchar)4);
}

// Rows times their weights.
struct row_list {
    global const uchar *tile;
    global const float *weight;
    uint entry[ROWS_AT_ONCE];
    uchar sorted[ROW_MOST_WAYS][ROWS_AT_ONCE];
    uint count[ROW_MOST_WAYS];
};

#define ROW_ADD(number, name)                                                                      \
    for (uint n = 0; n < l->count[number]; n++) {                                                  \
        const uint k = l->sorted[number][n];                                                       \
        name(l->tile + ROW_OFFSET(l->entry[k]), l->weight + k * TILE_CHANNELS, s);                 \
    }

// Adds `count` rows, at most ROWS_AT_ONCE, in the order of their ways. index NULL: those of `entry`.
ROW_INLINE void row_add_some(struct row_list *l, global const uint *entry, global const uint *index,
                             uint count, struct row_sums *s) {
    for (uint way = 0; way < ROW_MOST_WAYS; way++)
        l->count[way] = 0;
    for (uint k = 0; k < count; k++) {
        l->entry[k] = index ? entry[index[k]] : entry[k];
        const uint way = ROW_WAY(l->entry[k]);
        l->sorted[way][l->count[way]++] = (uchar)k;
    }
    ROW_WAYS(ROW_ADD)
}

// out = before + sum_k weight[k] row[index[k]], or row[k] where index is NULL.
ROW_INLINE void row_add(global const uchar *tile, global const uint *entry, global const uint *index,
                        global const float *weight, uint count, const bool anew,
                        global float16 *out) {
    struct row_sums s = {.base = 0};
    struct row_list l = {.tile = tile};
    _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)
        s.lane[v] = anew ? 0 : out[v];
    _Pragma("unroll") for (uint c = 0; c < TILE_CHANNELS; c++)
        s.mean[c] = 0;
    for (uint k = 0; k < count; k += ROWS_AT_ONCE) {
        l.weight = weight + (size_t)k * TILE_CHANNELS;
        row_add_some(&l, index ? entry : entry + k, index ? index + k : index,
                     min(count - k, (uint)ROWS_AT_ONCE), &s);
    }
    _Pragma("unroll") for (uint c = 0; c < TILE_CHANNELS; c++) {
        const float16 m = s.mean[c] + row_step(s.base, c);
        out[4 * c] = s.lane[4 * c] + m.s0000111122223333;
        out[4 * c + 1] = s.lane[4 * c + 1] + m.s4444555566667777;
        out[4 * c + 2] = s.lane[4 * c + 2] + m.s88889999aaaabbbb;
        out[4 * c + 3] = s.lane[4 * c + 3] + m.sccccddddeeeeffff;
    }
}
