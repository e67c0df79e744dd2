#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# How true edited pictures are: for each scene of data/scenes made for it, for the classroom and for one more that
# others made, random edits of a tensor with bounces against path tracing of the edited scene with its curves
# over 1024 bins and as many bounces.
#
# The error is relMSE without noise, so what is left is bias: for a picture p and independent traces u and v with
# mean m, (p - u)(p - v) = (p - m)^2 - (u - m)^2; two tensors tell their own noise, which is taken off likewise.
#
# usage: edit_truth.py RELUME SCENES OUT.json [--scene NAME] [--size N] [--spp N] [--truth N] [--edits N]
#                      [--series J,J2,...] [--kind KIND] [--later NAME] [--tail NAME] [--sharp] [--all-bounces] [--caustic]
#   --sharp        lobes down to roughness 0.02, which the bins cannot carry
#   --all-bounces  against light of all bounces, with --tail (frozen); --kind as-it-was: what the tail alone costs
#   --caustic      of the ring: the light of its second bounce, against path tracing
#   --check        a test: small, with RELUME_TEST_FULL only; fails where the mean of ten edits is beyond the mark
#                  of a series; --each: where any edit is
# Scenes of others lie in RELUME_SHARED_DATA; without it they are left out.
import argparse
import json
import os
import random
import subprocess
import sys
import tempfile

# By scene: file (@: of RELUME_SHARED_DATA, its objects made editable), series, objects by kind.
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
    "classroom": ("@scenes/bitterli/classroom/scene.xml", ["128,1,1"],
                  {"cloth": ["ChairWood", "Whiteboard3"], "even": ["Floor", "Wall", "Lectern"]}),
    "bitterli-box": ("@scenes/bitterli/cornell-box/scene_mitsuba05.xml", ["128,8,1", "128,1,1,1"],
                     {"even": ["LeftWall", "RightWall", "Floor", "BackWall", "ShortBox", "TallBox"]}),
}
MARKS = {"128,8,1": 2e-3, "128,1,1,1": 1e-2}


def colour(r, most=0.9):
    return ",".join("%.3f" % (most * r.random()) for _ in range(3))


def exponent(r, most):
    return 5 * (most / 5) ** r.random()


