#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# How editing tensors with bounces grow: time, memory and frames against bounces, bins, objects and pixels,
# with what the number of multisets says, C(N - 1 + M, M) for M objects and N bounces.
#
# usage: edit_scaling.py RELUME SCENES FOLDER   (writes FOLDER/scaling-*.svg, prints a table)
import json
import math
import os
import subprocess
import sys
import tempfile

WALLS = ["Floor", "BackWall", "LeftWall", "RightWall", "ShortBox", "TallBox", "Ceiling"]
COLOURS = {"precompute, seconds": "#1b6ca8", "tensor, MB": "#c0392b", "frame, ms": "#2e8b57"}


def groups(objects, bounces):
    return math.comb(bounces - 1 + objects, objects)


def series(bins, bounces):
    return ",".join([str(bins)] + ["1"] * (bounces - 1))


def call(words):
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(words), done.stderr))
    return json.loads(done.stdout.splitlines()[-1])


def measure(relume, scene, folder, bounces=3, bins=32, size=64, edit=()):
    tensor = os.path.join(folder, "t.safetensors")
    words = [relume, "precompute", "edit", scene, "-o", tensor, "--bounces", str(bounces), "--series",
             series(bins, bounces), "--tail", "none", "--size", "%dx%d" % (size, size), "--spp", "64", "-q",
             "--json", "--memory", "8"]
    for name in edit:
        words += ["--edit", name]
    made = call(words)
    frame = call([relume, "edit", tensor, "-o", os.path.join(folder, "p.exr"), "--no-device", "--time", "-q",
                  "--json"])
    return {"precompute, seconds": made["seconds"], "tensor, MB": made["file_bytes"] * 1e-6,
            "frame, ms": frame["frame_seconds"] * 1e3}


def svg(path, name, xs, rows, formula):
    """Both axes logarithmic; the formula goes through the last point of the tensor's size."""
    low = min(min(r.values()) for r in rows) / 2
    high = max(max(max(r.values()) for r in rows), max(formula)) * 2
    at = lambda x: 60 + 320 * math.log(x / xs[0]) / math.log(xs[-1] / xs[0])
    up = lambda y: 260 - 240 * math.log(max(y, low) / low) / math.log(high / low)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="460" height="310" font-family="sans-serif" '
           'font-size="11">', '<rect width="460" height="310" fill="white"/>']
    for x in xs:
        out.append('<text x="%.1f" y="276" text-anchor="middle">%g</text>' % (at(x), x))
    for d in range(math.ceil(math.log10(low)), math.floor(math.log10(high)) + 1):
        out.append('<path d="M60 %.1f H380" stroke="#ddd"/><text x="54" y="%.1f" text-anchor="end">%g</text>'
                   % (up(10 ** d), up(10 ** d) + 4, 10 ** d))
    lines = [(key, COLOURS[key], [r[key] for r in rows], "") for key in COLOURS]
    lines.append(("multisets", "#888", formula, ' stroke-dasharray="5 4"'))
    for i, (key, colour, values, dash) in enumerate(lines):
        points = " ".join("%.1f,%.1f" % (at(x), up(y)) for x, y in zip(xs, values))
        out.append('<polyline points="%s" fill="none" stroke="%s" stroke-width="2"%s/>' % (points, colour, dash))
        out.append('<text x="70" y="%d" fill="%s">%s</text>' % (30 + 14 * i, colour, key))
    out.append('<text x="220" y="298" text-anchor="middle">%s</text></svg>' % name)
    with open(path, "w") as f:
        f.write("\n".join(out) + "\n")


def study(folder, name, xs, run, law):
    rows = [run(x) for x in xs]
    sizes = [r["tensor, MB"] for r in rows]
    formula = [law(x) / law(xs[-1]) * sizes[-1] for x in xs]
    for x, r, f in zip(xs, rows, formula):
        print("%-8s %5g  %s  multisets %8.2f MB" % (
            name, x, "  ".join("%s %8.3g" % (k, v) for k, v in r.items()), f), flush=True)
    svg(os.path.join(folder, "scaling-%s.svg" % name), name, xs, rows, formula)


def main():
    relume, scenes, folder = sys.argv[1:]
    glossy = os.path.join(scenes, "cornell-glossy", "scene.xml")
    plain = os.path.join(scenes, "cornell-box", "scene.xml")
    with tempfile.TemporaryDirectory() as work:
        study(folder, "bounces", [1, 2, 3, 4, 5], lambda n: measure(relume, glossy, work, bounces=n),
              lambda n: groups(6, n))
        study(folder, "bins", [8, 16, 32, 64, 128], lambda j: measure(relume, glossy, work, bins=j),
              lambda j: j)
        study(folder, "objects", [1, 2, 3, 4, 5, 6, 7],
              lambda m: measure(relume, plain, work, edit=WALLS[:m], bounces=4), lambda m: groups(m, 4))
        study(folder, "pixels", [16, 32, 64, 128], lambda s: measure(relume, glossy, work, size=s),
              lambda s: s * s)


main()
