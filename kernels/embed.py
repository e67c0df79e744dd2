#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a C file with the texts of OpenCL kernels, the headers they include put into their places.

usage: embed.py OUT.c KERNEL.cl...
"""
import os
import re
import sys


def text_of(path, seen):
    if path in seen:
        return ""
    seen.add(path)
    lines = []
    with open(path, encoding="utf-8") as source:
        for line in source:
            include = re.match(r'#include "kernels/(.+)"', line)
            if include:
                lines.append(text_of(os.path.join(os.path.dirname(path), include[1]), seen))
            elif not line.startswith("#pragma once"):
                lines.append(line)
    return "".join(lines)


def literal(text):
    rows = []
    for line in text.splitlines():
        rows.append('    "' + line.replace("\\", "\\\\").replace('"', '\\"') + '\\n"')
    return "\n".join(rows)


out, *kernels = sys.argv[1:]
with open(out, "w", encoding="utf-8") as f:
    f.write('#include "cl/sources.h"\n\n#include <stddef.h>\n\n')
    f.write("const struct compute_source compute_sources[] = {\n")
    for path in kernels:
        name = os.path.splitext(os.path.basename(path))[0]
        f.write('    {"%s",\n%s},\n' % (name, literal(text_of(path, set()))))
    f.write("    {NULL, NULL}};\n")
