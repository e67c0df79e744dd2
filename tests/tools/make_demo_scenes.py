#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Makes the meshes and curves of data/scenes/teatray and data/scenes/earrings.
#
# usage: make_demo_scenes.py FOLDER   (data/scenes)
import math
import os
import struct
import sys


def write_ply(path, vertices, faces):
    head = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
            "property float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar ushort vertex_indices\nend_header\n")
    with open(path, "wb") as f:
        f.write((head % (len(vertices), len(faces))).encode())
        for v in vertices:
            f.write(struct.pack("<3f", *v))
        for t in faces:
            f.write(struct.pack("<B3H", 3, *t))


def grid_faces(rows, columns, wrap):
    faces = []
    for i in range(rows - 1):
        for j in range(columns if wrap else columns - 1):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            faces += [(a, a + columns, b), (b, a + columns, b + columns)]
    return faces


def revolve(profile, columns):
    """A surface of revolution about y from (radius, height) pairs."""
    vertices = [(r * math.cos(2 * math.pi * j / columns), y, r * math.sin(2 * math.pi * j / columns))
                for r, y in profile for j in range(columns)]
    return vertices, grid_faces(len(profile), columns, True)


def tube(path, radius, columns):
    """A tube around a curve of points in the plane z = 0."""
    vertices = []
    for i, (x, y) in enumerate(path):
        x0, y0 = path[max(i - 1, 0)]
        x1, y1 = path[min(i + 1, len(path) - 1)]
        l = math.hypot(x1 - x0, y1 - y0)
        nx, ny = -(y1 - y0) / l, (x1 - x0) / l
        for j in range(columns):
            a = 2 * math.pi * j / columns
            vertices.append((x + radius * math.cos(a) * nx, y + radius * math.cos(a) * ny,
                             radius * math.sin(a)))
    return vertices, grid_faces(len(path), columns, True)


def tray():
    profile = [(1e-3, 0), (1, 0), (2, 0), (2.7, 0), (2.8, 0.01), (2.86, 0.05), (2.9, 0.14), (2.94, 0.2),
               (3.0, 0.22), (3.05, 0.2), (3.05, 0.16), (3.0, 0.1), (2.9, -0.04), (2.8, -0.06),
               (1e-3, -0.06)]
    return revolve(profile, 96)


def handle():
    path = [(0.62 * math.cos(a), 0.5 * math.sin(a)) for a in
            (math.pi * (i / 48 * 1.1 - 0.05) for i in range(49))]
    return tube(path, 0.085, 20)


def cloth():
    n = 72
    vertices = []
    for i in range(n):
        for j in range(n):
            x, z = 8 * (j / (n - 1) - 0.5), 8 * (i / (n - 1) - 0.5)
            fold = (0.16 * math.sin(1.9 * x + 0.7 * z) + 0.10 * math.sin(0.8 * x - 2.3 * z + 1)
                    + 0.05 * math.sin(3.7 * x + 2.9 * z))
            vertices.append((x, fold * min(1, (x * x + z * z) / 3), z))
    return vertices, grid_faces(n, n, False)


def write_curve(path, bins, value):
    with open(path, "w") as f:
        f.write("from,to,r,g,b\n")
        for i in range(bins):
            low, high = 90 * i / bins, 90 * (i + 1) / bins
            rgb = [sum(value(math.radians(low + (high - low) * (k + 0.5) / 8))[c] for k in range(8)) / 8
                   for c in range(3)]
            f.write("%.9g,%.9g,%.6g,%.6g,%.6g\n" % (low, high, *rgb))


def beckmann(t, m):
    c = math.cos(t)
    return math.exp(-(math.tan(t) / m) ** 2) / (math.pi * m * m * c ** 4) if c > 1e-3 else 0


def silver_half(t):
    lobe = 0.24 * beckmann(t, 0.09) + 0.05 * beckmann(t, 0.3)
    return (lobe, 0.97 * lobe, 0.92 * lobe)


def silver_difference(t):
    f = (1 - math.cos(t)) ** 5
    return tuple(r + (1 - r) * f for r in (0.92, 0.89, 0.84))


def velvet_half(t):
    return tuple(0.02 + 0.1 * k * math.exp(-(t / 0.5) ** 2) for k in (0.2, 0.35, 1.0))


def velvet_side(t):
    v = 0.5 + 1.6 * math.sin(t) ** 4
    return (v, v, v)


def main():
    folder = sys.argv[1]
    for name in ("teatray", "earrings"):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    at = lambda name: os.path.join(folder, name)
    write_ply(at("teatray/tray.ply"), *tray())
    write_ply(at("teatray/handle.ply"), *handle())
    write_curve(at("teatray/silver_half.csv"), 256, silver_half)
    write_curve(at("teatray/silver_difference.csv"), 32, silver_difference)
    write_ply(at("earrings/cloth.ply"), *cloth())
    write_curve(at("earrings/velvet_half.csv"), 128, velvet_half)
    write_curve(at("earrings/velvet_side.csv"), 128, velvet_side)


main()
