#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes lib/light/sunsky_data.inc from the sky data of Hosek and Wilkie.

    make_sunsky_tables.py sunsky_datasets.bin > lib/light/sunsky_data.inc

The input is the tensor file of Mitsuba 3's data package (BSD 3-clause, see sunsky_data.c). Of the
sky the RGB tables are kept. The sun's RGB table there is the product of its spectral table, the
limb darkening and the observer; it is kept in that factored form, and each cubic over a segment of
elevations by its values at 4 elevations, the outer two shared with its neighbours.
"""
import array
import struct
import sys

SIZES = {10: ("f", 4), 11: ("d", 8)}


def fields(data):
    """Name -> flat array of doubles, of a tensor file version 1."""
    assert data[:12] == b"tensor_file\0"
    count, = struct.unpack_from("<I", data, 14)
    at, out = 18, {}
    for _ in range(count):
        length, = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        dims, kind, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dims}Q", data, at + 11)
        at += 11 + 8 * dims
        size = 1
        for n in shape:
            size *= n
        values = array.array(SIZES[kind][0])
        values.frombytes(data[offset:offset + size * SIZES[kind][1]])
        out[name] = list(values)
    return out


def write(name, values, digits):
    print(f"static const float {name}[{len(values)}] = {{")
    line = "   "
    for v in values:
        word = f" {v:.{digits}g}f,".replace("e-0", "e-").replace("e+0", "e")
        if "." not in word and "e" not in word:
            word = word.replace("f,", ".f,")
        if len(line) + len(word) > 100:
            print(line)
            line = "   "
        line += word
    print(line)
    print("};")


def sun_values(spectral):
    """[turbidity][wavelength][136 elevations], from [turbidity][45 segments][wavelength][4]."""
    half_pi = 1.5707963267948966
    out = []
    for t in range(10):
        for w in range(11):
            for segment in range(45):
                lo, hi = (half_pi * (s / 45) ** 3 for s in (segment, segment + 1))
                c = spectral[((t * 45 + segment) * 11 + w) * 4:][:4]
                for k in range(4 if segment == 44 else 3):
                    x = (hi - lo) * k / 3
                    out.append(c[0] + x * (c[1] + x * (c[2] + x * c[3])))
    return out


def main():
    with open(sys.argv[1], "rb") as f:
        data = fields(f.read())
    print("// Made by tests/tools/make_sunsky_tables.py.")
    write("SKY_PARAMS", data["sky_params_rgb"], 7)
    write("SKY_RADIANCE", data["sky_rad_rgb"], 7)
    write("SUN_RADIANCE", sun_values(data["sun_rad_spec"]), 5)
    write("SUN_LIMB", data["sun_ld_spec"], 7)


if __name__ == "__main__":
    main()
