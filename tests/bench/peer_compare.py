#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time relume beside Mitsuba 3 on the same scene files, in turn, and print the ratios.

    peer_compare.py --relume PROGRAM SCENE:WxH:SPP ...

Render time only (no loading, no compilation), medians. Equal samples: both with their independent
sampler. Equal error: time x relMSE against one reference (relume, another seed, 16 times the
samples), which is the time to a given relMSE where error falls as 1/N; relume with its default
sampler, Mitsuba llvm with the better of independent and multijitter.
"""
import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

REPEATS = 3


def read_rgb(path):
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        rgb = channels["RGB"].pixels if "RGB" in channels else np.stack(
            [channels[c].pixels for c in "RGB"], -1)
        return rgb.astype(np.float64)


def relmse(picture, reference):
    return np.mean((picture - reference)**2 / (reference**2 + 1e-3 * reference.mean()**2))


def relume(args, scene, size, spp, sampler, seed, out):
    command = [args.relume, "render", scene, "-o", out, "--size", size, "--spp", str(spp),
               "--sampler", sampler, "--seed", str(seed), "--quiet", "--json"]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(result.stdout)["seconds"]


def mitsuba(scene, variant, size, spp, sampler, reference):
    width, height = size.split("x")
    command = [sys.executable, str(Path(__file__).with_name("peer_mitsuba.py")), scene,
               "--variant", variant, "--width", width, "--height", height, "--spp", str(spp),
               "--sampler", sampler, "--repeats", "1" if variant == "scalar_rgb" else str(REPEATS),
               "--ref", reference]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    data = json.loads(result.stdout)
    return data["seconds"] * spp / data["spp"], data["relmse"] * data["spp"] / spp


def compare(args, scene, size, spp):
    with tempfile.TemporaryDirectory() as folder:
        reference, out = f"{folder}/reference.exr", f"{folder}/out.exr"
        relume(args, scene, size, 16 * spp, "sobol", 4711, reference)
        truth = read_rgb(reference)
        ours, best, error = [], [], []
        peers = {key: ([], []) for key in
                 (("scalar_rgb", "independent"), ("llvm_ad_rgb", "independent"),
                  ("llvm_ad_rgb", "multijitter"))}
        for repeat in range(REPEATS):
            ours.append(relume(args, scene, size, spp, "independent", repeat, out))
            best.append(relume(args, scene, size, spp, "sobol", repeat, out))
            error.append(relmse(read_rgb(out), truth))
            for (variant, sampler), (seconds, errors) in peers.items():
                if variant == "scalar_rgb" and repeat > 0:
                    continue
                t, e = mitsuba(scene, variant, size, spp, sampler, reference)
                seconds.append(t)
                errors.append(e)
    equal = {key: statistics.median(value[0]) / statistics.median(ours)
             for key, value in peers.items()}
    cost = min(statistics.median(peers["llvm_ad_rgb", s][0]) *
               statistics.mean(peers["llvm_ad_rgb", s][1]) for s in ("independent", "multijitter"))
    paths = int(size.split("x")[0]) * int(size.split("x")[1]) * spp / 1e6
    print(f"{Path(scene).parent.name} {size} {spp} spp: relume {paths / statistics.median(ours):.2f} "
          f"Mpaths/s; equal samples: {equal['scalar_rgb', 'independent']:.2f} x scalar_rgb, "
          f"{equal['llvm_ad_rgb', 'independent']:.2f} x llvm; equal relMSE: "
          f"{cost / (statistics.median(best) * statistics.mean(error)):.2f} x llvm "
          f"(relMSE relume {statistics.mean(error):.3g}, llvm "
          f"{min(statistics.mean(peers['llvm_ad_rgb', s][1]) for s in ('independent', 'multijitter')):.3g})",
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--relume", required=True)
    parser.add_argument("scenes", nargs="+", metavar="SCENE:WxH:SPP")
    args = parser.parse_args()
    for item in args.scenes:
        scene, size, spp = item.rsplit(":", 2)
        compare(args, scene, size, int(spp))


if __name__ == "__main__":
    main()
