#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Size against error of a tensor's storage: budgets, the error told (the largest of the trials) and that of
# ten random edits (the largest, against the tensor as it was), beside float32, bfloat16 and RGBE.
#
# usage: edit_storage.py RELUME TENSOR SCENE FOLDER [BUDGET...]
# SCENE: cornell-glossy, vase, room, teatray or ring, that the tensor is of; writes FOLDER/storage-SCENE.svg
import json
import math
import os
import random
import subprocess
import sys
import tempfile

from edit_truth import KINDS, SCENES, make_edit

BUDGETS = ["1e-2", "3e-3", "1e-3", "3e-4", "1e-4", "3e-5", "1e-5", "1e-6", "1e-7"]


def run(words):
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(words), done.stderr))
    return json.loads(done.stdout) if "--json" in words else done.stdout


class Edits:
    """Pictures of ten random edits, the first of which changes nothing."""

    def __init__(self, relume, tensor, scene, folder):
        self.relume, self.folder = relume, folder
        objects, r = SCENES[scene][2], random.Random(11)
        bases = [n for n in sum(objects.values(), []) if n + ".diffuse" in run([relume, "edit", tensor, "--list"])]
        self.edits = [[]]
        for kind in KINDS:
            sets, ops = make_edit(r, objects, kind, (64 / 5.2) ** 2, bases)
            self.edits.append([w for s in sets for w in ("--set", s)] + [w for o in ops for w in ("--op", o)])
        for i in range(len(self.edits)):
            self.picture(tensor, i, "truth%d.exr" % i)

    def picture(self, tensor, i, name):
        run([self.relume, "edit", tensor, "-o", os.path.join(self.folder, name), "-q", "--no-device"] + self.edits[i])

    def errors(self, tensor):
        out = []
        for i in range(len(self.edits)):
            self.picture(tensor, i, "p.exr")
            out.append(run([self.relume, "compare", os.path.join(self.folder, "truth%d.exr" % i),
                            os.path.join(self.folder, "p.exr"), "--json"])["relmse"]["value"])
        return out


def svg(path, rows, marks, noise):
    """Megabytes against relMSE, both logarithmic."""
    xs = [r["told"] for r in rows] + [noise, 1e-7]
    ys = [r["megabytes"] for r in rows] + [m[2] for m in marks]
    x0, x1, y0, y1 = min(xs) / 2, max(xs) * 2, min(ys) / 2, max(ys) * 2
    at = lambda x: 60 + 330 * math.log(max(x, x0) / x0) / math.log(x1 / x0)
    up = lambda y: 260 - 240 * math.log(y / y0) / math.log(y1 / y0)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="460" height="310" font-family="sans-serif" '
           'font-size="11">', '<rect width="460" height="310" fill="white"/>']
    for d in range(math.ceil(math.log10(x0)), math.floor(math.log10(x1)) + 1):
        out.append('<text x="%.1f" y="276" text-anchor="middle">1e%d</text>' % (at(10.0 ** d), d))
    for d in range(math.ceil(math.log10(y0)), math.floor(math.log10(y1)) + 1):
        out.append('<path d="M60 %.1f H390" stroke="#ddd"/><text x="54" y="%.1f" text-anchor="end">%g MB</text>'
                   % (up(10.0 ** d), up(10.0 ** d) + 4, 10.0 ** d))
    out.append('<path d="M%.1f 20 V260" stroke="#c0392b" stroke-dasharray="5 4"/><text x="%.1f" y="18" '
               'fill="#c0392b" text-anchor="middle">noise</text>' % (at(noise), at(noise)))
    for key, colour in (("told", "#1b6ca8"), ("edits", "#2e8b57")):
        points = " ".join("%.1f,%.1f" % (at(r[key]), up(r["megabytes"])) for r in rows)
        out.append('<polyline points="%s" fill="none" stroke="%s" stroke-width="2"/>' % (points, colour))
    for name, error, size in marks:
        out.append('<circle cx="%.1f" cy="%.1f" r="3"/><text x="%.1f" y="%.1f">%s</text>'
                   % (at(error), up(size), at(error) + 6, up(size) + 4, name))
    out.append('<text x="300" y="34" fill="#1b6ca8">error told</text>')
    out.append('<text x="300" y="48" fill="#2e8b57">largest of ten edits</text>')
    out.append('<text x="225" y="298" text-anchor="middle">relMSE added by storage</text></svg>')
    with open(path, "w") as f:
        f.write("\n".join(out) + "\n")


def main():
    relume, tensor, scene, folder = sys.argv[1:5]
    with tempfile.TemporaryDirectory() as work:
        edits = Edits(relume, tensor, scene, work)
        small = os.path.join(work, "small.safetensors")
        rows = []
        for budget in sys.argv[5:] or BUDGETS:
            r = run([relume, "tensor", "requantise", tensor, "-o", small, "--budget", "relmse=" + budget, "--json", "-q"])
            errors = edits.errors(small)
            rows.append({"told": r["storage_relmse"], "edits": max(errors), "megabytes": r["value_bytes"] * 1e-6})
            print("%-6s %8.2f MB (%5.1f with halves), told %.2e, edits: unedited %.2e, mean %.2e, largest %.2e; "
                  "noise %.2e, told %+.1f %%; %s" % (
                      budget, r["value_bytes"] * 1e-6, r["bytes"] * 1e-6, r["storage_relmse"], errors[0],
                      sum(errors) / len(errors), max(errors), r["noise_relmse"], 100 * r["noise_change"],
                      " ".join("%s %d" % w for w in r["rows"].items() if w[1])), flush=True)
        run([relume, "tensor", "requantise", tensor, "-o", small, "--half", "-q"])
        marks = [("RGBE without zeros", r["rgbe_relmse"], r["rgbe_bytes"] * 1e-6),
                 ("bfloat16", max(edits.errors(small)), r["float32_bytes"] * 0.5e-6)]
        for name, error, size in marks:
            print("%-20s %8.2f MB, relMSE %.2e" % (name, size, error))
        svg(os.path.join(folder, "storage-%s.svg" % scene), rows, marks, r["noise_relmse"])


if __name__ == "__main__":
    main()