def make_edit(r, objects, kind, most, bases):
    """Changes of one kind: what `relume edit --script` takes."""
    lobed = objects.get("gloss", []) + objects.get("facets", []) + objects.get("brushed", [])
    if not lobed and (kind not in ("free-hand", "fresnel") or "cloth" not in objects):
        kind = "colour"
    name = r.choice(lobed or objects["even"])
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
        self.options, self.folder, self.traced, self.more = options, folder, {}, []

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
                 "--series", series, "--tail", o.tail if o.all_bounces else "none", "-q", "--size",
                 "%dx%d" % (o.size, o.size), "--spp", str(o.spp), "--seed", str(seed), "--half", "--later", o.later,
                 *self.more)
        return tensor

    def trace(self, session, bounces):
        """Two pictures of the edited scene and their mean, made once."""
        o = self.options
        with open(session) as f:
            key = (f.read(), 0 if o.all_bounces else bounces)
        names = self.traced.get(key)
        if names:
            return names
        scene, own = self.path("truth.xml"), len(self.traced)
        names = self.traced[key] = [self.path("%s%d.exr" % (part, own)) for part in "uvm"]
        self.run("edit", self.path("fine.safetensors"), "--script", session, "-o", self.path("x.exr"),
                 "--save-scene", scene, "-q", "--no-device")
        for seed in (1, 2):
            self.run("render", scene, "-o", names[seed - 1], "-q", "--integrator", "path",
                     "--max-depth", "-1" if o.all_bounces else str(bounces + 1), "--seed", str(seed),
                     "--size", "%dx%d" % (o.size, o.size), "--samples", "0:%d" % o.truth)
        self.run("merge", names[0], names[1], "-o", names[2], "-q")
        return names

    def error(self, tensors, session, truth):
        """Of the edited picture: without noise; and the noise of one tensor."""
        p = [self.path("p1.exr"), self.path("p2.exr")]
        for tensor, picture in zip(tensors, p):
            self.run("edit", tensor, "--script", session, "-o", picture, "-q", "--no-device")
        noise = 0.25 * (self.relmse(p[0], p[1]) + self.relmse(p[1], p[0]))
        distance = 0.5 * (self.relmse(truth[2], p[0]) + self.relmse(truth[2], p[1]))
        return distance - noise - self.relmse(truth[2], truth[0]), noise

    def edits(self, objects, most, bases):
        r = random.Random(11)
        if "as-it-was" in (self.options.kind or []):
            yield "as-it-was", ([], [])
        for kind in KINDS[:self.options.edits]:
            edit = make_edit(r, objects, kind, most, bases)
            if not self.options.kind or kind in self.options.kind:
                yield kind, edit

    def open(self, name):
        """The scene's file; and its edits' parameters, in a tensor of fine bins."""
        file, _, objects = SCENES[name]
        scene = os.path.join(self.options.scenes, name, file)
        self.traced, self.more = {}, []
        if file[0] == "@":
            scene = os.path.join(os.environ["RELUME_SHARED_DATA"], file[1:])
            self.more = [w for n in sum(objects.values(), []) for w in ("--edit", n)]
        self.run("precompute", "edit", scene, "-o", self.path("fine.safetensors"), "--direct", "--size",
                 "8x8", "--spp", "1", "--lights", "64", "--light-samples", "2", "-q", *(self.more or ("-D", "bins=1024")))
        return scene

    def bases(self, objects):
        """Objects with a diffuse base."""
        listing = subprocess.run([self.options.relume, "edit", self.path("fine.safetensors"), "--list"],
                                 capture_output=True, text=True).stdout
        return [n for n in sum(objects.values(), []) if "%s.diffuse" % n in listing]

    def write_session(self, sets, ops):
        session = self.path("session.json")
        with open(session, "w") as f:
            json.dump({"steps": [{"set": sets, "op": ops}]}, f)
        return session

    def scene(self, name):
        o, scene = self.options, self.open(name)
        _, all_series, objects = SCENES[name]
        bases, rows = self.bases(objects), []
        for series in o.series or all_series:
            most = 5000 if o.sharp else (int(series.split(",")[0]) / 5.2) ** 2
            tensors = [self.precompute(scene, series, seed) for seed in (7, 8)]
            for kind, (sets, ops) in self.edits(objects, most, bases):
                session = self.write_session(sets, ops)
                truth = self.trace(session, series.count(",") + 1)
                error, noise = self.error(tensors, session, truth)
                rows.append({"scene": name, "series": series, "kind": kind, "edit": sets + ops,
                             "relmse": error, "noise": noise})
                print("%-15s %-10s %-11s bias %9.2e  noise %8.2e  %s" % (
                    name, series, kind, error, noise, " ".join(sets + ops)), flush=True)
            own = [row for row in rows if row["series"] == series]
            own_mean = mean([row["relmse"] for row in own])
            print("%-15s %-10s mean %.2e, median %.2e, largest %.2e; noise %.2e" % (
                name, series, own_mean, sorted(row["relmse"] for row in own)[len(own) // 2],
                max(row["relmse"] for row in own), mean([row["noise"] for row in own])), flush=True)
        return rows

    def caustic(self):
        """Light of the ring's second bounce inside the ring, of a tensor and of path tracing."""
        o, scene = self.options, self.open("ring")
        middle = "%d,%d,%d,%d" % (3 * o.size // 8, 3 * o.size // 8, 5 * o.size // 8, 5 * o.size // 8)
        rows = []
        for series in o.series or SCENES["ring"][1]:
            tensor = self.precompute(scene, series)
            for sets in ([], ["ring.exponent=60"], ["ring.exponent=150"]):
                picture, true = self.path("p.exr"), self.path("truth.xml")
                self.run("edit", tensor, "--script", self.write_session(sets, []), "-o", picture, "-q")
                self.run("edit", self.path("fine.safetensors"), "--script", self.path("session.json"), "-o",
                         self.path("x.exr"), "--save-scene", true, "-q")
                light = []  # over that of the picture
                for bounces in (1, 2):
                    self.run("render", true, "-o", self.path("r.exr"), "-q", "--integrator", "path", "--max-depth",
                             str(bounces + 1), "--size", "%dx%d" % (o.size, o.size), "--crop", middle,
                             "--spp", str(4 * o.truth))
                    light.append(self.run("compare", picture, self.path("r.exr"), "--json")["mean"]["value"])
                ratio = (1 - light[0]) / (light[1] - light[0])
                rows.append({"scene": "ring", "series": series, "edit": sets, "caustic": ratio})
                print("ring %-8s caustic %+.1f %%  %s" % (series, 100 * (ratio - 1), " ".join(sets)), flush=True)
        return rows


def mean(values):
    return sum(values) / len(values)


def exceeded(rows, each):
    """Whether the mean of a series, or its largest, is beyond its mark."""
    bad = False
    for scene, series in sorted({(r["scene"], r["series"]) for r in rows}):
        bias = (max if each else mean)(
            [r["relmse"] for r in rows if (r["scene"], r["series"]) == (scene, series)])
        if bias > MARKS.get(series, bias):
            print("%s (%s): %.2e is beyond %g" % (scene, series, bias, MARKS[series]))
            bad = True
    return bad


def is_there(name):
    return SCENES[name][0][0] != "@" or os.environ.get("RELUME_SHARED_DATA")


def main():
    a = argparse.ArgumentParser()
    a.add_argument("relume"), a.add_argument("scenes"), a.add_argument("out")
    a.add_argument("--scene", action="append", choices=SCENES)
    for name, value in (("size", 48), ("spp", 512), ("truth", 512), ("edits", 10)):
        a.add_argument("--" + name, type=int, default=value)
    a.add_argument("--later", default="kept", choices=("kept", "lambertian", "terms"))
    a.add_argument("--series", action="append")
    a.add_argument("--kind", action="append", choices=["as-it-was"] + sorted(set(KINDS)))
    a.add_argument("--tail", default="frozen", choices=("none", "frozen", "geometric"))
    for name in ("sharp", "all-bounces", "caustic", "check", "each"):
        a.add_argument("--" + name, action="store_true")
    options = a.parse_args()
    names = [name for name in options.scene or SCENES if is_there(name)]
    if options.check and (os.environ.get("RELUME_TEST_FULL") != "1" or not names):
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options, folder)
        rows = bench.caustic() if options.caustic else [row for name in names for row in bench.scene(name)]
    with open(options.out, "w") as f:
        json.dump(rows, f, indent=1)
    sys.exit(options.check and exceeded(rows, options.each))


if __name__ == "__main__":
    main()
