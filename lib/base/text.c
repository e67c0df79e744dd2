// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <math.h>
#include <stdio.h>

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// mantissa * 10^exponent. Both factors are exact in double where the quick way is taken (Clinger
// 1990, How to Read Floating Point Numbers Accurately); long double covers the rest.
static double scale(uint64_t mantissa, long exponent) {
    static const double exact[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (mantissa == 0 || exponent < -400)
        return 0;
    if (exponent > 400)
        return INFINITY;
    const long n = exponent < 0 ? -exponent : exponent;
    if (mantissa <= (uint64_t)1 << 53 && n <= 22)
        return exponent < 0 ? (double)mantissa / exact[n] : (double)mantissa * exact[n];
    long double power = 1, square = 10;
    for (long bits = n; bits; bits >>= 1, square *= square)
        if (bits & 1)
            power *= square;
    return (double)(exponent < 0 ? (long double)mantissa / power : (long double)mantissa * power);
}

// The exponent part at p, or p itself when there is none.
static const char *read_exponent(const char *p, long *exponent) {
    if (*p != 'e' && *p != 'E')
        return p;
    const char *q = p + 1;
    const bool negative = *q == '-';
    if (*q == '-' || *q == '+')
        q++;
    if (!is_digit(*q))
        return p;
    long e = 0;
    for (; is_digit(*q); q++)
        if (e < 1000000)
            e = e * 10 + (*q - '0');
    *exponent += negative ? -e : e;
    return q;
}

bool text_number(const char **cursor, double *value) {
    const uint64_t full = 1000000000000000000u; // one digit more still fits 64 bits
    const char *p = *cursor;
    const bool negative = *p == '-';
    if (*p == '-' || *p == '+')
        p++;
    uint64_t mantissa = 0;
    long exponent = 0;
    const char *digits = p;
    for (; is_digit(*p); p++)
        if (mantissa < full)
            mantissa = mantissa * 10 + (uint64_t)(*p - '0');
        else
            exponent++;
    size_t count = (size_t)(p - digits);
    if (*p == '.') {
        digits = ++p;
        for (; is_digit(*p); p++)
            if (mantissa < full) {
                mantissa = mantissa * 10 + (uint64_t)(*p - '0');
                exponent--;
            }
        count += (size_t)(p - digits);
    }
    if (count == 0)
        return false;
    *cursor = read_exponent(p, &exponent);
    *value = negative ? -scale(mantissa, exponent) : scale(mantissa, exponent);
    return true;
}

bool text_integer(const char **cursor, int64_t *value) {
    const char *p = *cursor;
    const bool negative = *p == '-';
    if (*p == '-' || *p == '+')
        p++;
    if (!is_digit(*p))
        return false;
    uint64_t n = 0;
    for (; is_digit(*p); p++)
        n = n < (uint64_t)INT64_MAX / 10 ? n * 10 + (uint64_t)(*p - '0') : INT64_MAX;
    *value = negative ? -(int64_t)n : (int64_t)n;
    *cursor = p;
    return true;
}

const char *text_excerpt(const char *p, char *out, size_t n) {
    if (*p == '\0' || *p == '\n' || *p == '\r') {
        snprintf(out, n, "%s", *p ? "end of line" : "end of file");
        return out;
    }
    size_t i = 0;
    for (; i + 1 < n && *p && !text_is_space(*p); p++)
        out[i++] = *p > ' ' && *p < 127 ? *p : '?';
    out[i] = '\0';
    return out;
}
