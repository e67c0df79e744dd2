// SPDX-License-Identifier: Apache-2.0
// Rows of coefficients as they are stored (lib/transport/rows.h): for each way, what adds a row
// times weights to sums. All is inlined and unrolled, so that sums stay in registers.
#pragma once

#define ROW_INLINE static inline __attribute__((always_inline))

// The ways by their numbers; row_zero, 0, adds nothing.
#define ROW_WAYS(X)                                                                                \
    X(1, row_float32) X(2, row_bfloat16) X(3, row_rgbe) X(4, row_int8) X(5, row_int4)              \
    X(6, row_int2) X(7, row_half8) X(8, row_half4) X(9, row_mean)
#define ROW_WAY(entry) ((entry) & 15)
#define ROW_OFFSET(entry) ((size_t)((entry) >> 4) * 16)

// A way whose vector number v of 12 is `value`.
#define ROW_DEFINE(name, value)                                                                    \
    ROW_INLINE void name(global const uchar *p, global const float *weight, float16 *sum) {        \
        _Pragma("unroll") for (uint v = 0; v < TILE_ROW; v++)                                      \
            sum[v] += weight[v / TILE_VECTORS] * (value);                                          \
    }

ROW_DEFINE(row_float32, vload16(v, (global const float *)p))
ROW_DEFINE(row_bfloat16,
           as_float16(convert_uint16(vload16(v, (global const ushort *)p)) << 16))
ROW_DEFINE(row_mean, (float16)(((global const float *)p)[v / TILE_VECTORS]))

// The exponent in plane 3 as a factor, 2^(E - 136).
ROW_INLINE float16 row_exponent(global const uchar *p, uint v) {
    const uint16 e = convert_uint16(vload16(TILE_ROW + v % TILE_VECTORS, p));
    return as_float16((max(e, (uint16)9) - 9) << 23);
}
ROW_DEFINE(row_rgbe, convert_float16(vload16(v, p)) * row_exponent(p, v))

// The lowest value and the step of a channel.
ROW_INLINE float2 row_head(global const uchar *p, uint channel) {
    const ushort2 h = vload2(channel, (global const ushort *)p);
    return as_float2(convert_uint2(h) << 16);
}

// Whole numbers: a vector of bytes holds 8 / bits vectors of values.
#define ROW_DEFINE_INT(name, bits)                                                                 \
    ROW_INLINE void name(global const uchar *p, global const float *weight, float16 *sum) {        \
        _Pragma("unroll") for (uint i = 0; i < TILE_ROW * bits / 8; i++) {                         \
            const int16 q = convert_int16(vload16(i, p + 16));                                     \
            _Pragma("unroll") for (uint j = 0; j < 8 / bits; j++) {                                \
                const uint v = j * (TILE_ROW * bits / 8) + i;                                      \
                const float2 h = row_head(p, v / TILE_VECTORS);                                    \
                sum[v] += weight[v / TILE_VECTORS] *                                               \
                          (h.x + h.y * convert_float16(q >> (int)(j * bits) & ((1 << bits) - 1))); \
            }                                                                                      \
        }                                                                                          \
    }

ROW_DEFINE_INT(row_int8, 8)
ROW_DEFINE_INT(row_int4, 4)
ROW_DEFINE_INT(row_int2, 2)

// Each of four means for four lanes.
ROW_INLINE float16 row_means(global const uchar *p, uint v, int4 q) {
    const float2 h = row_head(p, v / TILE_VECTORS);
    const float4 m = h.x + h.y * convert_float4(q);
    return m.s0000111122223333;
}
ROW_DEFINE(row_half8, row_means(p, v, convert_int4(vload4(v, p + 16))))
ROW_DEFINE(row_half4, row_means(p, v, convert_int4(vload4(v % 6, p + 16)) >> (int)(v / 6 * 4) & 15))
