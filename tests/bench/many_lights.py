#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Ways of choosing among 1e2, 1e4 and 1e6 emitting triangles, at equal time.

    many_lights.py BUILD [N ...]

A square of 40 x 40 m with pillars, and N triangles above it that emit: sizes over a decade, any
direction, 4 in 5 in clusters; N decides how large they are, not how much they emit together. For
each way: cost of a choice, and time x relMSE against a reference of many samples, which is the time
to a given relMSE where error falls as 1/N (independent sampler, median of three runs). Times are
processor seconds of rendering alone: those of a run with one sample are taken off.
"""
import json
import math
import random
import resource
import statistics
import struct
import subprocess
import sys
import tempfile

SPP, REFERENCE, SIZE, REPEATS = 32, 2048, "160x120", 3

SCENE = """<scene version="3.0.0">
    <default name="choice" value="auto"/>
    <integrator type="path">
        <integer name="max_depth" value="3"/>
        <boolean name="hide_emitters" value="true"/>
        <string name="light_choice" value="$choice"/>
    </integrator>
    <sensor type="perspective">
        <float name="fov" value="60"/>
        <transform name="to_world">
            <lookat origin="-18, 6, -18" target="0, 0, 0" up="0, 1, 0"/>
        </transform>
        <film type="hdrfilm"><rfilter type="box"/></film>
    </sensor>
    <bsdf type="diffuse" id="grey"><rgb name="reflectance" value="0.5"/></bsdf>
    <shape type="rectangle">
        <transform name="to_world">
            <rotate x="1" angle="-90"/><scale value="20"/>
        </transform>
        <ref id="grey"/>
    </shape>
%s    <shape type="ply">
        <string name="filename" value="lights.ply"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="%g"/></emitter>
    </shape>
</scene>
"""

PILLAR = """    <shape type="cube">
        <transform name="to_world">
            <scale x="0.4" y="%g" z="0.4"/><translate x="%g" y="0" z="%g"/>
        </transform>
        <ref id="grey"/>
    </shape>
"""


def make_triangles(n, rng):
    """Vertices of n triangles, and their area together."""
    middles = [[rng.uniform(-18, 18), rng.uniform(0.3, 3), rng.uniform(-18, 18)]
               for _ in range(max(4, int(math.sqrt(n) / 4)))]
    vertices, area = [], 0
    for _ in range(n):
        if rng.random() < 0.8:
            middle = [c + rng.gauss(0, 0.5) for c in rng.choice(middles)]
            middle[1] = abs(middle[1]) + 0.02
        else:
            middle = [rng.uniform(-20, 20), rng.uniform(0.1, 4), rng.uniform(-20, 20)]
        size = 0.6 / math.sqrt(n) * 10 ** rng.uniform(0, 1)
        corners = [[c + rng.gauss(0, size) for c in middle] for _ in range(3)]
        a, b = ([q - p for p, q in zip(corners[0], corners[k])] for k in (1, 2))
        area += 0.5 * math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                 a[0] * b[1] - a[1] * b[0])
        vertices += corners
    return vertices, area


def write_scene(folder, n):
    rng = random.Random(n)
    vertices, area = make_triangles(n, rng)
    with open(f"{folder}/lights.ply", "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {3 * n}\n"
                    "property float x\nproperty float y\nproperty float z\n"
                    f"element face {n}\nproperty list uchar int vertex_indices\n"
                    "end_header\n").encode())
        for v in vertices:
            file.write(struct.pack("<3f", *v))
        for i in range(n):
            file.write(struct.pack("<B3i", 3, 3 * i, 3 * i + 1, 3 * i + 2))
    pillars = "".join(PILLAR % (rng.uniform(0.5, 3), rng.uniform(-18, 18), rng.uniform(-18, 18))
                      for _ in range(60))
    with open(f"{folder}/scene.xml", "w", encoding="utf-8") as file:
        file.write(SCENE % (pillars, 1000 / area))


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def render(build, folder, out, choice, spp, seed):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    run(f"{build}/bin/relume", "render", f"{folder}/scene.xml", "-o", f"{folder}/{out}",
        "-D", f"choice={choice}", "--size", SIZE, "--spp", str(spp), "--sampler",
        "independent", "--seed", str(seed), "--threads", "1", "--quiet")
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def relmse(build, folder):
    text = run(f"{build}/bin/relume", "compare", f"{folder}/reference.exr", f"{folder}/out.exr",
               "--json")
    value = json.loads(text)["relmse"]
    return value["value"] if isinstance(value, dict) else value


def compare(build, folder, n):
    write_scene(folder, n)
    print(f"{n} triangles that emit", flush=True)
    print(run(f"{build}/tests/light_choice", f"{folder}/scene.xml"), end="", flush=True)
    render(build, folder, "reference.exr", "tree", REFERENCE, 99)
    work = {}
    for choice in ("tree", "power", "uniform"):
        seconds, errors = [], []
        for seed in range(REPEATS):
            seconds.append(-render(build, folder, "out.exr", choice, 1, seed))
            seconds[-1] += render(build, folder, "out.exr", choice, SPP + 1, seed)
            errors.append(relmse(build, folder))
        second, error = statistics.median(seconds), statistics.median(errors)
        work[choice] = second * error
        print(f"  {choice:8} {second:6.2f} s, relMSE {error:9.4f} at {SPP} samples; time to equal "
              f"relMSE {work[choice] / work['tree']:8.1f} x tree", flush=True)


def main():
    build = sys.argv[1] if len(sys.argv) > 1 else "build"
    for n in [int(float(a)) for a in sys.argv[2:]] or [100, 10000, 1000000]:
        with tempfile.TemporaryDirectory() as folder:
            compare(build, folder, n)


if __name__ == "__main__":
    main()
