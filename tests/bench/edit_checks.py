#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# The ways to an edited picture at the size of a scene, against each other: sessions that freeze what is not
# edited, in several orders, against whole products (A16 of the specification); OpenCL against C, and 16 bits
# a coefficient against 32 (A22). Errors are square roots of relMSE, and steps of 8-bit sRGB.
#
# usage: edit_checks.py RELUME SCENES [SIZE [SPP]]
import json
import os
import random
import struct
import subprocess
import sys
import tempfile
import zlib

NAMES = ["floor", "back", "left", "right", "small", "tall"]
GLOSSY = {"floor", "back"}
EDITS = 24


def call(*words):
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(words), done.stderr))
    return done.stdout


def png(path):
    """Bytes of an 8-bit picture without filters undone but None to Paeth."""
    data, at, idat = open(path, "rb").read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT":
            idat += data[at + 8:at + 8 + size]
        at += size + 12
    bytes_a_pixel = {0: 1, 2: 3, 4: 2, 6: 4}[colour] * bits // 8
    raw, row, out = zlib.decompress(idat), width * bytes_a_pixel, []
    before = bytearray(row)
    for y in range(height):
        kind, line = raw[y * (row + 1)], bytearray(raw[y * (row + 1) + 1:(y + 1) * (row + 1)])
        for i in range(row):
            a = line[i - bytes_a_pixel] if i >= bytes_a_pixel else 0
            b, c = before[i], before[i - bytes_a_pixel] if i >= bytes_a_pixel else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            line[i] = line[i] + (0, a, b, (a + b) // 2, paeth)[kind] & 255
        out += line
        before = line
    return out


class Bench:
    def __init__(self, relume, folder):
        self.relume, self.folder = relume, folder

    def at(self, name):
        return os.path.join(self.folder, name)

    def picture(self, tensor, name, sets, *more):
        call(self.relume, "edit", self.at(tensor), "-o", self.at(name), "-q", *more,
             *sum((["--set", s] for s in sets), []))

    def session(self, tensor, name, steps, *more):
        with open(self.at("s.json"), "w") as f:
            json.dump({"steps": [{"set": s} for s in steps]}, f)
        call(self.relume, "edit", self.at(tensor), "-o", self.at(name), "-q", "--script", self.at("s.json"),
             *more)

    def error(self, a, b):
        return json.loads(call(self.relume, "compare", self.at(a), self.at(b), "--json"))["relmse"]["value"] ** 0.5

    def steps(self, a, b):
        for name in (a, b):
            call(self.relume, "tonemap", self.at(name), "-o", self.at(name + ".png"))
        return max(abs(x - y) for x, y in zip(png(self.at(a + ".png")), png(self.at(b + ".png"))))


def make_edits():
    """Each object several times; albedos of 0 and 1 among them."""
    r = random.Random(3)
    for i in range(EDITS):
        name = NAMES[i % len(NAMES)] if i < len(NAMES) else r.choice(NAMES)
        colour = "0" if i % 5 == 4 else "1" if i % 7 == 6 else ",".join("%.3f" % r.random() for _ in range(3))
        yield ["%s.reflectance=%s" % (name, colour)] + (
            ["%s.exponent=%.3g" % (name, 5 * 60 ** r.random())] if name in GLOSSY else [])


def last_of(steps):
    """What is left of a session: each number's last value."""
    return ["%s=%s" % item for item in dict(s.split("=") for step in steps for s in step).items()]


def main():
    relume, scenes = sys.argv[1:3]
    size, spp = (sys.argv[3:] + ["64x64", "64"][len(sys.argv) - 3:])[:2]
    with tempfile.TemporaryDirectory() as folder:
        b = Bench(relume, folder)
        for series in ("64,1,1,1", "64,8,1"):
            call(relume, "precompute", "edit", os.path.join(scenes, "cornell-glossy", "scene.xml"), "-o", b.at("t"),
                 "--bounces", str(series.count(",") + 1), "--series", series, "--size", size, "--spp", spp, "-q")
            edits = list(make_edits())
            worst = other = parity = short = band = 0
            for k in range(6, EDITS + 1, 6):
                steps, final = edits[:k], last_of(edits[:k])
                b.picture("t", "whole.exr", final, "--no-device")
                b.session("t", "frozen.exr", steps, "--no-device")
                worst = max(worst, b.error("whole.exr", "frozen.exr"))
                mixed = [[s] for s in final]
                random.Random(k).shuffle(mixed)
                b.session("t", "frozen.exr", mixed, "--no-device")
                other = max(other, b.error("whole.exr", "frozen.exr"))
                b.picture("t", "device.exr", final)
                parity = max(parity, b.error("whole.exr", "device.exr"))
                call(relume, "tensor", "requantise", b.at("t"), "-o", b.at("half"), "--half", "-q")
                b.picture("half", "half.exr", final, "--no-device")
                short = max(short, b.error("whole.exr", "half.exr"))
                band = max(band, b.steps("whole.exr", "half.exr"))
            print("%-9s frozen / whole %.1e; in another order %.1e; OpenCL / C %.1e; 16 / 32 bits %.1e, %d of 255"
                  % (series, worst, other, parity, short, band), flush=True)


main()
