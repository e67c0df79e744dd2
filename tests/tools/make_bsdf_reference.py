#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes what Mitsuba 3's materials evaluate to, for tests/unit/bsdf_reference.c.

    make_bsdf_reference.py NAME SEED COUNT > data/materials/NAME.txt

Needs the Python package mitsuba. A line is: parameters | wo | wi | f cos, three channels | pdf.
Half of the directions wi lie around the mirror image of wo or its image behind the surface, where
the narrow lobes are. Left out are indices within 0.05 of 1 and clear coats of gloss above 0.4,
where Mitsuba's formulas cancel, and views of opaque material from below, for which it has a density
although it samples nothing.
"""
import random
import sys

import mitsuba as mi

mi.set_variant("scalar_rgb")

SHARES = ["anisotropic", "spec_tint", "sheen", "sheen_tint", "flatness"]


def draw_parameters(name, rnd):
    """Parameter -> number or three."""
    out = {"base_color": [round(rnd.uniform(0, 1), 3) for _ in range(3)],
           "roughness": round(rnd.uniform(0.1, 1), 3)}
    more = ["metallic", "clearcoat", "clearcoat_gloss"] if name == "principled" else []
    for share in SHARES + more:
        if rnd.random() < 0.6:
            out[share] = round(rnd.uniform(0, 0.4 if share == "clearcoat_gloss" else 1), 3)
    if rnd.random() < 0.6:
        out["spec_trans"] = round(rnd.choice([1, rnd.uniform(0, 1)]), 3)
    if rnd.random() < 0.7:
        out["eta"] = round(rnd.choice([rnd.uniform(0.6, 0.95), rnd.uniform(1.05, 2.5)]), 3)
    elif name == "principled":
        out["specular"] = round(rnd.uniform(0.01, 1), 3)
    if name == "principledthin" and rnd.random() < 0.6:
        out["diff_trans"] = round(rnd.uniform(0, 2), 3)
    if rnd.random() < 0.3:
        out["diffuse_reflectance_sampling_rate"] = round(rnd.uniform(0, 3), 3)
    return out


def direction(rnd, about=None):
    """A unit vector, uniform or within a blur of another."""
    while True:
        v = [rnd.uniform(-1, 1) for _ in range(3)]
        n = sum(x * x for x in v)
        if 1e-3 < n < 1:
            break
    scale = n ** -0.5 if about is None else 0.3 * rnd.random()
    v = [scale * x + (about[i] if about else 0) for i, x in enumerate(v)]
    n = sum(x * x for x in v) ** 0.5
    return [float(f"{x / n:.9g}") for x in v]


def draw_wi(rnd, wo):
    """Uniform, or around the mirror image or straight through."""
    kind = rnd.randrange(4)
    if kind < 2:
        return direction(rnd)
    return direction(rnd, [-wo[0], -wo[1], wo[2] if kind == 2 else -wo[2]])


def evaluate(name, parameters, wo, wi):
    """f cos and pdf. What Mitsuba calls wi is our wo."""
    scene = {"type": name}
    for key, value in parameters.items():
        scene[key] = {"type": "rgb", "value": value} if isinstance(value, list) else float(value)
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(wo)
    si.sh_frame = mi.Frame3f([0, 0, 1])
    bsdf, context = mi.load_dict(scene), mi.BSDFContext()
    return list(bsdf.eval(context, si, mi.Vector3f(wi))), bsdf.pdf(context, si, mi.Vector3f(wi))


def is_seen(name, parameters, wo):
    """Whether the material scatters what comes along wo."""
    through = parameters.get("spec_trans", 0) * (1 - parameters.get("metallic", 0))
    return name == "principledthin" or wo[2] > 0 or through > 0


def text(values):
    return " ".join(f"{x:.9g}" for x in values)


def main():
    name, seed, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    rnd = random.Random(seed)
    print(f"# {name} of Mitsuba {mi.__version__}: make_bsdf_reference.py {name} {seed} {count}")
    while count > 0:
        parameters = draw_parameters(name, rnd)
        wo = direction(rnd)
        if not is_seen(name, parameters, wo):
            continue
        count -= 1
        wi = draw_wi(rnd, wo)
        f, pdf = evaluate(name, parameters, wo, wi)
        words = " ".join(f"{k}=" + ",".join(f"{x:g}" for x in (v if isinstance(v, list) else [v]))
                         for k, v in parameters.items())
        print(f"{words} | {text(wo)} | {text(wi)} | {text(f)} | {pdf:.9g}")


if __name__ == "__main__":
    main()
