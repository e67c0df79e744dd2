#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times numpy's sgemv on as many numbers as bench/replay has, for comparison.

usage: sgemv.py [PIXELS [COEFFICIENTS]]     (262144 and 256)
"""
import sys
import time

try:
    import numpy
except ImportError:
    sys.exit("numpy is not installed: nothing to compare with")

pixels = int(sys.argv[1]) if len(sys.argv) > 1 else 262144
coefficients = int(sys.argv[2]) if len(sys.argv) > 2 else 256
matrices = [numpy.full((pixels, coefficients), 0.5, numpy.float32) for _ in range(3)]
weights = numpy.linspace(0, 1, coefficients, dtype=numpy.float32)
seconds = []
for _ in range(11):
    start = time.perf_counter()
    for m in matrices:
        m @ weights
    seconds.append(time.perf_counter() - start)
median = sorted(seconds)[len(seconds) // 2]
print(f"numpy {numpy.__version__}, 32 bits: product {median * 1e3:.1f} ms, "
      f"{3 * matrices[0].nbytes * 1e-9 / median:.1f} GB/s")
