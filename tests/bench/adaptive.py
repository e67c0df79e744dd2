#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Adaptive against uniform sampling at equal time, pilot included: relMSE against a long reference.

usage: adaptive.py BUILD SECONDS SEEDS SCENE[:REFERENCE]...
REFERENCE: a picture, or its samples (4096); SCENE `small`: a small thing before a plain sky

Prints, for 160x90 pixels, the means of relMSE over the seeds, uniform / adaptive with its standard
error (by leaving out a seed at a time), and that ratio of the medians: where rare bright samples make
most of the error, means say little of one picture. Pairs are rendered in turn, so that a busy machine
slows both.
"""
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

SMALL = """<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
<lookat origin="0,1,9" target="0,1,0" up="0,1,0"/></transform><sampler type="sobol"/>
<film type="hdrfilm"><rfilter type="box"/></film></sensor>
<emitter type="constant"><rgb name="radiance" value="0.3"/></emitter>
<shape type="sphere"><point name="center" value="0,0.9,0"/><float name="radius" value="0.4"/>
<bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="-90"/>
<translate y="0.5"/></transform></shape>
<shape type="sphere"><point name="center" value="2,4,2"/><float name="radius" value="0.2"/>
<emitter type="area"><rgb name="radiance" value="100"/></emitter></shape></scene>
"""


def run(*args):
    return subprocess.run([str(a) for a in args], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True).stdout


class Bench:
    def __init__(self, build, folder):
        self.relume, self.folder = os.path.join(build, "bin", "relume"), folder

    def render(self, scene, name, *options):
        out = os.path.join(self.folder, name)
        run(self.relume, "render", scene, "-o", out, "--size", "160x90", "--sampler", "sobol", "-q",
            "--json", *options)
        return out

    def relmse(self, reference, *options):
        picture = self.render(*options)
        return json.loads(run(self.relume, "compare", reference, picture, "--json"))["relmse"]["value"]


def ratio(pairs):
    return sum(p[0] for p in pairs) / sum(p[1] for p in pairs)


def jackknife(pairs):
    n = len(pairs)
    rest = [ratio(pairs[:i] + pairs[i + 1:]) for i in range(n)]
    mean = sum(rest) / n
    return math.sqrt((n - 1) / n * sum((r - mean) ** 2 for r in rest))


def measure(bench, name, scene, seconds, seeds, reference):
    if not reference.endswith(".exr"):
        reference = bench.render(scene, "reference.exr", "--spp", reference, "--seed", 1000)
    pairs = []
    for seed in range(1, seeds + 1):
        limits = ("--time", seconds, "--seed", seed)
        pairs.append((bench.relmse(reference, scene, "uniform.exr", *limits),
                      bench.relmse(reference, scene, "adaptive.exr", "--adaptive", *limits)))
    mean = [sum(p[i] for p in pairs) / seeds for i in (0, 1)]
    median = [statistics.median(p[i] for p in pairs) for i in (0, 1)]
    print(f"{name}, {seconds} s, {seeds} seeds: relMSE {mean[0]:.3g} uniform, {mean[1]:.3g} adaptive; ratio "
          f"{ratio(pairs):.2f} +- {jackknife(pairs):.2f}, of medians {median[0] / median[1]:.2f}",
          flush=True)


def main():
    build, seconds, seeds = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        small = os.path.join(folder, "small.xml")
        with open(small, "w", encoding="utf-8") as file:
            file.write(SMALL)
        for argument in sys.argv[4:]:
            scene, _, reference = argument.partition(":")
            path = small if scene == "small" else scene
            name = scene if scene == "small" else os.path.basename(os.path.dirname(scene))
            measure(Bench(build, folder), name, path, seconds, seeds,
                    reference or "4096")


main()
