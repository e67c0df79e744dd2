#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints tests/unit/rgl_references.inc: values of Mitsuba 3's `measured` plugin (scalar_rgb) for
materials of the RGL database at random directions.

usage: make_rgl_references.py FOLDER   (with *_rgb.bsdf)
"""
import glob
import math
import os
import random
import sys

import mitsuba as mi

mi.set_variant('scalar_rgb')
random.seed(1)


def direction():
    z = random.uniform(0.02, 1)
    phi = random.uniform(0, 2 * math.pi)
    r = (1 - z * z) ** 0.5
    return mi.Vector3f(r * math.cos(phi), r * math.sin(phi), z)


context = mi.BSDFContext()
print('// SPDX-License-Identifier: Apache-2.0')
print(f'// By tests/tools/make_rgl_references.py with Mitsuba {mi.__version__}: eye, light, '
      'f cos, pdf.')
for path in sorted(glob.glob(os.path.join(sys.argv[1], '*_rgb.bsdf'))):
    material = mi.load_dict({'type': 'measured', 'filename': path})
    for i in range(50):
        hit = mi.SurfaceInteraction3f()
        hit.wi, wo = direction(), direction()
        if i % 3 == 0:  # near the mirror direction, where materials peak
            wo = mi.Vector3f(-hit.wi.x, -hit.wi.y, hit.wi.z) + 0.2 * wo
            wo /= sum(x * x for x in wo) ** 0.5
        f = material.eval(context, hit, wo)
        row = list(hit.wi) + list(wo) + list(f) + [material.pdf(context, hit, wo)]
        print('{"' + os.path.basename(path) + '", {' + ', '.join('%.7g' % x for x in row) + '}},')
