#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume tonemap and info: known values of known pictures, and wrong usage.
#
# usage: tonemap.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

half=$folder/half.pfm png=$folder/out.png
make_pfm "$half" 5 7 3f000000

# shows VALUE OPTION...: the 8-bit value that 0.5 becomes
shows() {
    local value=$1
    shift
    expect 0 "$relume" tonemap "$half" -o "$png" "$@"
    expect 0 "$relume" info "$png" --json
    near "$out" channels.0.mean "$(python3 -c "print($value / 255)")"
    near "$out" channels.2.max "$(python3 -c "print($value / 255)")"
}

shows 188                          # 1.055 * 0.5^(1/2.4) - 0.055 = 0.7354
shows 137 --exposure -1            # 0.25: 0.5371
shows 255 --exposure 3
shows 206 --curve filmic           # 0.6163 by the curve: 0.8066
shows 188 --layer R
near "$out" width 5
near "$out" height 7
near "$out" bits 8

# A logarithmic scale: 0.5 of 0.05 to 5 is its middle, between #23888e and #1f988b; beside it a legend.
shows_middle() {
    expect 0 "$relume" tonemap "$half" -o "$png" "$@"
    expect 0 "$relume" info "$png" --json
    near "$out" width 101
    near "$out" height 96
    python3 - "$png" <<'END' || fail "false colour: wrong pixel for $*"
import struct, sys, zlib
data = open(sys.argv[1], "rb").read()
at, packed = 8, b""
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
    at += size + 12
rows = zlib.decompress(packed)
filters = {rows[y * (1 + 3 * 101)] for y in range(1)}
assert filters <= {0, 1}, filters
pixel = rows[1:4]
print(list(pixel))
sys.exit(any(abs(a - b) > 1 for a, b in zip(pixel, (0x21, 0x90, 0x8d))))
END
}
shows_middle --false-colour plain --range 0.05:5
shows_middle --false-colour cd/m2 --range 34.15:3415
shows_middle --false-colour lux --efficacy 200 --range 0:200 --linear
expect 0 "$relume" tonemap "$half" -o "$png" --false-colour lux
expect 1 "$relume" tonemap "$half" -o "$png" --false-colour lux --range 0:5
contains "$err" "LOW:HIGH"
for options in "--range 1:5" --linear "--false-colour lux --exposure 2" "--false-colour lux --curve filmic"; do
    # shellcheck disable=SC2086 # words
    expect 2 "$relume" tonemap "$half" -o "$png" $options
    contains "$err" "--false-colour"
done

expect 0 "$relume" info "$half" --json
near "$out" channels.1.mean 0.5
near "$out" bits 32
expect 0 "$relume" info "$half"
contains "$out" "width: 5"

expect 2 "$relume" tonemap "$half"
contains "$err" "--output"
# A PNG takes the place of no render and of no picture of another kind, not even of one that is not there.
cp "$half" "$folder/kept.exr"
for name in kept.exr out.jpg out out.png/out; do
    expect 2 "$relume" tonemap "$folder/none.pfm" -o "$folder/$name"
    contains "$err" "$name', expected a name that ends in .png"
done
cmp -s "$half" "$folder/kept.exr" || fail "tonemap wrote over kept.exr"
expect 0 "$relume" tonemap "$half" -o "$folder/OUT.PNG"
for command in "denoise none.exr" "merge none.exr" "edit none.safetensors" "relight none.safetensors"; do
    # shellcheck disable=SC2086 # words
    expect 2 "$relume" $command -o "$folder/kept.pfm"
    contains "$err" "ends in .exr"
done
expect 2 "$relume" tonemap "$half" -o "$png" --curve cinematic
contains "$err" "filmic"
expect 2 "$relume" tonemap "$half" -o "$png" --exposure bright
expect 1 "$relume" tonemap "$half" -o "$png" --layer albedo
contains "$err" "half.pfm"
expect 1 "$relume" tonemap "$half" -o "$folder/none/out.png"
expect 1 "$relume" tonemap "$folder" -o "$png"
echo "hello" >"$folder/text.png"
expect 1 "$relume" info "$folder/text.png"
contains "$err" "text.png"
printf '' >"$folder/empty.exr"
expect 1 "$relume" info "$folder/empty.exr"
contains "$err" "empty.exr"
expect 2 "$relume" inf "$half"
contains "$err" "'info'"
for name in "" compare tonemap info; do
    # shellcheck disable=SC2086 # no name: no argument
    expect 0 "$relume" $name --help
    contains "$out" "usage: relume"
done
expect 0 "$relume" --version
expect 2 "$relume"
finish
