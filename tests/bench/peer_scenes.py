#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write plain Mitsuba 3 copies of the Bitterli scenes, for timing relume and Mitsuba on one file.

    peer_scenes.py DATA OUT        DATA holds scenes/bitterli/{cornell-box,veach-mis,classroom}

Each OUT/<scene>/scene.xml takes the parameters spp, resx, resy, integrator, sampler, max_depth,
rr_depth, samples_per_pass and robust (mitsuba -D name=value): whether either program's rays are kept
from slipping through between triangles. The pixel filter is a box. Where Mitsuba can
be imported, classroom also gets scene_envmap.xml, its procedural sky baked to sky.exr.
"""
import argparse
import re
import shutil
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

SCENES = {
    # name: (file, width, height)
    "cornell-box": ("scene_mitsuba05.xml", 512, 512),
    "veach-mis": ("scene_mitsuba3.xml", 640, 360),
    "classroom": ("scene.xml", 640, 360),
}

OPAQUE = ("diffuse", "conductor", "roughconductor", "plastic", "roughplastic")

SENSOR = """
<root>
    <sampler type="$sampler">
        <integer name="sample_count" value="$spp"/>
    </sampler>
    <film type="hdrfilm">
        <integer name="width" value="$resx"/>
        <integer name="height" value="$resy"/>
        <string name="pixel_format" value="rgb"/>
        <string name="component_format" value="float32"/>
        <rfilter type="box"/>
    </film>
</root>"""

INTEGRATOR = """
<integrator type="$integrator">
    <integer name="max_depth" value="$max_depth"/>
    <integer name="rr_depth" value="$rr_depth"/>
    <integer name="samples_per_pass" value="$samples_per_pass"/>
</integrator>"""

# Mitsuba 0.x sunsky: y up, ground albedo 0.15, radius as a factor of the true one. Mitsuba 3: z up,
# albedo 0.3, radius as an aperture. Both keep the power of the sun when it grows.
SUN_APERTURE = 0.5338
SKY = """
<emitter type="sunsky">
    <float name="turbidity" value="{turbidity}"/>
    <rgb name="albedo" value="0.15"/>
    <vector name="sun_direction" x="{x}" y="{y}" z="{z}"/>
    <float name="sky_scale" value="{sky}"/>
    <float name="sun_scale" value="{sun}"/>
    <float name="sun_aperture" value="{aperture:.6g}"/>
    <transform name="to_world">
        <rotate x="1" angle="-90"/>
    </transform>
</emitter>"""

ENVMAP = '<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>'


def snake(name):
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def value_of(element, name, default=None):
    for child in element:
        if snake(child.get("name", "")) == name:
            return child.get("value", default)
    return default


def max_depth(scene):
    value = value_of(scene.find("integrator"), "max_depth")
    for default in scene.findall("default"):
        if value == "$" + default.get("name"):
            return default.get("value")
    return value


def twosided(scene):
    """Some walls of the Cornell box face away from us; its reference picture shows them lit."""
    for bsdf in scene.findall("bsdf"):
        if bsdf.get("type") in OPAQUE:
            inner = ET.Element("bsdf", type=bsdf.get("type"))
            inner.extend(list(bsdf))
            bsdf[:] = [inner]
            bsdf.set("type", "twosided")


def sky(old):
    sun = next(v for v in old if snake(v.get("name", "")) == "sun_direction")
    return ET.fromstring(SKY.format(
        x=sun.get("x"), y=sun.get("y"), z=sun.get("z"),
        turbidity=value_of(old, "turbidity", "3"),
        sky=value_of(old, "sky_scale", "1"),
        sun=value_of(old, "sun_scale", "1"),
        aperture=SUN_APERTURE * float(value_of(old, "sun_radius_scale", "1"))))


def convert(scene, width, height):
    """Rewrite a tree of either dialect in place as version 3, with our integrator and sensor."""
    depth = max_depth(scene)
    for child in list(scene):
        if child.tag in ("mode", "default", "integrator"):
            scene.remove(child)
    for element in scene.iter():
        if "name" in element.attrib:
            element.set("name", snake(element.get("name")))
        for child in list(element):
            if snake(child.get("name", "")) == "ext_eta":  # a conductor in something denser
                assert float(child.get("value")) == 1, "ext_eta is gone in Mitsuba 3"
                element.remove(child)
            if child.get("value") == "trilinear":
                child.set("value", "bilinear")
    twosided(scene)
    sensor = scene.find("sensor")
    for child in list(sensor):
        if child.tag in ("sampler", "film", "hide"):
            sensor.remove(child)
    sensor.extend(ET.fromstring(SENSOR))
    for index, child in enumerate(list(scene)):
        if child.tag == "emitter" and child.get("type") == "sunsky":
            scene.remove(child)
            scene.insert(index, sky(child))
    head = [ET.Element("default", name=name, value=value) for name, value in (
        ("integrator", "path"), ("sampler", "independent"), ("spp", "64"),
        ("resx", str(width)), ("resy", str(height)), ("max_depth", depth), ("rr_depth", "5"),
        ("samples_per_pass", "4294967295"), ("robust", "true"))]
    robust = ET.Element("boolean", name="embree_use_robust_intersections", value="$robust")
    scene[:0] = head + [ET.fromstring(INTEGRATOR), robust]
    scene.set("version", "3.0.0")


def write(scene, path):
    ET.indent(scene, "    ")
    ET.ElementTree(scene).write(path, encoding="utf-8", xml_declaration=True)


def bake_sky(emitter, path, width=2048, height=1024, sub=4):
    """Average a sunsky over the texels of a latitude-longitude map, y up."""
    import mitsuba as mi
    import numpy as np
    mi.set_variant("llvm_ad_rgb")
    emitter.set("version", "3.0.0")
    light = mi.load_string(ET.tostring(emitter, encoding="unicode"))
    u = (np.arange(width * sub) + 0.5) / (width * sub) * 2 * np.pi
    image = np.zeros((height, width, 3), np.float32)
    for row in range(height):
        theta = (row + (np.arange(sub) + 0.5) / sub) / height * np.pi
        t, p = np.meshgrid(theta, u, indexing="ij")
        d = np.stack([np.sin(p) * np.sin(t), np.cos(t), -np.cos(p) * np.sin(t)]).reshape(3, -1)
        si = mi.SurfaceInteraction3f()
        si.wi = -mi.Vector3f(d.astype(np.float32))
        rgb = np.maximum(np.array(light.eval(si)), 0)
        image[row] = rgb.reshape(3, sub, width, sub).mean(axis=(1, 3)).T
    mi.Bitmap(image).write(str(path))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    args = parser.parse_args()
    for name, (file, width, height) in SCENES.items():
        source, target = args.data / "scenes" / "bitterli" / name, args.out / name
        target.mkdir(parents=True, exist_ok=True)
        for folder in ("models", "textures"):
            for path in source.glob(folder + "/*"):
                (target / folder).mkdir(exist_ok=True)
                shutil.copyfile(path, target / folder / path.name)
        shutil.copyfile(source / "LICENSE.txt", target / "LICENSE.txt")
        scene = ET.parse(source / file).getroot()
        convert(scene, width, height)
        write(scene, target / "scene.xml")
        emitter = scene.find("emitter[@type='sunsky']")
        if emitter is None:
            continue
        try:
            bake_sky(emitter, target / "sky.exr")
        except ImportError:
            print(f"{name}: no mitsuba module, sky not baked", file=sys.stderr)
            continue
        scene.remove(emitter)
        scene.append(ET.fromstring(ENVMAP))
        write(scene, target / "scene_envmap.xml")


if __name__ == "__main__":
    main()
