#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time relume beside Mitsuba 3 on the same scene files, in turn, and print the ratios.

    peer_compare.py --relume PROGRAM [--robust true|false|each] [--repeats N] [--references DIR]
                    SCENE:WxH:SPP ...

Render time only (no loading, no compilation), medians; each ratio twice, of wall clock and of
processor seconds (user and system, all threads; ours without loading), since other work on the
machine stretches the first far more. Equal samples: both with their independent sampler, and
Russian roulette from the edge on that the file names, and one light sample a vertex; relume once more
with its own roulette, which takes fewer rays. Equal error: time x relMSE, which is the time to a given relMSE where error
falls as 1/N; relume with its own roulette, the better of sobol and lattice, and of one or two paths from
each first hit, Mitsuba llvm of independent and multijitter (an earlier roulette does not help it). The error is the mean of
(picture - A) (picture - B) over two independent references, so that their own noise drops out of it;
both are Mitsuba's, each with 64 times the samples, since relMSE divides by their mean, whose noise stays.
--references keeps them, which take as long as the rest, and reads those that are there.
Where few pixels decide, relMSE differs many times from seed to seed: the ratio is also told of all but the
worst 1 % of each picture's pixels, and both with their standard errors. --robust: whether rays may not slip
through between triangles, for both programs; or as each does by itself: relume's may not, Mitsuba's may.
"""
import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR

REFERENCE_PASSES = 64


def read_rgb(path):
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        rgb = channels["RGB"].pixels if "RGB" in channels else np.stack(
            [channels[c].pixels for c in "RGB"], -1)
        return rgb.astype(np.float64)


def relative_errors(picture, references):
    """Squared and relative, of each pixel."""
    a, b = references
    mean = (a + b) / 2
    return np.mean((picture - a) * (picture - b) / (mean**2 + 1e-3 * mean.mean()**2), -1)


def relmse(picture, references):
    return relative_errors(picture, references).mean()


def both_errors(path, references):
    """relMSE, and the mean over all but the worst 1 % of the pixels, which single bright paths do not decide."""
    errors = np.sort(relative_errors(read_rgb(path), references), axis=None)
    return np.array([errors.mean(), errors[:errors.size * 99 // 100].mean()])


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def with_parameters(scene, values):
    """A copy beside the scene whose integrator has these integers too."""
    copy = Path(scene).with_name("peer_compare-" + "-".join(values) + ".xml")
    opening = '<integrator type="$integrator">'
    asked = "".join('<integer name="{}" value="{}"/>'.format(*v.split("=")) for v in values)
    text = Path(scene).read_text()
    if opening not in text:
        sys.exit(f"{scene}: not of peer_scenes.py")
    copy.write_text(text.replace(opening, opening + asked, 1))
    return str(copy)


def relume(args, scene, size, spp, setting, seed, out):
    sampler, *names = setting
    own = [name for name in names if name in OWN_PARAMETERS]
    if own:
        scene = with_parameters(scene, own)
    command = [args.relume, "render", scene, "-o", out, "--size", size, "--spp", str(spp),
               "--sampler", sampler, "--seed", str(seed), "--quiet", "--json",
               "-D", "robust=" + ("false" if args.robust == "false" else "true")]
    for name in set(names) - set(own):
        command += ["-D", name]
    start = cpu_seconds()
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    return np.array([json.loads(result.stdout)["seconds"], cpu_seconds() - start])


def mitsuba(args, scene, variant, size, spp, sampler, seed, out, passes=1):
    width, height = size.split("x")
    command = [sys.executable, str(Path(__file__).with_name("peer_mitsuba.py")), scene,
               "--variant", variant, "--width", width, "--height", height, "--spp", str(spp),
               "--sampler", sampler, "--repeats", "1", "--seed", str(seed), "--passes", str(passes),
               "--out", out, "--robust", "true" if args.robust == "true" else "false"]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    data = json.loads(result.stdout)
    # multijitter rounds the sample count up
    return np.array([data["seconds"], data["cpu_seconds"]]) * spp / data["spp"], data["spp"] / spp


PEERS = (("scalar_rgb", "independent"), ("llvm_ad_rgb", "independent"),
         ("llvm_ad_rgb", "multijitter"))
OWN_ROULETTE = "rr_depth=3"
TWO_PATHS, ONE_LIGHT = OWN_PARAMETERS = ("shading_samples=2", "light_candidates=1")
EQUAL = ("independent", ONE_LIGHT)
EARLIER = ("independent", ONE_LIGHT, OWN_ROULETTE)
BEST = tuple((sampler, OWN_ROULETTE, *more) for sampler in ("sobol", "lattice")
             for more in ((), (TWO_PATHS,)))


def reference(args, scene, size, spp, seed, folder):
    path = Path(scene)
    robust = "-robust" if args.robust == "true" else ""
    name = f"{path.parent.name}-{path.stem}-{size}-{spp}-{seed}{robust}.exr"
    kept = Path(args.references or folder) / name
    if not kept.exists():
        kept.parent.mkdir(parents=True, exist_ok=True)
        made = kept.with_suffix(".part.exr")
        mitsuba(args, scene, "llvm_ad_rgb", size, spp, "independent", seed, str(made), REFERENCE_PASSES)
        made.rename(kept)
    return read_rgb(kept)


def measure(args, scene, size, spp, folder):
    """Seconds (wall, processor) and relMSE of every renderer, all repeats in turn."""
    out = f"{folder}/out.exr"
    references = [reference(args, scene, size, spp, seed, folder) for seed in (1001, 1002)]
    loading = min(relume(args, scene, "16x16", 1, EQUAL, 0, out)[1] for _ in range(3))
    seconds, errors = {}, {}
    for repeat in range(args.repeats):
        for setting in (EQUAL, EARLIER, *BEST):
            spent = relume(args, scene, size, spp, setting, repeat, out)
            seconds.setdefault(setting, []).append(spent - [0, loading])
            errors.setdefault(setting, []).append(both_errors(out, references))
        for peer in PEERS:
            spent, more = mitsuba(args, scene, peer[0], size, spp, peer[1], repeat, out)
            seconds.setdefault(peer, []).append(spent)
            errors.setdefault(peer, []).append(both_errors(out, references) * more)
    return ({key: np.median(value, axis=0) for key, value in seconds.items()},
            {key: np.array(value) for key, value in errors.items()})


def to_equal_error(seconds, errors):
    """Mitsuba's seconds over ours, each with its best sampler, and the relative standard error of it."""
    best = [min(keys, key=lambda s: seconds[s][0] * errors[s].mean()) for keys in (BEST, PEERS[1:])]
    cost, theirs = (seconds[s] * errors[s].mean() for s in best)
    noise = np.hypot(*(errors[s].std(ddof=1) / len(errors[s])**0.5 / errors[s].mean() for s in best))
    return theirs / cost, noise


