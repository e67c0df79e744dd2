// SPDX-License-Identifier: Apache-2.0
// Ways to store a row of coefficients, by their numbers in files: new ones go to the end. The
// kernels' part of one is a function of its name in kernels/row_load.h.
X(row_zero)
X(row_float32)
X(row_bfloat16)
X(row_rgbe)
X(row_int8)
X(row_int4)
X(row_int2)
X(row_half8)
X(row_half4)
X(row_mean)
