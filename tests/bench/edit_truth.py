#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# How true edited pictures are: for each scene of data/scenes made for it, random edits of a tensor with
# bounces against path tracing of the edited scene with its curves over 1024 bins and as many bounces.
#
# The error is relMSE without noise: for a picture p and independent traces u and v with mean m,
# (p - u)(p - v) = (p - m)^2 - (u - m)^2; two tensors tell their own noise, which is taken off likewise.
#
# usage: edit_truth.py RELUME SCENES OUT.json [--scene NAME] [--size N] [--spp N] [--truth N] [--edits N]
#                      [--series J,J2,...] [--kind KIND] [--later NAME] [--sharp] [--all-bounces]
#   --sharp        lobes down to roughness 0.02, which the bins cannot carry
#   --all-bounces  against light of all bounces, the tail frozen
import argparse
import json
import os
import random
import subprocess
import sys
import tempfile

# By scene: file, series, objects by kind.
SCENES = {
    "cornell-glossy": ("scene.xml", ["128,8,1", "128,1,1,1", "64,1,1,1"],
                       {"gloss": ["floor", "back"], "even": ["left", "right", "small", "tall"]}),
    "vase": ("scene.xml", ["128,8,1", "128,1,1,1"],
             {"brushed": ["vase"], "gloss": ["table", "stems"], "even": ["flowers"]}),
    "room": ("scene.xml", ["128,8,1", "128,1,1,1"],
             {"cloth": ["couch"], "gloss": ["floor", "stairs", "sills"], "even": ["walls", "ceiling"]}),
    "teatray": ("bounces.xml", ["128,8,1", "128,1,1,1", "16,8,1,1"],
                {"facets": ["teapot"], "gloss": ["tray", "handles"]}),
    "ring": ("scene.xml", ["64,16", "64,8", "64,1"], {"gloss": ["ring", "plane"]}),
}


def colour(r, most=0.9):
    return ",".join("%.3f" % (most * r.random()) for _ in range(3))


def exponent(r, most):
    return 5 * (most / 5) ** r.random()


def make_edit(r, objects, kind, most, bases):
    """Changes of one kind: what `relume edit --script` takes."""
    lobed = objects.get("gloss", []) + objects.get("facets", []) + objects.get("brushed", [])
    name = r.choice(lobed)
    facets, brushed = name in objects.get("facets", []), name in objects.get("brushed", [])
    if kind == "colour":
        name = r.choice(sum(objects.values(), []))
        even = name in objects.get("even", [])
        base = [] if even else ["%s.diffuse=%s" % (name, colour(r))] if name in bases else []
        return (["%s.reflectance=%s" % (name, colour(r))] if even or not base else base), []
    if kind == "free-hand":
        name = r.choice(lobed + objects.get("cloth", []))
        return [], ["%s.specular.f_A:amplify-y,%.3g,%.3g,%.3g,%.3g,%.3g" % (
            (name,) + tuple(sorted(r.uniform(5, 60) for _ in range(4))) + (r.uniform(0.3, 4),))]
    if kind == "fresnel" and objects.get("brushed"):
        return ["%s.r0=%s" % (objects["brushed"][0], colour(r, 0.8))], []
    if kind == "fresnel" and objects.get("cloth"):
        return [], ["%s.specular.f_B:amplify-y,20,40,90,90,%.3g" % (objects["cloth"][0], r.uniform(2, 8))]
    if kind == "anisotropy" and objects.get("brushed"):
        return ["%s.exponent_v=%.4g" % (objects["brushed"][0], exponent(r, most))], []
    if kind == "sharp":
        sharp = ["%s.reflectance=%s" % (name, colour(r))]
        sharp += ["%s.diffuse=0.02" % name] if name in bases else []
        return sharp + lobe(name, most, facets, brushed), []
    return lobe(name, exponent(r, most), facets, brushed), []


def lobe(name, n, facets, brushed):
    if facets:
        return ["%s.alpha=%.4g" % (name, (2 / (n + 2)) ** 0.5)]
    return ["%s.%s=%.4g" % (name, "exponent_v" if brushed else "exponent", n)]


