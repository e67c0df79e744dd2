#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes lib/sampler/lattice_data.inc: the generating vector of an extensible rank-1 lattice.

    make_lattice.py > lib/sampler/lattice_data.inc

Component by component: each number is the one, of all odd ones, whose planes with the numbers before
it have the least error at their worst level. A plane's error at level m is the squared worst-case
error of its 2^m points in the Korobov space of smoothness 2, relative to the best lattice's of that
size (Dick, Kuo, Sloan 2013, High-dimensional integration: the quasi-Monte Carlo way). Planes of two
dimensions count by how near they stand: those of one draw of two numbers most.
"""
import numpy as np

LEVELS = range(4, 15)
BITS, DIMENSIONS, WINDOW = 14, 64, 16


def plane_errors(m):
    """Relative error of the lattice (1, a) of 2^m points, by a; infinite for even a."""
    n = 1 << m
    i = np.arange(n)
    term = 1 + 2 * np.pi**2 * ((i / n) ** 2 - i / n + 1 / 6)
    errors = np.full(n, np.inf)
    for a in range(1, n, 2):
        errors[a] = np.mean(term * term[(i * a) % n]) - 1
    return errors / errors.min()


def nearness(a, b):
    return 4.0 if a // 2 == b // 2 else 1.0 if b - a < WINDOW else 0.1


def choose():
    tables = {m: plane_errors(m) for m in LEVELS}
    odd = np.arange(1, 1 << BITS, 2)
    vector = [1]
    for d in range(1, DIMENSIONS):
        cost = np.zeros(len(odd))
        for m, errors in tables.items():
            n = 1 << m
            level = sum(nearness(k, d) * errors[(odd * pow(z, -1, n)) % n]
                        for k, z in enumerate(vector))
            cost = np.maximum(cost, level)
        cost[np.isin(odd, vector)] = np.inf
        vector.append(int(odd[np.argmin(cost)]))
    return vector


print("// SPDX-License-Identifier: Apache-2.0")
print("// Made by tests/tools/make_lattice.py.")
v = choose()
for i in range(0, len(v), 10):
    print("    " + " ".join(f"{z}," for z in v[i:i + 10]))