def compare(args, scene, size, spp):
    with tempfile.TemporaryDirectory() as folder:
        seconds, errors = measure(args, scene, size, spp, folder)
    of_all, of_most = (to_equal_error(seconds, {key: e[:, k] for key, e in errors.items()}) for k in (0, 1))
    width, height = map(int, size.split("x"))
    ratios = (("scalar_rgb", seconds[PEERS[0]] / seconds[EQUAL]),
              ("llvm", seconds[PEERS[1]] / seconds[EQUAL]),
              ("scalar_rgb, our roulette", seconds[PEERS[0]] / seconds[EARLIER]),
              ("llvm, our roulette", seconds[PEERS[1]] / seconds[EARLIER]),
              (f"llvm to equal relMSE (+- {100 * of_all[1]:.0f} %)", of_all[0]),
              (f"the same of all but the worst 1 % of pixels (+- {100 * of_most[1]:.0f} %)", of_most[0]))
    print(f"{Path(scene).parent.name} {size} {spp} spp: relume "
          f"{width * height * spp / 1e6 / seconds[EQUAL][0]:.2f} Mpaths/s; times ours, wall "
          "(processor): " + ", ".join(f"{name} {r[0]:.2f} ({r[1]:.2f})" for name, r in ratios) +
          "; relMSE (of most) " + ", ".join(f"{' '.join(key)} {e[:, 0].mean():.3g} ({e[:, 1].mean():.3g})"
                                            for key, e in errors.items()),
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--relume", required=True)
    parser.add_argument("--robust", choices=("true", "false", "each"), default="each")
    parser.add_argument("--repeats", type=int, default=6, help="turns of all, 2 or more")
    parser.add_argument("--references", metavar="DIR", help="where references are kept")
    parser.add_argument("scenes", nargs="+", metavar="SCENE:WxH:SPP")
    args = parser.parse_args()
    for item in args.scenes:
        scene, size, spp = item.rsplit(":", 2)
        compare(args, scene, size, int(spp))


if __name__ == "__main__":
    main()
