#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares FLIP of `relume compare` with the authors' flip-evaluator, to 1e-4 in the mean.

usage: flip_peer.py RELUME [--golden]

Exit 77 (skipped) where the Python modules flip_evaluator and numpy are missing. Pairs: generated
ones, and pictures under $RELUME_SHARED_DATA where that is set. --golden prints the numbers that
tests/unit/flip.c holds. Means are taken of flip-evaluator's maps in double precision: the mean it
returns itself is summed in float and off by 3e-5 on a megapixel.
"""
import json
import os
import subprocess
import sys
import tempfile

try:
    import flip_evaluator
    import numpy
except ImportError:
    print("skipped: no Python module flip_evaluator or numpy")
    sys.exit(77)

LIMIT = 1e-4
WIDTH, HEIGHT = 64, 48


def generated_pairs():
    """The two small pairs that tests/unit/flip.c makes too: (name, range, reference, test)."""
    y, x, c = numpy.mgrid[0:HEIGHT, 0:WIDTH, 0:3]
    v = ((x * 7 + y * 13 + c * 29) % 64) / 63
    yield "small", "LDR", v, numpy.where((x * y + c) % 5 == 0, 1 - v, v)
    hdr = v * v * 2.0 ** (x // 8 - 2)
    yield "small", "HDR", hdr, hdr * (1 + ((x + 3 * y) % 7 - 3) / 10)


def noisy_pairs(folder):
    """A real picture against itself with multiplicative noise."""
    random = numpy.random.default_rng(1)
    for name in ("veach-mis", "cornell-box"):
        path = os.path.join(folder, "scenes/bitterli", name, "TungstenRender.exr")
        picture = flip_evaluator.load(path)[100:500, 300:800, :3].astype(numpy.float64)
        test = picture * random.gamma(4, 0.25, picture.shape)
        yield name, "HDR", picture, test
        yield name, "LDR", numpy.clip(picture, 0, 1), numpy.clip(test, 0, 1)


def rendered_pairs(folder):
    tests = os.path.join(folder, "scenes/mitsuba-tests")
    for name in ("bsdf_spheres/refs/test_arealight", "instancing/refs/test_instancing"):
        a, b = (flip_evaluator.load(os.path.join(tests, f"{name}_ref_{kind}.exr"))[..., :3]
                for kind in ("rgb", "spectral"))
        a, b = numpy.maximum(a, 0), numpy.maximum(b, 0)
        yield name, "HDR", a, b
        yield name, "LDR", numpy.clip(a, 0, 1), numpy.clip(b, 0, 1)


def write_pfm(path, picture):
    with open(path, "wb") as out:
        out.write(b"PF\n%d %d\n-1.0\n" % (picture.shape[1], picture.shape[0]))
        out.write(numpy.ascontiguousarray(picture[::-1], dtype="<f4").tobytes())


def ours(relume, folder, reference, test):
    paths = [os.path.join(folder, name) for name in ("reference.pfm", "test.pfm")]
    for path, picture in zip(paths, (reference, test)):
        write_pfm(path, picture)
    out = subprocess.run([relume, "compare", *paths, "--json"], check=True, capture_output=True)
    return json.loads(out.stdout)


def theirs(dynamic_range, reference, test):
    pictures = [numpy.ascontiguousarray(p, dtype=numpy.float32) for p in (reference, test)]
    flip_map, _, _ = flip_evaluator.evaluate(*pictures, dynamic_range, inputsRGB=False,
                                             applyMagma=False)
    return float(numpy.mean(flip_map, dtype=numpy.float64))


def main():
    relume = sys.argv[1]
    pairs = list(generated_pairs())
    shared = os.environ.get("RELUME_SHARED_DATA")
    if shared and "--golden" not in sys.argv:
        pairs += [*noisy_pairs(shared), *rendered_pairs(shared)]
    worst = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, dynamic_range, reference, test in pairs:
            expected = theirs(dynamic_range, reference, test)
            key = "flip" if dynamic_range == "HDR" else "ldr-flip"
            actual = ours(relume, folder, reference, test)[key]["value"]
            worst = max(worst, abs(actual - expected))
            print(f"{name} {dynamic_range}: relume {actual:.7f}, flip-evaluator {expected:.7f}")
    print(f"largest difference {worst:.2g}, limit {LIMIT}")
    return 0 if worst <= LIMIT else 1


if __name__ == "__main__":
    sys.exit(main())
