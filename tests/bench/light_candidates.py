#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What choosing among several light samples costs and gains where surfaces are glossy.

    light_candidates.py --relume PROGRAM [--counts 1,2,3,4,8] [--repeats N] SCENE:WxH:SPP ...

Renders with `light_candidates` of each count in turn, with another seed each time, and prints relMSE,
processor seconds without loading, and their product, which is the time to a given relMSE, as parts of
those of the first count. The error is the mean of (picture - A) (picture - B) over two references
of 64 times the samples, so that their own noise drops out. The scene's integrator must be a path
tracer; a copy of the scene is written beside it, and removed.
"""
import argparse
import re
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from peer_compare import read_rgb, relmse

REFERENCE = 64 # times the samples


def with_count(scene, count):
    copy = scene.with_name(f"candidates-{count}-of-{scene.name}")
    asked = f'<integer name="light_candidates" value="{count}"/>'
    text, found = re.subn(r'(<integrator\b[^>]*[^/>])(/>|>)',
                          lambda m: m[1] + ">" + asked + "</integrator>" * (m[2] == "/>"),
                          scene.read_text(), count=1)
    if not found:
        sys.exit(f"{scene}: no integrator")
    copy.write_text(text)
    return copy


def render(relume, scene, size, spp, seed, out):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([relume, "render", scene, "-o", out, "--size", size, "--spp", str(spp), "--seed",
                    str(seed), "--sampler", "sobol", "--quiet"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measure(args, copies, size, spp, out):
    references = []
    for seed in (1001, 1002):
        render(args.relume, copies[0], size, REFERENCE * spp, seed, out)
        references.append(read_rgb(out))
    loading = min(render(args.relume, copies[0], "16x16", 1, 0, out) for _ in range(3))
    seconds, errors = ([[] for _ in copies] for _ in range(2))
    for repeat in range(args.repeats):
        for i, copy in enumerate(copies):
            seconds[i].append(render(args.relume, copy, size, spp, repeat, out) - loading)
            errors[i].append(relmse(read_rgb(out), references))
    return seconds, errors


def compare(args, scene, size, spp):
    copies = [with_count(Path(scene), count) for count in args.counts]
    try:
        with tempfile.TemporaryDirectory() as folder:
            seconds, errors = measure(args, copies, size, spp, f"{folder}/out.exr")
    finally:
        for copy in copies:
            copy.unlink()
    print(f"{scene} {size} {spp} spp")
    for i, count in enumerate(args.counts):
        slower = statistics.median(a / b for a, b in zip(seconds[i], seconds[0]))
        error, spread = np.mean(errors[i]), np.std(errors[i]) / len(errors[i]) ** 0.5
        less = error / np.mean(errors[0])
        print(f"  {count} candidates: relMSE {error:.4g} +- {spread:.2g}, {less:.3f} of it; "
              f"time {slower:.3f}; to equal relMSE {slower * less:.3f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--relume", required=True)
    parser.add_argument("--counts", type=lambda s: [int(n) for n in s.split(",")],
                        default=[1, 2, 3, 4, 8])
    parser.add_argument("--repeats", type=int, default=8)
    parser.add_argument("scenes", nargs="+", metavar="SCENE:WxH:SPP")
    args = parser.parse_args()
    for scene in args.scenes:
        name, size, spp = scene.rsplit(":", 2)
        compare(args, name, size, int(spp))


if __name__ == "__main__":
    main()
