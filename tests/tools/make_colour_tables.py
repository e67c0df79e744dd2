#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes lib/math/cie.h and lib/math/ior_table.h from folders of measured spectra.

    make_colour_tables.py SPECTRA LIB_MATH

SPECTRA holds cie/CIE_xyz_1931_2deg.csv (CIE 1931 observer, 1 nm, as the CIE publishes it),
illuminants-cie/D65.csv (5 nm, to 780 nm) and ior-mitsuba/*.{eta,k}.spd (optical constants of
Mitsuba's data package, from the Luxpop and SOPRA data bases and Palik 1998).

Conductors become linear Rec.709 triples in the way of Mitsuba 3's RGB variants: 1000 samples over
360..830 nm of the linearly interpolated constant times the observer, divided by the integral of
the observer's y, through the matrix from XYZ, negative values clamped.
"""
import pathlib
import sys

FIRST, LAST, STEP, SAMPLES = 360, 830, 5, 95
Y_INTEGRAL = 106.7502593994140625  # of the observer at 5 nm
# CIE 015:2018, table of illuminant D65, 785 to 830 nm
D65_TAIL = [63.8434, 64.304, 61.8779, 59.4519, 55.7054, 51.959, 54.6998, 57.4406, 58.8765, 60.3125]
FROM_XYZ = ((3.240479, -1.537150, -0.498535),
            (-0.969256, 1.875991, 0.041556),
            (0.055648, -0.204043, 1.057311))
DIELECTRICS = [  # Mitsuba's ior.h, which names its sources
    ("vacuum", 1.0), ("helium", 1.000036), ("hydrogen", 1.000132), ("air", 1.000277),
    ("carbon dioxide", 1.00045), ("water", 1.3330), ("acetone", 1.36), ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461), ("glycerol", 1.4729), ("benzene", 1.501),
    ("silicone oil", 1.52045), ("bromine", 1.661), ("water ice", 1.31), ("fused quartz", 1.458),
    ("pyrex", 1.470), ("acrylic glass", 1.49), ("polypropylene", 1.49), ("bk7", 1.5046),
    ("sodium chloride", 1.544), ("amber", 1.55), ("pet", 1.5750), ("diamond", 2.419)]


def rows(path):
    for line in path.read_text().splitlines():
        line = line.split("#")[0].replace(",", " ").split()
        try:
            yield [float(x) for x in line]
        except ValueError:
            continue  # a heading


def lerp(x, y, at):
    if at < x[0] or at > x[-1]:
        return None
    i = max(j for j in range(len(x) - 1) if x[j] <= at) if at > x[0] else 0
    return y[i] + (y[i + 1] - y[i]) * (at - x[i]) / (x[i + 1] - x[i])


def to_rgb(x, y, grid, observer):
    xyz = [0.0, 0.0, 0.0]
    steps = 1000
    i = 0
    for k in range(steps):
        at = FIRST + k / (steps - 1) * (LAST - FIRST)
        if at < x[0] or at > x[-1]:
            continue
        while i + 2 < len(x) and x[i + 1] <= at:
            i += 1
        value = y[i] + (y[i + 1] - y[i]) * (at - x[i]) / (x[i + 1] - x[i])
        for c in range(3):
            xyz[c] += lerp(grid, observer[c], at) * value
    scale = (LAST - FIRST) / steps / Y_INTEGRAL
    return [max(0.0, scale * sum(m * v for m, v in zip(row, xyz))) for row in FROM_XYZ]


def table(name, values):
    lines = [", ".join("%.10g" % v for v in values[i:i + 6]) for i in range(0, len(values), 6)]
    return "static const double %s[CIE_SAMPLES] = {\n    %s,\n};\n" % (name, ",\n    ".join(lines))


def main(spectra, out):
    cie = {int(r[0]): r[1:] for r in rows(spectra / "cie" / "CIE_xyz_1931_2deg.csv")}
    d65 = {int(r[0]): r[1] for r in rows(spectra / "illuminants-cie" / "D65.csv") if len(r) == 2}
    grid = list(range(FIRST, LAST + 1, STEP))
    observer = [[cie[w][c] for w in grid] for c in range(3)]
    illuminant = [d65[w] for w in grid if w <= 780] + D65_TAIL
    head = "// SPDX-License-Identifier: Apache-2.0\n// Made by tests/tools/make_colour_tables.py.\n"
    (out / "cie.h").write_text(
        head + "// CIE 1931 2 degree observer and illuminant D65, 360 to 830 nm in steps of 5 nm.\n"
        "#pragma once\n\nenum { CIE_FIRST = 360, CIE_LAST = 830, CIE_STEP = 5, CIE_SAMPLES = 95 };\n\n"
        + "\n".join(table("cie_" + n, v) for n, v in
                    [("x", observer[0]), ("y", observer[1]), ("z", observer[2]),
                     ("d65", illuminant)]))
    folder = spectra / "ior-mitsuba"
    names = sorted(p.name[:-8] for p in folder.glob("*.eta.spd"))
    lines = []
    for name in names:
        if not (folder / (name + ".k.spd")).exists():
            continue
        triples = []
        for part in "eta", "k":
            data = [r for r in rows(folder / ("%s.%s.spd" % (name, part))) if len(r) == 2]
            triples.append(to_rgb([r[0] for r in data], [r[1] for r in data], grid, observer))
        lines.append('    {"%s", {%s}, {%s}},' % (name, *(
            ", ".join("%.7gf" % v if "%.7g" % v != "0" else "0" for v in t) for t in triples)))
    (out / "ior_table.h").write_text(
        head + "// Complex indices of conductors as linear Rec.709 triples (eta, k), from the spectra of\n"
        "// Mitsuba's data package (Luxpop, SOPRA, Palik 1998), and indices of dielectrics.\n"
        "#pragma once\n\nstatic const struct {\n    const char *name;\n    float eta[3], k[3];\n"
        "} conductors[] = {\n" + "\n".join(lines) + "\n};\n\nstatic const struct {\n"
        "    const char *name;\n    float ior;\n} dielectrics[] = {\n"
        + "\n".join('    {"%s", %rf},' % d for d in DIELECTRICS) + "\n};\n")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
