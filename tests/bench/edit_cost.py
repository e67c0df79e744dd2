#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a tensor costs: precomputing against path tracing of the same samples and bounces, in
interleaved pairs, for the Cornell box with six editable objects, two of them glossy. Then a session that edits
one of them: freezing, frames, how many edits make up for the precomputation, and how many frames a second
450x450 pixels (the published size) take, by the bytes of a frame and what the machine reads.

usage: edit_cost.py BUILD [PAIRS [SIZE [SPP [LATER]]]]
"""
import json
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile

GLOSSY = ('<bsdf type="twosided" id="%s"><bsdf type="editable">'
          '<string name="model" value="blinnphong"/>'
          '<string name="basis" value="box"/><rgb name="specular_reflectance" value="0.3"/>'
          '<rgb name="diffuse_reflectance" value="0.4"/></bsdf></bsdf>')


def run(*command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    out = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    out["processor"] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    return out


def fresh(folder, name):
    """A path where nothing stands: freeing the disk of an earlier half gigabyte is no part of either's work."""
    path = pathlib.Path(folder, name)
    path.unlink(missing_ok=True)
    return str(path)


def session(relume, tensor, folder):
    """Seconds of freezing and of a frame of a session, bytes of a frame, bytes a second the machine reads."""
    script = folder + "/session.json"
    steps = [{"set": f"BackWall.exponent={20 + 10 * i}"} for i in range(9)]
    pathlib.Path(script).write_text(json.dumps({"focus": True, "steps": steps}))
    out = subprocess.run([relume, "edit", tensor, "--script", script, "-o", folder + "/c.exr", "--time", "--json",
                          "--quiet"], check=True, capture_output=True, text=True).stdout
    *frames, total = (json.loads(line) for line in out.splitlines())
    frame = statistics.median(f["frame_seconds"] for f in frames[1:])
    return frames[0]["switch_seconds"], frame, frames[-1]["bytes"], total["machine_gigabytes_per_second"] * 1e9


def main():
    root = pathlib.Path(__file__).resolve().parents[2]
    build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else root / "build")
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    size = sys.argv[3] if len(sys.argv) > 3 else "64x64"
    spp = sys.argv[4] if len(sys.argv) > 4 else "1024"
    later = sys.argv[5] if len(sys.argv) > 5 else "kept"
    relume = str(build / "bin/relume")
    text = (root / "data/scenes/cornell-box/scene.xml").read_text()
    for name in ("Floor", "BackWall"):
        text = re.sub(r'<bsdf type="twosided" id="%s">.*?</bsdf>\s*</bsdf>' % name,
                      GLOSSY % name, text, flags=re.S)
    edit = [f"--edit={n}" for n in ("LeftWall", "RightWall", "ShortBox", "TallBox")]
    with tempfile.TemporaryDirectory() as folder:
        scene = folder + "/scene.xml"
        pathlib.Path(scene).write_text(text)
        same = ["--size", size, "--spp", spp, "--sampler", "sobol", "--quiet", "--json"]
        ratios, processor, plain, tensor = [], [], [], []
        for _ in range(pairs):
            a = run(relume, "render", scene, "-o", fresh(folder, "a.exr"), "--max-depth", "5", *same)
            b = run(relume, "precompute", "edit", scene, "-o", fresh(folder, "b.safetensors"), *edit,
                    "--bounces", "4", "--series", "64,1,1,1", "--tail", "none",
                    "--later", later, *same)
            plain.append(a["paths"] / a["seconds"])
            tensor.append(b["paths"] / b["seconds"])
            seconds = a["seconds"], b["seconds"]
            ratios.append(b["seconds"] / a["seconds"])
            processor.append(b["processor"] / a["processor"])
        print(f"{size}, {spp} samples, later hops {later}, {b['objects']} objects, {b['groups']} products, "
              f"{b['file_bytes'] / 1e6:.0f} MB; medians of {pairs} pairs (lowest, highest)")
        for name, values in (("picture, paths/s", plain), ("tensor, paths/s", tensor),
                             ("time of the tensor / of the picture", ratios),
                             ("processor time, whole runs", processor)):
            print(f"{name}: {statistics.median(values):.4g} ({min(values):.4g}, {max(values):.4g})")
        freeze, frame, read, limit = session(relume, folder + "/b.safetensors", folder)
        width, height = map(int, size.split("x"))
        full = read * 450 * 450 / (width * height)
        print(f"freezing {freeze * 1e3:.0f} ms, a frame {frame * 1e3:.2f} ms, {read / 1e6:.1f} MB; at 450x450 {full / 1e6:.0f} MB, "
              f"{limit / full:.0f} frames/s at the {limit / 1e9:.1f} GB/s the machine reads")
        print(f"break-even: {seconds[1] / (seconds[0] - frame):.2f} edits (tensor / (picture - frame), last pair)")


if __name__ == "__main__":
    main()
