#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time Mitsuba 3 on a scene of peer_scenes.py and print the figures as JSON.

One untimed render comes first, so loading, kernel compilation and allocation are left out. Then
every repeat renders with its own seed. A path is one sample of one pixel. Seconds are wall clock;
CPU seconds are user plus system time of all threads. Other work on the machine stretches the first
a lot and the second by up to a third (shared caches, clock), so compare runs that alternate.
"""
import argparse
import json
import os
import resource
import statistics
import time

import mitsuba as mi
import numpy as np


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def relmse(a, b):
    a, b = a.astype(np.float64), b.astype(np.float64)
    return float(np.mean((a - b) ** 2 / (b ** 2 + 1e-3 * np.mean(b) ** 2)))


def read_exr(path):
    return np.array(mi.Bitmap(path).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32))


def render(scene, seed, spp, passes):
    """The mean of some renders, in memory: np.array waits for the kernels to finish."""
    total = np.array(mi.render(scene, spp=spp, seed=seed * passes))
    for i in range(1, passes):
        total += np.array(mi.render(scene, spp=spp, seed=seed * passes + i))
    return total / np.float32(passes)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene")
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("--spp", type=int, default=16, help="samples per pixel of one launch")
    parser.add_argument("--passes", type=int, default=1, help="launches averaged into one picture")
    parser.add_argument("--width", type=int, help="default: as in the scene file")
    parser.add_argument("--height", type=int)
    parser.add_argument("--sampler", default="independent")
    parser.add_argument("--integrator", default="path")
    parser.add_argument("--max-depth", type=int, help="default: as in the scene file")
    parser.add_argument("--rr-depth", type=int)
    parser.add_argument("--robust", choices=("true", "false"), help="watertight intersections")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1, help="of the first timed repeat")
    parser.add_argument("--threads", type=int, help="default: all cores")
    parser.add_argument("--out", help="write the last repeat's picture (EXR)")
    parser.add_argument("--mean-out", help="write the mean of all repeats (EXR)")
    parser.add_argument("--ref", help="reference EXR: adds relMSE of each repeat, and their mean")
    return parser.parse_args()


def main():
    args = arguments()
    mi.set_variant(args.variant)
    mi.set_log_level(mi.LogLevel.Error)
    import drjit as dr
    if args.threads:
        dr.set_thread_count(args.threads)
    names = {"resx": args.width, "resy": args.height, "max_depth": args.max_depth,
             "rr_depth": args.rr_depth, "sampler": args.sampler, "integrator": args.integrator,
             "robust": args.robust}
    names = {key: str(value) for key, value in names.items() if value is not None}
    scene = mi.load_file(args.scene, **names)
    width, height = scene.sensors()[0].film().size()

    start = time.perf_counter()
    render(scene, 0, args.spp, 1)
    warm_up = time.perf_counter() - start
    reference = read_exr(args.ref) if args.ref else None
    wall, cpu, errors, total = [], [], [], 0
    for i in range(args.repeats):
        start, start_cpu = time.perf_counter(), cpu_seconds()
        picture = render(scene, args.seed + i, args.spp, args.passes)
        wall.append(time.perf_counter() - start)
        cpu.append(cpu_seconds() - start_cpu)
        total = total + picture.astype(np.float64)
        if reference is not None:
            errors.append(relmse(picture, reference))

    # stratified samplers round the sample count up
    spp = scene.sensors()[0].sampler().sample_count()
    paths = int(width) * int(height) * spp * args.passes
    result = {
        "scene": args.scene, "variant": args.variant, "mitsuba": mi.__version__,
        "drjit": dr.__version__, "threads": dr.thread_count(), "cores": os.cpu_count(),
        "width": int(width), "height": int(height), "spp": spp, "passes": args.passes,
        "sampler": args.sampler, "integrator": args.integrator, "repeats": args.repeats,
        "warm_up_seconds": warm_up,
        "seconds": statistics.median(wall), "seconds_all": wall,
        "cpu_seconds": statistics.median(cpu), "cpu_seconds_all": cpu,
        "mpaths_per_second": paths / statistics.median(wall) / 1e6,
        "mpaths_per_second_best": paths / min(wall) / 1e6,
        "mpaths_per_cpu_second": paths / statistics.median(cpu) / 1e6,
        "mpaths_per_cpu_second_best": paths / min(cpu) / 1e6,
        "mean": [float(x) for x in np.mean(total / args.repeats, axis=(0, 1))],
        "peak_memory_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }
    if errors:
        result["relmse"] = statistics.mean(errors)
        result["relmse_all"] = errors
        result["relmse_of_mean"] = relmse(total / args.repeats, reference)
    if args.out:
        mi.Bitmap(picture).write(args.out)
    if args.mean_out:
        mi.Bitmap((total / args.repeats).astype(np.float32)).write(args.mean_out)
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
