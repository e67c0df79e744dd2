// SPDX-License-Identifier: Apache-2.0
// Rows of coefficients as they are stored (lib/transport/rows.h): for each way, 16 of the 192 values,
// number v of 12.
#pragma once

// The ways by their numbers; row_zero, 0, adds nothing.
#define ROW_WAYS(X)                                                                                \
    X(1, row_float32) X(2, row_bfloat16) X(3, row_rgbe) X(4, row_int8) X(5, row_int4)              \
    X(6, row_int2) X(7, row_half8) X(8, row_half4) X(9, row_mean)
#define ROW_WAY(entry) ((entry) & 15)
#define ROW_OFFSET(entry) ((size_t)((entry) >> 4) * 16)

inline float16 row_float32(global const uchar *p, uint v) {
    return vload16(v, (global const float *)p);
}

inline float16 row_bfloat16(global const uchar *p, uint v) {
    return as_float16(convert_uint16(vload16(v, (global const ushort *)p)) << 16);
}

// Mantissas in planes of 64, then exponents; 2^(E - 136).
inline float16 row_rgbe(global const uchar *p, uint v) {
    const uint16 e = convert_uint16(vload16(12 + v % TILE_VECTORS, p));
    return convert_float16(vload16(v, p)) * as_float16((max(e, (uint16)9) - 9) << 23);
}

// The lowest value and the step of a channel.
inline float2 row_head(global const uchar *p, uint channel) {
    const ushort2 h = vload2(channel, (global const ushort *)p);
    return as_float2(convert_uint2(h) << 16);
}

inline float16 row_int8(global const uchar *p, uint v) {
    const float2 h = row_head(p, v / TILE_VECTORS);
    return h.x + h.y * convert_float16(vload16(v, p + 16));
}

inline float16 row_int4(global const uchar *p, uint v) {
    const float2 h = row_head(p, v / TILE_VECTORS);
    const uint16 q = convert_uint16(vload16(v % 6, p + 16)) >> v / 6 * 4 & 15;
    return h.x + h.y * convert_float16(q);
}

inline float16 row_int2(global const uchar *p, uint v) {
    const float2 h = row_head(p, v / TILE_VECTORS);
    const uint16 q = convert_uint16(vload16(v % 3, p + 16)) >> v / 3 * 2 & 3;
    return h.x + h.y * convert_float16(q);
}

inline float16 row_half8(global const uchar *p, uint v) {
    const float2 h = row_head(p, v / TILE_VECTORS);
    const float4 m = h.x + h.y * convert_float4(vload4(v, p + 16));
    return (float16)(m.xxxx, m.yyyy, m.zzzz, m.wwww);
}

inline float16 row_half4(global const uchar *p, uint v) {
    const float2 h = row_head(p, v / TILE_VECTORS);
    const uint4 q = convert_uint4(vload4(v % 6, p + 16)) >> v / 6 * 4 & 15;
    const float4 m = h.x + h.y * convert_float4(q);
    return (float16)(m.xxxx, m.yyyy, m.zzzz, m.wwww);
}

inline float16 row_mean(global const uchar *p, uint v) {
    return (float16)(((global const float *)p)[v / TILE_VECTORS]);
}