KINDS = ["roughness", "colour", "fresnel", "anisotropy", "free-hand", "sharp", "roughness", "colour",
         "free-hand", "sharp"]


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder

    def path(self, name):
        return os.path.join(self.folder, name)

    def run(self, *words):
        done = subprocess.run([self.options.relume, *words], capture_output=True, text=True)
        if done.returncode:
            sys.exit("%s\n%s" % (" ".join(words), done.stderr))
        return json.loads(done.stdout) if "--json" in words else None

    def relmse(self, truth, picture):
        return self.run("compare", truth, picture, "--json")["relmse"]["value"]

    def precompute(self, scene, series, seed=7):
        o = self.options
        tensor = self.path("t%d.safetensors" % seed)
        self.run("precompute", "edit", scene, "-o", tensor, "--bounces", str(series.count(",") + 1),
                 "--series", series, "--tail", "frozen" if o.all_bounces else "none", "-q", "--size",
                 "%dx%d" % (o.size, o.size), "--spp", str(o.spp), "--seed", str(seed), "--half", "--later", o.later)
        return tensor

    def trace(self, session, bounces):
        o = self.options
        scene = self.path("truth.xml")
        self.run("edit", self.path("fine.safetensors"), "--script", session, "-o", self.path("x.exr"),
                 "--save-scene", scene, "-q", "--no-device")
        for seed in (1, 2):
            self.run("render", scene, "-o", self.path("u%d.exr" % seed), "-q", "--integrator", "path",
                     "--max-depth", "-1" if o.all_bounces else str(bounces + 1), "--seed", str(seed),
                     "--size", "%dx%d" % (o.size, o.size), "--samples", "0:%d" % o.truth)
        self.run("merge", self.path("u1.exr"), self.path("u2.exr"), "-o", self.path("m.exr"), "-q")

    def error(self, tensors, session):
        """Of the edited picture: without noise; and the noise of one tensor."""
        m, p = self.path("m.exr"), [self.path("p1.exr"), self.path("p2.exr")]
        for tensor, picture in zip(tensors, p):
            self.run("edit", tensor, "--script", session, "-o", picture, "-q", "--no-device")
        noise = 0.25 * (self.relmse(p[0], p[1]) + self.relmse(p[1], p[0]))
        distance = 0.5 * (self.relmse(m, p[0]) + self.relmse(m, p[1]))
        return distance - noise - self.relmse(m, self.path("u1.exr")), noise

    def edits(self, objects, most, bases):
        r = random.Random(11)
        for kind in KINDS[:self.options.edits]:
            edit = make_edit(r, objects, kind, most, bases)
            if not self.options.kind or kind in self.options.kind:
                yield kind, edit

    def scene(self, name):
        o = self.options
        file, all_series, objects = SCENES[name]
        scene = os.path.join(o.scenes, name, file)
        self.run("precompute", "edit", scene, "-o", self.path("fine.safetensors"), "--direct", "--size",
                 "8x8", "--spp", "1", "--lights", "64", "--light-samples", "2", "-D", "bins=1024", "-q")
        rows = []
        for series in o.series or all_series:
            bins = int(series.split(",")[0])
            most = 5000 if o.sharp else (bins / 5.2) ** 2
            tensors = [self.precompute(scene, series, seed) for seed in (7, 8)]
            listing = subprocess.run([o.relume, "edit", tensors[0], "--list"], capture_output=True,
                                     text=True).stdout
            bases = [n for n in sum(objects.values(), []) if "%s.diffuse" % n in listing]
            for kind, (sets, ops) in self.edits(objects, most, bases):
                session = self.path("session.json")
                with open(session, "w") as f:
                    json.dump({"steps": [{"set": sets, "op": ops}]}, f)
                self.trace(session, series.count(",") + 1)
                error, noise = self.error(tensors, session)
                rows.append({"scene": name, "series": series, "kind": kind, "edit": sets + ops,
                             "relmse": error, "noise": noise})
                print("%-15s %-10s %-11s %9.2e  noise %8.2e  %s" % (
                    name, series, kind, error, noise, " ".join(sets + ops)), flush=True)
            own = [row["relmse"] for row in rows if row["series"] == series]
            print("%-15s %-10s mean %.2e, largest %.2e" % (name, series, sum(own) / len(own), max(own)),
                  flush=True)
        return rows


def main():
    a = argparse.ArgumentParser()
    a.add_argument("relume"), a.add_argument("scenes"), a.add_argument("out")
    a.add_argument("--scene", action="append", choices=SCENES)
    for name, value in (("size", 48), ("spp", 512), ("truth", 512), ("edits", 10)):
        a.add_argument("--" + name, type=int, default=value)
    a.add_argument("--later", default="kept", choices=("kept", "lambertian"))
    a.add_argument("--series", action="append")
    a.add_argument("--kind", action="append", choices=sorted(set(KINDS)))
    a.add_argument("--sharp", action="store_true")
    a.add_argument("--all-bounces", action="store_true")
    options = a.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options, folder)
        rows = [row for name in options.scene or SCENES for row in bench.scene(name)]
    with open(options.out, "w") as f:
        json.dump(rows, f, indent=1)


if __name__ == "__main__":
    main()
