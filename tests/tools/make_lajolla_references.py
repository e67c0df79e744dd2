#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reference pictures of scenes of lajolla by Mitsuba 3, for tests/render/lajolla.c.

    make_lajolla_references.py SCENES VOLUMES OUT [NAME ...]

SCENES and VOLUMES are the folders of the scenes and of their .vol files. Writes OUT/NAME.exr: means of
24x24 pixels with a box filter, and their squared standard errors as the layer `variance`, from
16 pictures with other random numbers each. Needs mitsuba, numpy, OpenEXR.

The files are those of Mitsuba 0.5, which has sigmaA and sigmaS, or density, where Mitsuba 3 has sigma_t
and albedo, takes a shape around a medium without a bsdf for no surface, and a light's spectrum of one
number for grey, where Mitsuba 3 has equal energy.
"""
import os
import re
import sys
import tempfile

import mitsuba
import numpy
import OpenEXR

SIZE, BATCHES = 24, 16
# Samples a pixel of each of the 16 pictures, and the integrator.
CASES = {
    "volpath_test1": (1024, "volpath"),
    "volpath_test2": (1024, "volpath"),
    "volpath_test3": (1024, "volpath"),
    "volpath_test4": (1024, "volpath"),
    "volpath_test5": (1024, "volpath"),
    "vol_cbox": (1024, "volpath"),
    "vol_cbox_teapot": (1024, "volpath"),
    "hetvol": (256, "volpath"),
    "hetvol_colored": (64, "volpathmis"),
}
# Where the file says, and as it stands in it.
GRID = ('type="gridvolume"><boolean name="use_grid_bbox" value="true"/>'
        '<boolean name="raw" value="true"/>')


def numbers(text):
    values = [float(v) for v in re.split(r"[ ,]+", text.strip())]
    return values * 3 if len(values) == 1 else values


def value(medium, name):
    return numbers(re.search(rf'<(?:rgb|spectrum) name="{name}" value="([^"]*)"', medium).group(1))


def translate_medium(match):
    medium = match.group(0)
    if 'name="sigmaA"' not in medium:
        medium = medium.replace('name="density"', 'name="sigma_t"').replace('type="gridvolume">', GRID)
        return re.sub(r'<(?:string name="method"|float name="stepSize")[^>]*>', "", medium)
    a, s = value(medium, "sigmaA"), value(medium, "sigmaS")
    t = [x + y for x, y in zip(a, s)]
    albedo = [y / z if z > 0 else 0 for y, z in zip(s, t)]
    most = max(t)  # colours above 1 are refused: the scale takes them
    scale = re.search(r'<float name="scale" value="([^"]*)"', medium)
    medium = re.sub(r'<(?:rgb|spectrum|float) name="(?:sigma[AS]|scale)"[^>]*>', "", medium)
    return medium.replace("</medium>", '<rgb name="sigma_t" value="%s"/><rgb name="albedo" value="%s"/>'
                          '<float name="scale" value="%.9g"/></medium>' % (
                              " ".join(str(x / most) for x in t), " ".join(map(str, albedo)),
                              most * float(scale.group(1) if scale else 1)))


def translate_shape(match):
    shape = match.group(0)
    if "<bsdf" in shape or 'name="interior"' not in shape or re.search(r'<ref id="', shape):
        return shape
    return shape.replace("</shape>", '<bsdf type="null"/></shape>')


def translate(text, integrator):
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"<medium.*?</medium>", translate_medium, text, flags=re.S)
    text = re.sub(r"<shape.*?</shape>", translate_shape, text, flags=re.S).replace("<lookAt", "<lookat")
    text = re.sub(r'<spectrum name="radiance" value="([\d.]+)"/>', r'<rgb name="radiance" value="\1"/>', text)
    text = re.sub(r'<(?:integer name="version"|boolean name="banner")[^>]*>', "", text)
    text = re.sub(r'<integrator type="\w+"', f'<integrator type="{integrator}"', text)
    text = re.sub(r'<integer name="(width|height)" value="\d+"', rf'<integer name="\1" value="{SIZE}"', text)
    return text.replace('<rfilter type="gaussian"', '<rfilter type="box"')


def render(path, spp):
    scene = mitsuba.load_file(path)
    pictures = [numpy.array(mitsuba.render(scene, spp=spp, seed=i + 1), dtype=numpy.float64)[..., :3]
                for i in range(BATCHES)]
    return numpy.mean(pictures, 0), numpy.var(pictures, 0, ddof=1) / BATCHES


def write(path, mean, variance, samples):
    channels = {}
    for i, c in enumerate("RGB"):
        channels[c] = mean[..., i].astype(numpy.float32)
        channels["variance." + c] = variance[..., i].astype(numpy.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage,
              "samples": float(samples), "renderer": "Mitsuba " + mitsuba.__version__}
    OpenEXR.File(header, channels).write(path)


def main():
    scenes, volumes, out = sys.argv[1:4]
    mitsuba.set_variant("llvm_ad_rgb")
    for name in sys.argv[4:] or CASES:
        spp, integrator = CASES[name]
        with tempfile.TemporaryDirectory() as folder:
            for f in os.listdir(scenes):
                os.symlink(os.path.join(scenes, f), os.path.join(folder, f))
            for f in os.listdir(volumes):
                if f.endswith(".vol"):
                    os.symlink(os.path.join(volumes, f), os.path.join(folder, f))
            with open(f"{scenes}/{name}.xml", encoding="utf-8") as file:
                text = translate(file.read(), integrator)
            with open(f"{folder}/reference.xml", "w", encoding="utf-8") as file:
                file.write(text)
            mean, variance = render(f"{folder}/reference.xml", spp)
        write(f"{out}/{name}.exr", mean, variance, spp * BATCHES)
        print(name, mean.mean((0, 1)), numpy.sqrt(variance.mean((0, 1)) / SIZE**2) / mean.mean((0, 1)), flush=True)


if __name__ == "__main__":
    main()
