#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Makes the meshes and curves of data/scenes/teatray, earrings, vase, room and ring.
#
# usage: make_demo_scenes.py FOLDER   (data/scenes)
import math
import os
import struct
import sys


def write_ply(path, vertices, faces):
    """Vertices are (x, y, z) or (x, y, z, u, v)."""
    names = "xyzuv"[:len(vertices[0])]
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(vertices)
    head += "".join("property float %s\n" % name for name in names)
    head += "element face %d\nproperty list uchar ushort vertex_indices\nend_header\n" % len(faces)
    with open(path, "wb") as f:
        f.write(head.encode())
        for v in vertices:
            f.write(struct.pack("<%df" % len(names), *v))
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


def vase():
    """With u around and v up, so that its tangents go round it."""
    outer = [(0.02, 0), (0.3, 0), (0.36, 0.03), (0.44, 0.15), (0.52, 0.35), (0.55, 0.55), (0.52, 0.75),
             (0.43, 0.95), (0.31, 1.12), (0.24, 1.26), (0.22, 1.38), (0.25, 1.48), (0.3, 1.54)]
    profile = outer + [(r - 0.03, y) for r, y in reversed(outer[3:])]
    columns = 64
    vertices = [(r * math.cos(2 * math.pi * j / columns), y, r * math.sin(2 * math.pi * j / columns),
                 j / columns, i / (len(profile) - 1))
                for i, (r, y) in enumerate(profile) for j in range(columns + 1)]
    return vertices, grid_faces(len(profile), columns + 1, False)


def ring():
    """A band with rounded edges."""
    profile = [(0.94, 0.03), (0.94, 0.42), (0.95, 0.445), (0.97, 0.455), (0.99, 0.445), (1.0, 0.42),
               (1.0, 0.03), (0.99, 0.005), (0.97, 0), (0.95, 0.005), (0.94, 0.03)]
    return revolve([(r, y) for r, y in reversed(profile)], 128)


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


# The fit of a shifted gamma distribution to the measured "red-fabric" (Bagher, Soler, Holzschuch 2012):
# rho_s, alpha, p, f0 and f1 by channel.
FABRIC = ((0.168669, 0.324447, 0.787411, 0.0718348, -0.0585917),
          (0.0486346, 0.228455, 0.821197, 0.0644687, -0.0062547),
          (0.040485, 0.109436, 0.279212, 0.0206123, -0.050402))


def gamma_slopes(alpha, p):
    """The density of squared slopes, with the integral 1."""
    density = lambda x: math.exp(-(alpha * alpha + x) / alpha) / (alpha * alpha + x) ** p
    step = 1e-3
    whole = step * sum(density(step * (i + 0.5)) for i in range(20000))
    return lambda x: density(x) / whole


def fabric_half(t):
    c = max(math.cos(t), 1e-3)
    x = math.tan(t) ** 2 if t < 1.57 else 1e6
    return tuple(s / math.pi * SLOPES[k](x) / (math.pi * c ** 4) if x < 1e5 else 0
                 for k, (s, *_) in enumerate(FABRIC))


SLOPES = [gamma_slopes(alpha, p) for _, alpha, p, *_ in FABRIC]


def fabric_difference(t):
    c = math.cos(t)
    return tuple(max(f0 - f1 * c + (1 - f0) * (1 - c) ** 5, 0) for *_, f0, f1 in FABRIC)


def main():
    folder = sys.argv[1]
    for name in ("teatray", "earrings", "vase", "room", "ring"):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    at = lambda name: os.path.join(folder, name)
    write_ply(at("teatray/tray.ply"), *tray())
    write_ply(at("teatray/handle.ply"), *handle())
    write_curve(at("teatray/silver_half.csv"), 256, silver_half)
    write_curve(at("teatray/silver_difference.csv"), 32, silver_difference)
    write_ply(at("earrings/cloth.ply"), *cloth())
    write_curve(at("earrings/velvet_half.csv"), 128, velvet_half)
    write_curve(at("earrings/velvet_side.csv"), 128, velvet_side)
    write_ply(at("vase/vase.ply"), *vase())
    write_ply(at("ring/ring.ply"), *ring())
    write_curve(at("room/fabric_half.csv"), 64, fabric_half)
    write_curve(at("room/fabric_difference.csv"), 16, fabric_difference)


main()
