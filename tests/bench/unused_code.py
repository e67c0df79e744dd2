#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Instructions that scenes execute in code for what they do not hold (callgrind), by features.

    unused_code.py BUILD     a folder that meson made with -Dportable=true -Ddebug=true

The scenes hold diffuse, plastic and conducting surfaces and area lights. A run of 5 samples a pixel
counts with its loading; the instructions of a sample are a quarter of what it has over a run of 1.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).parents[2] / "data" / "scenes"

FEATURES = {  # by where the code stands
    "media, phase functions, volumes": r"lib/(medium|phase|volume)/|volume_path|volpath",
    "dipole": r"dipole",
    "textures": r"lib/texture/",
    "editable materials, curves": r"lib/curve/|editable|curve_sampler",
    "measured materials, tables": r"lib/table/|bsdf/(merl|measured|goniometer|window)",
    "light tree": r"light_tree",
    "image lights, skies, IES profiles": r"envmap|sunsky|preetham|/ies|projector",
    "tensors": r"tensor|source_basis|lib/replay|lib/transport",
}


def instructions(build, scene, spp, folder):
    """Instructions by file, and all of them ("")."""
    out = f"{folder}/callgrind"
    subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}",
                    f"{build}/bin/relume", "render", scene, "-o", f"{folder}/out.exr", "--size",
                    "48x36", "--spp", str(spp), "--threads", "1", "--quiet"],
                   check=True, capture_output=True)
    text = subprocess.run(["callgrind_annotate", "--threshold=100", out], check=True,
                          capture_output=True, text=True).stdout
    counts = {}
    for number, file in re.findall(r"^\s*([\d,]+) \([ \d.]+%\)\s+(\S+?)(?::| TOTALS)", text, re.M):
        name = "" if file == "PROGRAM" else file
        counts[name] = counts.get(name, 0) + int(number.replace(",", ""))
    return counts


def total(counts, pattern):
    return sum(n for file, n in counts.items() if re.search(pattern, file))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for name in ("cornell-box", "veach-mis"):
        scene = str(SCENES / name / "scene.xml")
        with tempfile.TemporaryDirectory() as folder:
            one = instructions(sys.argv[1], scene, 1, folder)
            five = instructions(sys.argv[1], scene, 5, folder)
        print(f"{name}: {five['']} instructions, {(five[''] - one['']) // 4} of them a sample")
        for feature, pattern in FEATURES.items():
            run, sample = total(five, pattern), (total(five, pattern) - total(one, pattern)) / 4
            print(f"  {feature:34} {run:9} {sample:9.0f}")


if __name__ == "__main__":
    main()
