#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# What --group costs in truth and saves in size: pictures of random edits from grouped tensors against those
# of a tensor without groups, of the same paths. For each way to group: relMSE of the picture as it is, the
# mean and the largest of twelve edits, products, megabytes and seconds.
#
# usage: edit_group.py RELUME SCENES [SIZE [SPP]]
import json
import os
import random
import subprocess
import sys
import tempfile

GROUPS = [[], ["boxes=small,tall"], ["sides=left,right"], ["boxes=small,tall", "sides=left,right"], ["4"],
          ["2"], ["1"]]
GLOSSY = {"floor", "back"}


def call(*words):
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(words), done.stderr))
    return json.loads(done.stdout) if "--json" in words else None


def edits():
    r = random.Random(5)
    for name in ["floor", "back", "left", "right", "small", "tall"] * 2:
        colour = ",".join("%.3f" % (0.9 * r.random()) for _ in range(3))
        sets = ["%s.reflectance=%s" % (name, colour)]
        if name in GLOSSY:
            sets.append("%s.exponent=%.3g" % (name, 5 * 20 ** r.random()))
        yield sum((["--set", s] for s in sets), [])


def main():
    relume, scenes = sys.argv[1:3]
    size, spp = (sys.argv[3:] + ["48x48", "256"][len(sys.argv) - 3:])[:2]
    scene = os.path.join(scenes, "cornell-glossy", "scene.xml")
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        for i, groups in enumerate(GROUPS):
            made = call(relume, "precompute", "edit", scene, "-o", at("t"), "--bounces", "4", "--series", "64",
                        "--size", size, "--spp", spp, "-q", "--json", *sum((["--group", g] for g in groups), []))
            errors = []
            for k, change in enumerate([[]] + list(edits())):
                truth = at("%d.exr" % k)
                call(relume, "edit", at("t"), "-o", at("p.exr") if i else truth, "-q", "--no-device", *change)
                if i:
                    errors.append(call(relume, "compare", truth, at("p.exr"), "--json")["relmse"]["value"])
            told = ("as it is %.1e, edits mean %.1e, largest %.1e" %
                    (errors[0], sum(errors[1:]) / (len(errors) - 1), max(errors)) if i else "")
            print("%-34s %4d products %7.1f MB %6.1f s  %s" % (
                " ".join(groups) or "none", made["groups"], made["file_bytes"] * 1e-6, made["seconds"], told),
                flush=True)


main()
